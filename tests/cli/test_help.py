"""Help of the command line: commands by purpose, flags without values, suggestions, and where the gallery leads."""

import re

import pytest
from typer.testing import CliRunner

from eigencontact.cli import app
from eigencontact.command_help import PANELS

#: What tells the commands apart that verify something.
SAYS = {
    "campaign": "Map where a model is accurate",
    "check": "Check plugins against the contract of their kind",
    "extremes": "Test numerical stability at built-in extreme inputs",
    "study": "Reproduce a trend of the literature",
    "tradeoff": "Compare fidelities of one scene",
    "verify": "Cross-check kernels, laws, or one stored run",
}


@pytest.fixture
def text(command, monkeypatch):
    """Help of a command, without frames."""
    monkeypatch.setenv("COLUMNS", "200")
    return lambda *words: command(*words, "--help").out


def test_commands_stand_under_their_purpose(text):
    shown = text()
    places = [shown.index(f"─ {panel} ─") for panel in PANELS]
    assert places == sorted(places)
    for panel, start, end in zip(PANELS.values(), places, [*places[1:], len(shown)], strict=True):
        assert re.findall(r"^│ ([a-z-]+) ", shown[start:end], re.MULTILINE) == list(panel)
    assert "Commands of other packages" not in shown


def test_each_line_tells_its_command_apart(text):
    shown = text()
    for name, words in SAYS.items():
        assert re.search(rf"^│ {name} +{words}", shown, re.MULTILINE), name


@pytest.mark.parametrize("words", [(), ("run",), ("verify",), ("sweep",), ("gallery",), ("plot",)])
def test_flags_show_no_value(text, words):
    shown = text(*words)
    assert "--help" in shown
    assert "bool" not in shown.lower()


def test_an_unknown_option_names_those_that_exist(command):
    every = " ".join(command("run", "--bogus").err.split())
    for option in ("--set", "--output", "--resume", "--overwrite", "--quiet", "--verbose", "--json"):
        assert option in every
    slip = " ".join(command("run", "hertz", "--overwite").err.split())
    assert "--overwrite" in slip
    assert "--verbose" not in slip


def test_gallery_run_names_the_command_that_solves(command):
    outcome = command("gallery", "run", "hertz")
    assert outcome.code == 2
    assert outcome.err == (
        "eigencontact: gallery must list or show scenes (got run); `eigencontact run hertz` solves one\n"
    )
    assert "run " not in CliRunner().invoke(app, ["gallery", "--help"]).output
