"""Bundled scenes that wear, on coarser cells, against closed forms, volumes by load and path, and the rings."""

import numpy as np
import pytest

import eigencontact as ec
from close import close
from eigencontact.scene.loader import bundled_names

#: Changes that make a run take about a second.
COARSER = {
    "wear-gross-sliding": ["grid.cells=33"],
    "fretting-wear-partial-slip": [
        "grid.cells=33",
        "steps.1.increments=2",
        "steps.2.cycle.0.increments=4",
        "steps.2.cycle.1.increments=4",
        "steps.2.repeat=6",
    ],
    "fretting-wear-gross-slip": [
        "grid.cells=33",
        "steps.1.increments=3",
        "steps.2.cycle.0.increments=6",
        "steps.2.cycle.1.increments=6",
        "steps.2.repeat=6",
    ],
    "fretting-loop-evolution": [
        'wear.coefficient="10 mm^3/(J mm)"',
        "grid.cells=25",
        "steps.1.increments=1",
        "steps.2.cycle.0.increments=5",
        "steps.2.cycle.1.increments=5",
        "steps.2.repeat=14",
    ],
    "pin-on-disc": [
        "grid.cells=[40, 18]",
        'grid.spacing=["12 um", "12 um"]',
        "steps.1.cycle.0.increments=20",
        "steps.1.cycle.1.increments=20",
        "steps.1.repeat=1",
    ],
    "worn-rough-surface": ["wear.jump-error=0.1", "steps.1.repeat=300"],
    "wear-and-plasticity": [
        "grid.cells=[19, 19]",
        'grid.spacing=["4 um", "4 um"]',
        "steps.0.increments=2",
        "steps.1.increments=4",
        "stress=[]",
    ],
}
#: Scenes that run with the slow tests: each takes a second or more.
LONG = {"fretting-loop-evolution", "fretting-wear-gross-slip", "worn-rough-surface"}
#: Sphere of 200 um on steel under 12.307 N: contact radius, radius of the sphere [m], load [N], p0 [Pa].
A, RADIUS, LOAD = 20e-6, 200e-6, 12.307
P0 = 1.5 * LOAD / (np.pi * A * A)
CARRIED = 0.5 * LOAD


@pytest.fixture
def finished(finished):
    """Run a bundled scene on coarser cells."""
    return lambda name, *changes: finished(name, *COARSER[name], *changes)


def test_every_bundled_scene_of_wear_is_tested():
    """The coating that is worn through is in a file of its own."""
    worn = [name for name in bundled_names() if ec.load_scene(name).wear is not None]
    assert [name for name in worn if name != "coating-worn-through"] == sorted(COARSER)


@pytest.mark.parametrize("name", [pytest.param(n, marks=[pytest.mark.slow] * (n in LONG)) for n in COARSER])
def test_volume_by_energy_or_by_load_and_path(name, finished):
    """What holds for any contact."""
    result = finished(name)
    data, scene = result.dataset, ec.load_scene(name)
    assert result.summary["converged"] is True
    worn, area = data.worn_depth.values[-1], float(np.prod(data.attrs["cell_size"]))
    assert worn.min() >= 0
    assert worn.sum() * area == close(float(data.worn_volume[-1]), rel=1e-12)
    assert np.all(np.diff(data.worn_volume.values) >= 0)
    if scene.wear.type == "dissipated-energy":
        assert float(data.energy_volume_residual[-1]) <= 1e-10


def ends_of_cycles(data):
    """Positions of the steps that end solved cycles, and how many cycles were done then."""
    cycles = data.cycles.values
    return np.flatnonzero(np.diff(cycles) == 1.0) + 1


#: Young's modulus of the coating: peak pressure at first over p0; after 1000 cycles peak pressure [Pa], largest depth,
#: and contact radius [m], by rings on the layered half-space (oracles/wear_rings, 176 rings, steps extrapolated).
COATINGS = {
    105: (0.7047, 5.222e9, 1.8349e-6, 32.9e-6),
    210: (1.0, 4.793e9, 2.0014e-6, 31.7e-6),
    420: (1.4754, 4.532e9, 2.0701e-6, 30.9e-6),
}


@pytest.mark.parametrize("young", [105, *(pytest.param(young, marks=pytest.mark.slow) for young in (210, 420))])
def test_coated_spheres_come_to_the_same_shape(young, finished):
    """WR-1 to WR-3, WR-17."""
    first, peak, depth, radius = COATINGS[young]
    changes = [] if young == 105 else [f'body1.medium.layers.0.young-modulus="{young} GPa"']
    data = finished("wear-gross-sliding", *changes).dataset
    assert float(data.cycles[-1]) == 1000
    assert float(data.worn_volume[-1]) == close(3076.8e-18, rel=1e-3)
    assert float(data.max_pressure[0]) / P0 == close(first, rel=0.01)
    assert float(data.max_pressure[-1]) == close(peak, rel=0.015)
    assert float(data.max_worn_depth[-1]) == close(depth, rel=0.01)
    assert float(data.contact_radius[-1]) == close(radius, abs=1.5e-6)
    assert float(data.wear_error[-1]) < 0.01


def test_sliding_all_over_the_contact_needs_no_increments(finished):
    """By a sliding-distance the contact slips as a whole at once: no work of friction is missed on the way."""
    result = finished("wear-gross-sliding")
    assert result.dataset.slip_fraction.values[:2].tolist() == [0.0, 1.0]
    assert "load-steps" not in str(result.summary["warnings"])


def test_partial_slip_wears_a_ring(finished):
    """WR-5: Mindlin's first cycle; nothing is worn inside the stick circle; the loop turns clockwise and narrows."""
    data = finished("fretting-wear-partial-slip").dataset
    ends = ends_of_cycles(data)
    load, energy = data.tangential_load_x.values, data.dissipated_energy.values
    assert load[2] == close(3.378, rel=0.01)
    assert energy[ends[0]] - energy[ends[0] - 8] == close(2.942e-7, rel=0.06)
    assert energy[ends[-1]] - energy[ends[-1] - 8] < 0.9 * (energy[ends[0]] - energy[ends[0] - 8])
    assert load[ends[-1]] < load[2]
    worn, r = data.worn_depth.values[-1], np.hypot(data.x.values, data.y.values[:, None])
    assert worn[r < 0.72 * A].max() == 0
    assert worn[(r > 0.85 * A) & (r < 0.95 * A)].mean() > 0.6 * worn.max()
    assert worn.max() < 217e-9
    np.testing.assert_allclose(worn, worn[::-1], atol=1e-4 * worn.max())


@pytest.mark.slow
def test_gross_slip_opens_the_loop_under_a_load(finished):
    """WR-6: deepest in the middle; a cycle costs 4 μ P (u0 - elastic shift), which shrinks as the contact grows."""
    data = finished("fretting-wear-gross-slip").dataset
    ends = ends_of_cycles(data)
    energy = data.dissipated_energy.values
    spent = energy[ends] - energy[ends - 12]
    assert spent[0] == close(3.762e-5, rel=0.02)
    assert np.all(np.diff(spent[data.jump_cycles.values[ends] == 1]) > 0)
    assert spent[-1] < 4 * CARRIED * 2.5e-6
    np.testing.assert_allclose(data.tangential_load_x.values[ends], CARRIED, rtol=1e-4)
    worn = data.worn_depth.values[-1]
    assert worn[16, 16] == worn.max()
    assert float(data.max_pressure[-1]) < 0.6 * P0


@pytest.mark.slow
def test_loops_close_under_an_approach(finished):
    """All of the sphere beyond the flat is worn off in the end, and carries nothing: V = π R d², depth d."""
    data = finished("fretting-loop-evolution").dataset
    assert float(data.worn_volume[-1]) == close(np.pi * RADIUS * (2e-6) ** 2, rel=2e-3)
    assert float(data.max_worn_depth[-1]) == close(2e-6, rel=1e-3)
    r = np.hypot(data.x.values, data.y.values[:, None])
    left = np.clip(2e-6 - r * r / (2 * RADIUS), 0, None)
    np.testing.assert_allclose(data.worn_depth.values[-1], left, atol=0.01 * 2e-6)
    load = data.tangential_load_x.values
    assert load[1] == close(CARRIED, rel=2e-3)
    assert np.abs(load[-10:]).max() < 1e-2 * CARRIED


def test_pin_on_disc(finished):
    """Half of the volume each; the ball's spot is round, the flat's track is as long as the stroke."""
    data = finished("pin-on-disc").dataset
    area = float(np.prod(data.attrs["cell_size"]))
    volumes = [float(data[f"worn_depth_{body}"][-1].sum()) * area for body in (1, 2)]
    assert volumes == close([2.5e-13 * 5 * 480e-6] * 2, rel=1e-5)
    stroke = data.isel(step=20)  # the end of the first one
    middle = [float(stroke.worn_depth_1.interp(x=0, y=0)), 2.5e-13 * 0.5 * np.pi * 1.127e9 * 46.03e-6]
    assert middle[0] == close(middle[1], rel=0.08)
    along, across = (float((data.worn_depth_2[-1] > 0).any(axis).sum()) for axis in ("y", "x"))
    assert along == across
    assert float((data.worn_depth_1[-1] > 0).any("y").sum()) == along + 20


@pytest.mark.slow
def test_a_rough_ball_runs_in(finished):
    """The peaks go first; volume by load and path."""
    data = finished("worn-rough-surface").dataset
    assert float(data.worn_volume[-1]) == close(1e-15 * 0.5 * 300 * 1e-4, rel=2e-4)
    assert np.all(np.diff(data.max_pressure.values) < 0)
    assert float(data.max_pressure[-1]) < 0.15 * float(data.max_pressure[0])
    assert float(data.contact_area[-1]) > 3 * float(data.contact_area[0])
    first, worn = data.pressure.values[0], data.worn_depth_2.values[-1]
    assert worn[first > 0].mean() > 3 * worn[first == 0].mean()


def test_wear_relieves_what_has_yielded(finished):
    """The strain of the loading stays; the pressure falls as the contact grows."""
    data = finished("wear-and-plasticity").dataset
    assert float(data.worn_volume[-1]) == close(738.4e-18, rel=1e-4)
    strain = data.plastic_zone_max_strain.values
    assert strain[1] > 0.008
    np.testing.assert_allclose(strain[1:], strain[1], rtol=0.01)
    assert np.all(np.diff(data.max_pressure.values[1:6]) < 0)
    assert float(data.max_pressure[-1]) == 0
