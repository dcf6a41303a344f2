"""Load histories: ramps, increments, switches of control, and what watchers are told."""

import numpy as np
import pytest

import eigencontact as ec
from close import close
from eigencontact.execution.run.loading import LoadHistory, control_at
from eigencontact.scene.schema import Step

SMALL = ["stress=[]", "grid={cells=16, size=[1.6e-5, 1.6e-5]}"]


def all_points(steps, *, cycles=1, friction=False):
    history, points = LoadHistory(steps, friction=friction), []
    while (point := history.after(points[-1] if points else None, cycles=cycles)) is not None:
        points.append(point)
    return points


def test_load_points_count_through_the_ramps():
    ramps = [Step(normal_load=1.0, increments=2), Step(approach=1e-6), Step(normal_load=0.0, increments=3)]
    points = all_points(ramps)
    assert [point.index for point in points] == [1, 2, 3, 4, 5, 6]
    assert [point.time for point in points] == close([0.5, 1.0, 2.0, 2 + 1 / 3, 2 + 2 / 3, 3.0])
    assert [point.ramp for point in points] == [0, 0, 1, 2, 2, 2]
    assert [point.fraction for point in points][-1] == 1.0


@pytest.mark.parametrize(
    ("step", "fraction", "before", "expected"),
    [
        (Step(normal_load=4.0), 0.25, {}, {"normal_load": 1.0}),
        (Step(normal_load=4.0), 0.25, {"normal_load": 8.0}, {"normal_load": 7.0}),
        (Step(normal_load=0.1), 1.0, {"normal_load": 0.3}, {"normal_load": 0.1}),
        (Step(approach=4.0), 0.5, {"approach": 2.0, "normal_load": 9.0}, {"approach": 3.0}),
        (Step(normal_load=2.0, moment_x=1.0), 0.5, {"moment_x": -1.0}, {"normal_load": 1.0, "moment_x": 0.0}),
        (Step(approach=2.0, tilt_y=0.2), 0.5, {"tilt_y": 0.4}, {"approach": 1.0, "tilt_y": 0.3}),
    ],
)
def test_controls_along_a_ramp(step, fraction, before, expected):
    control = control_at(step, fraction, before)
    for name in ("normal_load", "approach", "moment_x", "moment_y", "tilt_x", "tilt_y"):
        value = getattr(control, name)
        assert value == close(expected[name], abs=1e-15) if name in expected else value is None


def test_frictionless_contact_has_no_memory():
    """Loading, unloading and a switch of control: the same load gives the same contact."""
    steps = "[{normal-load=0.6, increments=3}, {normal-load=0.2, increments=2}, {approach=0.0, increments=2}]"
    result = ec.run(ec.load_scene("hertz", [*SMALL, f"steps={steps}", "numerics.tolerance=1e-9"]))
    data = result.dataset
    np.testing.assert_allclose(data.normal_load[:5], [0.2, 0.4, 0.6, 0.4, 0.2], rtol=1e-8)
    np.testing.assert_allclose(data.time, [1 / 3, 2 / 3, 1, 1.5, 2, 2.5, 3], rtol=1e-15)
    for up, down in ((0, 4), (1, 3)):
        np.testing.assert_allclose(data.pressure[down], data.pressure[up], atol=1e-7 * float(data.max_pressure[up]))
    assert float(data.approach[5]) == close(0.5 * float(data.approach[4]), rel=1e-8)
    assert float(data.approach[6]) == 0.0
    assert float(data.normal_load[6]) == 0.0
    assert float(data.pressure[6].max()) == 0.0


def test_approach_and_load_control_are_two_ways_to_one_contact():
    tight = [*SMALL, "numerics.tolerance=1e-10"]
    loaded = ec.run(ec.load_scene("hertz", tight))
    approach = loaded.summary["approach"]
    pushed = ec.run(ec.load_scene("hertz", [*tight, f"steps=[{{approach={approach!r}}}]"]))
    assert pushed.summary["normal_load"] == close(0.65, rel=1e-8)
    peak = loaded.summary["max_pressure"]
    np.testing.assert_allclose(pushed.dataset.pressure, loaded.dataset.pressure, rtol=0, atol=1e-7 * peak)


class Diary:
    """Watcher that writes everything down."""

    def __init__(self):
        self.pages = []

    def step_started(self, point, total):
        self.pages.append(("started", point.index, total))

    def iterated(self, text, residual, tolerance):
        assert residual >= 0
        assert tolerance > 0
        if self.pages[-1][0] != "iterated":
            self.pages.append(("iterated", text))

    def step_finished(self, record, total):
        self.pages.append(("finished", record.index, total))


def test_a_watcher_is_told_of_every_step():
    diary = Diary()
    ec.run(ec.load_scene("hertz", [*SMALL, "steps.increments=2"]), watcher=diary)
    kinds = [page for page in diary.pages if page[0] != "iterated"]
    assert kinds == [("started", 1, 2), ("finished", 1, 2), ("started", 2, 2), ("finished", 2, 2)]
    assert sum(page[0] == "iterated" for page in diary.pages) >= 2


def test_two_observers_of_one_kind_keep_their_numbers_apart():
    observers = "[{type='probe', points=[[0.0, 0.0]]}, {type='probe', field='gap', points=[[7e-6, 0.0]]}]"
    result = ec.run(ec.load_scene("hertz", [*SMALL, f"observers={observers}"]))
    assert set(result.summary["observed"]) == {"probe_1_pressure_1", "probe_2_gap_1"}
    assert result.summary["observed"]["probe_2_gap_1"] > 0


def test_reference_pressure_is_only_given_where_it_holds():
    for changes, given in (([], True), (["steps.tilt-x=1e-6"], False), (["steps.normal-load=0"], False)):
        data = ec.run(ec.load_scene("hertz", [*SMALL, *changes])).dataset
        assert ("reference_pressure" in data and bool(np.isfinite(data.reference_pressure).any())) is given
