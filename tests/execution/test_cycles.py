"""Cycles of a load history: the same as written out, also where a run is resumed, and where nothing wears."""

import numpy as np
import pytest

import eigencontact as ec
from bodies import rubbed
from eigencontact.execution.run.loading import LoadHistory
from eigencontact.scene.schema import Step
from eigencontact.scene.steps import each_impact

FRETTING = [{"shift-x": "60 nm"}, {"shift-x": "-60 nm", "increments": 2}, {"shift-x": 0.0}]
PRESSED = {"normal-load": 0.65}
#: Steps before a cycle, the cycle, steps after it, and whether there is friction.
HISTORIES = {
    "fretting": ([PRESSED], FRETTING, [], True),
    "from the start": ([], [{"normal-load": 1.0, "increments": 3}, {"normal-load": 0.0}], [], False),
    "a load that the cycle leaves": ([PRESSED], [{"shift-x": 1e-7}, {"normal-load": 0.4}], [{"shift-x": 0.0}], True),
    "another control at its end": (
        [PRESSED],
        [{"tangential-load-x": 0.1, "increments": 2}, {"shift-x": 0.0}, {"twist": 1e-4}],
        [{"torsion-moment": 0.0, "increments": 2}],
        True,
    ),
    "there and back": (
        [PRESSED | {"travel-x": 2e-6}],
        [PRESSED | {"travel-x": 5e-6, "increments": 3}, PRESSED | {"travel-y": 1e-6}, PRESSED],
        [PRESSED | {"travel-x": 0.0, "increments": 2}],
        False,
    ),
    "sliding": ([PRESSED], [PRESSED | {"sliding-distance": 1e-3, "increments": 2}, PRESSED], [], False),
    "impacts": ([], [{"normal-load": 1.0, "impacts": {"count": 3, "size": [1e-6, 1e-6]}}], [], False),
}


def points_of(steps, *, friction, jumps=1):
    """All that a history says of each of its points."""
    history, point, found = LoadHistory(each_impact([Step(**step) for step in steps]), friction=friction), None, []
    while (after := history.after(point, cycles=jumps)) is not None:
        ramp, before = history.ramp(after), history.ramp_before(after)
        values = {
            "time": after.time,
            "fraction": after.fraction,
            "ramp": {name: getattr(ramp, name.replace("-", "_")) for name in ramp.prescribed},
            "before": None if before is None else before.prescribed,
            "begins": history.begins_ramp(after),
            "travel": history.travel(after),
            "slide": history.slide(after, point),
        }
        found.append((after, values, history.cycle(after)))
        point = after
    return found


@pytest.mark.parametrize("case", HISTORIES)
def test_a_cycle_is_the_history_written_out(case):
    before, cycle, after, friction = HISTORIES[case]
    found = points_of([*before, {"cycle": cycle, "repeat": 4}, *after], friction=friction)
    plain = points_of([*before, *(4 * cycle), *after], friction=friction)
    assert [values for _, values, _ in found] == [values for _, values, _ in plain]
    assert [point.index for point, _, _ in found] == list(range(1, len(plain) + 1))


@pytest.mark.parametrize("case", HISTORIES)
def test_what_is_solved_of_skipped_cycles_is_what_stands_there_written_out(case):
    before, cycle, after, friction = HISTORIES[case]
    found = points_of([*before, {"cycle": cycle, "repeat": 9}, *after], friction=friction, jumps=3)
    plain = {values["time"]: values for _, values, _ in points_of([*before, *(9 * cycle), *after], friction=friction)}
    for point, values, place in found:
        but = {"slide"} if point.skipped else set()  # after skipped cycles the way from the point before is another
        assert {name: values[name] for name in values.keys() - but} == {
            name: plain[point.time][name] for name in values.keys() - but
        }
        assert (place is None) == (not point.segment.cycle)
    solved = sorted({place.number for _, _, place in found if place is not None})
    assert solved == [1, 4, 7, 9]


def test_the_place_in_a_cycle():
    found = points_of([PRESSED, {"cycle": FRETTING, "repeat": 6}], friction=True, jumps=4)
    places = [place for _, _, place in found]
    assert places[0] is None
    told = [(place.number, place.skipped, place.repeats_after, place.begins, place.ends) for place in places[1:]]
    assert told == [
        (1, 0, 5, True, False), (1, 0, 5, False, False), (1, 0, 5, False, False), (1, 0, 5, False, True),
        (5, 3, 1, True, False), (5, 0, 1, False, False), (5, 0, 1, False, False), (5, 0, 1, False, True),
        (6, 0, 0, True, False), (6, 0, 0, False, False), (6, 0, 0, False, False), (6, 0, 0, False, True),
    ]  # fmt: skip


def test_a_million_cycles_are_found_one_by_one():
    found = points_of([PRESSED, {"cycle": FRETTING, "repeat": 10**6}], friction=True, jumps=10**5)
    assert found[-1][0].time == 1 + 3 * 10**6
    assert len(found) == 1 + 4 * 11


def scene(steps, **changes):
    grid = {"cells": 12, "size": ["15 um", "15 um"]}
    return ec.load_scene(rubbed(**{"grid": grid, "steps": steps, **changes}))


def same(one, other, *, but=()):
    """Each number of two data sets to the last bit, but for times of the clock and what the solvers took."""
    but = {"solve_seconds", "convolutions", "iterations", "load_cycle", *but}  # written out there are no cycles
    assert set(one.variables) - but == set(other.variables) - but
    for name in set(one.variables) - but:
        np.testing.assert_array_equal(one[name].values, other[name].values, err_msg=name)


def worn(**table):
    return {"type": "dissipated-energy", "coefficient": "1e-2 mm^3/J"} | table


#: Names of what a run without wear has not, or what only cycles have.
OF_WEAR = (
    *("worn_depth", "worn_depth_1", "worn_volume", "max_worn_depth", "wear_energy", "energy_volume_residual"),
    *("wear_total_energy", "wear_error", "update_error"),
    *("reference_pressure", "reference_shear_x", "reference_shear_y"),
)
OF_CYCLES = ("cycles", "jump_cycles")


def test_a_repeated_cycle_is_the_run_written_out():
    """WR-20 without wear, to the bit."""
    repeated = ec.run(scene([PRESSED, {"cycle": FRETTING, "repeat": 3}])).dataset
    same(repeated, ec.run(scene([PRESSED, *(3 * FRETTING)])).dataset)
    assert repeated.sizes["step"] == 13


def test_a_repeated_cycle_wears_as_the_run_written_out():
    """WR-20 where each increment moves the surface."""
    repeated = ec.run(scene([PRESSED, {"cycle": FRETTING, "repeat": 3}], wear=worn(update="increment"))).dataset
    written = ec.run(scene([PRESSED, *(3 * FRETTING)], wear=worn(update="increment"))).dataset
    held = {name for name in repeated.variables if str(name).startswith("wear_") or name.startswith("history")}
    same(repeated, written, but={*OF_CYCLES, *held})
    assert float(written["worn_volume"][-1]) > 0


@pytest.mark.parametrize("update", ["cycle", "increment"])
def test_a_coefficient_of_zero_is_the_run_without_wear(update):
    slide = PRESSED | {"sliding-distance": "1 mm"}
    steps = [PRESSED, {"cycle": FRETTING, "repeat": 3}, slide, {"shift-x": "10 nm"}]
    table = worn(coefficient=0.0, update=update) | {"cycles-per-update": 1}
    none = ec.run(scene(steps, wear=table)).dataset
    assert float(none["max_worn_depth"].max()) == 0.0
    held = {name for name in none.variables if str(name).startswith("wear_") or name.startswith("history")}
    same(none, ec.run(scene(steps)).dataset, but={*OF_WEAR, *OF_CYCLES, *held})


class Stopped(Exception):
    """An end that nobody expects."""


class Stop:
    """Watcher that ends a run before a load step."""

    def __init__(self, index):
        self.index = index

    def step_started(self, point, _total):
        if point.index == self.index:
            raise Stopped

    def iterated(self, text, residual, tolerance):
        pass

    def step_finished(self, record, total):
        pass


BY_ERROR, BY_NUMBER = worn(), worn() | {"cycles-per-update": 4}
BY_INCREMENT = BY_NUMBER | {"update": "increment"}
# table of wear, load step before which a run ends: in a cycle, at its start, where cycles are skipped
STOPS = {
    "no wear, within": (None, 7),
    "at the start of the second": (BY_ERROR, 6),
    "within a later one": (BY_ERROR, 16),
    "after a jump": (BY_NUMBER, 10),
    "within, after a jump": (BY_NUMBER, 12),
    "increments": (BY_INCREMENT, 11),
}
QUICK = {"within, after a jump"}


@pytest.mark.parametrize("case", [pytest.param(one, marks=[pytest.mark.slow] * (one not in QUICK)) for one in STOPS])
def test_a_run_that_ends_within_a_cycle_is_resumed_to_the_bit(case, tmp_path):
    wear, index = STOPS[case]
    planned = scene([PRESSED, {"cycle": FRETTING, "repeat": 3 if wear is None else 12}], wear=wear)
    with pytest.raises(Stopped):
        ec.run(planned, tmp_path / "out", watcher=Stop(index))
    assert len(list((tmp_path / "out" / "steps").glob("[0-9]???.step"))) == index - 1
    resumed = ec.run(planned, tmp_path / "out", resume=True).dataset
    same(resumed, ec.run(planned).dataset)
    if wear is not None:
        assert float(resumed["cycles"][-1]) == 12.0
        assert float(resumed["jump_cycles"].max()) > 1
