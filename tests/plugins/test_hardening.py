"""Hardening and damage laws: values, slopes against differences, what is refused, tables inside tables."""

import numpy as np
import pytest

import eigencontact as ec
from close import close
from eigencontact.errors import SceneError
from eigencontact.scene.files import anchored
from eigencontact.scene.installed import installed_plugins

P = np.array([0.0, 1e-5, 1e-3, 0.02, 0.3])
# key, fields, expected flow stress at P
ISOTROPIC = {
    "perfect": ({"yield_stress": "1 GPa"}, [1e9] * 5),
    "linear": ({"yield_stress": "1 GPa", "modulus": "10 GPa"}, 1e9 + 1e10 * P),
    "softening": ({"yield_stress": "1 GPa", "modulus": "-10 GPa"}, np.maximum(1e9 - 1e10 * P, 1e6)),
    # Thesis 4.1.4 (checked in the project's theory, A.8): first yield at 1655.7 MPa.
    "swift": ({"B": "1240 MPa", "C": 30, "n": 0.085}, 1240e6 * (30 + 1e6 * P) ** 0.085),
    "ludwik": ({"yield_stress": "1 GPa", "strength": "2 GPa", "n": 0.4}, 1e9 + 2e9 * P**0.4),
    "voce": ({"yield_stress": "1 GPa", "saturation": "-0.4 GPa", "rate": 50}, 0.6e9 + 0.4e9 * np.exp(-50 * P)),
    "tabulated": (
        {"strain": [0, 0.01, 0.1], "stress": ["1 GPa", "1.2 GPa", "1.5 GPa"]},
        [1e9, 1.0002e9, 1.02e9, 1.2e9 + 0.3e9 / 9, 1.5e9],
    ),
}


def law(name, **fields):
    return ec.make("linear" if name == "softening" else name, kind="hardening-law", **fields)


@pytest.mark.parametrize("name", ISOTROPIC)
def test_flow_stresses_are_those_of_the_formula(name):
    fields, expected = ISOTROPIC[name]
    np.testing.assert_allclose(law(name, **fields).flow_stress(P)[0], expected, rtol=1e-13)


@pytest.mark.parametrize("name", ISOTROPIC)
def test_slopes_are_derivatives(name):
    found = law(name, **ISOTROPIC[name][0])
    inner = P[1:]
    step = 1e-6 * inner
    rise = (found.flow_stress(inner + step)[0] - found.flow_stress(inner - step)[0]) / (2 * step)
    np.testing.assert_allclose(found.flow_stress(inner)[1], rise, rtol=1e-5, atol=1.0)


def test_swift_begins_to_yield_at_the_stress_of_the_reference():
    assert law("swift", **ISOTROPIC["swift"][0]).flow_stress(np.zeros(1))[0][0] == close(1655.7e6, rel=5e-5)


@pytest.mark.parametrize("key", ["exponential", "tabulated"])
def test_damage_rises_from_zero_with_its_slope(key):
    fields = {"exponential": {"saturation": 0.6, "strain": 0.02}, "tabulated": {"strain": [0, 0.1], "values": [0, 0.5]}}
    found = ec.make(key, kind="damage-law", **fields[key])
    assert found.damage(np.zeros(1))[0][0] == 0.0
    inner = P[1:-1]
    rise = (found.damage(inner * (1 + 1e-6))[0] - found.damage(inner * (1 - 1e-6))[0]) / (2e-6 * inner)
    np.testing.assert_allclose(found.damage(inner)[1], rise, rtol=1e-6)


@pytest.mark.parametrize(
    ("key", "fields", "message"),
    [
        ("perfect", {"yield_stress": 0}, r"yield.stress must be positive"),
        ("linear", {"yield_stress": 1e9}, r"modulus must be given, or else tangent-modulus"),
        ("linear", {"yield_stress": 1e9, "modulus": 1e9, "tangent_modulus": 1e9}, r"or else tangent-modulus"),
        ("swift", {"B": 1e9, "C": 0, "n": 0.1}, r"C must be positive"),
        ("voce", {"yield_stress": 1e9, "saturation": -1e9, "rate": 1}, r"above -yield-stress"),
        ("tabulated", {"strain": [0, 0.1, 0.1], "stress": [1, 2, 3]}, r"ascend from 0"),
        ("armstrong-frederick", {"modulus": -1.0, "recovery": 1}, r"modulus must be zero or positive"),
    ],
)
def test_refusals_name_the_field_and_the_rule(key, fields, message):
    with pytest.raises(SceneError, match=message):
        ec.make(key, kind="hardening-law", **fields)


def scene(material):
    return ec.Scene(
        body1={"young_modulus": "210 GPa", "poisson_ratio": 0.3},
        geometry={"type": "sphere", "radius": "105 um"},
        steps={"normal_load": "0.65 N"},
        inclusions={"type": "sphere", "radius": "2 um", "center": [0, 0, "4 um"], "material": material},
    )


STEEL = {"type": "j2", "young-modulus": "210 GPa", "poisson-ratio": 0.3}


@pytest.mark.parametrize(
    ("hardening", "message"),
    [
        ({"type": "perfekt"}, r"inclusions.material.hardening.*'perfect'"),
        ({"type": "perfect", "yield-stres": 1}, r"inclusions.material.hardening.*yield-stress"),
        ({"type": "perfect"}, r"inclusions.material.hardening.yield-stress must be given"),
        ([{"type": "perfect", "yield-stress": "1 m"}], r"hardening.0.yield-stress"),
        ({"type": "prager", "modulus": "1 GPa"}, r"hardening must be one that gives a yield stress"),
        ({"type": "linear", "yield-stress": "1 GPa", "tangent-modulus": "300 GPa"}, r"below Young's modulus"),
    ],
)
def test_laws_inside_a_law_are_refused_by_their_place(hardening, message):
    with pytest.raises(ec.EigencontactError, match=message):
        ec.explain(scene({**STEEL, "hardening": hardening}))


def test_a_component_with_components_comes_back_from_its_table():
    hardening = (ISOTROPIC["swift"][0] | {"type": "swift"}, {"type": "prager", "modulus": "5 GPa"})
    damage = {"type": "exponential", "saturation": 0.5, "strain": 0.01}
    material = ec.make("j2", young_modulus=2.1e11, poisson_ratio=0.3, hardening=hardening, damage=damage)
    table = scene(material).inclusions[0].material
    assert [one["type"] for one in table["hardening"]] == ["swift", "prager"]
    assert ec.make(table.pop("type"), **table) == material


def test_files_of_laws_inside_laws_are_found(tmp_path):
    (tmp_path / "curve.txt").write_text("0 1e9\n0.1 2e9\n")
    found = scene({**STEEL, "hardening": {"type": "tabulated", "file": "curve.txt"}}).within(tmp_path)
    placed, files = anchored(found, installed_plugins())
    assert files == (tmp_path / "curve.txt",)
    assert placed.inclusions[0].material["hardening"]["file"] == str(tmp_path / "curve.txt")
