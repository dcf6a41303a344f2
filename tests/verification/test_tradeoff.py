"""`eigencontact tradeoff`: what is varied follows from the scene; errors, fronts, and a small study for real."""

import json
from importlib.metadata import EntryPoint
from pathlib import Path
from tempfile import TemporaryDirectory
from types import SimpleNamespace

import numpy as np
import pytest

import eigencontact.cli
from close import close
from eigencontact import app
from eigencontact.scene.schema import GridSpec, Numerics
from eigencontact_verification.tradeoff.errors import errors, field_error
from eigencontact_verification.tradeoff.process import Solved, solve_fresh
from eigencontact_verification.tradeoff.report import as_markdown
from eigencontact_verification.tradeoff.study import Prediction, Row, fronts, predict, study
from eigencontact_verification.tradeoff.variant import Fidelities, Variant, keys_of, tables_of, variants
from eigencontact_verification.tradeoff.worker import solve

SMALL = ["stress=[]", "grid.cells-per-contact-radius=8", "numerics.threads=1"]


@pytest.fixture
def tradeoff(command, monkeypatch, tmp_path):
    """Run the command in a folder of its own, whatever is installed."""
    entry = EntryPoint("tradeoff", "eigencontact_verification.tradeoff.command:tradeoff", eigencontact.cli.COMMANDS)

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
        ("buried-cuboid", [], ("grid", "half-space")),
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
    planned = [app.plan(tables_of(plan.scene.resolved(), variant)) for variant in (reference, scene, *others)]
    assert planned[1].grid == plan.grid
    cells = [one.scene.grid.cells_per_contact_radius for one in planned]
    assert cells == [16, 8, 2, 4, 8, 8, 8]
    numerics = [one.scene.numerics for one in planned]
    assert [one.precision for one in numerics] == ["double"] * 4 + ["single", "double", "double"]
    assert [one.tolerance for one in numerics] == close([1e-7, 1e-6, 1e-6, 1e-6, 1e-6, 1e-4, 1e-2])
    assert not any(one.scene.output.pictures for one in planned)


def test_a_given_window_keeps_its_place_and_size():
    plan = app.plan("buried-cuboid")
    found = [variant.changes["grid"] for variant in variants(plan, Fidelities(), ["grid"])]
    assert [grid["cells"] for grid in found] == [[122, 122], [61, 61], [15, 15], [30, 30]]
    assert [[*grid["size"], *grid["center"]] for grid in found] == [close([12.2e-6, 12.2e-6, 0.0, 0.0])] * 4


@pytest.mark.parametrize(("material", "expected"), [({"young-modulus": 1e9}, ["whole"]), (None, [])])
def test_how_inhomogeneities_are_resolved_is_varied_where_a_scene_has_them(material, expected):
    class Resolved(Numerics):
        inclusion_resolution: str = "cells"

    inclusion = SimpleNamespace(material=material, model_extra={})
    scene = SimpleNamespace(numerics=Resolved(), inclusions=[inclusion], grid=GridSpec())
    grid = app.plan("buried-cuboid").grid
    plan = SimpleNamespace(scene=scene, grid=grid, geometries=(), friction=None, sources=())
    found = [v.changes["numerics"]["inclusion-resolution"] for v in variants(plan, Fidelities()) if "resol" in v.key]
    assert found == expected


def test_a_setting_that_changes_nothing_is_not_solved():
    plan = app.plan("buried-cuboid")
    same = Variant(key="inclusion-cells", words="4", changes={"numerics": {"inclusion-cells": 4}})
    found = predict(plan.scene.resolved(), [Variant(key="scene", words=""), same])
    assert [one.reason for one in found] == ["", "the regions are cut into the same cells as in the scene"]


# --- errors and fronts ------------------------------------------------------------------------------------------------


def plane(n, slope=1.0, steps=1):
    """A field that linear interpolation meets exactly, on n x n cells of a window of side 2."""
    axis = (np.arange(n) + 0.5) * 2.0 / n - 1.0
    value = 3.0 + slope * axis + 0.5 * axis[:, None]
    return {"x": axis, "y": axis, "pressure": np.repeat(value[None], steps, axis=0)}


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
    steps = [{"max_pressure": 2.0, "normal_load": 1.0}, {"max_pressure": 4.0, "normal_load": 0.0, "approach": None}]
    other = [{"max_pressure": 2.0, "normal_load": 1.0}, {"max_pressure": 3.0, "normal_load": 0.1}]
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
    data = json.loads((tmp_path / "hertz-tradeoff" / "tradeoff.json").read_text())
    reference, scene, coarse = data["rows"]
    assert [reference["error"], reference["errors"]] == [None, {}]
    assert 0.0 < scene["error"] < coarse["error"] < 0.5
    assert scene["seconds"] > 0.0
    assert (tmp_path / "hertz-tradeoff" / "tradeoff.png").stat().st_size > 10_000


def test_the_plan_solves_nothing(tradeoff, tmp_path):
    outcome = tradeoff("hertz", "--plan", "--json", *(part for one in SMALL for part in ("--set", one)))
    data = json.loads(outcome.out)
    assert [one["key"] for one in data[:3]] == ["reference", "scene", "grid"]
    assert all(one["seconds"] > 0.0 and one["memory_bytes"] > 1e6 and not one["reason"] for one in data)
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
