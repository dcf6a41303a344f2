"""What README and the pages of the site show can be typed: scenes are planned, library examples run, commands exist."""

import re
import shlex
import tomllib
from pathlib import Path

import numpy as np
import pytest

import eigencontact as ec

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text("utf-8")
MADE = {"_build", "_cache", "gallery", "reference"}  # what the build writes, and runs itself
PAGES = {
    path.relative_to(ROOT).as_posix(): path.read_text("utf-8")
    for path in [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
    if not MADE & set(path.parts)
}
LANDING = PAGES["docs/index.md"]
EXECUTED_BY_THE_BUILD = ("{code-cell}", "{toctree}", "{include}", "{literalinclude}", "{eval-rst}")
PROSE = ("{figure}", "{glossary}")
PLAIN = ("text", "bibtex")


def blocks(text, language):
    return re.findall(rf"^```{language}\n(.*?)^```", text, re.DOTALL | re.MULTILINE)


SCENES = [(page, scene) for page, text in PAGES.items() for scene in blocks(text, "toml")]


@pytest.mark.parametrize(("page", "text"), SCENES, ids=[f"{page}: {text.splitlines()[0]}" for page, text in SCENES])
def test_scenes_are_planned(page, text):
    assert "predicted" in str(ec.explain(tomllib.loads(text)))


def test_library_examples_run(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    names = {}
    for text in blocks(README, "python"):
        exec(text, names)  # the blocks build on each other
    hertz = (6 * 0.65 * (105e9 / (1 - 0.3**2)) ** 2 / (np.pi**3 * 105e-6**2)) ** (1 / 3)
    assert abs(names["contact"].max_pressure / hertz - 1) < 0.002  # like materials: shear does not change the pressure
    assert names["u"].shape == (1, 3)
    assert names["u"][0, 2] < 0  # what swells lifts the surface


def test_the_example_of_the_landing_page_runs(capsys):
    names = {}
    (text,) = blocks(LANDING, "python")
    exec(text, names)
    assert float(capsys.readouterr().out) == names["result"].summary["max_pressure"] > 0


def test_commands_exist():
    """Lines of a shell block begin with a command of the program, a file's name or the environment."""
    from click import Context
    from typer.main import get_command

    from eigencontact.cli import app

    group = get_command(app)
    known = set(group.list_commands(Context(group)))
    shell = [*blocks(README, "sh"), *blocks(LANDING, "sh")]
    typed = [line for text in shell for line in text.splitlines() if line.startswith("eigencontact")]
    assert len(typed) > 5
    for line in typed:
        words = shlex.split(line, comments=True)
        assert words[1] in known, line
        options = {name for parameter in group.get_command(None, words[1]).params for name in parameter.opts}
        assert {word for word in words[2:] if word.startswith("-")} <= options, line


def test_every_block_is_executed_somewhere():
    """By the build (cells), by the tests above, by CI as a command of README, or it is no code."""
    tested = {page: {"toml", "python", "sh"} for page in ("README.md", "docs/index.md")}
    for page, text in PAGES.items():
        rest = re.sub(r"(?ms)^```sh\n(.*?)^```", lambda hit: "" if hit[1] in README else hit[0], text)
        for language in re.findall(r"^```+(\S+)", rest, re.MULTILINE):
            allowed = {*PLAIN, *PROSE, *EXECUTED_BY_THE_BUILD, *tested.get(page, {"toml"})}
            assert language in allowed, f"{page}: a block of {language!r} is executed by nothing; make it a cell"


def test_readme_is_short():
    assert len(README.encode()) <= 10_000


def test_the_version_is_one():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]["version"]
    citation = re.search(r"^version: (.+)$", (ROOT / "CITATION.cff").read_text("utf-8"), re.MULTILINE)[1]
    assert project == citation == ec.__version__
    assert f"({ec.__version__})" in (ROOT / "CHANGELOG.md").read_text("utf-8")
