"""Regions of an old run: their fields are those that the run would have stored, and nothing is solved for them."""

import numpy as np
import pytest
from typer.testing import CliRunner

import eigencontact as ec
from bodies import STEEL_TABLE as STEEL
from eigencontact.cli import app
from eigencontact.errors import ResultsError, SceneError
from eigencontact.execution.mechanics.mechanics import Mechanics
from hz_1 import FRICTION, LOAD, NU, RADIUS, A, E
from stopping import Stop, Stopper

CONTACT = {
    "body1": STEEL,
    "geometry": {"type": "sphere", "radius": RADIUS},
    "grid": {"cells": 16, "size": [3.2 * A, 3.2 * A]},
    "steps": {"normal-load": LOAD},
}
BALL = {"type": "sphere", "center": [0.2 * A, 0.0, 0.5 * A], "radius": 0.3 * A}
SOFT = {**BALL, "material": {"young-modulus": 0.3 * E, "poisson-ratio": NU}}
FREE = {"body1": STEEL, "grid": {"cells": 16, "size": [3.2 * A, 3.2 * A]}}
PLANE = {"name": "cut", "shape": "plane", "normal": "x", "position": 0.1 * A, "depth-max": A, "depth-cells": 5}
SCENES = {
    "contact": CONTACT,
    "friction": {**CONTACT, **FRICTION},
    "inclusion": {**CONTACT, "inclusions": [{**BALL, "eigenstrain": 1e-3}]},
    "inhomogeneity": {**CONTACT, "inclusions": [SOFT]},
    "inhomogeneity and friction": {**CONTACT, **FRICTION, "inclusions": [SOFT]},
    "void": {**CONTACT, "inclusions": [{**BALL, "material": {"void": True}}]},
    "whole": {**CONTACT, "inclusions": [SOFT], "numerics": {"inclusion-resolution": "whole"}},
    "polynomial": {**CONTACT, "inclusions": [SOFT], "numerics": {"inclusion-resolution": {"whole": 2}}},
    "both bodies": {**CONTACT, "body2": STEEL, "inclusions": [SOFT, {**SOFT, "body": 2, "eigenstrain": 1e-3}]},
    "layers": {**CONTACT, "body1": {"medium": {"type": "bonded-layers", "layers": [
        {"thickness": 0.5 * A, **STEEL}], "substrate": {"young-modulus": 2 * E, "poisson-ratio": NU}}}},
}  # fmt: skip


#: Scenes beside another one of the same sort.
SLOW = {"void", "inhomogeneity", "inhomogeneity and friction", "both bodies"}


@pytest.mark.parametrize("case", [pytest.param(name, marks=[pytest.mark.slow] * (name in SLOW)) for name in SCENES])
def test_fields_are_those_that_the_run_would_have_stored(case, tmp_path, monkeypatch):
    scene = SCENES[case]
    region = {**PLANE, "fields": ["stress"] if case == "layers" else ["stress", "strain"]}
    ec.run({**scene, "output": {"pictures": False}}, tmp_path)
    expected = ec.run({**scene, "stress": [region]}).dataset
    monkeypatch.setattr(Mechanics, "start", None)  # calling it would fail
    found = ec.region(tmp_path, region)
    for name in (f"cut_{field}" for field in (*region["fields"], "von_mises")):
        np.testing.assert_array_equal(found[name][-1], expected[name][-1], err_msg=name)
        assert found[name].attrs == expected[name].attrs
    np.testing.assert_array_equal(found["cut_z"], expected["cut_z"])
    assert "pressure" not in found
    assert found.attrs["references"] == expected.attrs["references"]


@pytest.mark.parametrize("inclusion", [{**BALL, "eigenstrain": 1e-3}, {**SOFT, "eigenstrain": 1e-3}])
def test_displacement_without_a_contact(inclusion, tmp_path):
    line = {"name": "axis", "shape": "line", "start": [0, 0, 0], "end": [0, 0, A], "count": 7}
    region = {**line, "fields": ["displacement", "stress"], "quantities": ["principal"]}
    ec.run({**FREE, "inclusions": [inclusion], "output": {"pictures": False}}, tmp_path)
    expected = ec.run({**FREE, "inclusions": [inclusion], "stress": [region]}).dataset
    found = ec.region(tmp_path, region)
    for name in ("axis_displacement", "axis_principal"):
        np.testing.assert_array_equal(found[name], expected[name], err_msg=name)


@pytest.fixture(scope="module")
def history(tmp_path_factory):
    """Folders of a run of three steps that keeps its last history, and of one that keeps all."""
    folders = {}
    for kept in ("last", "all"):
        folders[kept] = tmp_path_factory.mktemp(kept)
        steps = [{"normal-load": LOAD / 3, "increments": 1}, {"normal-load": LOAD, "increments": 2}]
        scene = {**CONTACT, "inclusions": [SOFT], "steps": steps, "output": {"pictures": False, "history": kept}}
        ec.run(scene, folders[kept])
    return folders


@pytest.mark.slow
def test_an_earlier_step_needs_a_run_that_keeps_all(history):
    with pytest.raises(ResultsError, match=r"hold equivalent_eigenstrain_1 of step 1 .* output.history = 'all'"):
        ec.region(history["last"], PLANE, step=1)
    fields = [ec.region(history["all"], PLANE, step=step)["cut_stress"].values for step in (1, 2, 3)]
    np.testing.assert_array_equal(fields[2], ec.region(history["last"], PLANE)["cut_stress"])
    largest = [np.abs(field).max() for field in fields]
    assert largest[0] < largest[1] < largest[2]


@pytest.mark.slow
@pytest.mark.parametrize("every", [False, True])
def test_a_run_continues_from_what_is_stored_alone(tmp_path, every, history):
    """Stopped before each step, with no state but the folder: the same to the last bit."""
    kept = "all" if every else "last"
    with ec.open_results(history[kept]) as whole:
        scene = ec.load_scene({**_tables(whole), "output": {"pictures": False, "history": kept}})
        for stop in (2, 3):
            with pytest.raises(Stop):
                ec.run(scene, tmp_path, watcher=Stopper(stop), resume=stop > 2)
        with ec.run(scene, tmp_path, resume=True).dataset as found:
            assert set(found.variables) == set(whole.variables)
            # What was spent may differ: an operator that was applied last is not applied again in the same process.
            spent = {"solve_seconds", "convolutions", "iterations", "inclusion_iterations"}
            for name in set(whole.variables) - spent:
                np.testing.assert_array_equal(found[name].values, whole[name].values, err_msg=name)


def _tables(data):
    import tomllib

    return tomllib.loads(data.attrs["scene"])


@pytest.mark.parametrize(
    ("table", "step", "error", "message"),
    [
        ('shape = "plane", depth-max = ', None, SceneError, "region must be a table like those of"),
        ('shape = "plane", depth-maxi = "1 um"', None, SceneError, "did you mean 'depth-max'"),
        ('shape = "plane"', None, SceneError, "given depths or depth-max"),
        ('shape = "points", points = [[0, 0, -1e-6]]', None, SceneError, "points"),
        (PLANE, 4, SceneError, r"1 to 3 \(got 4\)"),
        (PLANE, 0, SceneError, r"1 to 3 \(got 0\)"),
        ({**PLANE, "body": 2}, None, SceneError, "body"),
    ],
)
def test_refused_regions(history, table, step, error, message):
    with pytest.raises(error, match=message):
        ec.region(history["last"], table, step=step)


def test_a_name_that_is_stored_and_a_file_of_others_are_refused(tmp_path):
    ec.run({**CONTACT, "stress": [PLANE], "output": {"pictures": False}}, tmp_path)
    with pytest.raises(SceneError, match=r"region.name must differ from those that the run has stored \(got 'cut'"):
        ec.region(tmp_path, PLANE)
    (tmp_path / "region-other.nc").write_text("mine")
    with pytest.raises(ResultsError, match=r"region-other.nc must be a file that eigencontact wrote"):
        ec.region(tmp_path, {**PLANE, "name": "other"}, folder=tmp_path)
    assert (tmp_path / "region-other.nc").read_text() == "mine"
    with pytest.raises(ResultsError, match="must exist"):
        ec.region(tmp_path / "none", PLANE)


def test_a_changed_window_is_noticed(history, tmp_path, monkeypatch):
    """An automatic window may come out otherwise in another version."""
    from eigencontact.postprocess import revisit

    changed = ec.plan({**CONTACT, "inclusions": [SOFT], "stress": [PLANE], "grid": {"cells": 12, "size": [3e-5, 3e-5]}})
    monkeypatch.setattr(revisit, "make_plan", lambda scene, registry: changed)  # noqa: ARG005
    with pytest.raises(ResultsError, match="must be of the window that its scene stands for now, 12 x 12 cells"):
        ec.region(history["last"], PLANE)


@pytest.mark.usefixtures("small_pictures")
def test_the_command_draws_and_stores_the_region_and_nothing_else(history, tmp_path):
    before = sorted(path.name for path in history["last"].iterdir())
    words = ["plot", str(history["last"]), "--region", '{name = "cut", shape = "plane", depth-max = "9 um"}']
    done = CliRunner().invoke(app, [*words, "-o", str(tmp_path)])
    assert done.exit_code == 0, done.output
    written = sorted(path.name for path in tmp_path.iterdir())
    assert written == ["cut.png", "cut.pvd", "cut_0003.vti", "region-cut.nc"]
    assert sorted(path.name for path in history["last"].iterdir()) == before
    with ec.open_results(tmp_path / "region-cut.nc") as data:
        assert data["step"].values.tolist() == [3]
    again = CliRunner().invoke(app, [*words, "-o", str(tmp_path), "--no-vtk", "--step", "2"])
    assert again.exit_code == 5
    assert "output.history = 'all'" in again.output
