"""Observers of friction on fields in closed form, and the closed cycles of a stored history."""

import numpy as np
import pytest

from close import close
from eigencontact.plugin import Grid, SceneError, StepView
from eigencontact.results.cycles import last_cycle
from eigencontact_plugins.observers.dissipated_energy import DissipatedEnergy
from eigencontact_plugins.observers.fretting_loop import FrettingLoop
from eigencontact_plugins.observers.stick_radius import StickRadius

GRID = Grid(nx=60, ny=40, dx=0.1, dy=0.2, center=(1.0, -2.0))
Y, X = GRID.axes()


def view(scalars=None, **fields):
    for values in fields.values():
        values.flags.writeable = False
    known = {"normal_load": 10.0, "contact_radius": 2.0, "shift_x": 3e-6, "shift_y": -4e-6, "twist": 2e-3}
    return StepView(index=1, grid=GRID, fields=fields, scalars=known if scalars is None else scalars)


def shear(q_x=0.0, q_y=0.0):
    density = np.full(GRID.shape, 0.25)
    return {
        "shear_x": q_x + np.zeros(GRID.shape),
        "shear_y": q_y + np.zeros(GRID.shape),
        "dissipated_energy_density": density,
    }


AREA = 6.0 * 8.0


@pytest.mark.parametrize(
    ("angle", "load", "shift"),
    [
        (0.0, 0.3 * AREA, 3e-6),
        (np.pi / 2, -0.4 * AREA, -4e-6),
        (np.arctan2(-4, 3), 0.5 * AREA, 5e-6),
        (np.arctan2(3, 4), 0.0, 0.0),
    ],
)
def test_a_point_of_the_loop_along_a_direction(angle, load, shift):
    found = FrettingLoop(angle=angle).observe(view(**shear(0.3, -0.4)))
    assert list(found) == ["load", "shift", "load_ratio", "dissipated_energy"]
    expected = [load, shift, load / 10.0, 0.25 * AREA]
    assert list(found.values()) == close(expected, rel=1e-12, abs=1e-12)
    assert found["shift"] == close(shift, rel=1e-12, abs=1e-20)


def test_a_point_of_the_loop_of_torsion():
    found = FrettingLoop(motion="twist").observe(view(**shear(-0.1 * (Y + 2.0), 0.1 * (X - 1.0))))
    # The polar moment of the window by the mid-point rule: b h (b² - dx² + h² - dy²) / 12, about its own centre.
    moment = 0.1 * AREA * (36.0 - 0.01 + 64.0 - 0.04) / 12
    assert found["moment"] == close(moment, rel=1e-12)
    assert found["load_ratio"] == close(moment / 20.0, rel=1e-12)
    assert found["twist"] == 2e-3


def test_a_direction_that_the_run_leaves_out_is_zero():
    fields = shear(0.3)
    del fields["shear_y"]
    scalars = {"normal_load": 0.0, "shift_x": 1e-6}
    found = FrettingLoop(angle=np.pi).observe(view(scalars, **fields))
    assert found["load"] == close(-0.3 * AREA, rel=1e-12)
    assert (found["shift"], found["load_ratio"]) == (-1e-6, 0.0)


def test_the_dissipated_energy_of_two_patches():
    left = np.exp(-((X + 0.55) ** 2 + (Y + 2.1) ** 2) / 0.08) * (X < 1)
    right = 2.0 * np.exp(-((X - 2.45) ** 2 + (Y + 2.1) ** 2) / 0.08) * (X >= 1)
    found = DissipatedEnergy().observe(view(dissipated_energy_density=left + right))
    cell = GRID.cell_area
    assert found["patches"] == 2
    assert found["total"] == close((left + right).sum() * cell, rel=1e-12)
    assert found["largest_patch"] == close(right.sum() * cell, rel=1e-5)  # but for the cells below the threshold
    assert (found["max_x"], found["max_y"]) == close((2.45, -2.1), rel=1e-12)
    assert found["max_density"] == (left + right).max()
    # Two clouds of weights 1 and 2 at a distance of 3 and of variance 0.08 in all: r² = 0.08 + (1/3)(2/3) 9.
    assert found["spread"] == close(np.sqrt(0.08 + 2.0), rel=2e-3)
    covered = np.count_nonzero((left + right) > 1e-6 * found["max_density"]) * cell
    assert found["mean_density"] * covered == close(found["total"], rel=1e-5)


def test_a_higher_threshold_parts_patches():
    density = np.exp(-((np.abs(X - 1.0) - 1.5) ** 2) - (Y + 2.0) ** 2)  # two hills, 0.105 of the largest between them
    assert DissipatedEnergy(threshold=0.05).observe(view(dissipated_energy_density=density))["patches"] == 1
    assert DissipatedEnergy(threshold=0.2).observe(view(dissipated_energy_density=density.copy()))["patches"] == 2


def test_the_stick_zone_of_an_ellipse():
    contact = ((X - 1.0) / 2.5) ** 2 + ((Y + 2.0) / 3.5) ** 2 < 1
    stick = ((X - 1.5) / 1.2) ** 2 + ((Y + 2.4) / 2.0) ** 2 < 1
    found = StickRadius().observe(view(contact_zone=np.where(stick, 2.0, np.where(contact, 1.0, 0.0))))
    assert found["radius"] == close(np.sqrt(1.2 * 2.0), rel=0.01)
    assert found["half_width_x"] == close(1.2, abs=0.051)
    assert found["half_width_y"] == close(2.0, abs=0.101)
    assert found["eccentricity"] == close(np.hypot(0.5, 0.4), rel=0.02)
    assert found["ratio"] == close(np.sqrt(1.2 * 2.0 / (2.5 * 3.5)), rel=0.01)


def test_zeros_where_nothing_slips_or_sticks():
    zero = np.zeros(GRID.shape)
    assert set(DissipatedEnergy().observe(view(dissipated_energy_density=zero)).values()) == {0.0}
    assert set(StickRadius().observe(view(contact_zone=zero + 1.0)).values()) == {0.0}


OBSERVERS = [FrettingLoop(), DissipatedEnergy(), StickRadius()]


@pytest.mark.parametrize("observer", OBSERVERS, ids=lambda observer: observer.key)
def test_names_stay_the_same_and_values_are_plain_floats(observer):
    rest = view(**shear(), contact_zone=np.zeros(GRID.shape))
    zone = np.zeros(GRID.shape)
    zone[5:20, 5:20] = 2.0
    loaded = view(**shear(1.0), contact_zone=zone)
    found = [observer.observe(step) for step in (rest, loaded)]
    assert list(found[0]) == list(found[1])
    assert all(type(value) is float for numbers in found for value in numbers.values())


@pytest.mark.parametrize("observer", OBSERVERS, ids=lambda observer: observer.key)
def test_a_run_without_friction_is_refused(observer):
    with pytest.raises(SceneError) as caught:
        observer.observe(view(pressure=np.zeros(GRID.shape), gap=np.zeros(GRID.shape)))
    assert str(caught.value) == (
        f"{observer.key} must observe a contact with friction (got fields gap, pressure); add a table [friction]"
    )


@pytest.mark.parametrize(
    ("build", "message"),
    [
        (lambda: FrettingLoop(motion="roll"), "fretting-loop.motion must be 'shift' or 'twist' (got 'roll')"),
        (lambda: FrettingLoop(angle=np.inf), "fretting-loop.angle must be finite [rad] (got inf)"),
        (
            lambda: FrettingLoop(motion="twist", angle=1.0),
            "fretting-loop.angle must be 0 for motion = 'twist' (got 1.0)",
        ),
        (
            lambda: DissipatedEnergy(threshold=1.0),
            "dissipated-energy.threshold must be 0 or more and below 1 [-] (got 1.0)",
        ),
    ],
)
def test_wrong_tables_are_refused(build, message):
    with pytest.raises(SceneError) as caught:
        build()
    assert str(caught.value) == message


def mindlin(peak, steps, cycles=1):
    """Shifts and loads of Mindlin and Deresiewicz (1953) for a sphere, load in units of mu P and shift of that of the
    onset of sliding, from rest to `peak` and through whole cycles; the energy of one cycle in units of their product.
    """
    loading = np.linspace(0, peak, steps + 1)[1:]
    away = peak - np.linspace(0, 2 * peak, 2 * steps + 1)[1:]

    def first(load):
        return 1 - (1 - load) ** (2 / 3)

    back = first(peak) - 2 * first((peak - away) / 2)
    loads = np.concatenate([loading, *[np.concatenate([away, -away])] * cycles])
    shifts = np.concatenate([first(loading), *[np.concatenate([back, -back])] * cycles])
    d = (1 - peak) ** (1 / 3)
    # Twice the area between the branch of unloading and the chord, by the exact integral of (1 - s)^(2/3).
    exact = 4 * ((2 * 0.6 * (1 - d**5)) - peak * (1 + d**2))
    return shifts, loads, exact


@pytest.mark.parametrize("peak", [0.25, 0.5, 0.8, 0.999])
def test_the_area_of_a_mindlin_loop_converges_to_the_closed_form(peak):
    errors = []
    for steps in (10, 20, 40):
        shifts, loads, exact = mindlin(peak, steps)
        cycle = last_cycle({"tangential_load_x": 3.0 * loads, "shift_x": 5e-6 * shifts})
        assert (cycle.first, cycle.last) == (steps - 1, 5 * steps - 1)
        assert cycle.load_amplitude == close(3.0 * peak, rel=1e-12)
        assert cycle.displacement_amplitude == close(5e-6 * (1 - (1 - peak) ** (2 / 3)), rel=1e-12)
        assert np.isnan(cycle.dissipated)
        assert cycle.area == cycle.work
        errors.append(abs(cycle.area / (3.0 * 5e-6 * exact) - 1))
    slope = -np.polyfit(np.log([10, 20, 40]), np.log(errors), 1)[0]
    assert slope == close(2.0, abs=0.35)
    assert errors[-1] < 3e-3


def test_of_several_cycles_the_last_and_its_own_work():
    shifts, loads, _ = mindlin(0.8, 8, cycles=3)
    spent = np.linspace(0, 7.0, loads.size)
    cycle = last_cycle({"tangential_load_x": loads, "shift_x": shifts, "dissipated_energy": spent})
    assert (cycle.first, cycle.last) == (7 + 64, 7 + 96)
    assert cycle.dissipated == close(7.0 * 32 / 103, rel=1e-12)


def test_a_circular_path_in_the_plane():
    angle = np.linspace(0, 4 * np.pi, 65)
    lag = 0.3
    history = {
        "tangential_load_x": 2 * np.cos(angle + lag), "tangential_load_y": 2 * np.sin(angle + lag),
        "shift_x": 3 * np.cos(angle), "shift_y": 3 * np.sin(angle),
    }  # fmt: skip
    cycle = last_cycle(history)
    assert (cycle.first, cycle.last) == (32, 64)
    polygon = 32 * np.sin(2 * np.pi / 32)
    assert cycle.area == close(6 * np.sin(lag) * polygon, rel=1e-12)
    assert (cycle.load_amplitude, cycle.displacement_amplitude) == close((2, 3), rel=1e-12)


def test_gross_slip_without_stiffness_has_energy_ratio_one_in_torsion_too():
    history = {"torsion_moment": [1.0, 1, -1, -1, 1, 1], "twist": [0.0, 2, 2, -2, -2, 2], "normal_load": [5.0] * 6}
    cycle = last_cycle(history, "twist")
    assert (cycle.area, cycle.work, cycle.energy_ratio) == (8.0, 8.0, 1.0)
    assert np.isnan(last_cycle(history, "shift").energy_ratio)


@pytest.mark.parametrize(
    "history",
    [
        {},
        {"tangential_load_x": np.linspace(0, 1, 20), "shift_x": np.linspace(0, 1, 20)},
        {"tangential_load_x": np.zeros(9), "shift_x": np.zeros(9)},
        # Out and back to the start, but not round: the branch of unloading does not reach the state that it left.
        {"tangential_load_x": [0.0, 0.5, 1, 0.5, 0], "shift_x": [0.0, 0.5, 1.2, 0.8, 0.4]},
    ],
)
def test_no_closed_cycle(history):
    assert last_cycle(history) is None
