"""Cracks of a run: factors by a weight function, mirror, fate against thresholds, refusals, command."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import eigencontact as ec
from close import close
from eigencontact.postprocess.crack_threshold import Threshold

STEPS = [{"normal-load": 0.65}, {"normal-load": 0.1}]
LONG = {"long-crack-range": "5 MPa*m^0.5", "limit-range": "400 MPa"}


def scene(**changes):
    base = ec.load_scene("hertz", ["grid.cells-per-contact-radius=10", "stress.0.depth-cells=30"]).resolved()
    return {**base, "steps": STEPS, **changes}


@pytest.fixture(scope="module")
def pressed():
    return ec.run(scene())


def test_the_factor_is_that_of_a_weight_function(pressed):
    """Universal weight function of an edge crack along the normal (G. Shen, G. Glinka 1991), good to 3e-3."""
    length, place = 8e-6, 5e-6
    answer = ec.crack(pressed, at=place, region="section", cycle="all", lengths=[length])
    stress = pressed.dataset["section_stress"].sel(component="xx").isel(step=0)
    depths = stress["section_z"].values
    along = [np.interp(place, stress["section_x"].values, row) for row in stress.transpose("section_z", "section_x")]

    root = np.linspace(0, 1, 20001)  # of 1 - x / a, which takes the singularity out
    rest = root**2
    weight = np.sqrt(2 / (np.pi * length)) * (1 + 0.0719768 * root + 0.246984 * rest + 0.514465 * root**3)
    expected = np.trapezoid(2 * length * weight * np.interp(length * (1 - rest), depths, along), root)
    assert answer.dataset["mode_1"].values[0, 0] == close(expected, rel=3e-3)


def test_a_mirrored_crack_has_mirrored_factors(pressed):
    right = ec.crack(pressed, at=4e-6, angle="20 deg", region="section", cycle="all").dataset
    left = ec.crack(pressed, at=-4e-6, angle=-np.radians(20), region="section", cycle="all").dataset
    scale = float(abs(right.mode_1).max())
    np.testing.assert_allclose(left.mode_1, right.mode_1, rtol=0, atol=1e-6 * scale)
    np.testing.assert_allclose(left.mode_2, -right.mode_2, rtol=0, atol=1e-6 * scale)


def test_ranges_are_those_of_the_cycle_and_closed_cracks_have_none(pressed):
    answer = ec.crack(pressed, at=0.0, angle="10 deg", region="section", cycle="all").dataset
    assert np.all(answer.mode_1 < 0)  # pressed from above
    np.testing.assert_array_equal(answer.mode_1_range, 0.0)
    np.testing.assert_allclose(answer.effective_range, abs(answer.mode_2[0] - answer.mode_2[1]), rtol=1e-13)


@pytest.mark.parametrize(
    ("limit", "fate"), [(lambda a: 0 * a + 1e12, "does not start"), (lambda a: 0 * a, "grows"), (None, "unknown")]
)
def test_fate(pressed, limit, fate):
    assert ec.crack(pressed, at=6.5e-6, region="section", cycle="all", threshold=limit).summary["fate"] == fate


def test_a_crack_stops_where_its_range_meets_the_threshold(pressed):
    free = ec.crack(pressed, at=6.5e-6, region="section", cycle="all").dataset
    sizes, span = free["length"].values, free["effective_range"].values

    def rule(length):
        return 1.5 * span.max() * length / sizes[-1]

    stopped = ec.crack(pressed, at=6.5e-6, region="section", cycle="all", threshold=rule).summary
    assert stopped["fate"] == "stops"
    assert sizes[0] < stopped["arrest_length"] < sizes[-1]
    assert np.interp(stopped["arrest_length"], sizes, span) == close(rule(stopped["arrest_length"]), rel=1e-9)


def test_a_hot_spot_gives_place_plane_and_cycle(pressed):
    criterion = {"type": "findley", "slope": 0.3, "limit-amplitude": "3 GPa"}
    hot = ec.fatigue(pressed, criterion, region="section", cycle="all")
    answer = ec.crack(pressed, start=hot)
    across, _, down = hot.summary["normal"]
    assert answer.summary["place"] == hot.summary["place"][0]
    assert np.sin(answer.summary["angle"]) * across + np.cos(answer.summary["angle"]) * down == close(
        0, rel=0, abs=1e-12
    )
    assert answer.summary["steps"] == hot.summary["steps"]


def test_thresholds_of_short_and_long_cracks():
    smooth, sharp = (
        Threshold(long_crack_range=5e6, limit_range=4e8, curve=name) for name in ("el-haddad", "kitagawa-takahashi")
    )
    for rule in (smooth, sharp):
        assert rule(np.array([1e3]))[0] == close(5e6, rel=1e-6)
        short = np.array([1e-12])
        assert rule(short)[0] == close(1.1215 * 4e8 * np.sqrt(np.pi * short[0]), rel=1e-6)
    meeting = np.array([smooth.intrinsic_length])
    assert smooth(meeting)[0] == close(5e6 / np.sqrt(2), rel=1e-12)
    assert sharp(meeting)[0] == close(5e6, rel=1e-12)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({}, "at must be given"),
        ({"at": "1 m"}, "at must lie within 'section'"),
        ({"at": 0.0, "angle": "80 deg"}, "crack.inclination must be within -65 and 65 degrees"),
        ({"at": 0.0, "lengths": ["1 m"]}, "lengths must end within the region"),
        ({"at": 0.0, "lengths": [2e-6, 1e-6]}, "lengths must be positive and growing"),
        ({"at": 0.0, "compare": "shear"}, "compare must be 'effective' or 'opening'"),
        ({"at": 0.0, "threshold": {"long-crack-range": 1.0}}, "threshold.limit-range must be given"),
        ({"at": 0.0, "threshold": {**LONG, "curv": "x"}}, "threshold.curv must be one of"),
        ({"at": 0.0, "threshold": {**LONG, "limit-range": "-1 Pa"}}, "threshold.limit-range must be positive"),
        ({"at": 0.0, "threshold": lambda a: -a}, "threshold must return a finite value >= 0"),
        ({"start": {"place": 1}}, "start must be what fatigue returned"),
        ({"at": "1 um", "cycle": "last"}, "cycle must be given"),
    ],
)
def test_refusals(pressed, options, words):
    with pytest.raises(ec.EigencontactError, match=words):
        ec.crack(pressed, **{"region": "section", "cycle": "all", **options})


def test_a_line_is_no_section():
    line = {"name": "axis", "shape": "line", "start": [0, 0, 0], "end": [0, 0, 1e-5], "count": 5}
    answer = ec.run(scene(stress=[line]))
    with pytest.raises(ec.EigencontactError, match="region must be a section in x and z"):
        ec.crack(answer, at=0.0, cycle="all")


def test_command_stores_factors_picture_and_summary(tmp_path):
    ec.run({**scene(), "output": {"pictures": False}}, tmp_path / "run")
    options = ["--at", "6.5 um", "--angle", "15 deg", "--cycle", "all", "--region", "section"]
    options += ["--long-crack-range", "5 MPa*m^0.5", "--limit-range", "400 MPa"]
    command = [Path(sys.executable).with_name("eigencontact"), "crack", tmp_path / "run", *options]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=120)
    assert done.returncode == 0, done.stderr
    stored = json.loads((tmp_path / "run" / "crack-section.json").read_text(encoding="utf-8"))
    assert stored["angle"] == close(np.radians(15), rel=1e-12)
    assert stored["fate"] in ("does not start", "stops", "grows")
    assert {path.suffix for path in (tmp_path / "run").glob("crack-section.*")} == {".nc", ".json", ".png"}
