"""The bound and the closed form that are stored beside a contact with friction, and the cycles of a stored run."""

import numpy as np
import pytest

import eigencontact as ec
from bodies import STEEL
from close import close
from eigencontact.core.grid import Grid
from eigencontact.core.material import Material
from eigencontact.execution.blocks.step import Step
from eigencontact.execution.mechanics.friction_reference import ReferenceShear
from eigencontact.results.cycles import last_cycle
from eigencontact.results.records import StepRecord
from eigencontact_plugins.geometries.sphere import Sphere

MU, LOAD = 0.5, 12.307
#: Hertz: radius of the contact [m] and largest pressure [Pa] of the ball of 200 um on steel.
A = (0.75 * LOAD * 200e-6 * (1 - 0.3**2) / 210e9) ** (1 / 3)
P0 = 1.5 * LOAD / (np.pi * A**2)
SLIDES = MU * LOAD


def run(steps, *, cells=24, coupling="partial", friction=None, geometry=None, folder=None, **more):
    scene = ec.Scene(
        body1=more.pop("body1", STEEL),
        geometry=geometry or {"type": "sphere", "radius": 200e-6},
        friction=friction or {"type": "coulomb", "coefficient": MU},
        grid={"cells": cells, "size": [48e-6, 48e-6]},
        steps=steps,
        numerics={"coupling": coupling, "threads": 1},
        output={"pictures": False},
        **more,
    )
    return ec.run(scene, folder).dataset


def cattaneo_mindlin(dataset, load):
    """Shear of K. L. Johnson 1985, eq. 7.41."""
    r = np.hypot(dataset["x"].values, dataset["y"].values[:, None])
    ratio = (1 - load / SLIDES) ** (1 / 3)

    def dome(size):
        return np.sqrt(np.maximum(0, 1 - (r / size) ** 2))

    return MU * P0 * (dome(A) - ratio * dome(ratio * A))


def holds(dataset):
    """At which steps a closed form is stored."""
    if "reference_shear_x" not in dataset:
        return [False] * dataset.sizes["step"]
    return [bool(np.isfinite(values).all()) for values in dataset["reference_shear_x"].values]


def test_bound_and_closed_form_of_cattaneo_and_mindlin():
    pull = {"tangential_load_x": 0.3 * SLIDES, "tangential_load_y": 0.4 * SLIDES, "increments": 2}
    dataset = run([{"normal_load": LOAD}, pull], coupling="none")
    np.testing.assert_allclose(dataset["shear_bound"], MU * dataset["pressure"], rtol=1e-12)
    assert holds(dataset) == [True] * 3
    expected = cattaneo_mindlin(dataset, 0.5 * SLIDES)
    found = [dataset[f"reference_shear_{axis}"][-1].values for axis in "xy"]
    np.testing.assert_allclose(found, [0.6 * expected, 0.8 * expected], rtol=0, atol=1e-6 * MU * P0)
    assert not np.any(dataset["reference_shear_x"][0])


X, Y = "tangential_load_x", "tangential_load_y"
PRESS = {"normal_load": LOAD}
#: Normal load, tangential loads along x and y, twist of each step; at which of them the closed form holds.
PATHS = {
    "gross slip and back": ([(LOAD, 0), (LOAD, SLIDES), (LOAD, 0.99 * SLIDES)], [True, True, False]),
    "unloaded, then more than before": ([(LOAD, 0), (LOAD, 2), (LOAD, 1), (LOAD, 2.5)], [True, True, False, False]),
    "held, but for the error of the solver": ([(LOAD, 0), (LOAD, 2, 1e-8), (LOAD, 2, -1e-8)], [True, True, True]),
    "turned": ([(LOAD, 0), (LOAD, 2), (LOAD, 2, 0.5)], [True, True, False]),
    "reversed at once": ([(LOAD, 0), (LOAD, 1), (LOAD, -2)], [True, True, False]),
    "pressed and pulled together": ([(LOAD, 2)], [False]),
    "pressed in two steps, then pulled": ([(6, 0), (LOAD, 0), (LOAD, 2)], [True] * 3),
    "pressed more while pulled": ([(6, 0), (6, 1), (LOAD, 1)], [True, True, False]),
    "twisted, then pulled": ([(LOAD, 0), (LOAD, 0, 0, 0.005), (LOAD, 1)], [True, False, False]),
    "apart": ([(0, 0), (LOAD, 0)], [False, False]),
}


@pytest.mark.parametrize("path", PATHS)
def test_the_closed_form_holds_until_the_path_is_left(path):
    points, expected = PATHS[path]
    ball, grid = Sphere(radius=200e-6), Grid(nx=9, ny=9, dx=5e-6, dy=5e-6)
    block, last, found = ReferenceShear(ball, "sphere", grid, (Material(**STEEL), None)), None, []
    y, x = grid.axes()
    for index, point in enumerate(points, 1):
        load, q_x, q_y, twist = (*point, 0.0, 0.0)[:4]
        pressure = ball.reference_pressure(x, y, load, 210e9 / 0.91)
        step = Step(index=index, time=float(index), previous=last)
        step.fields |= {"pressure": pressure, "shear_bound": MU * pressure}
        step.scalars |= {"normal_load": load, X: q_x, Y: q_y, "twist": twist, "tilt_x": 0.0, "tilt_y": 0.0}
        block.advance(step)
        found.append("reference_shear_x" in step.fields)
        last = StepRecord(index=index, time=float(index), scalars=step.scalars, fields=step.fields)
    assert found == expected


@pytest.mark.parametrize(
    "table",
    [
        {"coupling": "full", "body1": STEEL},  # normal and tangential are joined: the bodies differ
        {"friction": {"type": "shear-cap", "coefficient": MU, "cap": 4e9}},  # no one coefficient
        {"geometry": [{"type": "sphere", "radius": 200e-6}, {"type": "sphere", "radius": 1.0, "center": [1e-6, 0.0]}]},
    ],
    ids=["full coupling", "a cap that is reached", "two geometries of different axes"],
)
def test_no_closed_form(table):
    dataset = run([PRESS, {X: 1.0}], cells=12, **table)
    assert not any(holds(dataset))
    assert (dataset["shear_bound"] >= np.hypot(dataset["shear_x"], dataset["shear_y"]) * (1 - 1e-5)).all()


def test_two_spheres_about_one_axis_have_the_closed_form_of_their_relative_radius():
    balls = [{"type": "sphere", "radius": radius} for radius in (300e-6, 600e-6)]
    dataset = run([PRESS], coupling="none", geometry=balls)
    alone = run([PRESS], coupling="none", geometry={"type": "sphere", "radius": 200e-6})
    reference = [data["reference_pressure"][-1].values for data in (dataset, alone)]
    np.testing.assert_allclose(*reference, rtol=0, atol=1e-9 * reference[1].max())
    assert all(holds(dataset))


@pytest.mark.slow
@pytest.mark.parametrize("coupling", ["partial", "full"])
def test_the_area_of_a_closed_loop_is_the_local_work_of_friction(coupling):
    """But for what the trapezoids of the loop miss of its curved flanks: it falls with the increment, and faster."""
    missed, taken = {}, {}
    for count in (4, 16):
        turn = [
            {X: 0.8 * SLIDES, "increments": count // 2},
            {X: -0.8 * SLIDES, "increments": count},
            {X: 0.8 * SLIDES, "increments": count},
        ]
        dataset = run([PRESS, *turn, *turn[1:]], cells=12, coupling=coupling)
        history = {name: dataset[name].values for name in dataset.data_vars if dataset[name].dims == ("step",)}
        cycle = last_cycle(history)
        assert cycle.last - cycle.first == 2 * count
        # with full coupling the state at the two ends still differs, it shakes down for several cycles
        ends = history["shift_x"][[cycle.first, cycle.last]]
        still_open = cycle.load_amplitude * abs(ends[1] - ends[0]) / cycle.dissipated
        assert still_open < (0.02 if coupling == "full" else 1e-4)
        missed[count], taken[count] = (cycle.dissipated - cycle.work) / cycle.dissipated, cycle.dissipated
    assert abs(missed[16]) < 0.01
    assert taken[4] == close(taken[16], rel=0.02 if coupling == "full" else 1e-3)
    if coupling == "partial":
        assert 8.0 < missed[4] / missed[16] < 32.0


def test_a_resumed_run_knows_whether_the_path_was_kept(tmp_path, monkeypatch):
    from eigencontact.execution.mechanics.mechanics import RunningMechanics

    steps = [PRESS, {X: 1.0}, {X: 0.5}, {X: 2.0}]
    whole = run(steps, cells=12)

    advance = RunningMechanics.advance

    def stopping(self, step):
        if step.index > 3:
            raise KeyboardInterrupt
        advance(self, step)

    scene = {
        "body1": STEEL, "geometry": {"type": "sphere", "radius": 200e-6},
        "friction": {"type": "coulomb", "coefficient": MU}, "grid": {"cells": 12, "size": [48e-6, 48e-6]},
        "steps": steps, "numerics": {"coupling": "partial", "threads": 1}, "output": {"pictures": False},
    }  # fmt: skip
    with monkeypatch.context() as patch:
        patch.setattr(RunningMechanics, "advance", stopping)
        with pytest.raises(KeyboardInterrupt):
            ec.run(ec.Scene(**scene), tmp_path)
    resumed = ec.run(ec.Scene(**scene), tmp_path, resume=True).dataset
    assert holds(resumed) == holds(whole) == [True, True, False, False]
    np.testing.assert_array_equal(resumed["reference_shear_x"], whole["reference_shear_x"])
    np.testing.assert_array_equal(resumed["shear_bound"], whole["shear_bound"])
