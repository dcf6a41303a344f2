"""Bodies with a law: elastic to the bit below yield, references of cases.md above it, cycles, friction, refusals."""

import numpy as np
import pytest

import eigencontact as ec
from bodies import STEEL, SWIFT, perfect, pressed
from close import close
from eigencontact.errors import SceneError
from stopping import Stop, Stopper

LOAD, UNLOAD = {"normal_load": "0.65 N"}, {"normal_load": "0 N"}


def scene(law=None, law2=None, steps=(LOAD,), cells=16, **more):
    """Sphere on a plane, HZ-1; a body without law is rigid if the other has one."""
    rigid = {"rigid": True}
    bodies = {"body2": {**STEEL, "law": law2} if law2 else rigid} | ({"body1": rigid} if law2 and not law else {})
    return ec.Scene(**pressed(law, steps, cells, **more) | bodies)


@pytest.fixture(scope="module")
def elastic():
    return ec.run(scene(steps=[LOAD, {"normal_load": "0.1 N"}])).dataset


@pytest.mark.parametrize("stress", ["9 GPa", "5.45 GPa"])
def test_a_body_that_never_yields_is_an_elastic_one_to_the_bit(elastic, stress):
    """Hertz: the largest von Mises stress is .62 p0 = 5.25 GPa; a box is only made where that comes near the limit."""
    found = ec.run(scene(perfect(stress), steps=[LOAD, {"normal_load": "0.1 N"}])).dataset
    assert ("equivalent_plastic_strain_1" in found) == (stress == "5.45 GPa")
    for name in ("pressure", "displacement_z", "approach"):
        np.testing.assert_array_equal(found[name], elastic[name])


CYCLES = [LOAD, UNLOAD] * 2 + [LOAD]


@pytest.fixture(scope="module")
def cycled():
    return ec.run(scene(perfect("3 GPa"), steps=CYCLES)).dataset


def test_further_cycles_to_the_same_load_are_elastic(cycled):
    """EP-16; unloading applies the operator at most once, for what the last sweep left."""
    depth = cycled["approach"].values
    assert depth[0] > 1.5 * depth[1] > 0.0
    np.testing.assert_allclose(depth[[2, 4]], depth[0], rtol=1e-6)
    np.testing.assert_allclose(depth[3], depth[1], rtol=1e-5)
    assert np.all(cycled["inclusion_iterations"][1:] <= 1)


def test_bodies_may_be_exchanged(cycled):
    """EP-20: the same pressure and displacement in every step, and the strain in the other body."""
    other = ec.run(scene(None, perfect("3 GPa"), steps=CYCLES)).dataset
    np.testing.assert_array_equal(other["pressure"], cycled["pressure"])
    np.testing.assert_allclose(other["max_sink"], cycled["max_sink"], rtol=1e-12, atol=0.0)
    assert "equivalent_plastic_strain_2" in other
    assert "equivalent_plastic_strain_1" not in other


def test_bodies_yield_by_their_own_laws():
    """Two laws under one pressure: the weaker body yields more."""
    found = ec.run(scene(perfect("1.8 GPa"), perfect("2.4 GPa"), cells=8)).dataset
    weaker, stronger = (float(found[f"equivalent_plastic_strain_{body}"][-1].max()) for body in (1, 2))
    assert weaker > 3.0 * stronger > 1e-3


@pytest.mark.slow
def test_two_identical_bodies_behave_each_as_one_under_a_rigid_sphere_of_twice_the_radius():
    """EP-19: the total depth is twice that of one body under the gap r²/4R."""
    law = perfect("2 GPa")
    grid = {"cells": [16, 16], "size": ["22 um", "22 um"]}
    both = {"body1": {**STEEL, "law": law}, "body2": {**STEEL, "law": law}, "grid": grid, "output": {"pictures": False}}
    pair = ec.run(ec.Scene(**both, geometry={"type": "sphere", "radius": "100 um"}, steps=[LOAD])).dataset
    single = {"body1": {**STEEL, "law": law}, "grid": grid, "output": {"pictures": False}}
    one = ec.run(ec.Scene(**single, geometry={"type": "sphere", "radius": "200 um"}, steps=[LOAD])).dataset
    assert float(pair["approach"][0]) == close(2.0 * float(one["approach"][0]), rel=1e-5)
    np.testing.assert_allclose(pair["pressure"], one["pressure"], atol=1e-4 * float(one["pressure"].max()))
    strains = [pair[f"equivalent_plastic_strain_{body}"].values for body in (1, 2)]
    np.testing.assert_allclose(strains[0], strains[1], atol=1e-5 * strains[0].max())


@pytest.mark.parametrize("coupling", [pytest.param("none", marks=pytest.mark.slow), "full"])
def test_yield_and_friction(coupling):
    """Both at once: bounds hold, and a body that yields keeps displacements along all directions when unloaded."""
    steps = [LOAD, {"tangential_load_x": "0.1 N"}, {"tangential_load_x": "0 N", "normal_load": "0 N"}]
    friction = {"type": "coulomb", "coefficient": 0.3}
    found = ec.run(
        scene(perfect("3 GPa"), steps=steps, friction=friction, numerics={"coupling": coupling}, cells=12)
    ).dataset
    shear = np.hypot(found["shear_x"], found["shear_y"])
    assert np.all(shear <= 0.3 * found["pressure"] * (1 + 1e-9) + 1.0)
    assert float(found["tangential_load_x"][1]) == close(0.1, rel=1e-5)
    left = {name: float(abs(found[f"residual_displacement_{name}"][-1]).max()) for name in "xyz"}
    assert left["z"] > 3e-8
    assert min(left.values()) > 1e-9


@pytest.mark.slow
def test_resume_continues_to_the_bit(tmp_path):
    paused = scene(SWIFT, steps=[LOAD, UNLOAD, {"normal_load": "0.8 N"}], cells=8)
    whole = ec.run(paused).dataset
    with pytest.raises(Stop):
        ec.run(paused, tmp_path / "part", watcher=Stopper(2))
    continued = ec.run(paused, tmp_path / "part", resume=True).dataset
    np.testing.assert_array_equal(continued["pressure"], whole["pressure"])
    np.testing.assert_array_equal(continued["plastic_strain_1"], whole["plastic_strain_1"])


def test_the_room_around_a_zone_changes_neither_its_cells_nor_the_result():
    """The truncated cells are elastic: the room may cost growth, not accuracy."""
    near, far = (ec.run(scene(SWIFT, cells=6, numerics={"law_room": room})).dataset for room in (0.05, 0.6))
    strain = [found["equivalent_plastic_strain_1"][-1] for found in (near, far)]
    assert strain[0].size < 0.5 * strain[1].size
    heights = [np.diff(values["cells_1_z"])[0] for values in strain]
    np.testing.assert_allclose(heights[0], heights[1], rtol=1e-12)
    np.testing.assert_allclose(near["approach"], far["approach"], rtol=1e-6)
    np.testing.assert_allclose(near["print_depth"], far["print_depth"], rtol=1e-6)
    assert not np.any(strain[0][:, -1])
    assert not np.any(strain[0][..., [0, -1]])


PITCH = {"inclusion_pitch": "2 um"}
GROWING = {
    "steps": [{"normal_load": "0.3 N"}, {"normal_load": "0.75 N"}, UNLOAD],
    "numerics": PITCH | {"law_room": 0.0},
    "cells": 8,
}
LINE = {"name": "axis", "shape": "line", "start": [0, 0, "1 um"], "end": [0, 0, "15 um"], "count": 9}


@pytest.fixture(scope="module")
def grown(tmp_path_factory):
    """A body whose cells do not suffice at first, in a folder."""
    folder = tmp_path_factory.mktemp("grown")
    table = scene(perfect("1.5 GPa"), stress=[LINE], **GROWING).resolved()
    every = ec.Scene(**{**table, "output": {"pictures": False, "history": "all"}})
    return every, ec.run(every, folder), folder


@pytest.mark.slow
def test_a_box_that_yields_at_its_rim_grows_and_the_result_does_not_depend_on_it(grown):
    """State moves to the larger box; the same run with much room at first."""
    _, found, _ = grown
    wide = GROWING | {"numerics": PITCH | {"law_room": 1.0}}
    roomy = ec.run(scene(perfect("1.5 GPa"), stress=[LINE], **wide)).dataset
    data = found.dataset
    for name in ("approach", "max_sink"):
        np.testing.assert_allclose(data[name], roomy[name], rtol=1e-5)
    np.testing.assert_allclose(data["pressure"], roomy["pressure"], atol=1e-5 * float(roomy["pressure"].max()))
    np.testing.assert_allclose(data["axis_stress"], roomy["axis_stress"], atol=1e-4 * 1e9)
    strain = data["equivalent_plastic_strain_1"]
    rims = [strain[-1, -1], strain[-1, :, 0], strain[-1, :, -1], strain[-1, :, :, 0], strain[-1, :, :, -1]]
    assert max(float(abs(rim).max()) for rim in rims) == 0.0
    assert float(strain[0].max()) > 1e-3  # of the smaller box, in its place


@pytest.mark.slow
def test_another_region_of_a_body_that_has_grown(grown):
    _, found, folder = grown
    again = ec.region(folder, {**LINE, "name": "later"}, step=2)
    np.testing.assert_allclose(again["later_stress"].squeeze(), found.dataset["axis_stress"][1], rtol=1e-12, atol=1e-3)


@pytest.mark.slow
def test_resume_after_growth_continues_to_the_bit(grown, tmp_path):
    every, found, _ = grown
    with pytest.raises(Stop):
        ec.run(every, tmp_path, watcher=Stopper(2))
    continued = ec.run(every, tmp_path, resume=True).dataset
    np.testing.assert_array_equal(continued["pressure"], found.dataset["pressure"])
    np.testing.assert_array_equal(continued["plastic_strain_1"], found.dataset["plastic_strain_1"])


@pytest.mark.parametrize(
    ("law", "more", "message"),
    [
        ({"type": "isotropic", "young-modulus": 1e9, "poisson-ratio": 0.3}, {}, "body1.law.type must be of a material"),
        (perfect("1 GPa", **{"young-modulus": "9 GPa"}), {}, r"with the elastic constants of body 1"),
        pytest.param(  # the default tests of the elastic zone have a law of another kind
            perfect("1 Pa"), {}, r"body1.law must yield only near the contact .* times the yield.*; check the unit of",
            marks=pytest.mark.slow,
        ),
        ({"type": "j3"}, {}, r"body1.law.*'j2'"),
    ],
)  # fmt: skip
def test_laws_that_a_body_cannot_have_are_refused(law, more, message):
    with pytest.raises(ec.EigencontactError, match=message):
        ec.explain(scene(law, cells=6, **more))


def test_a_law_without_contact_or_in_a_rigid_or_layered_body_is_refused():
    ball = {"type": "sphere", "radius": "1 um", "center": [0, 0, "2 um"], "eigenstrain": 1e-3}
    with pytest.raises(SceneError, match=r"body1.law must be left out without a contact"):
        ec.explain(ec.Scene(body1={**STEEL, "law": SWIFT}, inclusions=ball))
    with pytest.raises(SceneError, match=r"leave out rigid or law"):
        ec.Scene(body1={"rigid": True, "law": SWIFT}, body2=STEEL, geometry={"type": "sphere", "radius": 1}, steps=LOAD)


@pytest.mark.slow
@pytest.mark.parametrize(("cells", "rims"), [(8, 0.05), (12, 0.03)])
def test_indentation_of_the_reference(cells, rims):
    """EP-1 of cases.md: depth 372.15 nm, print 81.6 nm (from below, first order), peak strain 1.707 %."""
    steps = [{**LOAD, "increments": 10}, {**UNLOAD, "increments": 3}]
    body = {"body1": {**STEEL, "law": SWIFT}, "geometry": {"type": "sphere", "radius": "105 um"}}
    grid = {"cells_per_contact_radius": cells, "margin": 1.6}
    found = ec.run(ec.Scene(**body, grid=grid, steps=steps, output={"pictures": False})).dataset
    assert float(found["approach"].max()) == close(372.15e-9, abs=0.6e-9)
    assert float(found["max_sink"][-1]) == close(81.6e-9, rel=rims)
    assert float(found["equivalent_plastic_strain_1"].max()) == close(0.01707, rel=0.02)
    spent = found["inclusion_iterations"].values
    assert spent[:10].sum() <= 80  # eight applications of the volume operator a step
    assert spent[10:].sum() <= 2


def test_a_contact_harder_than_its_estimate_is_a_warning():
    """A rough ball: coarse cells see 11.3 GPa of the 13 GPa that the tips of the roughness bear."""
    changes = ["output.pictures=false", 'body1.law={type="j2", hardening={type="perfect", yield-stress="%s"}}']
    found = ec.run(ec.load_scene("rough-surface", [changes[0], changes[1] % "8 GPa"]))
    assert found.summary["max_plastic_strain"] == 0.0
    assert "law-cells" in [one["code"] for one in found.summary["warnings"]]
    plain = ec.run(ec.load_scene("rough-surface", changes[:1]))
    assert "law-cells" not in [one["code"] for one in plain.summary["warnings"]]
