"""Exit codes of wrong options and of damaged results: 2 where the input is refused, 5 where results cannot be read."""

import shutil

import h5py
import pytest

import eigencontact as ec


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    folder = tmp_path_factory.mktemp("run") / "hertz"
    small = ["stress=[]", "grid.cells-per-contact-radius=4", "output.pictures=false", "output.vtk=false"]
    ec.run(ec.load_scene("hertz", small), folder).dataset.close()
    return folder


#: Arguments, with the folder of results as RUN; each is refused for an option.
WRONG = [
    ["plot", "RUN", "--step", "99"],
    ["plot", "RUN", "--step", "99", "--field", "pressure"],
    ["plot", "RUN", "--step", "99", "--region", 'shape = "plane", depth-max = "2 um"'],
    ["plot", "RUN", "--field", "presure"],
    ["plot", "RUN", "--region", "nowhere"],
    ["plot", "RUN", "--region", 'shape = "plane", depth = "2 um"'],
    ["plot", "RUN", "--component", "x"],
    ["plot", "RUN", "--format", "bmp"],
    ["plot", "RUN", "--style", "film"],
    ["plot", "RUN", "--dpi", "-1"],
    ["plot", "RUN", "--animation"],
    ["plot", "RUN", "--field", "pressure", "--zoom", "1:2:3"],
    ["report", "RUN", "-o", "RUN/page.txt"],
    ["run", "hertz", "--resume", "--overwrite", "-o", "RUN"],
    ["run", "hertz", "--set", "nothing"],
    ["run", "nowhere"],
    ["explain", "hertz", "--set", "body1.poisson-ratio=2"],
    ["plugins", "nothing"],
    ["schema", "nothing"],
    ["cache", "--limit", "many"],
    ["gallery", "show", "nothing"],
    ["new-plugin", "Not A Name"],
    ["new-plugin", "torus", "--kind", "nothing"],
    ["check", "nothing"],
    ["sweep", "hertz", "--vary", "nothing"],
    ["run", "hertz", "--no-such-option"],
]


@pytest.mark.parametrize("arguments", WRONG, ids=lambda words: " ".join(words)[:40])
def test_a_wrong_option_ends_with_2(arguments, results, command, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    outcome = command(*(word.replace("RUN", str(results)) for word in arguments))
    assert outcome.code == 2, outcome.err
    assert outcome.err
    assert "Traceback" not in outcome.err
    assert sorted(path.name for path in results.iterdir()) == ["results.nc", "summary.json"]


@pytest.mark.usefixtures("small_pictures")
@pytest.mark.parametrize(
    ("name", "text"), [("scene", "[[["), ("scene", ""), ("scene", "title = 3"), ("versions", "{"), ("regions", "{")]
)
@pytest.mark.parametrize(
    "arguments", [["report", "RUN"], ["plot", "RUN", "--region", 'name = "q", shape = "plane", depth-max = "2 um"']]
)
def test_damaged_contents_are_one_clear_error(arguments, name, text, results, command, tmp_path):
    shutil.copytree(results, tmp_path / "run")
    with h5py.File(tmp_path / "run" / "results.nc", "a") as file:
        file.attrs[name] = text
    outcome = command(*(word.replace("RUN", str(tmp_path / "run")) for word in arguments))
    planned_again = arguments[0] == "plot" and text in ("", "title = 3")  # a scene, but one that is refused
    assert outcome.code == (2 if planned_again else 5), outcome.err
    assert outcome.err.count("\n") == 1
    assert sorted(path.name for path in (tmp_path / "run").iterdir()) == ["results.nc", "summary.json"]


def test_no_results_end_with_5(command, tmp_path):
    for arguments in (["plot", tmp_path / "nowhere"], ["report", tmp_path / "nowhere"]):
        assert command(*arguments).code == 5
