"""Fatigue of a run: the number is the criterion's own, at the place it names; refusals."""

import json

import numpy as np
import pytest
import typer

import eigencontact as ec
from eigencontact.plugin import StressCycle, to_mandel

CRITERION = {"type": "crossland", "slope": 0.3, "limit-amplitude": "250 MPa"}


@pytest.fixture(scope="module")
def pressed():
    changes = ["grid.cells-per-contact-radius=8", "stress.0.depth-cells=10"]
    return ec.run(ec.load_scene("hertz", changes))


def test_hot_spot_is_the_largest_value_of_the_criterion(pressed):
    found = ec.fatigue(pressed, CRITERION, cycle="all", region="section")
    stress = pressed.dataset["section_stress"].values
    mandel = np.stack([to_mandel(step.reshape(6, -1)) for step in stress])
    parameters = {"slope": 0.3, "limit_amplitude": 250e6}
    expected = ec.make("crossland", **parameters).damage(StressCycle(stress=mandel)).value
    np.testing.assert_allclose(found.dataset.utilisation.values.ravel(), expected / 250e6, rtol=1e-12, atol=0)
    assert found.summary["utilisation"] == found.dataset.utilisation.values.max()


def test_refusals(pressed):
    with pytest.raises(ec.EigencontactError, match="cycle must be given"):
        ec.fatigue(pressed, CRITERION)
    with pytest.raises(ec.EigencontactError, match="region must name one with stress"):
        ec.fatigue(pressed, CRITERION, cycle="all", region="nowhere")
    with pytest.raises(ec.EigencontactError, match="distance must be positive"):
        ec.fatigue(pressed, CRITERION, cycle="all", region="section", distance=-1.0)


def test_a_cycle_of_one_step_says_that_nothing_has_an_amplitude(pressed):
    found = ec.fatigue(pressed, CRITERION, cycle="all", region="section")
    assert "the cycle has one step" in found.summary["warnings"][0]["words"]


def test_command_stores_map_picture_and_summary(tmp_path, command):
    """Pressed and released: two steps; values below the hot spot at a critical distance."""
    changes = ["grid.cells-per-contact-radius=8", "stress.0.depth-cells=10", "output.pictures=false"]
    scene = ec.load_scene("hertz", changes).resolved()
    ec.run({**scene, "steps": [{"normal-load": 0.65}, {"normal-load": 0.0}]}, tmp_path / "run")
    options = ["--criterion", "findley", "--set", "slope=0.3", "--set", "limit-amplitude='3 GPa'", "--cycle", "all"]
    done = command("fatigue", tmp_path / "run", *options, "--region", "section", "--distance", "2 um")
    assert done.code == 0, done.err
    stored = json.loads((tmp_path / "run" / "fatigue-findley-section.json").read_text(encoding="utf-8"))
    assert 0.0 < stored["utilisation"] < 10.0
    assert "one step" not in done.out + done.err
    assert {path.suffix for path in (tmp_path / "run").glob("fatigue-findley-section.*")} == {".nc", ".json", ".png"}


def test_an_answer_is_shown_by_its_words(pressed):
    answer = ec.fatigue(pressed, CRITERION, cycle="all", region="section")
    assert repr(answer) == f"Fatigue({'; '.join(answer.lines())})"


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("{", "--life must be keys and values, slope = 5, knee-cycles = 1e6 (got '{': Invalid initial character"),
        (
            "slope = 5 knee",
            "--life must be keys and values, slope = 5, knee-cycles = 1e6 (got 'slope = 5 knee': Unclosed",
        ),
    ],
)
def test_text_of_a_life_that_is_no_table(tmp_path, capsys, text, words):
    from eigencontact.postprocess.fatigue_command import fatigue

    with pytest.raises(typer.Exit):
        fatigue(tmp_path, criterion="crossland", changes=["slope=0.3", "limit-amplitude=2 GPa"], life=text)
    message = capsys.readouterr().err
    assert words in message
    assert "line 1" not in message
