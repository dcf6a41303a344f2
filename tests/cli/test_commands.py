"""The commands: what they print, where, and what they return."""

import json
import re
import tomllib

import numpy as np
import pytest

import eigencontact as ec
from close import close
from eigencontact.core.table_cache import TableCache

VERBS = ("run", "explain", "plugins", "gallery", "plot", "cache")


def test_help_lists_the_commands_and_exit_codes(command):
    outcome = command("--help")
    assert outcome.code == 0
    for verb in VERBS:
        assert re.search(rf"^.*\b{verb}\b", outcome.out, re.MULTILINE)
    assert "130 interrupted" in " ".join(outcome.out.split())


@pytest.mark.parametrize(
    ("verb", "words"),
    [
        ("run", ("--set", "--output", "--resume", "--overwrite", "--quiet", "--json", "SCENE")),
        ("explain", ("--set", "--json", "SCENE")),
        ("plugins", ("--json", "Show parameters and sources of one plugin")),
        ("gallery", ("show", "--json")),
        ("cache", ("--clear", "--limit", "--json")),
        ("plot", ("--output", "--vtk", "--quiet", "--json", "RESULTS")),
    ],
)
@pytest.mark.parametrize("flag", ["--help", "-h"])
def test_help_of_each_command(verb, words, flag, command, monkeypatch):
    monkeypatch.setenv("COLUMNS", "200")
    outcome = command(verb, flag)
    assert outcome.code == 0
    for word in words:
        assert word in outcome.out
    assert outcome.err == ""


def test_version(command):
    assert command("--version").out.strip() == ec.__version__


def test_no_arguments_print_the_help(command):
    outcome = command()
    assert "Usage" in outcome.out + outcome.err


@pytest.mark.parametrize("arguments", [["frobnicate"], ["run"], ["run", "hertz", "--colour"], ["run", "hertz", "-o"]])
def test_wrong_usage_is_refused(arguments, command, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    outcome = command(*arguments)
    assert outcome.code == 2
    assert outcome.out == ""
    assert "Traceback" not in outcome.err
    assert list(tmp_path.iterdir()) == []


@pytest.mark.usefixtures("small_pictures")
def test_run_says_what_it_found_and_where(command, tmp_path):
    changes = ["grid.cells-per-contact-radius=12", "stress.0.depth-cells=12", "output.vtk=false", "numerics.threads=1"]
    arguments = [part for change in changes for part in ("--set", change)]
    outcome = command("run", "hertz", *arguments, "-o", tmp_path / "out")
    assert outcome.code == 0
    assert all(line.startswith("load step ") for line in outcome.err.splitlines())  # told on a busy machine
    text = " ".join(outcome.out.split())
    assert re.search(r"largest pressure 8\.4\d* GPa", text)
    for words in ("Hertz contact: rigid sphere on steel", "normal load 650 mN", "largest pressure 8.4", "converged"):
        assert words in text
    assert str(tmp_path / "out") in outcome.out.replace("\n", "")
    for path in (tmp_path / "out").iterdir():
        assert path.name in outcome.out
    assert re.search(r"solved in .* s \(\d+ iterations, \d+ convolutions\); everything, pictures included, in ", text)


def test_run_with_friction_prints_the_loop(command, quick, tmp_path):
    outcome = command("run", "cattaneo-mindlin", *quick, "-o", tmp_path)
    lines = [line.split() for line in outcome.out.splitlines()]
    heading = lines.index(["step", "load", "shift", "x", "force", "x", "stick", "work"])
    assert [line[0] for line in lines[heading + 2 : heading + 7]] == ["1", "2", "3", "4", "5"]
    *_, stick, work = lines[heading + 6]
    history = json.loads((tmp_path / "summary.json").read_text(encoding="utf-8"))["history"]
    assert float(stick) == close(100 * (1 - history[-1]["slip_fraction"]), abs=0.05)
    assert float(work) == close(1e9 * history[-1]["dissipated_energy"], rel=1e-3)


def test_run_as_json_prints_the_summary_and_nothing_else(command, quick, tmp_path):
    outcome = command("run", "hertz", *quick, "-o", tmp_path / "out", "--json")
    assert (outcome.code, outcome.err) == (0, "")
    assert json.loads(outcome.out) == json.loads((tmp_path / "out" / "summary.json").read_text(encoding="utf-8"))


def test_quiet_prints_nothing(command, quick, tmp_path):
    assert command("run", "hertz", *quick, "-o", tmp_path / "out", "-q") == type(command("-h"))(0, "", "")
    assert (tmp_path / "out" / "summary.json").is_file()


def test_the_default_folder_is_named_after_the_scene(command, quick, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert command("run", "hertz", *quick, "-q").code == 0
    assert {path.name for path in (tmp_path / "hertz").iterdir()} == {"results.nc", "summary.json"}


def test_results_may_go_to_the_current_folder_beside_other_files(command, quick, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "notes.txt").write_text("mine")
    assert command("run", "hertz", *quick, "-q", "-o", ".").code == 0
    assert {path.name for path in tmp_path.iterdir()} == {"notes.txt", "results.nc", "summary.json"}


def test_results_of_another_scene_are_not_overwritten(command, quick, tmp_path):
    folder = tmp_path / "out"
    assert command("run", "hertz", *quick, "-q", "-o", folder).code == 0
    before = (folder / "results.nc").read_bytes()
    other = ["run", "hertz", *quick, "--set", "steps.normal-load=1.5", "-q", "-o", folder]
    refused = command(*other)
    assert refused.code == 5
    assert refused.err.startswith("eigencontact: ")
    assert refused.err.count("\n") == 1
    assert "--overwrite replaces them, another -o keeps them" in refused.err
    assert (folder / "results.nc").read_bytes() == before
    resumed = command(*other, "--resume")
    assert resumed.code == 5
    assert "--resume continues the same scene only" in resumed.err
    both = command(*other, "--resume", "--overwrite")
    assert both.code == 2
    assert "give --resume or --overwrite" in both.err
    assert (folder / "results.nc").read_bytes() == before
    assert command(*other, "--overwrite").code == 0
    assert json.loads((folder / "summary.json").read_text(encoding="utf-8"))["normal_load"] == close(1.5)


def test_the_same_scene_may_be_run_again(command, quick, tmp_path):
    arguments = ["run", "hertz", *quick, "-q", "-o", tmp_path / "out"]
    assert [command(*arguments).code, command(*arguments).code, command(*arguments, "--resume").code] == [0, 0, 0]


def test_not_converged_returns_3(command, quick, tmp_path):
    changes = ["--set", "numerics.max-iterations=1", "--set", "numerics.tolerance=1e-13"]
    outcome = command("run", "hertz", *quick, *changes, "-o", tmp_path / "out")
    assert outcome.code == 3
    assert outcome.err.count("\n") == 1
    assert "normal contact did not converge in 1 iterations" in outcome.err
    assert "raise max-iterations, loosen the tolerance" in outcome.err
    assert not (tmp_path / "out").exists()


def test_not_converged_carries_its_report():
    scene = ec.load_scene("hertz", ["stress=[]", "numerics.max-iterations=1", "numerics.tolerance=1e-13"])
    with pytest.raises(ec.NotConverged) as caught:
        ec.run(scene)
    assert caught.value.report.iterations >= 1
    assert len(caught.value.report.history) >= 1


# ---------------------------------------------------------------- explain, gallery, plot


def test_explain_is_text_or_json(command):
    text = command("explain", "hertz")
    assert (text.code, text.err) == (0, "")
    for words in ("blocks, in order", "kernels, ", "predicted", "left out, and why"):
        assert words in text.out
    data = json.loads(command("explain", "hertz", "--json").out)
    assert {"blocks", "kernels", "left_out", "predicted_memory_bytes", "predicted_seconds", "scene"} <= set(data)


def test_explain_takes_changes(command):
    data = json.loads(command("explain", "hertz", "--json", "--set", "stress=[]", "--set", "grid.margin=3").out)
    assert data["scene"]["grid"]["margin"] == 3.0


def test_gallery_lists_titles(command):
    outcome = command("gallery")
    data = json.loads(command("gallery", "--json").out)
    assert {"hertz", "hertz-ellipse", "tilted-punch", "rough-surface", "dissimilar-spheres"} <= set(data)
    for name, title in data.items():
        assert re.search(rf"^{name} +{re.escape(title)}$", outcome.out, re.MULTILINE)


def test_gallery_show_prints_a_scene_to_start_from(command, tmp_path):
    outcome = command("gallery", "show", "hertz")
    tomllib.loads(outcome.out)
    (tmp_path / "my.toml").write_text(outcome.out, encoding="utf-8")
    mine, bundled = ec.load_scene(tmp_path / "my.toml"), ec.load_scene("hertz")
    assert mine.resolved() == bundled.resolved() | {"name": "my"}


def test_gallery_show_refuses_unknown_names(command):
    outcome = command("gallery", "show", "herz")
    assert outcome.code == 2
    assert "unknown bundled scene 'herz'" in outcome.err
    assert "did you mean 'hertz'?" in outcome.err
    assert outcome.err.count("\n") == 1


@pytest.mark.usefixtures("small_pictures")
def test_plot_draws_stored_results(command, tmp_path):
    folder = tmp_path / "out"
    changes = ["stress.0.depth-cells=12", "grid.cells-per-contact-radius=12"]
    changes += ["output.pictures=false", "output.vtk=false"]
    arguments = [part for change in changes for part in ("--set", change)]
    assert command("run", "hertz", *arguments, "-q", "-o", folder).code == 0
    assert list(folder.glob("*.png")) == []
    outcome = command("plot", folder, "--no-vtk")
    assert (outcome.code, outcome.err) == (0, "")
    pictures = {path.name for path in folder.glob("*.png")}
    assert {"pressure.png", "pressure-profiles.png", "section.png", "axis.png"} <= pictures
    for name in pictures:
        assert str(folder / name) in outcome.out
    data = json.loads(command("plot", folder / "results.nc", "-o", tmp_path / "elsewhere", "--json").out)
    assert {path.rsplit("/", 1)[-1] for path in data} == {path.name for path in (tmp_path / "elsewhere").iterdir()}
    assert any(path.endswith(".vti") for path in data)


def test_plot_of_nothing(command, tmp_path):
    outcome = command("plot", tmp_path)
    assert outcome.code == 5
    assert "results.nc must exist (got nothing there); give the folder of a run or its results.nc" in outcome.err
    (tmp_path / "results.nc").write_bytes(b"not HDF5")
    outcome = command("plot", tmp_path)
    assert outcome.code == 5
    assert outcome.err.count("\n") == 1
    assert "results.nc must be a complete results file" in outcome.err


@pytest.mark.parametrize("arguments", [["plugins", "shpere"], ["plugins", "shpere", "--json"]])
def test_plugins_refuses_unknown_keys(arguments, command):
    outcome = command(*arguments)
    assert (outcome.code, outcome.out) == (2, "")
    assert "unknown plugin 'shpere'; installed: " in outcome.err
    assert "did you mean 'sphere'?" in outcome.err


def test_plugins_lists_kinds_packages_and_parameters(command):
    text = command("plugins").out
    for words in ("geometry", "observer", "surface-influence", "sphere", "(eigencontact "):
        assert words in text
    data = json.loads(command("plugins", "--json").out)
    assert data["broken"] == []
    sphere = next(entry for entry in data["plugins"] if entry["key"] == "sphere")
    assert sphere["parameters"][0] == {
        "name": "radius",
        "meaning": "R [m].",
        "takes": "a length [m]",
        "unit": "m",
        "choices": None,
        "required": True,
        "default": None,
    }


# --- cache --------------------------------------------------------------------------------------------------------


@pytest.fixture
def tables(tmp_path, monkeypatch):
    """Two tables in a folder of their own."""
    folder = tmp_path / "tables"
    monkeypatch.setenv("EIGENCONTACT_CACHE", str(folder))
    found = TableCache(folder)
    for name in "ab":
        found.keep(name, {"values": np.zeros(1000)})
    return found


def test_cache_tells_clears_and_bounds_the_tables_on_disk(command, tables):
    size = sum(entry.size for entry in tables.entries())
    expected = {"folder": str(tables.folder), "entries": 2, "bytes": size, "limit": 1_000_000_000}
    assert json.loads(command("cache", "--json").out) == expected
    assert command("cache").out.startswith("2 tables, 17.5")
    assert "of at most 2.5 GB" in command("cache", "--limit", "2.5 GB").out
    assert command("cache", "--limit", "10 kB").out.startswith("1 tables, 8.7")
    assert command("cache", "--clear").out.startswith("0 tables, 0 B of at most 10 kB")
    assert tables.entries() == []


@pytest.mark.parametrize(
    ("limit", "words"),
    [
        ("2", "give a plain number or a unit, like \"2 GB\" (got '2')"),
        ("2 m", "has the dimension [length]"),
        ("0 B", "cache.limit must be positive [bytes]"),
    ],
)
def test_cache_refuses_what_is_no_size(command, tables, limit, words):
    outcome = command("cache", "--limit", limit)
    assert outcome.code == 2
    assert words in outcome.err
    assert tables.limit == 1_000_000_000


def test_cache_that_is_turned_off_has_no_limit(command):
    assert command("cache").out == "tables are not kept on disk\n"
    outcome = command("cache", "--limit", "1 GB")
    assert outcome.code == 2
    assert "EIGENCONTACT_CACHE must name a folder" in outcome.err


def test_tables_in_a_pipe_have_no_blanks_at_the_ends_of_lines(command, quick, tmp_path):
    outcome = command("run", "hertz", "-o", tmp_path, *quick)
    assert outcome.code == 0
    assert [line for line in outcome.out.splitlines() if line != line.rstrip()] == []
