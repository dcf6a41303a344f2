"""The law brittle: closed forms in tension, unloading, cracks that close, its tangent, what it refuses."""

import numpy as np
import pytest

import eigencontact as ec
from close import close
from eigencontact.errors import SceneError
from eigencontact.plugin import LawStep, isotropic_stiffness
from law_paths import pulled

E, NU = 30e9, 0.2
FIRST, A, B = 1e-4, 0.9, 1.5e4
MAZARS = {"type": "mazars", "threshold": FIRST, "A": A, "B": B}


def law(**more):
    return ec.make("brittle", young_modulus=E, poisson_ratio=NU, damage=MAZARS, **more)


def step(n=1, **means):
    return LawStep(x=np.zeros(n), y=np.zeros(n), z=np.ones(n), time=1.0, duration=1.0, means=means)


def at_rest(n=1):
    return {"equivalent_strain": np.zeros((1, n)), "damage": np.zeros((1, n))}


@pytest.mark.parametrize("closure", [False, True])
def test_tension_is_the_curve_of_the_source(closure):
    """Linear up to E κ0, then ``E (κ0 (1 - A) + A ε exp(-B (ε - κ0)))``."""
    strain = np.array([0.5, 0.999, 1.2, 2, 4, 10]) * FIRST
    (stress, across), _ = pulled(law(crack_closure=closure), strain)
    curve = E * (FIRST * (1 - A) + A * strain * np.exp(-B * (strain - FIRST)))
    np.testing.assert_allclose(stress, np.where(strain < FIRST, E * strain, curve), rtol=1e-9)
    # The strain across follows the strain, or where cracks close the stress.
    np.testing.assert_allclose(across, -NU * (stress / E if closure else strain), rtol=1e-8)


@pytest.mark.parametrize("closure", [False, True])
def test_unloading_goes_to_the_origin_and_loading_again_comes_back(closure):
    found = law(crack_closure=closure)
    (stress, _), after = pulled(found, np.array([3, 1.5, 0.3, 2.9, 3, 4]) * FIRST)
    np.testing.assert_allclose(stress[1:5] / stress[0], np.array([1.5, 0.3, 2.9, 3]) / 3, rtol=1e-9)
    (straight, _), once = pulled(found, [4 * FIRST])
    assert stress[5] == close(float(straight[0]), rel=1e-10)
    assert float(after["damage"][0, 0]) == close(float(once["damage"][0, 0]), rel=1e-12)


def test_closed_cracks_bear_pressure_as_sound_material_does_only_if_asked():
    """After a damage of 0.83 in tension: E in compression with closure, (1 - D) E without."""
    for closure in (True, False):
        (stress, _), after = pulled(law(crack_closure=closure), [3 * FIRST, -1e-5])
        left = 1.0 - float(after["damage"][0, 0])
        assert left < 0.25
        assert stress[1] == close(-1e-5 * E * (1.0 if closure else left), rel=1e-9)


def test_compression_breaks_by_the_stretch_across():
    """The stretch is √2 ν times the strain: D begins at κ0 / (√2 ν)."""
    first = FIRST / (np.sqrt(2) * NU)
    for strain, damaged in ((-0.999 * first, False), (-1.001 * first, True)):
        (_, across), after = pulled(law(), [strain])
        assert bool(after["damage"][0, 0] > 0) == damaged
        assert float(after["equivalent_strain"][0, 0]) == close(np.sqrt(2) * float(across[0]), rel=1e-9)


@pytest.mark.parametrize("closure", [False, True])
def test_sound_material_is_hookes(closure):
    strain = 0.3 * FIRST * np.random.default_rng(0).uniform(-1, 1, (6, 9))
    found = law(crack_closure=closure).update(strain, at_rest(9), step(9))
    stiffness = isotropic_stiffness(E, NU)
    np.testing.assert_allclose(found.stress, stiffness @ strain, rtol=0, atol=1e-13 * E * FIRST)
    np.testing.assert_allclose(found.tangent, np.repeat(stiffness[..., None], 9, 2), rtol=0, atol=1e-13 * E)
    assert not found.variables["damage"].any()


@pytest.mark.parametrize("closure", [False, True])
@pytest.mark.parametrize("local", [True, False])
def test_tangent_is_the_derivative_of_the_stress(closure, local):
    """Also of equal principal strains, and at a mean that does not follow the strain."""
    found, rng = law(crack_closure=closure), np.random.default_rng(1)
    strain = 3 * FIRST * rng.normal(size=(6, 12))
    strain[3:, :2] = 0.0
    strain[:3, 0] = strain[0, 0]
    where = step(12) if local else step(12, equivalent_strain=np.full((1, 12), 3 * FIRST))
    response = found.update(strain, at_rest(12), where)
    assert response.variables["damage"].min() > 0
    for j in range(6):
        change = np.zeros((6, 1))
        change[j] = 1e-9
        up, down = (found.update(strain + sign * change, at_rest(12), where).stress for sign in (1, -1))
        assert np.abs((up - down) / 2e-9 - response.tangent[:, j])[:, 1:].max() < 1e-5 * E
    assert np.isfinite(response.tangent).all()


def test_the_mean_about_a_point_decides_where_there_is_one():
    strain = np.array([[5 * FIRST, 0.2 * FIRST], *[[0, 0]] * 5])
    found = law().update(strain, at_rest(2), step(2, equivalent_strain=np.array([[0.0, 3 * FIRST]])))
    expected = 1 - (1 - A) / 3 - A * np.exp(-B * 2 * FIRST)
    np.testing.assert_allclose(found.variables["damage"][0], [0.0, expected], rtol=1e-12)
    np.testing.assert_allclose(found.variables["equivalent_strain"][0], strain[0], rtol=1e-12)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            {"damage": {"type": "exponential", "saturation": 0.5, "strain": 0.1}},
            r"damage.type must be one of 'mazars', 'tabulated' \(got 'exponential'\)",
        ),
        ({"damage": {"type": "tabulated", "strain": [0, 1], "values": [0, 0.5]}}, r"zero up to some strain"),
        ({"damage": MAZARS | {"A": 1.2}}, r"brittle\.damage\.A must be in \[0, 1\]"),
        ({"damage": MAZARS | {"length": "-1 mm"}}, r"length must be positive and finite"),
        ({"poisson_ratio": -0.1}, r"poisson.ratio must be in \[0, 0.5\)"),
    ],
)
def test_refusals_name_the_field_and_the_rule(change, message):
    with pytest.raises(SceneError, match=message):
        ec.make("brittle", **{"young_modulus": E, "poisson_ratio": NU, "damage": MAZARS, **change})


def test_damage_by_a_mean_that_is_a_jump_is_refused():
    """Without a length the cells say so themselves; with one, rounds between cells that flip to and fro had no end."""
    for steep in ({"B": 1e9}, {"B": 1e6}):
        with pytest.raises(SceneError, match=r"brittle.damage.type must be a law that rises by at most 0.5 .*flatter"):
            ec.make("brittle", damage=MAZARS | steep | {"length": 1e-3})
        ec.make("brittle", damage=MAZARS | steep)
    ec.make("brittle", damage=MAZARS | {"B": 1e5, "length": 1e-3})
    points = {"type": "tabulated", "strain": [0, 1e-4, 1.0001e-4, 1.0], "values": [0, 0, 0.8, 0.9]}
    with pytest.raises(SceneError, match=r"rises by 0\.8 at the strain 0\.0001"):
        ec.make("brittle", damage=points | {"length": 1e-3})
