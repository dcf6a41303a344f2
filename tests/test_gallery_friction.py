"""Every bundled scene with friction runs, is certified, and agrees with its closed form, here on coarser cells."""

import numpy as np
import pytest

import eigencontact as ec
from close import close
from eigencontact.scene.loader import bundled_names
from eigencontact_verification.oracles import spence

#: Coarser cells, so that each scene takes about a second; the rough scene keeps the points of its measurement.
COARSER = {
    "cattaneo-mindlin": ["grid.cells-per-contact-radius=24", "steps.1.increments=1", "stress.0.depth-cells=12"],
    "gross-slip": ["grid.cells-per-contact-radius=16", "steps.1.increments=4"],
    "fretting-fatigue-ball": ["grid.cells-per-contact-radius=10", "stress.0.depth-cells=6"],
    "fretting-mode-1": ["grid.cells-per-contact-radius=20", "steps.1.increments=5"],
    "fretting-mode-2": ["grid.cells-per-contact-radius=20"],
    "fretting-mode-3": ["grid.cells-per-contact-radius=20", *(f"steps.{k}.increments={4 * k}" for k in (1, 2))],
    "rotating-shear": ["grid.cells-per-contact-radius=12"],
    "rough-surface-friction": [],
}
#: Sphere of 200 um on steel under 12.307 N: contact radius [m]; load that friction carries [N].
A, CARRIED = 20.0e-6, 0.5 * 12.307


@pytest.fixture
def finished(finished):
    """Run a bundled scene on coarser cells."""
    return lambda name: finished(name, *COARSER[name])


def test_every_bundled_scene_with_friction_is_tested():
    """On homogeneous elastic bodies; others are in test_gallery_line.py, _layers.py, _plastic.py and _wear.py."""
    scenes = {name: ec.load_scene(name) for name in bundled_names()}
    plain = [
        name
        for name, scene in scenes.items()
        if scene.friction is not None and scene.body1.medium is None and scene.body1.law is None and scene.wear is None
        if not scene.grid.line
    ]
    assert plain == sorted(COARSER)


@pytest.mark.parametrize("name", COARSER)
def test_all_steps_are_certified_and_obey_the_law(name, finished):
    result = finished(name)
    data, scene = result.dataset, ec.load_scene(name)
    assert result.summary["converged"] is True
    for residual in ("gap", "penetration", "load", "bound", "stick", "alignment", "coupling"):
        assert float(data[f"{residual}_residual"].max()) <= 1e-6
    shear = np.hypot(data.shear_x.values, data.shear_y.values)
    bound = scene.friction["coefficient"] * data.pressure.values
    assert np.all(shear <= bound + 1e-6 * bound.max())
    np.testing.assert_allclose(shear[data.contact_zone.values == 1], bound[data.contact_zone.values == 1], rtol=1e-5)
    # The work of a step is taken with the mean of the shear at its ends, which undoes a little where the shear turns.
    energy = data.dissipated_energy.values
    assert np.all(np.diff(energy) >= -1e-9 * energy[-1])
    numbers = ("tangential_load", "shift_magnitude", "stick_radius", "slip_fraction", "dissipated_energy")
    for key in (*numbers, "torsion_moment"):
        assert result.summary[key] == float(data[key][-1])


def test_cattaneo_mindlin(finished):
    """CM-1."""
    summary = finished("cattaneo-mindlin").summary
    assert summary["contact_radius"] == close(A, rel=5e-3)
    assert summary["stick_radius"] == close(0.5 ** (1 / 3) * A, rel=1e-2)
    assert summary["shift_magnitude"] == close(449.3e-9, rel=5e-3)
    assert summary["max_von_mises"] > 0


def energy_of_the_cycle(data, increments):
    return float(data.dissipated_energy[-1] - data.dissipated_energy[-1 - increments])


def test_gross_slip(finished):
    """CM-3: slides at the bound of friction, and takes 3.762e-5 J a cycle."""
    data = finished("gross-slip").dataset
    assert energy_of_the_cycle(data, 32) == close(3.762e-5, rel=1e-2)
    np.testing.assert_allclose(data.tangential_load_x[[4, 20, 36]], [CARRIED, -CARRIED, CARRIED], rtol=1e-5)
    np.testing.assert_array_equal(data.slip_fraction[[4, 20, 36]], 1.0)
    assert float(data.slip_fraction[6]) < 0.5


def test_fretting_mode_1(finished):
    """CM-2: 0.5489 of what friction carries, c/a = 0.7670, 2.942e-7 J a cycle."""
    data = finished("fretting-mode-1").dataset
    np.testing.assert_allclose(data.tangential_load_x[[5, 25, 45]] / CARRIED, [0.5489, -0.5489, 0.5489], rtol=5e-3)
    np.testing.assert_allclose(data.stick_radius[[5, 25, 45]] / A, 0.7670, rtol=1e-2)
    assert energy_of_the_cycle(data, 40) == close(2.942e-7, rel=2e-2)


def test_fretting_mode_2(finished):
    """Spence's stick circle, mu/beta = 0.7, on forty increments; the ring slips inwards, its shear outwards."""
    data = finished("fretting-mode-2").dataset
    assert float(data.stick_radius[-1] / data.contact_radius[-1]) == close(0.7334, rel=1.5e-2)
    last = data.isel(step=-1)
    slipping = last.contact_zone == 1
    assert float((last.slip_x * last.x + last.slip_y * last.y).where(slipping).max()) < 0
    assert float((last.shear_x * last.x + last.shear_y * last.y).where(slipping).min()) > 0
    assert float(np.abs(last.tangential_load)) < 1e-9


def test_fretting_mode_2_has_the_shear_of_spence_without_kinks(finished):
    """Increments even in the radius: 0.9 % of root mean square, and second differences within 0.6 % of the peak.

    Forty increments even in the load leave 1.9 % and 4.6 %.
    """
    last = finished("fretting-mode-2").dataset.isel(step=-1)
    x, y = np.meshgrid(last.x, last.y)
    radius, peak = np.hypot(x, y), 1.5 * 12.307 / (np.pi * A**2)
    radial = (last.shear_x.values * x + last.shear_y.values * y) / radius
    exact = 2 / 7 * peak * spence.radial_shear((radius / A).ravel(), 0.7).reshape(radius.shape)
    assert np.sqrt(np.sum((radial - exact) ** 2) / np.sum(exact**2)) < 0.012
    middle = radius.shape[0] // 2
    sticks = radius[middle, 1:-1] < 0.68 * A
    bends = [np.diff(values[middle], 2)[sticks] / exact.max() for values in (radial, exact)]
    assert np.sqrt(np.mean((bends[0] - bends[1]) ** 2)) < 0.01


def test_fretting_mode_3(finished):
    """TO-1: moment and stick radius at the turns."""
    data = finished("fretting-mode-3").dataset
    np.testing.assert_allclose(data.torsion_moment[[4, 12, 28]], [65.05e-6, -65.05e-6, 65.05e-6], rtol=5e-3)
    np.testing.assert_allclose(data.stick_radius[[4, 12, 28]], 10e-6, rtol=2e-2)


def test_rotating_shear(finished):
    """The first pull is Cattaneo's; then the load keeps its size at the corners, and the stick circle shrinks."""
    data = finished("rotating-shear").dataset
    assert float(data.stick_radius[4]) == close(0.4 ** (1 / 3) * A, rel=2e-2)
    np.testing.assert_allclose(data.tangential_load[6::2], 0.6 * CARRIED, rtol=1e-5)
    assert float(data.stick_radius[-1]) < 0.93 * float(data.stick_radius[4])
    assert np.all(np.diff(data.dissipated_energy[4:]) > 0)


def test_rough_surface_friction(finished):
    """Half of what friction carries leaves some spots stuck; pulled back, the shear does not vanish with the load."""
    data = finished("rough-surface-friction").dataset
    assert 0.3 < float(data.slip_fraction[2]) < 0.95
    assert float(data.tangential_load_x[2]) == close(0.045, rel=1e-5)
    assert abs(float(data.tangential_load_x[4])) < 1e-6 * 0.09
    assert float(np.abs(data.shear_x[4]).max()) > 0.05 * float(data.pressure[4].max())


def test_fretting_fatigue_of_a_ball(finished):
    """Half a cycle later loads, bulk stress and shear have changed sign; it slips on one side in turn."""
    data = finished("fretting-fatigue-ball").dataset
    shear, bound = data.shear_x.values, data.shear_bound.values
    np.testing.assert_allclose(shear[21], -shear[15], rtol=0.0, atol=1e-3 * bound.max())
    np.testing.assert_allclose(shear[24], -shear[18], rtol=0.0, atol=1e-3 * bound.max())
    far = data.section_stress.values[:, 0, -1, :]
    stretched = data.bulk_stress_xx.values
    assert stretched[[15, 18, 21, 24]].tolist() == [0.0, 4e8, 0.0, -4e8]
    # The shear of half a cycle is that of the other with its sign: what does not change sign is the pressure's.
    np.testing.assert_allclose((far[18] - far[24]) / 2, np.full(far.shape[1], 4e8), rtol=0.1)
    slips = data.contact_zone.values[18] == 1
    right, left = slips[:, data.x.values > 0].sum(), slips[:, data.x.values < 0].sum()
    assert right > 2 * left
