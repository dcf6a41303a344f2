"""Runs to an accuracy: reached and true against Hertz's closed form, refused with a reason, ended by the budget."""

import json
import subprocess
import sys
import tomllib
from dataclasses import replace
from math import log, pi

import pytest

import eigencontact as ec
from bodies import STEEL_TABLE as STEEL
from close import close
from eigencontact.accuracy import bars
from eigencontact.accuracy.bars import Run, error_bars
from eigencontact.accuracy.levers import Lever, cheapest
from eigencontact.accuracy.pursuit import pilot_cells, pilot_tables, pursue
from eigencontact.accuracy.runs import Runs, memory_of
from eigencontact.accuracy.settings import finer_settings
from eigencontact.accuracy.sources import SOURCES, error_sources
from eigencontact.accuracy.targets import Targets
from eigencontact.accuracy.words import accuracy_lines
from eigencontact.app import foretold
from eigencontact.core.numbers import ErrorBar
from eigencontact.errors import EigencontactError, NotConverged, ResultsError, SceneError
from eigencontact.planning.memory import results_bytes
from eigencontact_verification.benchmarks.accuracy_asked import verdict

LOAD, RADIUS = 0.65, 105e-6
HERTZ = {
    "body1": STEEL,
    "geometry": {"type": "sphere", "radius": RADIUS},
    "steps": {"normal-load": LOAD},
    "output": {"pictures": False},
}
FRICTION = {
    "friction": {"type": "coulomb", "coefficient": 0.3},
    "steps": [{"normal-load": LOAD}, {"tangential-load-x": 0.1, "increments": 2}],
}
HISTORY = {**FRICTION, "steps": [{"normal-load": LOAD}, {"tangential-load-x": 0.1, "increments": 8}]}


def pilot_of(scene):
    planned = ec.plan(scene)
    return ec.plan(pilot_tables(planned, pilot_cells(planned, ec.plan)))


def edge_of_pilot(scene):
    return pilot_of(scene).grid.dx


def closed_form():
    modulus = STEEL["young-modulus"] / (1 - STEEL["poisson-ratio"] ** 2)
    radius = (3 * LOAD * RADIUS / (4 * modulus)) ** (1 / 3)
    return {"max_pressure": 1.5 * LOAD / (pi * radius**2), "approach": radius**2 / RADIUS, "contact_radius": radius}


def summary(value, warnings=()):
    declared = {"name": "depth", "unit": "m", "meaning": "depth", "role": "result", "headline": True}
    return {"numbers": {"depth": declared}, "observed": {}, "warnings": list(warnings), "depth": value}


@pytest.mark.parametrize("target", ["2 %", 0.005])
def test_the_target_is_reached_and_true(target):
    result = ec.run(HERTZ, accuracy=target).summary
    part = 0.02 if target == "2 %" else target
    assert result["accuracy"]["reached"]
    for name, value in closed_form().items():
        row = result["accuracy"]["targets"][name]
        assert abs(result[name] - value) <= row["error"] <= row["allowed"]
        assert row["allowed"] == close(part * result[name])
    assert set(result["accuracy"]["left_out"]) == {"normal_load"}


def test_error_bars_that_are_too_small_end_it_too_early_and_are_seen(monkeypatch):
    """Planted fault: a twentieth of the errors. The run then ends where the contact radius misses its target."""
    honest = bars.estimate

    def fault(*given, **options):
        found = honest(*given, **options)
        return found._replace(error=0.05 * found.error)

    monkeypatch.setattr(bars, "estimate", fault)
    with pytest.raises(AssertionError):
        test_the_target_is_reached_and_true(0.005)


def test_numbers_have_targets_of_their_own():
    result = ec.run(HERTZ, accuracy={"max_pressure": "0.1 %", "approach": "0.5 nm"}).summary
    targets = result["accuracy"]["targets"]
    assert set(targets) == {"max_pressure", "approach"}
    assert targets["approach"]["allowed"] == close(0.5e-9)
    for name, row in targets.items():
        assert abs(result[name] - closed_form()[name]) <= row["allowed"]
    assert result["errors"]["contact_radius"]["relative"] > 0.001  # nobody asked, nobody paid


def test_coarser_runs_of_a_rung_are_the_runs_before_it():
    result = ec.run(HERTZ, accuracy="0.8 %").summary["accuracy"]
    first, second = result["rungs"][:2]
    assert second["cells"][0] > 1.4 * first["cells"][0]
    assert result["reused"] >= 2  # the grids of the first rung and of its bars
    planned = pilot_of(HERTZ)
    per_rung = 1 + sum(len(source.variations(planned)) for source in error_sources(planned))
    assert result["runs"] == per_rung * len(result["rungs"]) - result["reused"]


@pytest.mark.slow
def test_the_answer_is_an_ordinary_result(tmp_path):
    kept = ec.run({**HERTZ, **FRICTION}, tmp_path / "run", accuracy={"approach": "1 %"})
    again = ec.open_results(tmp_path / "run")
    assert again.sizes["step"] == 3
    last = again["approach"].values[-1]
    assert last == close(kept.summary["approach"])
    assert [again.sizes["x"], again.sizes["y"]] == kept.summary["accuracy"]["rungs"][-1]["cells"]
    assert again["pressure_error"].dims == again["pressure"].dims
    assert float(again["approach_error"][-1]) == close(kept.summary["errors"]["approach"]["error"])
    assert kept.summary["field_errors"]["pressure"]["source"] in kept.summary["errors"]["max_pressure"]["parts"]
    same = ec.run(tomllib.loads(again.attrs["scene"])).summary  # the scene with the settings that were found
    assert same["approach"] == close(last)
    with pytest.raises(ResultsError, match="--overwrite"):
        ec.run({**HERTZ, **FRICTION}, tmp_path / "run", accuracy={"approach": "1 %"})


def test_the_budget_of_time_ends_it_and_the_rest_has_a_price():
    result = ec.run(HERTZ, accuracy={"contact-radius": "0.001 %", "time": "1.5 s"}).summary
    found = result["accuracy"]
    assert not found["reached"]
    assert "budget" in found["stopped"]
    assert found["more"]["factors"]["cells"] > 2
    assert found["more"]["seconds"] > found["rungs"][-1]["seconds"]
    assert "accuracy" in [warning["code"] for warning in result["warnings"]]
    assert accuracy_lines(result)[0].startswith("accuracy not reached: ")


def test_the_budget_of_memory_ends_it():
    found = ec.run(HERTZ, accuracy={"contact-radius": "0.001 %", "memory": "12 MB"}).summary["accuracy"]
    assert not found["reached"]
    planned = ec.plan({**HERTZ, "grid": {"cells": found["rungs"][-1]["cells"], "size": 2e-5}})
    assert planned.cost.peak < 12e6


LINE = {"name": "section", "shape": "line", "start": [-6e-6, 0, 2e-6], "end": [6e-6, 0, 2e-6], "count": 25}


def test_a_field_of_a_region_has_a_target_of_its_own():
    """Along a line through the axis at a depth; on the axis the closed form of Huber tells the normal stress."""
    result = ec.run({**HERTZ, "stress": LINE}, accuracy={"stress": {"section": "0.05 %"}})
    (name, row), rungs = *result.summary["accuracy"]["targets"].items(), result.summary["accuracy"]["rungs"]
    assert name == "stress.section"
    assert len(rungs) > 1  # the pilot does not reach it
    assert rungs[-1]["errors"][name] == row["error"] <= row["allowed"] == close(0.0005 * row["value"])
    assert result.summary["field_errors"]["section_stress"]["error"] == close(row["error"])
    stress = result.dataset["section_stress"].sel(component="zz").values[0]
    exact = -closed_form()["max_pressure"] / (1 + (2e-6 / closed_form()["contact_radius"]) ** 2)
    assert abs(stress[12] - exact) <= row["allowed"]
    assert row["value"] == close(abs(result.dataset["section_stress"]).values[0].max())


@pytest.mark.parametrize(
    ("accuracy", "message"),
    [
        ({"stress": {"sectoin": "1 %"}}, "no field of this name.*did you mean 'stress.section'"),
        ({"stres": {"section": "1 %"}}, "did you mean 'stress.section'"),
        ({"strain": {"section": "1 %"}}, "ask for one of .*stress.section, von-mises.section"),
        ({"stress": "1 %"}, "accuracy.stress must be a result of the scene"),
        ({"stress": {"section": "150 %"}}, "accuracy.stress must be a table of targets by region, each a relative"),
        ({"stress": {}}, "accuracy.stress must be a table of targets by region"),
        ({"von-mises": {"section": "2 nm"}}, "accuracy.von-mises.section must be an error .Pa"),
    ],
)
def test_fields_without_a_region_of_the_scene_are_refused(accuracy, message):
    with pytest.raises(SceneError, match=message):
        ec.explain({**HERTZ, "stress": LINE}, accuracy=accuracy)


@pytest.mark.parametrize(
    ("accuracy", "message"),
    [
        ({"max-pressur": "1 %"}, "did you mean 'max-pressure'"),
        ({"iterations": "1 %"}, "must be a result of the scene .got an effort"),
        ({"normal-load": "1 %"}, "the scene prescribes it.*ask for approach, contact-radius"),
        ({"tilt-x": "1 %"}, 'zero by symmetry.*give an error with a unit, like "1 nm"'),
        ({"max-pressure": "1 um"}, "accuracy.max-pressure must be an error .Pa"),
        ({"numbers": "2 nm"}, "accuracy.numbers must be a relative error"),
        ({"approach": "1 %", "memory": "1 kB"}, "accuracy.memory must be at least"),
        ("150 %", "accuracy.numbers must be a relative error"),
        ({"time": "1 s"}, 'given numbers = "1 %"'),
        ([1], "or a table of such targets by name"),
    ],
)
def test_what_cannot_be_reached_is_refused(accuracy, message):
    with pytest.raises(SceneError, match=message):
        ec.run(HERTZ, accuracy=accuracy)


@pytest.mark.slow
def test_a_number_that_does_not_converge_is_refused_with_what_does():
    with pytest.raises(SceneError, match=r"does not converge: .* lies on an edge of .*; "):
        ec.run(ec.load_scene("buried-cuboid", ["grid.cells=31"]), accuracy={"max-von-mises": "1 %"})


def test_a_run_to_an_accuracy_is_not_resumed(tmp_path):
    with pytest.raises(SceneError, match="resume must be without accuracy"):
        ec.run(HERTZ, tmp_path / "run", accuracy="1 %", resume=True)


# --- the choice of what is refined ------------------------------------------------------------------------------

CELLS, STEPS = (next(source for source in SOURCES if source.name == name) for name in ("cells", "load steps"))


def levers(cells, steps):
    return [Lever(source=CELLS, seconds=cells, memory=2.0), Lever(source=STEPS, seconds=steps, memory=0.0)]


def bar(cells, steps, order=None):
    return {
        "depth": ErrorBar(
            value=1.0, error=cells + steps, source="cells", order=order, parts={"cells": cells, "load steps": steps}
        )
    }


def test_the_source_with_the_larger_error_is_refined():
    targets = Targets(allowed={"depth": 0.02})
    assert set(cheapest(levers(2.0, 1.0), bar(0.03, 0.0), targets).factors) == {"cells"}
    assert set(cheapest(levers(2.0, 1.0), bar(0.0, 0.03), targets).factors) == {"load steps"}


def test_the_cheaper_of_two_equal_sources_is_refined_more():
    targets = Targets(allowed={"depth": 0.03})
    factors = [cheapest(levers(*prices), bar(0.02, 0.02), targets).factors for prices in ((5.0, 1.0), (1.0, 5.0))]
    assert factors[0]["load steps"] > factors[0].get("cells", 1.0)
    assert factors[1]["cells"] > factors[1].get("load steps", 1.0)


def test_a_higher_order_needs_fewer_cells():
    targets = Targets(allowed={"depth": 0.01})
    first, second = (cheapest(levers(2.0, 1.0), bar(0.04, 0.0, order), targets, far=True) for order in (1.0, 2.0))
    assert 4.0 / 0.85 <= first.factors["cells"] <= 1.1 * 4.0 / 0.85
    assert (4.0 / 0.85) ** 0.5 <= second.factors["cells"] <= 1.1 * (4.0 / 0.85) ** 0.5
    assert first.holds
    assert second.holds


def test_no_cells_make_up_for_load_steps_that_the_next_rung_refines():
    """The load steps reach their largest factor of one rung; with them the cells hold as they are."""
    targets = Targets(allowed={"depth": 0.01})
    way = cheapest(levers(2.0, 1.0), bar(0.004, 0.1), targets)
    assert set(way.factors) == {"load steps"}
    assert 3.0 <= way.factors["load steps"] <= 4.0
    assert not way.holds
    both = cheapest(levers(2.0, 1.0), bar(0.02, 0.1), targets)
    assert 0.02 / 0.0085 <= both.factors["cells"] <= 1.1 * 0.02 / 0.0085


def test_a_budget_limits_the_factors():
    targets = Targets(allowed={"depth": 0.01})
    way = cheapest(levers(2.0, 1.0), bar(0.04, 0.0, 1.0), targets, time=4.0)
    assert 1.8 <= way.factors["cells"] <= 2.0
    assert not way.holds
    assert not cheapest(levers(2.0, 1.0), bar(0.04, 0.0, 1.0), targets, memory=1.1).factors


def test_smaller_cells_lower_the_error_that_no_run_shows():
    """A width that all grids count alike: its error is the size of a cell, and twice as many cells halve it."""
    width = ErrorBar(value=1.0, error=0.02, source="size of a cell", parts={"cells": 0.0, "size of a cell": 0.02})
    refinement = cheapest(levers(2.0, 1.0), {"depth": width}, Targets(allowed={"depth": 0.01}))
    assert set(refinement.factors) == {"cells"}
    assert 2.0 / 0.85 <= refinement.factors["cells"] <= 1.1 * 2.0 / 0.85
    assert refinement.holds


def test_the_pilot_has_more_cells_where_they_cost_little():
    """One step of a ball takes hardly longer on twice the cells; nine steps with friction do."""
    radius = closed_form()["contact_radius"]
    cells = [radius / edge_of_pilot(scene) for scene in (HERTZ, {**HERTZ, **HISTORY})]
    assert cells == close([24.0, 12.0], rel=0.02)  # the window is a whole number of cells of the estimated contact
    assert cells[0] / cells[1] == close(2.0)


# --- the course, with a depth that is known ------------------------------------------------------------------------


def test_a_depth_of_second_order_is_reached_in_few_runs():
    edge = edge_of_pilot(HERTZ)

    def depth(plan):
        return 1.0 + 0.05 * (plan.grid.dx / edge) ** 2

    answer, solved = known(depth, {"depth": "2 %"})
    assert answer.last.holds
    assert 0.0 < depth(answer.last.run.plan) - 1.0 <= 0.02
    assert len(answer.rungs) == 2
    cells = answer.last.run.plan.grid.nx / answer.rungs[0].run.plan.grid.nx
    assert 1.7 < cells < 2.6  # sqrt(2.5 * 1.25 / 0.85) = 1.9
    assert len(solved) == answer.runs.solved
    assert answer.runs.reused >= 1  # the pilot is a coarser run of the answer
    assert len({(plan.grid.nx, plan.numerics.tolerance) for plan in solved}) == len(solved)  # nothing twice


def test_half_an_error_bar_misses_the_target_and_is_seen(monkeypatch):
    honest = bars.estimate

    def fault(*given, **options):
        found = honest(*given, **options)
        return found._replace(error=0.5 * found.error)

    monkeypatch.setattr(bars, "estimate", fault)
    with pytest.raises(AssertionError):
        test_a_depth_of_second_order_is_reached_in_few_runs()


def test_errors_that_do_not_fall_end_it():
    """Of a logarithm of the cell size: twice as many cells change it by as much as before."""
    edge = edge_of_pilot(HERTZ)
    answer, _ = known(lambda plan: 1.0 + 0.05 * log(plan.grid.dx / edge), {"depth": "1 %"})
    assert not answer.last.holds
    assert answer.stopped == "the errors no longer fall"
    assert len(answer.rungs) <= 4


def test_a_finer_run_that_fails_leaves_the_one_before():
    edge = edge_of_pilot(HERTZ)

    def depth(plan):
        if plan.grid.dx < 0.9 * edge:
            raise NotConverged("no convergence")
        return 1.0 + 0.1 * plan.grid.dx / edge

    answer, _ = known(depth, {"depth": "1 %"})
    assert len(answer.rungs) == 1
    assert answer.stopped == "no convergence"


def test_finer_load_steps_are_judged_on_the_coarsest_cells_alone():
    """Of first order in the load steps: each further run is the only one on its cells."""

    def depth(plan):
        return 1.0 + 0.5 / plan.steps

    answer, solved = known(depth, {"depth": "1 %"}, HISTORY)
    assert answer.last.holds
    bar = answer.last.bars["depth"]
    assert 1.25 * (depth(answer.last.run.plan) - 1.0) == close(bar.error)  # two step sizes tell first order exactly
    assert bar.order == close(1.0)
    assert len(answer.rungs) >= 3
    finest, coarsest = solved[0].grid.nx, min(plan.grid.nx for plan in solved)
    assert [plan.grid.nx for plan in solved[5:]].count(finest) == len(answer.rungs) - 1
    assert {plan.grid.nx for plan in solved[5:]} == {finest, coarsest}
    assert len({(plan.grid.nx, plan.steps) for plan in solved}) == len(solved)  # nothing twice


def test_cells_are_varied_on_few_load_steps():
    edge = edge_of_pilot({**HERTZ, **HISTORY})

    def depth(plan):
        return 1.0 + 0.05 * (plan.grid.dx / edge) ** 2 + 0.5 / plan.steps

    answer, solved = known(depth, {"depth": "2 %"}, HISTORY)
    last = answer.last.run.plan
    assert answer.last.holds
    assert depth(last) - 1.0 <= answer.last.bars["depth"].error <= 0.021
    first, second = (rung.run.plan for rung in answer.rungs[:2])
    assert second.steps >= 2 * first.steps
    coarsest = min(plan.grid.nx for plan in solved)
    assert {plan.grid.nx for plan in solved if plan.steps == second.steps} == {second.grid.nx, coarsest}
    assert second.grid.nx in [plan.grid.nx for plan in solved if plan.steps == first.steps]


@pytest.mark.parametrize("source", ["load steps", "cells"])
def test_a_run_before_with_a_wrong_step_size_is_seen(monkeypatch, source):
    """Planted fault: coarser runs count as twice as coarse as they are."""
    vary = bars.joined_bars

    def fault(whole, comparisons):
        wrong = [
            replace(one, coarser_results=[(2.0 * size, values) for size, values in one.coarser_results])
            if one.source.name == source
            else one
            for one in comparisons
        ]
        return vary(whole, wrong)

    monkeypatch.setattr(bars, "joined_bars", fault)
    with pytest.raises(AssertionError):
        test_cells_are_varied_on_few_load_steps()


def known(depth, table, tables=None, **budget):
    """Pursuit of a depth that follows from the plan, nothing is solved; and the plans that it would solve."""
    solved = []

    def solve(plan, _):
        value = depth(plan)
        solved.append(plan)
        return Run(plan, summary(value))

    planned = ec.plan({**HERTZ, **(tables or {}), "accuracy": {"approach": "1 %"}})
    targets = planned.scene.accuracy.model_copy(update={"numbers": table["depth"], **budget})
    targets.__pydantic_extra__.clear()
    return pursue(planned, targets, Runs(make=ec.plan, solve=solve)), solved


# --- nothing without the option -----------------------------------------------------------------------------------


def test_without_accuracy_nothing_of_it_is_imported():
    code = (
        "import sys, eigencontact as ec\n"
        f"ec.run({ {**HERTZ, 'grid': {'cells-per-contact-radius': 6}}!r})\n"
        "print([name for name in sys.modules if name.startswith('eigencontact.accuracy')])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=120)
    assert done.stdout.strip() == "[]"


def test_every_source_has_a_finer_variation():
    for tables in (HERTZ, {**HERTZ, **FRICTION}):
        planned = ec.plan({**tables, "numerics": {"tolerance": 1e-4}})
        for source in error_sources(planned):
            if source.known_errors is not None:  # follows from the plan, no run varies it
                continue
            finer = source.finer(planned, source.stride)
            coarser = source.variations(planned)[0].changes
            assert finer
            assert finer.keys() <= coarser.keys()
            assert finer != {name: coarser[name] for name in finer}


def test_judges_and_sources_divide_the_same_settings():
    """A judge is finer in all settings with a step size, one without a source of error too."""
    ball = {"type": "sphere", "center": [0, 0, "60 um"], "radius": "20 um", "material": {"void": True}}
    numerics = {"tolerance": 1e-6, "inclusion-resolution": {"whole": 2}, "inclusion-cells": 4}
    planned = ec.plan({**HERTZ, "inclusions": [ball], "numerics": numerics})
    sources = {source.name: source for source in error_sources(planned)}
    assert "tolerance" not in sources  # too tight to be worth a run
    judge = finer_settings(planned)["numerics"]
    assert judge["tolerance"] == close(1e-7)
    assert judge["inclusion-resolution"] == {"whole": 4}
    assert sources["degree"].finer(planned, sources["degree"].stride)["numerics"].items() <= judge.items()
    tight = ec.plan({**HERTZ, "numerics": {"tolerance": 1e-10}})
    assert finer_settings(tight)["numerics"]["tolerance"] == close(1e-10)  # no tighter than is of use


def test_explain_foretells_the_way_without_solving(monkeypatch):
    monkeypatch.setattr("eigencontact.execution.run.driver.drive", lambda *_: pytest.fail("solved"))
    text = ec.explain(HERTZ, accuracy="1 %")
    assert "accuracy asked for" in text
    assert "cells: 2 times finer takes" in text
    assert "accuracy asked for" not in ec.explain(HERTZ)
    with pytest.raises(EigencontactError, match="did you mean 'max-pressure'"):
        ec.explain(HERTZ, accuracy={"max-pressur": "1 %"})


def test_the_memory_of_the_results_of_all_load_steps_is_foretold():
    """Of a history it is far more than that of the arrays of a run."""
    coarse = {**HERTZ, **HISTORY, "grid": {"cells-per-contact-radius": 6}, "numerics": {"allow-coarse": True}}
    for tables in (coarse, {**HERTZ, "stress": LINE}):
        planned = ec.plan(tables)
        held = ec.run(planned).dataset
        stored = sum(held[name].nbytes for name in held.data_vars)
        assert stored == close(results_bytes(planned), 0.15)
    planned = ec.plan({**coarse, "steps": [{"normal-load": LOAD}, {"tangential-load-x": 0.1, "increments": 60}]})
    assert results_bytes(planned) > 2.0 * planned.cost.peak


def test_explain_foretells_the_time_and_memory_of_error_bars(command):
    coarse = {**HERTZ, **HISTORY, "grid": {"cells-per-contact-radius": 12}}
    told = foretold(ec.plan(coarse), errors=True)["errors"]
    runs = []

    def solve(tables, _):
        runs.append(ec.plan(tables))
        return Run(runs[-1], summary(1.0 + 0.1 / runs[-1].steps))

    planned = ec.plan(coarse)
    error_bars(planned, summary(1.0 + 0.1 / planned.steps), solve)
    assert told["runs"] == len(runs)
    assert told["seconds"] == close(sum(plan.seconds for plan in runs), 1e-6)
    assert told["memory"] >= sum(results_bytes(plan) for plan in runs)
    assert "at most 4 coarser runs" in ec.explain(coarse, errors=True)
    assert "error bars" in ec.explain({**coarse, "output": {"errors": True}})
    assert "error bars" not in ec.explain(coarse)
    said = json.loads(command("explain", "hertz", "--errors", "--json").out)
    assert said["errors"]["runs"] == 2


def test_the_results_of_all_runs_count_against_the_memory():
    def depth(plan):
        return 1.0 + 0.5 / plan.steps

    pilot = memory_of(pilot_of({**HERTZ, **HISTORY}))
    answers = [known(depth, {"depth": "1 %"}, HISTORY, memory=part * pilot)[0] for part in (1.5, 1e3)]
    assert [answer.last.holds for answer in answers] == [False, True]
    assert "memory" in answers[0].stopped


def test_the_commands_take_an_accuracy(command, tmp_path):
    plain = ("--set", "output.pictures=false", "--set", "output.vtk=false", "--set", "stress=[]")
    done = command("run", "hertz", *plain, "-o", str(tmp_path / "run"), "--accuracy", "3%")
    assert done.code == 0
    assert "accuracy reached: " in done.out
    assert "no target for normal_load: " in done.out
    told = json.loads(command("explain", "hertz", *plain, "--accuracy", "3%", "--json").out)["accuracy"]
    found = json.loads((tmp_path / "run" / "summary.json").read_text("utf-8"))["accuracy"]
    assert told["first"]["cells"] == found["rungs"][0]["cells"]
    line = 'stress=[{shape="line", name="axis", start=[0,0,1e-6], end=[0,0,5e-6], count=9}]'
    told = command("explain", "hertz", *plain[:4], "--set", line, "--set", "accuracy.stress.axis=3%", "--json")
    assert json.loads(told.out)["accuracy"]["targets"] == {"stress.axis": "3%"}
    assert command("run", "hertz", "-o", str(tmp_path / "no"), "--set", "accuracy.max-pressur=1%").code == 2
    assert not (tmp_path / "no").exists()


def test_the_benchmark_counts_targets_that_hold_by_the_bars_and_are_not_true():
    targets = {name: {"allowed": 0.1, "holds": holds} for name, holds in (("a", True), ("b", True), ("c", False))}
    answer = {"accuracy": {"targets": targets}, "observed": {}, "a": 1.0, "b": 2.0, "c": 3.0}
    hand = {"observed": {"b": 2.1}, "a": 1.2}
    truth = {"observed": {}, "a": 1.05, "b": 2.2, "c": 3.0}
    row = verdict(answer, hand, truth)
    assert (row["held"], row["missed"], row["true"], row["untrue"]) == ("2 of 3", "c", "1 of 2", "b")
    assert row["error"] == close(2.0)
    assert row["hand_error"] == close(1.5)
    assert "true" not in verdict(answer, hand, None)
    without_region = verdict(answer, hand, {"observed": {}, "a": 1.05})
    assert (without_region["held"], without_region["true"], without_region["untrue"]) == ("2 of 3", "1 of 1", "none")


def test_the_depth_of_a_maximum_is_known_to_the_points_of_its_region():
    """Points every 0.5 um: no cells tell the depth to 1 %; a larger error can be asked for."""
    line = {"name": "axis", "shape": "line", "start": [0, 0, 1e-6], "end": [0, 0, 6e-6], "count": 11}
    tables = {**HERTZ, "stress": [line]}
    found = ec.run(tables, accuracy="2 %").summary["accuracy"]
    assert found["reached"]
    assert "the points of its region give it to 250 nm only" in found["left_out"]["max_von_mises_depth"]
    with pytest.raises(SceneError, match=r"max-von-mises-depth must be at least the error by points of \[\[stress\]\]"):
        ec.run(tables, accuracy={"max-von-mises-depth": "2 %"})
    assert ec.run(tables, accuracy={"max-von-mises-depth": "20 %"}).summary["accuracy"]["reached"]
