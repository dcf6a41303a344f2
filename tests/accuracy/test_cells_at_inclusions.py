"""Cells at inclusions of bodies that yield as a source of error: where they are one, counted once, refined."""

import json
from dataclasses import replace
from functools import cache

import pytest

import eigencontact as ec
from bodies import STEEL_TABLE as STEEL
from close import close
from eigencontact.accuracy import bars, refinement, runs
from eigencontact.accuracy.bars import Run, error_bars
from eigencontact.accuracy.levers import Lever, cheapest
from eigencontact.accuracy.pursuit import pursue
from eigencontact.accuracy.refinement import with_refinement
from eigencontact.accuracy.runs import Runs
from eigencontact.accuracy.sources import SOURCES, error_sources, without_overlap
from eigencontact.accuracy.targets import Targets
from eigencontact.core.cautions import Caution
from eigencontact.core.numbers import ErrorBar
from eigencontact.errors import NotConverged, SceneError

E, NU, RADIUS, LOAD = 210e9, 0.3, 105e-6, 0.65
A = (0.75 * LOAD * RADIUS / (E / (1 - NU**2))) ** (1 / 3)
NAME, KEY = "cells at inclusions", "inclusion-refinement"
BALL = {
    "type": "sphere", "center": [0.0, 0.0, 0.75 * A], "radius": 0.33 * A,
    "material": {"young-modulus": 2.0 * E, "poisson-ratio": NU},
}  # fmt: skip
BODY = {**STEEL, "law": {"type": "j2", "hardening": {"type": "perfect", "yield-stress": 14e9}}}
LATE = {"type": "j2", "hardening": {"type": "perfect", "yield-stress": 100e9}}
SCENE = {
    "body1": BODY,
    "geometry": {"type": "sphere", "radius": RADIUS},
    "grid": {"cells": 21, "size": 2.6 * A},
    "steps": [{"normal-load": LOAD}],
    "inclusions": [BALL],
    "output": {"pictures": False},
}


@cache
def _plan_of(text):
    return ec.plan(json.loads(text))


def plan_of(tables):
    """Plan of a scene, made once for all tests."""
    return _plan_of(json.dumps(tables, sort_keys=True))


def planned(refinement=1, **more):
    numerics = {"tolerance": 1e-6, KEY: refinement, **more.pop("numerics", {})}
    return plan_of({**SCENE, "numerics": numerics, **more})


def names(plan):
    return [source.name for source in error_sources(plan)]


def summary(value):
    declared = {"name": "depth", "unit": "m", "meaning": "depth", "role": "result", "headline": True}
    return {"numbers": {"depth": declared}, "observed": {}, "warnings": [], "depth": value}


# --- where it applies ------------------------------------------------------------------------------------------------


def test_the_source_is_there_where_a_body_yields_around_an_inclusion():
    assert names(planned()) == ["cells", "size of a cell", "load steps", NAME]
    assert names(planned(numerics={"inclusion-pitch": 0.1 * A}))[2:] == ["load steps", "cells along z", NAME]
    assert NAME in names(planned(numerics={"inclusion-resolution": {"whole": 2}}))
    assert NAME in names(planned(3))


@pytest.mark.parametrize(
    "change",
    [
        {"inclusions": []},
        {"body1": STEEL},
        {"body1": STEEL, "inclusions": [{**BALL, "material": {**STEEL, "type": "j2", **BODY["law"]}}]},
        {"eigenstrain": [{"type": "uniform", "value": 1e-4, "depth": 0.3 * A}]},
        {
            "wear": {"type": "dissipated-energy", "coefficient": "1 um^3/J", "body": 1},
            "friction": {"type": "coulomb", "coefficient": 0.1},
        },
    ],
    ids=["no inclusion", "no law", "law of the inclusion alone", "prescribed", "wear"],
)
def test_the_source_is_not_there_where_cells_cannot_be_finer_or_need_not_be(change):
    assert NAME not in names(planned(**change))


def test_cells_of_a_line_contact_are_refused_by_the_name_of_the_key():
    line = {"geometry": {"type": "cylinder", "radius": "10 mm"}, "steps": [{"normal-load": "200 N/mm"}]}
    line["grid"] = {"length": "infinite", "cells-per-contact-radius": 6}
    line["body1"] = {**STEEL, "law": {"type": "j2", "hardening": {"type": "perfect", "yield-stress": "500 MPa"}}}
    ball = {"type": "cuboid", "center": [0, 0, "150 um"], "edges": ["100 um", "1 m", "100 um"]}
    line["inclusions"] = [{**ball, "material": BALL["material"]}]
    assert NAME not in names(planned(**line))
    with pytest.raises(SceneError, match=rf"numerics\.{KEY} must be 1 where the contact is a line \(got 2\)"):
        planned(2, **line)


@pytest.mark.parametrize(("own", "other", "ratio"), [(1, 2, 0.5), (2, 1, 2.0), (3, 1, 3.0), (8, 4, 2.0)])
def test_cells_are_divided_by_half_or_twice_as_much(own, other, ratio):
    plan = planned(own)
    (source,) = (source for source in SOURCES if source.name == NAME)
    (variation,) = source.variations(plan)
    assert variation.changes == {"numerics": {KEY: other}}
    assert variation.ratio == ratio
    finer = {} if own == 8 else {"numerics": {KEY: 2 * own}}
    assert source.finer(plan, 2.0) == finer


# --- counted once ----------------------------------------------------------------------------------------------------

ELSEWHERE, THERE = 0.01, 0.03


def depth_of(first):
    """Depth with an error of first order in the edges of cells, elsewhere and at inclusions."""
    edge = first.grid.dx

    def depth(plan):
        size = plan.grid.dx / edge
        return 1.0 + ELSEWHERE * size + THERE * size / plan.numerics.inclusion_refinement

    return depth


def test_cells_at_inclusions_are_varied_on_few_load_steps():
    plan, solved = planned(steps=[{"normal-load": LOAD, "increments": 8}]), []

    def solve(tables, _):
        solved.append(plan_of(tables))
        return Run(solved[-1], summary(depth_of(plan)(solved[-1])))

    bar = error_bars(plan, summary(depth_of(plan)(plan)), solve).bars["depth"]
    assert bar.parts[NAME] == close(THERE)
    assert [one.steps for one in solved if one.numerics.inclusion_refinement == 2] == [4]
    assert len(solved) == 4


def test_cells_at_inclusions_are_varied_where_cells_are_as_coarse_along_z():
    """Half of the error is that of the edge along z, which the scene gives."""
    pitch = 0.1 * A
    plan = planned(numerics={"inclusion-pitch": pitch})

    def depth(other):
        edges = other.grid.dx / plan.grid.dx + other.numerics.inclusion_pitch / pitch
        return 1.0 + 0.5 * THERE * edges / other.numerics.inclusion_refinement

    def solve(tables, _):
        other = plan_of(tables)
        return Run(other, summary(depth(other)))

    assert error_bars(plan, summary(depth(plan)), solve).bars["depth"].parts[NAME] == close(THERE)


@pytest.mark.parametrize("refinement", [1, 2])
def test_cells_at_inclusions_have_their_own_part_of_the_error_and_no_other(refinement):
    plan = planned(refinement)
    depth, solved = depth_of(plan), []

    def solve(tables, _):
        solved.append(plan_of(tables))
        return Run(solved[-1], summary(depth(solved[-1])))

    bar = error_bars(plan, summary(depth(plan)), solve).bars["depth"]
    there = THERE / refinement
    assert bar.parts[NAME] == close(there)
    assert bar.parts["cells"] == close(1.25 * (ELSEWHERE + there) - there)
    assert bar.error == close(1.25 * (ELSEWHERE + there))
    coarsest = min(one.grid.nx for one in solved)
    assert [one.grid.nx for one in solved if one.numerics.inclusion_refinement != refinement] == [coarsest]


def test_a_source_that_is_left_out_is_seen(monkeypatch):
    kept = tuple(source for source in SOURCES if source.name != NAME)
    monkeypatch.setattr(bars, "error_sources", lambda plan: [one for one in kept if one.applies(plan)])
    with pytest.raises(KeyError, match=NAME):
        test_cells_at_inclusions_have_their_own_part_of_the_error_and_no_other(1)


@pytest.mark.parametrize("fault", ["counted twice", "of the coarse cells"])
def test_an_error_that_counts_twice_or_is_that_of_coarse_cells_is_seen(monkeypatch, fault):
    if fault == "counted twice":
        monkeypatch.setattr(bars, "without_overlap", dict)
    else:
        honest = bars.estimate
        monkeypatch.setattr(bars, "estimate", lambda *given, **more: honest(*given, **{**more, "size": 1.0}))
    with pytest.raises(AssertionError):
        test_cells_at_inclusions_have_their_own_part_of_the_error_and_no_other(1)


def test_an_error_above_that_of_all_cells_stands_alone():
    assert without_overlap({"cells": 1.0, "load steps": 2.0, NAME: 3.0}) == {"cells": 0.0, "load steps": 2.0, NAME: 3.0}
    assert without_overlap({"cells": 0.0, NAME: 0.0}) == {"cells": 0.0, NAME: 0.0}
    assert without_overlap({NAME: 3.0}) == {NAME: 3.0}


# --- refined by a target ---------------------------------------------------------------------------------------------


def levers(cells, there, price=0.5):
    parts = {"cells": cells, NAME: there}
    bar = ErrorBar(value=1.0, error=cells + there, source="cells", order=1.0, parts=parts)
    found = [
        Lever(source=one, seconds=price if one.of_cells else 2.0, memory=1.5) for one in SOURCES if one.name in parts
    ]
    return found, {"depth": bar}


def test_a_target_refines_the_cells_with_the_error():
    targets = Targets(allowed={"depth": 0.02})
    assert cheapest(*levers(0.001, 0.04), targets).factors == {NAME: 4.0}
    assert set(cheapest(*levers(0.05, 0.0), targets).factors) == {"cells"}


def test_cells_that_are_finer_everywhere_are_finer_at_inclusions():
    targets = Targets(allowed={"depth": 0.02})
    way = cheapest(*levers(0.02, 0.02, price=50.0), targets)
    assert set(way.factors) == {"cells"}
    assert way.errors["depth"] == close(0.04 / way.factors["cells"])


def course(target):
    """Pursuit of a depth whose error is at the inclusions, and its plans; nothing is solved."""
    solved = []

    def solve(plan, _):
        solved.append(plan)
        size = plan.grid.dx / solved[0].grid.dx
        return Run(plan, summary(1.0 + 0.002 * size**2 + 0.06 * size / plan.numerics.inclusion_refinement))

    small = {"grid": {"cells": 31, "size": 2.6 * A}, "inclusions": [{**BALL, "radius": 0.15 * A}]}
    plan = planned(accuracy={"approach": "1 %"}, numerics={"inclusion-pitch": 0.1 * A, "allow-coarse": True}, **small)
    targets = plan.scene.accuracy.model_copy(update={"numbers": target})
    targets.__pydantic_extra__.clear()
    return pursue(plan, targets, Runs(make=plan_of, solve=solve)), solved


def test_an_accuracy_makes_the_cells_at_inclusions_finer():
    answer, solved = course("5 %")
    last = answer.last
    assert last.holds
    assert last.run.plan.numerics.inclusion_refinement == 2
    assert last.run.plan.grid == solved[0].grid
    assert [rung["inclusion_refinement"] for rung in answer.to_dict()["accuracy"]["rungs"]] == [1, 2]
    error = last.run.summary["depth"] - 1.0
    assert error <= last.bars["depth"].error <= 1.5 * error
    settings = [
        (one.grid.nx, one.steps, one.numerics.inclusion_refinement, one.numerics.inclusion_pitch) for one in solved
    ]
    assert len(set(settings)) == len(settings)


def test_coarser_runs_without_the_finer_cells_are_seen(monkeypatch):
    """Planted fault: the error of all cells stays that of the run before, whose cells at inclusions were larger."""
    monkeypatch.setattr(runs, "EDGES", ())
    with pytest.raises(AssertionError):
        test_an_accuracy_makes_the_cells_at_inclusions_finer()


def test_cells_are_varied_alone_with_the_finer_cells_at_inclusions():
    """In the course of many load steps they are varied on the few of the first run."""
    found = Runs(make=plan_of, solve=lambda plan, _: Run(plan, summary(1.0)))
    found.rung(planned(), "first")
    alone = found._with_cells_of(planned(2, steps=[{"normal-load": LOAD, "increments": 9}]))
    assert (alone.plan.steps, alone.plan.numerics.inclusion_refinement) == (1, 2)


# --- "auto" ----------------------------------------------------------------------------------------------------------


def chosen(there, plan=None, elsewhere=ELSEWHERE):
    """Number that "auto" takes for an approach with an error at inclusions, its count of runs, and its warning."""
    plan, solved = plan or planned("auto"), []

    def solve(other, _):
        solved.append(other)
        size = other.grid.dx / plan.grid.dx
        found = summary(1.0 + elsewhere * size + there * size / other.numerics.refinement)
        declared = {"approach": {**found["numbers"]["depth"], "name": "approach"}}
        return Run(other, {**found, "numbers": declared, "approach": found["depth"]})

    refined, caution = with_refinement(plan, plan_of, solve)
    return refined.numerics.inclusion_refinement, len(solved), caution


@pytest.mark.parametrize(("there", "number"), [(0.0, 1), (0.01, 1), (0.03, 2), (0.05, 3), (0.5, 4)])
def test_auto_takes_the_smallest_number_within_two_per_cent(there, number):
    assert chosen(there)[:2] == (number, 2)


@pytest.mark.parametrize(("there", "share"), [(0.05, None), (0.5, 0.057), (0.9, 0.072)])
def test_auto_warns_where_4_leaves_more_than_two_per_cent(there, share):
    *_, caution = chosen(there)
    assert (caution is None) == (share is None)
    if caution is not None:
        assert caution.code == "inclusion-refinement"
        coarse = 21 / 9  # edge of the coarse cells
        assert caution.error == close(there / 4 / (1.0 + coarse * (ELSEWHERE + there))) == close(share, 0.01)
        assert f"error of approach by the cells at inclusions is {100 * share:.2g} %, above 2 %" in caution.words
        assert f"numerics.{KEY} = 4, the largest" in caution.words


@pytest.mark.parametrize(
    ("change", "keys"),
    [
        ({}, "(grid.cells)"),
        ({"grid": {"cells": 21, "spacing": 0.12 * A}}, "(grid.spacing)"),
        ({"grid": {"cells-per-contact-radius": 8}}, "(grid.cells-per-contact-radius)"),
        ({"numerics": {"inclusion-pitch": 0.1 * A}}, "(grid.cells and numerics.inclusion-pitch)"),
    ],
)
def test_the_warning_of_auto_names_the_keys_of_finer_cells(change, keys):
    *_, caution = chosen(0.5, planned("auto", **change))
    assert keys in caution.words


def test_auto_by_the_error_of_coarse_cells_is_seen(monkeypatch):
    monkeypatch.setattr(refinement, "edge_of", lambda _: 1.0)
    with pytest.raises(AssertionError):
        test_auto_takes_the_smallest_number_within_two_per_cent(0.03, 2)


@pytest.mark.parametrize("change", [{"inclusions": []}, {"body1": STEEL}, {"accuracy": {"approach": "1 %"}}])
def test_auto_is_1_without_a_run_where_nothing_has_to_be_chosen(change):
    assert chosen(0.5, planned("auto", **change)) == (1, 0, None)


def test_auto_whose_runs_fail_is_refused_with_the_reason():
    def solve(plan, _):
        if plan.numerics.refinement > 1:
            raise NotConverged("no convergence")
        return Run(plan, summary(1.0))

    with pytest.raises(SceneError, match=rf'numerics\.{KEY} must be a number .*\(got "auto": no convergence\)'):
        with_refinement(planned("auto"), plan_of, solve)


def test_results_of_auto_have_its_number_and_its_warning(monkeypatch):
    caution = Caution("inclusion-refinement", "a warning", 0.03)
    monkeypatch.setattr(refinement, "_AT_INCLUSIONS", replace(refinement._AT_INCLUSIONS, applies=lambda _: True))
    monkeypatch.setattr(refinement, "_chosen", lambda *_: (1, caution))
    small = {**SCENE, "grid": {"cells": 11, "size": 2.6 * A}, "body1": {**BODY, "law": LATE}}
    runs = [ec.run({**small, "numerics": {KEY: number, "allow-coarse": True}}) for number in ("auto", 1)]
    assert runs[0].summary["approach"] == runs[1].summary["approach"]
    assert "inclusion-refinement = 1" in runs[0].dataset.attrs["scene"]
    assert caution.to_dict() in runs[0].summary["warnings"]
    assert caution.to_dict() not in runs[1].summary["warnings"]


@pytest.mark.parametrize("value", [0, 9, 1.5, "many"])
def test_other_values_are_refused(value):
    with pytest.raises(SceneError, match=rf"numerics\.{KEY} must be a (whole )?number"):
        planned(value)
