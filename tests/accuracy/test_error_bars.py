"""Error bars of runs: against closed forms, and against each planted fault."""

from dataclasses import asdict, replace
from math import pi

import numpy as np
import pytest
from numpy.random import default_rng

import eigencontact as ec
from bodies import STEEL_TABLE as STEEL
from close import close
from eigencontact.accuracy import bars, points, sources
from eigencontact.accuracy.bars import Run, error_bars
from eigencontact.accuracy.changes import refined_steps
from eigencontact.errors import SceneError
from eigencontact.progress import progress

HERTZ = {
    "body1": STEEL,
    "geometry": {"type": "sphere", "radius": 105e-6},
    "steps": {"normal-load": 0.65},
    "grid": {"cells-per-contact-radius": 13},
}
FRICTION = {"friction": {"type": "coulomb", "coefficient": 0.3}}
SHEARED = [{"normal-load": 0.65}, {"tangential-load-x": 0.1, "increments": 4}]


def number(name, value, role="result"):
    return {name: {"name": name, "unit": "m", "meaning": name, "role": role}}, {name: value}


def summary(value, warnings=()):
    declared, values = number("depth", value)
    return {"numbers": declared, "observed": {}, "warnings": list(warnings), **values}


def solver(of_changes):
    """Runs whose depth follows from edge and increments; nothing is solved."""

    def solve(tables, _):
        planned = ec.plan(tables)
        return Run(planned, summary(of_changes(planned)))

    return solve


def increments(planned):
    return sum(step.increments for step in planned.scene.steps)


def test_the_bars_of_a_hertz_contact_hold_the_closed_form():
    result = ec.run(HERTZ, errors=True).summary
    modulus = STEEL["young-modulus"] / (1 - STEEL["poisson-ratio"] ** 2)
    radius = (3 * 0.65 * 105e-6 / (4 * modulus)) ** (1 / 3)
    exact = {"max_pressure": 1.5 * 0.65 / (pi * radius**2), "approach": radius**2 / 105e-6, "contact_radius": radius}
    for name, value in exact.items():
        bar = result["errors"][name]
        assert bar["value"] == result[name]
        assert abs(bar["value"] - value) <= bar["error"] <= 0.05 * value
        assert bar["source"] == "cells"
        assert sum(bar["parts"].values()) == close(bar["error"])
    assert result["errors_left_out"] == {}
    assert result["error_runs"] == 2
    assert result["errors"]["normal_load"]["error"] < 1e-9 * 0.65


def test_without_the_option_there_are_no_errors():
    assert "errors" not in ec.run(HERTZ | {"grid": {"cells-per-contact-radius": 6}}).summary


def _ball(depth, place=0.0):
    material = {"young-modulus": 420e9, "poisson-ratio": 0.3}
    return {"type": "sphere", "center": [place, 0, depth], "radius": 1.5e-6, "material": material}


@pytest.mark.parametrize(
    ("balls", "varied"),
    [
        ([_ball(2e-6)], {"whole": 7}),  # degree 8
        ([_ball(1.7e-6)], {"whole": 11}),  # a thin roof: errors fall by 0.60 per degree
        ([_ball(9e-6)], {"whole": 2}),  # the least degree that "auto" takes
        ([_ball(2e-6), _ball(4e-6, 5e-6)], None),  # degrees 8 and 5: both are lower
    ],
)
def test_degrees_that_are_chosen_by_the_program_are_a_source_as_given_ones_are(balls, varied):
    """The depth depends on the degrees alone; the whole change by a degree counts."""
    tables = HERTZ | {"inclusions": balls, "numerics": {"inclusion-resolution": {"whole": "auto"}}}
    planned = ec.plan(tables)

    def degrees(other):
        return [source.degree.degree for source in other.model.cells.inhomogeneities]

    def depth(other):
        return 1.0 + sum(2.0**-degree for degree in degrees(other))

    (source,) = (source for source in sources.error_sources(planned) if source.name == "degree")
    (variation,) = source.variations(planned)
    qualities = [source.degree.quality for source in planned.model.cells.inhomogeneities]
    assert variation.ratio == close(min(2.0, 1.0 / max(qualities)))
    if varied is not None:
        assert variation.changes == {"numerics": {"inclusion-resolution": varied}}
    coarser, finer = (
        degrees(ec.plan({**tables, **changes})) for changes in (variation.changes, source.finer(planned, 4.0))
    )
    assert all(low < own for low, own in zip(coarser, degrees(planned), strict=True))
    assert all(own < high or own == 12 for own, high in zip(degrees(planned), finer, strict=True))
    found = error_bars(planned, summary(depth(planned)), solver(depth)).bars["depth"]
    assert found.parts["degree"] >= depth(planned) - 1.0
    assert found.source == "degree"


def test_every_source_counts_by_itself():
    """Cells of second order and increments of first order, each with its known error."""
    tables = HERTZ | FRICTION | {"steps": SHEARED}
    planned = ec.plan(tables)
    edge, count = planned.grid.dx, increments(planned)

    def depth(other):
        return 1.0 + 0.01 * (other.grid.dx / edge) ** 2 + 0.02 * count / increments(other)

    found = error_bars(planned, summary(depth(planned)), solver(depth)).bars["depth"]
    assert found.error >= 0.03
    assert found.parts["cells"] == close(1.25 * 0.01, rel=1e-6)
    assert found.parts["load steps"] == close(1.25 * 0.02, rel=1e-6)
    assert found.order == close(1.0)
    assert set(found.parts) == {"cells", "load steps"}
    assert found.source == "load steps"


def test_a_source_left_out_is_seen(monkeypatch):
    """Without the increments, the bar of a number whose error comes from these does not hold."""
    monkeypatch.setattr(
        bars, "error_sources", lambda plan: [s for s in sources.error_sources(plan) if s.name != "load steps"]
    )
    with pytest.raises(AssertionError):
        test_every_source_counts_by_itself()


MANY = [{"normal-load": 0.65}, {"tangential-load-x": 0.1, "increments": 8}]
FEW = [{"normal-load": 0.65}, {"tangential-load-x": 0.1, "increments": 2}]
ORDER = 0.6


@pytest.mark.parametrize(("steps", "counts"), [(MANY, [9, 5, 3]), (FEW, [3, 2, 6])])
def test_a_second_number_of_increments_tells_their_order(steps, counts):
    """Below the first order half the increments alone give half the error; a quarter, or twice as many, all of it."""
    planned = ec.plan(HERTZ | FRICTION | {"steps": steps})
    solved = []

    def depth(other):
        solved.append(increments(other))
        return 1.0 + 0.02 * (increments(planned) / increments(other)) ** ORDER

    found = error_bars(planned, summary(depth(planned)), solver(depth)).bars["depth"]
    assert found.parts["load steps"] == close(1.25 * 0.02, rel=1e-6)
    assert found.order == close(ORDER)
    assert solved == [counts[0]] * 3 + counts[1:]


def test_a_second_number_of_increments_that_is_skipped_is_seen(monkeypatch):
    """Planted fault: half the increments alone."""
    monkeypatch.setattr(bars, "_is_notable", lambda *_: False)
    with pytest.raises(AssertionError):
        test_a_second_number_of_increments_tells_their_order(MANY, [9, 5, 3])
    monkeypatch.undo()
    once = sources._increments
    steps = next(source for source in sources.SOURCES if source.name == "load steps")
    monkeypatch.setattr(
        sources,
        "SOURCES",
        [replace(steps, variations=lambda plan: once(plan)[:1]) if s is steps else s for s in sources.SOURCES],
    )
    with pytest.raises(AssertionError):
        test_a_second_number_of_increments_tells_their_order(FEW, [3, 2, 6])


@pytest.mark.parametrize("part", [0.1, 0.0005])
def test_a_small_error_of_increments_is_not_worth_a_second_run(part):
    """A tenth of the error of the cells, or a twentieth of a per cent of the number."""
    planned = ec.plan(HERTZ | FRICTION | {"steps": MANY})
    edge, solved = planned.grid.dx, []

    def depth(other):
        solved.append(increments(other))
        cells = 0.1 * part * (other.grid.dx / edge) ** 2
        return 1.0 + (cells if part == 0.1 else 0.0) + 0.1 * part * part / increments(other)

    error_bars(planned, summary(depth(planned)), solver(depth))
    assert solved == [9, 9, 9, 5]


def test_a_loose_tolerance_is_a_source_and_a_tight_one_is_none():
    planned = ec.plan(HERTZ | {"numerics": {"tolerance": 1e-4}})

    def depth(other):
        return 1.0 + 10.0 * other.numerics.tolerance

    found = error_bars(planned, summary(depth(planned)), solver(depth)).bars["depth"]
    assert found.parts["tolerance"] == close(0.001, rel=1e-6)
    assert "tolerance" not in [source.name for source in sources.error_sources(ec.plan(HERTZ))]


CYCLES = {"type": "dissipated-energy", "coefficient": 1e-15, "body": 1}
WORN = HERTZ | {
    "body2": {"rigid": True},
    "friction": FRICTION["friction"],
    "wear": CYCLES,
    "steps": [{"normal-load": 0.65}, {"cycle": {"normal-load": 0.65, "sliding-distance": 0.01}, "repeat": 20}],
    "numerics": {"coupling": "none"},
    "observers": [{"type": "fretting-loop"}],
}


def worn(planned, energy=4.0):
    """Summary of a run whose jumps over cycles miss 2 % by its own estimate, and 1 % by one update per cycle."""
    declared = {name: asdict(number) for name, number in {**planned.numbers, **planned.observed}.items()}
    names = ("worn_volume", "wear_energy", "dissipated_energy", "fretting_loop_dissipated_energy")
    estimates = {"wear_error": 0.03, "update_error": -0.01}
    values = dict(zip(names, (2.0, energy, 3.0, 3.0), strict=True)) | estimates
    known = {name: declared[name] for name in values}
    return {"numbers": known, "observed": {names[-1]: 3.0}, "warnings": [], **values}


def test_jumps_over_cycles_have_the_error_that_the_run_estimates_where_their_variation_shows_nothing():
    planned = ec.plan(WORN)
    found = error_bars(planned, worn(planned), lambda tables, _: Run(ec.plan(tables), worn(planned)))
    errors = {name: found.bars[name].error for name in ("worn_volume", "wear_energy")}
    assert errors == {"worn_volume": close(0.02 * 2.0), "wear_energy": close(0.02 * 4.0)}
    assert found.bars["worn_volume"].source == "jumps over cycles"


def test_the_larger_of_the_estimate_of_the_run_and_of_the_variation_counts():
    planned = ec.plan(WORN)

    def solve(tables, _):
        other = ec.plan(tables)
        return Run(other, worn(planned, 5.0 if other.scene.wear.error > planned.scene.wear.error else 4.0))

    assert error_bars(planned, worn(planned), solve).bars["wear_energy"].error >= 1.0


def test_an_estimate_of_the_run_that_is_left_out_is_seen(monkeypatch):
    without = [replace(s, known_errors=None) if s.name == "jumps over cycles" else s for s in sources.SOURCES]
    monkeypatch.setattr(sources, "SOURCES", without)
    with pytest.raises(AssertionError):
        test_jumps_over_cycles_have_the_error_that_the_run_estimates_where_their_variation_shows_nothing()


def test_work_of_the_solved_cycles_alone_has_no_error():
    planned = ec.plan(WORN)
    name = "fretting_loop_dissipated_energy"
    found = error_bars(planned, worn(planned), lambda tables, _: Run(ec.plan(tables), worn(planned)))
    assert name not in found.bars
    assert "solved cycles alone" in found.left_out[name]
    whole = worn(planned, energy=3.0)  # no cycle was skipped
    assert name in error_bars(planned, whole, lambda tables, _: Run(ec.plan(tables), whole)).bars


SECTION = {"shape": "plane", "normal": "y", "depth-max": 8e-6, "depth-cells": 8}


def deepest(z):
    """Summary of a run whose largest stress is at the depth `z`, on all grids alike."""
    declared = {"max_von_mises_depth": {"unit": "m", "role": "result", "of_points": True}}
    return {"numbers": declared, "observed": {}, "warnings": [], "max_von_mises_depth": z}


def test_a_depth_is_known_to_half_the_distance_of_the_points():
    line = {"shape": "line", "start": [0, 0, 0], "end": [0, 0, 8e-6], "count": 5}
    for stress, expected in (([SECTION], 0.5e-6), ([SECTION, line], 1e-6)):
        planned = ec.plan(HERTZ | {"stress": stress})
        found = error_bars(planned, deepest(4e-6), lambda tables, _: Run(ec.plan(tables), deepest(4e-6)))
        bar = found.bars["max_von_mises_depth"]
        assert bar.error == close(expected)
        assert bar.source == "points of regions"


def test_points_left_out_are_seen(monkeypatch):
    kept = [source for source in sources.SOURCES if source.name != "points of regions"]
    monkeypatch.setattr(sources, "SOURCES", tuple(kept))
    with pytest.raises(AssertionError):
        test_a_depth_is_known_to_half_the_distance_of_the_points()


def counted(area):
    """Summary of a run with an area counted in cells."""
    declared = {"area": {"unit": "m2", "role": "result", "scatters": True}}
    return {"numbers": declared, "observed": {}, "warnings": [], "area": area}


@pytest.mark.parametrize("area", [0.0, 3e-12])
def test_an_area_that_no_run_changes_is_known_to_a_cell(area):
    planned = ec.plan(HERTZ)
    found = error_bars(planned, counted(area), lambda tables, _: Run(ec.plan(tables), counted(area))).bars["area"]
    assert found.parts["size of a cell"] == close(planned.grid.dx * planned.grid.dy)
    assert (found.parts["cells"] > 0.0) == (area > 0.0)


@pytest.mark.parametrize("change", [1e-14, 0.2e-12])
def test_an_area_that_changes_little_by_chance_is_known_to_a_part_of_the_cells_at_its_edge(change):
    planned, radius = ec.plan(HERTZ), (3e-12 / pi) ** 0.5
    cells = radius / planned.grid.dx
    found = error_bars(planned, counted(3e-12), lambda tables, _: Run(ec.plan(tables), counted(3e-12 + change)))
    assert found.bars["area"].parts == {"cells": close(planned.grid.dx**2 * 2.0 * pi * (cells / 6.0) ** 0.5)}


def test_an_area_that_changes_has_no_more_than_its_scatter():
    planned = ec.plan(HERTZ)
    found = error_bars(planned, counted(3e-12), lambda tables, _: Run(ec.plan(tables), counted(4e-12))).bars["area"]
    assert found.parts == {"cells": close(1e-12)}


def test_without_coarser_cells_the_place_of_the_edge_alone_is_no_error():
    def refuse(*_):
        raise SceneError("grid must be finer")

    assert error_bars(ec.plan(HERTZ), counted(3e-12), refuse, sources=sources.SOURCES[:1]).bars == {}


def test_a_least_error_left_out_is_seen(monkeypatch):
    monkeypatch.setattr(points, "_OF_RADIUS", 0.5 * points._OF_RADIUS)
    with pytest.raises(AssertionError):
        test_an_area_that_changes_little_by_chance_is_known_to_a_part_of_the_cells_at_its_edge(1e-14)
    with pytest.raises(AssertionError):
        test_the_least_error_holds_for_the_areas_of_circles_and_ellipses()


def sizes(**values):
    """Summary of a zone with radius, half width and distance from the centre [m], all counted in cells."""
    declared = {name: {"unit": "m", "role": "result", "scatters": True} for name in values}
    return {"numbers": declared | {"half_width": declared["half_width"] | {"of_widths": True}}, "observed": values}


def test_a_width_is_known_to_half_a_cell_and_what_is_smaller_is_no_width():
    least = points.parts_of_cells(0.2, sizes(radius=1.1, half_width=1.3, distance=1e-17))
    assert least == {"radius": close(0.2 * (0.2 / 6.6) ** 0.5), "half_width": close(0.1)}


def test_the_widths_of_the_stick_zone_are_declared():
    declared = ec.plan("fretting-mode-1").observed
    assert {name for name, number in declared.items() if number.of_widths} == {
        "stick_radius_half_width_x",
        "stick_radius_half_width_y",
    }


def test_the_least_error_holds_for_the_areas_of_circles_and_ellipses():
    """Cells whose middle is inside, of zones in the middle of a cell or of a corner, as contacts are."""
    random, held = default_rng(29), []
    for radius, ratio, centre in zip(
        random.uniform(3.0, 25.0, 500), random.uniform(0.5, 1.0, 500), random.choice([0.0, 0.5], 500), strict=True
    ):
        places = np.arange(-30, 31) - centre
        cells = np.count_nonzero(ratio * places**2 + places[:, None] ** 2 / ratio <= radius**2)
        least = points.parts_of_cells(1.0, counted(float(cells)))["area"]
        held.append(least >= abs(cells - pi * radius**2))
    assert 0.93 < np.mean(held) < 0.99


def test_widths_of_a_line_contact_have_no_least_error():
    assert points.places_of_edges(ec.plan("cylinder-fretting"), counted(3e-12)) == {}


def test_half_an_estimate_is_seen(monkeypatch):
    halved = bars.estimate

    def fault(*given, **options):
        found = halved(*given, **options)
        return found._replace(error=0.5 * found.error)

    monkeypatch.setattr(bars, "estimate", fault)
    with pytest.raises(AssertionError):
        test_every_source_counts_by_itself()


def test_a_refused_coarser_run_is_named():
    planned = ec.plan(HERTZ)

    def refuse(*_):
        raise SceneError("grid must be finer")

    found = error_bars(planned, summary(1.0), refuse)
    assert found.left_out == {"cells": "grid must be finer"}
    assert found.bars == {}


@pytest.mark.parametrize(("order", "expected"), [(0.5, 0.1), (0.0, None)])
def test_a_number_that_converges_slowly_or_not_at_all(order, expected):
    warning = {"code": "slow-place", "words": "at the edge", "number": "depth", "order": order}
    planned = ec.plan(HERTZ)
    edge = planned.grid.dx
    exponent = order or -1.0

    def depth(other):
        return 1.0 + 0.1 * (other.grid.dx / edge) ** exponent

    found = error_bars(planned, summary(depth(planned), [warning]), solver(depth))
    if expected is None:
        assert "depth" not in found.bars
        assert found.left_out["depth"] == "at the edge"
    else:
        assert expected <= found.bars["depth"].error <= 1.3 * expected


def test_increments_are_halved_in_steps_and_cycles():
    steps, ratio = refined_steps([{"increments": 4}, {"cycle": [{"increments": 2}, {"increments": 6}]}], 0.5)
    assert [steps[0]["increments"], *(step["increments"] for step in steps[1]["cycle"])] == [2, 1, 3]
    assert ratio == 0.5


def test_the_scene_asks_for_errors_and_a_sweep_has_them_beside_the_numbers(tmp_path):
    coarse = HERTZ | {"grid": {"cells-per-contact-radius": 6}, "output": {"errors": True, "pictures": False}}
    swept = ec.sweep(coarse, {"steps.normal-load": [0.3, 0.6]}, tmp_path / "sweep").dataset
    assert swept["max_pressure_error"].attrs["estimates"] == "max_pressure"
    assert (swept["max_pressure_error"] > 0).all()
    assert (swept["max_pressure_error"] < 0.1 * swept["max_pressure"]).all()


def test_coarser_runs_are_announced(capsys):
    with progress(enabled=True, verbose=True) as watcher:
        ec.run(HERTZ | {"grid": {"cells-per-contact-radius": 6}}, errors=True, watcher=watcher)
    assert "error bars: cells, step size times 2.5" in capsys.readouterr().err


def test_the_console_and_the_report_show_errors(tmp_path):
    result = ec.run(HERTZ | {"output": {"pictures": False}}, tmp_path / "run", errors=True)
    assert "±" in result._repr_html_()
    page = ec.report(tmp_path / "run").read_text(encoding="utf-8")
    assert page.count("<small>±") >= 3


def test_a_region_without_a_name_is_solved_on_coarser_cells_too():
    result = ec.run(HERTZ | {"stress": SECTION}, errors=True).summary
    assert result["errors_left_out"] == {}
    assert result["errors"]["max_von_mises"]["error"] > 0
    assert result["errors"]["max_von_mises_depth"]["parts"]["points of regions"] == close(0.5e-6)
