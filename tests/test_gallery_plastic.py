"""Bundled scenes of bodies that yield, on coarser cells."""

import numpy as np
import pytest

import eigencontact as ec
from close import close
from eigencontact.scene.loader import bundled_names

COARSER = {
    "plastic-indentation": [
        "grid.cells-per-contact-radius=6", "numerics.inclusion-pitch='1 um'", "steps.0.increments=5",
        "steps.1.increments=2", "output.pictures=false",
    ]
}  # fmt: skip


def test_every_bundled_body_with_a_law_is_tested():
    scenes = {name: ec.load_scene(name) for name in bundled_names()}
    assert sorted(COARSER) == [name for name, scene in scenes.items() if scene.body1.law or scene.body2.law]


@pytest.fixture(scope="module")
def indented():
    return ec.run(ec.load_scene("plastic-indentation", COARSER["plastic-indentation"]))


def test_the_indentation_leaves_what_the_finite_elements_found(indented):
    """Depth 372.15 nm, print 81.6 nm; the peak of the pressure is 3.1 % high at six cells a radius, 1.6 % at ten."""
    data = indented.dataset
    assert indented.summary["converged"] is True
    assert float(data["approach"].max()) == close(372.15e-9, rel=0.01)
    assert float(data["max_sink"][-1]) == close(81.6e-9, rel=0.08)
    assert float(data["max_pressure"].max()) == close(5517e6, rel=0.04)
    assert float(data["plastic_zone_max_strain"][-1]) == close(0.01707, rel=0.05)


def test_unloading_is_elastic_and_leaves_a_wall_around_the_print(indented):
    data = indented.dataset
    assert np.all(data["inclusion_iterations"][5:] <= 1)
    strain = data["plastic_zone_max_strain"].values
    np.testing.assert_allclose(strain[5:], strain[4], rtol=1e-6)
    assert 1e-9 < float(data["max_uplift"][-1]) < 10e-9
    assert float(data["section_von_mises"][-1].max()) > 5e8


def test_the_observer_knows_the_zone(indented):
    """It reaches deeper than the contact is wide, and its volume is that of its cells."""
    last = indented.dataset.isel(step=-1)
    cells = np.count_nonzero(last["equivalent_plastic_strain_1"].values > 1e-9)
    edge = float(last["x"][1] - last["x"][0])
    pitch = np.diff(last["cells_1_z"].values)[0]
    assert float(last["plastic_zone_volume"]) == close(cells * edge**2 * pitch, rel=1e-9)
    assert 6e-6 < float(last["plastic_zone_deepest"]) < 15e-6
    assert last["plastic_zone_volume"].attrs["units"] == "m^3"
