"""`eigencontact tradeoff`: what is varied follows from the scene; errors, fronts, and a small study for real."""

import json
from dataclasses import replace
from importlib.metadata import EntryPoint
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest

import eigencontact.cli
from close import close
from eigencontact import app
from eigencontact.accuracy.changes import changed
from eigencontact.accuracy.settings import FIDELITIES
from eigencontact.results.ownership import is_ours
from eigencontact_verification.tradeoff.errors import bars, errors, field_error
from eigencontact_verification.tradeoff.figure import picture
from eigencontact_verification.tradeoff.process import Solved, solve, solve_fresh
from eigencontact_verification.tradeoff.report import as_markdown
from eigencontact_verification.tradeoff.study import Prediction, Row, Study, fronts, predict, standing, study
from eigencontact_verification.tradeoff.variant import KEYS, Fidelities, Variant, keys_of, variants

SMALL = ["stress=[]", "grid.cells-per-contact-radius=8", "numerics.threads=1"]
COARSE = [*SMALL[:1], "grid.cells-per-contact-radius=4", "numerics.inclusion-pitch=4 um", "observers=[]"]


@pytest.fixture
def tradeoff(command, monkeypatch, tmp_path):
    """Run the command in a folder of its own, whatever is installed."""
    entry = EntryPoint("tradeoff", "eigencontact_verification.commands.tradeoff:tradeoff", eigencontact.cli.COMMANDS)

    def found(group, name=None):
        return [entry] if group == eigencontact.cli.COMMANDS and name in (None, "tradeoff") else []

    monkeypatch.setattr(eigencontact.cli, "entry_points", found)
    monkeypatch.chdir(tmp_path)
    return lambda *arguments: command("tradeoff", *arguments)


@pytest.mark.parametrize(
    ("scene", "changes", "keys"),
    [
        ("hertz", SMALL, ("grid", "precision", "tolerance")),
        ("gross-slip", SMALL, ("grid", "precision", "tolerance", "coupling")),
        pytest.param("buried-cuboid", [], ("grid", "half-space"), marks=pytest.mark.slow),
        ("peened-layer", [], ("grid", "precision", "half-space")),
    ],
)
def test_what_is_varied_follows_from_the_scene(scene, changes, keys):
    plan = app.plan(app.load_scene(scene, changes))
    assert keys_of(plan) == keys
    found = variants(plan, Fidelities())
    assert [found[0].key, found[1].key] == ["reference", "scene"]
    assert dict.fromkeys(variant.key for variant in found[2:]) == dict.fromkeys(keys)
    assert {variant.key for variant in variants(plan, Fidelities(), ["grid"])[2:]} == {"grid"}


def test_changes_reach_the_scene():
    plan = app.plan(app.load_scene("hertz", SMALL))
    reference, scene, *others = variants(plan, Fidelities())
    planned = [app.plan(changed(plan.scene.resolved(), variant.changes)) for variant in (reference, scene, *others)]
    assert planned[1].grid == plan.grid
    cells = [one.scene.grid.cells_per_contact_radius for one in planned]
    assert cells == [16, 8, 2, 4, 8, 8, 8, 8]
    numerics = [one.scene.numerics for one in planned]
    assert [one.precision for one in numerics] == ["double"] * 4 + ["auto", "single", "double", "double"]
    assert [one.tolerance for one in numerics] == close([1e-7, *[1e-6] * 5, 1e-4, 1e-2])
    assert not any(one.scene.output.pictures for one in planned)


@pytest.mark.slow
def test_a_given_window_keeps_its_place_and_size():
    plan = app.plan("buried-cuboid")
    found = [variant.changes["grid"] for variant in variants(plan, Fidelities(), ["grid"])]
    assert [grid["cells"] for grid in found] == [[122, 122], [61, 61], [15, 15], [30, 30]]
    assert [[*grid["size"], *grid["center"]] for grid in found] == [close([12.2e-6, 12.2e-6, 0.0, 0.0])] * 4


@pytest.mark.parametrize(
    ("scene", "changes", "key", "expected"),
    [
        (
            "void-near-surface", ["numerics.inclusion-resolution=cells"], "inclusion-resolution",
            [f"inclusion-resolution whole{degree}" for degree in (" = 0", " = 2", " = 4")],
        ),
        ("plastic-hertz", COARSE, "inclusion-resolution", []),
        ("plastic-hertz", COARSE, "plastic-error", ["plastic-error 0.03", "plastic-error 0.1"]),
        ("plastic-hertz", [*COARSE, "numerics.plastic-error=0.02"], "plastic-error", ["no plastic-error"]),
        ("fretting-wear-partial-slip", [], "jump-error", ["jump-error 0.03", "jump-error 0.1"]),
        ("fretting-wear-partial-slip", ["wear.jump-error=0.05"], "jump-error", ["jump-error 0.1"]),
        ("coated-sphere", ["grid.cells-per-contact-radius=8"], "layers", ["layers cells"]),
        ("buried-cuboid", [], "cloud-tolerance", []),
    ],
)  # fmt: skip
def test_each_fidelity_is_there_where_a_scene_has_what_it_is_about(scene, changes, key, expected):
    plan = app.plan(app.load_scene(scene, changes))
    found = [variant for variant in variants(plan, Fidelities(), [key] if expected else []) if variant.key == key]
    assert [variant.words for variant in found] == expected
    for variant in found:  # and every one is a scene
        app.load_scene(changed(plan.scene.resolved(), variant.changes))


@pytest.mark.slow
def test_the_tolerance_of_clouds_is_varied_where_there_are_many_regions():
    cubes = [
        {"type": "cuboid", "center": [x, y, 3e-6], "edges": [1e-6] * 3, "eigenstrain": 0.01}
        for x in np.arange(20) * 2e-6
        for y in np.arange(20) * 2e-6
    ]
    body = {"young-modulus": 210e9, "poisson-ratio": 0.3}
    tables = {"body1": body, "inclusions": cubes, "grid": {"cells": [80, 80], "size": [4e-5, 4e-5]}}
    plan = app.plan(tables)
    reference, _, *found = variants(plan, Fidelities(), ["cloud-tolerance"])
    assert reference.changes["numerics"]["cloud-tolerance"] == 1e-9
    assert [variant.changes["numerics"]["cloud-tolerance"] for variant in found] == [0.0, 1e-4, 1e-2]
    app.load_scene(changed(plan.scene.resolved(), found[0].changes))


@pytest.mark.slow
def test_cells_of_the_box_are_varied_by_their_height():
    plan = app.plan(app.load_scene("plastic-hertz", COARSE))
    reference, scene, coarse = variants(plan, Fidelities(), ["inclusion-pitch"])
    heights = []
    for variant in (reference, scene, coarse):
        planned = app.plan(changed(plan.scene.resolved(), variant.changes))
        heights.append(planned.model.cells.inhomogeneities[0].lattice.edges[0])
    assert heights == close([0.5 * heights[1], heights[1], 2.0 * heights[1]])


def test_layers_become_cells_that_fill_the_window():
    scene = app.load_scene("coated-sphere", ["grid.cells-per-contact-radius=8", "stress=[]"])
    plan = app.plan(scene)
    *_, cells = variants(plan, Fidelities(), ["layers"])
    planned = app.plan(changed(scene.resolved(), cells.changes))
    assert planned.grid.shape == plan.grid.shape
    assert [planned.grid.dx, planned.grid.dy] == close([plan.grid.dx, plan.grid.dy])
    (layer,) = planned.model.cells.inhomogeneities
    assert planned.model.bodies.solids[0].young_modulus == close(210e9)
    assert layer.law.young_modulus == close(420e9)
    low, high = layer.shape.bounds
    assert np.subtract(high, low) == close([*plan.grid.size, 2e-6])
    assert abs(low[2]) < 1e-18


def test_a_setting_that_changes_nothing_is_not_solved():
    plan = app.plan("peened-layer")
    pitch = next(one for one in FIDELITIES if one.key == "inclusion-cells")
    same = Variant(key=pitch.key, words="as it is", changes={"numerics": {"inclusion-cells": 16}}, fidelity=pitch)
    found = predict(plan.scene.resolved(), [Variant(key="scene", words=""), same])
    assert [one.reason for one in found] == ["", "the plan is that of the scene"]


# --- errors and fronts ------------------------------------------------------------------------------------------------


def plane(n, slope=1.0, steps=1):
    """A field that linear interpolation meets exactly, on n x n cells of a window of side 2."""
    axis = (np.arange(n) + 0.5) * 2.0 / n - 1.0
    value = 3.0 + slope * axis + 0.5 * axis[:, None]
    return {"time": 1.0 + np.arange(steps), "x": axis, "y": axis, "pressure": np.repeat(value[None], steps, axis=0)}


def test_field_error_is_that_of_the_difference():
    wanted = plane(4)
    assert field_error(plane(4), wanted, ["pressure"]) == 0.0
    fine, coarse = plane(10, steps=3), plane(20)
    # between the middles of the coarser cells a plane is met exactly; at the rim the value of the last cell holds
    inner = {**fine, "x": fine["x"][1:-1], "y": fine["y"][1:-1], "pressure": fine["pressure"][:, 1:-1, 1:-1]}
    assert field_error(coarse, inner, ["pressure"]) < 1e-15
    scaled = {**fine, "pressure": 1.25 * fine["pressure"]}
    assert field_error(scaled, fine, ["pressure"]) == close(0.25)
    # a narrower window is judged by what it shows
    narrow = {**inner, "pressure": 1.1 * inner["pressure"]}
    assert field_error(narrow, fine, ["pressure"]) == close(0.1)


def test_a_component_that_is_left_out_counts_as_zero():
    wanted = {**plane(4), "shear_x": 3.0 * np.ones((1, 4, 4)), "shear_y": 4.0 * np.ones((1, 4, 4))}
    found = {**plane(4), "shear_x": wanted["shear_x"]}
    named = errors({"history": []}, found, {"history": []}, wanted)
    assert named["shear field"] > named["traction field"] > named["pressure field"] == 0.0
    assert field_error(found, wanted, ["shear_x", "shear_y"]) == close(0.8)
    assert field_error(found, plane(4), ["shear_x"]) is None


def test_scalar_errors_are_relative_to_the_largest_over_the_steps():
    steps = [
        {"time": 1.0, "max_pressure": 2.0, "normal_load": 1.0},
        {"time": 3.0, "max_pressure": 4.0, "normal_load": 0.0, "approach": None},
    ]
    other = [
        {"time": 1.0, "max_pressure": 2.0, "normal_load": 1.0},
        {"time": 2.0, "max_pressure": 9.0, "normal_load": 9.0},  # the reference has jumped over this one
        {"time": 3.0, "max_pressure": 3.0, "normal_load": 0.1},
    ]
    found = errors({"history": other}, plane(4), {"history": steps}, plane(4))
    assert found == {"max pressure": 0.25, "loads": 0.1, "pressure field": 0.0}


def row(error, seconds, memory):
    prediction = Prediction(variant=Variant(key="grid", words=""))
    return Row(prediction=prediction, status="ok", error=error, seconds=seconds, memory=memory)


def test_fronts():
    rows = [row(0.1, 1.0, 5.0), row(0.01, 2.0, 5.0), row(0.02, 3.0, 1.0), row(0.1, 1.0, 9.0), row(None, 0.1, 0.1)]
    assert fronts(rows) == [("time",), ("time", "memory"), ("memory",), ("time",), ()]
    # what is as accurate within 2 % is beaten by what is cheaper; of the same price, by what is more accurate
    rows = [row(0.1, 2.0, 5.0), row(0.101, 1.0, 6.0), row(0.2, 1.0, 9.0)]
    assert fronts(rows) == [("memory",), ("time",), ()]


def test_fields_are_compared_at_the_times_that_both_have():
    found, wanted = plane(6, steps=3), plane(6, steps=2)
    wanted["time"] = np.array([1.0, 3.0])
    found["pressure"] = found["pressure"] * np.array([1.0, 7.0, 1.5])[:, None, None]
    assert field_error(found, wanted, ["pressure"]) == close(0.5 / 2**0.5)


def studied(*rows):
    """A study of rows (key, error, seconds, memory), the reference before them."""
    found = [
        Row(
            prediction=Prediction(variant=Variant(key=key, words=f"{key} {k}")),
            status="ok", error=error, seconds=seconds, memory=memory,
        )
        for k, (key, error, seconds, memory) in enumerate([("reference", None, 9.0, 9e6), *rows])
    ]  # fmt: skip
    marked = tuple(replace(one, fronts=mark) for one, mark in zip(found, fronts(found), strict=True))
    return Study(name="s", headline="pressure field", rows=marked)


def test_where_the_scene_stands():
    rows = [("scene", 0.01, 2.0, 5e6), ("grid", 0.1, 1.0, 5e6), ("tolerance", 0.01, 4.0, 2e6)]
    time, memory = standing(studied(*rows))
    assert time == "front of time: the scene stands on it, point 2 of 2 from the cheapest"
    assert memory == "front of memory: the scene is not on it; 3 (tolerance 3) is as accurate at 0.4 of its memory"
    assert standing(studied(*rows[1:])) == []
    near = standing(studied(("scene", 0.01, 2.0, 5e6), ("grid", 0.01, 1.99, 5e6)))
    assert near[0] == "front of time: the scene is within 2 % of it; 2 (grid 2) is as accurate at 0.99 of its time"


def crowded():
    """Points on top of each other, close to each other, alone, and at the rim; of every key."""
    rng = np.random.default_rng(5)
    keys = ("scene", *KEYS)
    rows = [(key, 0.279, 0.3 + 0.02 * k, (100 + 4 * k) * 1e6) for k, key in enumerate(keys)]
    rows[4] = ("tolerance", 0.279, rows[0][2], rows[0][3])
    scattered = zip(rng.uniform(0.01, 0.1, 3), rng.uniform(0.2, 1.0, 3), rng.uniform(1e8, 1.7e8, 3), strict=True)
    rows += [("coupling", *place) for place in scattered]
    return studied(*rows)


def test_every_number_of_the_picture_stands_beside_its_own_mark():
    found = crowded()
    figure = picture(found)
    for axes, price in zip(figure.axes, ("seconds", "memory"), strict=True):
        marks = {}
        for k, one in enumerate(found.rows[1:], 1):
            x = getattr(one, price) * (1e-6 if price == "memory" else 1.0)
            marks[k] = axes.transData.transform((x, one.error))
        low, high = axes.bbox.min, axes.bbox.max
        assert all(np.all((low < place) & (place < high)) for place in marks.values())
        told = {}
        for note in axes.texts:
            box = note.get_window_extent()
            middle = 0.5 * (box.min + box.max)
            nearest = min(marks, key=lambda k: np.hypot(*(marks[k] - middle)))
            numbers = [int(part) for part in note.get_text().split(", ")]
            told |= dict.fromkeys(numbers, note)
            assert nearest in numbers
            # what shares a text is in one place
            assert max(np.hypot(*(marks[k] - marks[numbers[0]])) for k in numbers) < 7.0 / 72.0 * figure.dpi
        assert sorted(told) == sorted(marks)
        boxes = [note.get_window_extent() for note in dict.fromkeys(told.values())]
        assert not any(one.overlaps(two) for k, one in enumerate(boxes) for two in boxes[:k])


def test_the_legend_names_the_mark_that_stands_at_the_place_of_its_row():
    found = crowded()
    figure = picture(found)
    (legend,) = figure.legends
    shown = {text.get_text(): handle for text, handle in zip(legend.get_texts(), legend.legend_handles, strict=True)}
    looks = {}
    for k, one in enumerate(found.rows[1:], 1):
        label = f"{k}  {one.variant.words}" + (" (scene)" if one.variant.key == "scene" else "")
        handle = shown.pop(label)
        for axes, x in zip(figure.axes, (one.seconds, 1e-6 * one.memory), strict=True):
            (line,) = [line for line in axes.lines if line.get_label() == label]
            assert [line.get_xdata()[0], line.get_ydata()[0]] == close([x, one.error])
            assert (line.get_marker(), line.get_color()) == (handle.get_marker(), handle.get_color())
        looks.setdefault((handle.get_marker(), handle.get_color()), set()).add(one.variant.key)
    assert list(shown) == ["front"]
    assert all(len(keys) == 1 for keys in looks.values())


# --- a study ----------------------------------------------------------------------------------------------------------


def fake(found):
    """Stand-in for a solution: by the words of what was asked, a factor on the field, or a failure."""

    def solve(tables, limit):
        cells = int(tables["grid"]["cells"])
        factor = found[cells]
        if isinstance(factor, str):
            return Solved(status="failed", reason=factor)
        field = plane(4)
        numbers = {"cells": [cells, cells], "seconds": 1.0 * cells, "peak_bytes": 1e6 * cells, "history": []}
        return Solved(status="ok", numbers=numbers, fields={**field, "pressure": factor * field["pressure"]})

    return solve


def predictions(*cells, **more):
    return [
        Prediction(variant=Variant(key="grid", words=f"{n} cells", changes={"grid": {"cells": n}}), **more)
        for n in cells
    ]


def test_a_failure_is_a_row():
    found = study("s", {}, predictions(8, 4, 2), limit=9, memory=9, solve=fake({8: 1.0, 4: "NotConverged: no", 2: 1.5}))
    assert [one.status for one in found.rows] == ["ok", "failed", "ok"]
    assert [one.error for one in found.rows] == [None, None, close(0.5)]
    assert "1 (4 cells) failed: NotConverged: no" in as_markdown(found)


def test_the_finest_stands_in_for_a_reference_that_fails():
    found = study("s", {}, predictions(8, 2, 4), limit=9, memory=9, solve=fake({8: "big", 4: 1.0, 2: 1.5}))
    assert [one.variant.words for one in found.rows] == ["4 cells", "8 cells", "2 cells"]
    assert found.rows[2].error == close(0.5)
    assert "'4 cells' stands in for it" in found.note
    with pytest.raises(ValueError, match=r"no variant could be solved \(reference: big\)"):
        study("s", {}, predictions(8), limit=9, memory=9, solve=fake({8: "big"}))


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ({"seconds": 10.0}, "predicted time 10 s is above --time 9"),
        ({"memory": 3e9}, "predicted memory 3.0 GB is above --memory 2.0"),
        ({"reason": "half-space must be exact"}, "half-space must be exact"),
    ],
)
def test_what_is_refused_is_not_started(more, words):
    tried = [*predictions(8), *predictions(4, **more)]
    found = study("s", {}, tried, limit=9, memory=2e9, solve=fake({8: 1.0}))
    assert [found.rows[1].status, found.rows[1].reason] == ["refused", words]


@pytest.mark.slow
def test_what_the_child_measures():
    found = solve_fresh(app.load_scene("hertz", SMALL).resolved(), 60.0)
    assert found.status == "ok", found.reason
    assert 0.0 < found.numbers["seconds"] < found.numbers["whole_seconds"]
    assert 5e7 < found.numbers["peak_bytes"] < 1e9
    assert found.fields["pressure"].max() == close(8.47e9, rel=0.01)


def in_process(tables, limit):
    with TemporaryDirectory() as folder:
        found = solve(tables, Path(folder) / "fields.npz")
        if found["status"] != "ok":
            return Solved(status="failed", reason=found["reason"])
        with np.load(Path(folder) / "fields.npz") as fields:
            return Solved(status="ok", numbers=found, fields=dict(fields))


def test_what_does_not_converge_says_so():
    tables = app.load_scene("hertz", [*SMALL, "numerics.max-iterations=1"]).resolved()
    assert in_process(tables, 9.0).reason.startswith("NotConverged: ")


def test_a_child_that_takes_too_long_is_ended():
    assert solve_fresh({}, 0.01).status == "slow"


def test_the_command(tradeoff, tmp_path, monkeypatch):
    monkeypatch.setattr("eigencontact_verification.tradeoff.study.solve_fresh", in_process)
    outcome = tradeoff("hertz", "--quick", "--only", "grid", *(part for one in SMALL for part in ("--set", one)))
    assert outcome.code == 0, outcome.err
    assert "error: pressure field" in " ".join(outcome.out.split())
    assert "\n1  4 cells per contact" in outcome.out
    assert all(map(is_ours, (tmp_path / "hertz-tradeoff").glob("tradeoff.*")))
    data = json.loads((tmp_path / "hertz-tradeoff" / "tradeoff.json").read_text())
    reference, scene, coarse = data["rows"]
    assert [reference["error"], reference["errors"]] == [None, {}]
    assert 0.0 < scene["error"] < coarse["error"] < 0.5
    assert scene["seconds"] > 0.0
    assert (tmp_path / "hertz-tradeoff" / "tradeoff.png").stat().st_size > 10_000


@pytest.mark.slow
def test_error_bars_of_scene_and_reference_stand_beside_the_errors(tradeoff, tmp_path, monkeypatch):
    """The true difference is within the bars; the rows are those without bars."""
    monkeypatch.setattr("eigencontact_verification.tradeoff.study.solve_fresh", in_process)
    options = ("hertz", "--quick", "--only", "grid", *(part for one in SMALL for part in ("--set", one)))
    rows = []
    for more in ((), ("--errors",)):
        outcome = tradeoff(*options, *more)
        assert outcome.code == 0, outcome.err
        rows.append(json.loads((tmp_path / "hertz-tradeoff" / "tradeoff.json").read_text())["rows"])
    plain, barred = rows
    assert not any("error_bars" in one for one in plain)
    assert [one["errors"] for one in barred] == [one["errors"] for one in plain]
    reference, scene, coarse = barred
    assert "error_bars" not in coarse
    assert "loads" not in scene["error_bars"]  # prescribed
    for name in ("max pressure", "contact radius", "approach"):
        assert scene["errors"][name] <= scene["error_bars"][name] + reference["error_bars"][name]
    lines = [line for line in outcome.out.splitlines() if line.startswith("error bars of the ")]
    assert lines[0].startswith("error bars of the reference, below which the table tells nothing apart: max pressure ")
    assert (
        f"approach {scene['error_bars']['approach']:.1e} (holds the error {scene['errors']['approach']:.1e})"
        in lines[1]
    )


def test_a_bar_that_is_too_small_is_said_and_drawn():
    reference, scene, other = studied(("scene", 1e-2, 2.0, 5e6), ("grid", 0.1, 1.0, 4e6)).rows
    rows = (replace(reference, bars={"pressure field": 1e-3}),
            replace(scene, bars={"pressure field": 2e-3}, errors={"pressure field": 1e-2}), other)  # fmt: skip
    found = Study(name="s", headline="pressure field", rows=rows)
    assert "error bars of the scene: pressure field 2.0e-03 (does not hold the error 1.0e-02)" in as_markdown(found)
    for axes in picture(found).axes:
        (bar,) = [line for line in axes.lines if line.get_label() == "error bar of the scene"]
        assert list(bar.get_ydata()) == [2e-3]
        (span,) = axes.patches
        assert span.get_y() + span.get_height() == close(1e-3)


def test_bars_of_a_run_are_in_the_measure_of_the_errors():
    """The error of a field that is off by its stored errors is the bar."""
    numbers = {"max_pressure": {"error": 2.0, "value": -50.0}, "shift_x": {"error": 1.0, "value": 0.0}}
    field, rng = plane(6), np.random.default_rng(3)
    off = 0.1 * rng.uniform(size=field["pressure"].shape)
    found = bars({"errors": numbers}, {**field, "pressure_error": off})
    assert found == close({"max pressure": 0.04, "pressure field": field_error(
        {**field, "pressure": field["pressure"] + off}, field, ["pressure"])})  # fmt: skip
    sheared = {**field, "pressure_error": off, "shear_x": 3.0 * off, "shear_x_error": off}
    assert bars({}, sheared)["shear field"] == close(1.0 / 3.0)
    assert "traction field" in bars({}, sheared)
    assert bars({}, field) == {}


def test_the_plan_solves_nothing(tradeoff, tmp_path):
    outcome = tradeoff("hertz", "--plan", "--json", *(part for one in SMALL for part in ("--set", one)))
    data = json.loads(outcome.out)
    assert [one["key"] for one in data[:3]] == ["reference", "scene", "grid"]
    refused = [one for one in data if one["reason"]]
    assert [one["words"] for one in refused] == ["precision auto"]  # at this tolerance it takes double as well
    assert all(one["seconds"] > 0.0 and one["memory_bytes"] > 1e6 for one in data if one not in refused)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["herz"], "did you mean 'hertz'?"),
        (["hertz", "--only", "coupling"], "--only must be one of grid, precision, tolerance (got 'coupling')"),
        (["hertz", "--set", "grid.cells=3"], "two of cells, size, spacing"),
    ],
)
def test_wrong_input_is_refused(tradeoff, arguments, words):
    outcome = tradeoff(*arguments)
    assert outcome.code == 2
    assert words in outcome.err
