"""`eigencontact extremes`: the quick corners hold, faults that are planted are seen, the page has all features."""

import json
from pathlib import Path

import numpy as np
import pytest

from eigencontact.errors import NotConverged, SceneError
from eigencontact_verification.extremes import catalogue
from eigencontact_verification.extremes.feature import Corner, Feature, refusal
from eigencontact_verification.extremes.judge import FeatureVerdict, judge, run
from eigencontact_verification.extremes.report import Report, as_html, as_markdown

FEATURES = catalogue.chosen()
PAGE = Path(__file__).parents[2] / "docs" / "measured" / "extremes.md"
#: Corners that take seconds; all others are either quick or slow.
QUICK = [(feature.key, corner) for feature in FEATURES for corner in feature.corners if corner.quick]
REST = [(feature.key, corner) for feature in FEATURES for corner in feature.corners if not corner.quick]


def holds(corner):
    found = judge(corner)
    assert found.word != "fails", found.message
    assert found.word == ("refused" if corner.refused else "holds")


@pytest.mark.parametrize(("key", "corner"), QUICK, ids=[f"{key}: {corner.name}" for key, corner in QUICK])
def test_quick_corners(key, corner):
    holds(corner)


@pytest.mark.slow
@pytest.mark.parametrize(("key", "corner"), REST, ids=[f"{key}: {corner.name}" for key, corner in REST])
def test_all_other_corners(key, corner):
    holds(corner)


def test_every_feature_has_quick_corners_a_reason_for_each_bound_and_names_of_its_own():
    assert [feature.key for feature in FEATURES] == list(catalogue.KEYS)
    for feature in FEATURES:
        assert feature.title
        assert feature.reference
        assert any(corner.quick for corner in feature.corners), feature.key
        names = [corner.name for corner in feature.corners]
        assert len(set(names)) == len(names), feature.key
        for corner in feature.corners:
            assert len(corner.reason) > 10, corner.name
            assert bool(corner.refused) == (corner.bound == 0), corner.name
            assert 0 <= corner.bound <= 0.02, corner.name


# ---------------------------------------------------------------- faults that are planted


def raising(problem):
    def call():
        raise problem

    return call


def corner(error, *, bound=1e-3, refused=""):
    return Corner(name="planted", error=error, bound=bound, reason="planted for a test", refused=refused)


@pytest.mark.parametrize(
    ("planted", "word", "said"),
    [
        (corner(lambda: 1e-3), "holds", ""),
        (corner(lambda: 1.1e-3), "fails", "off by 0.0011, more than 0.001"),
        (corner(lambda: np.nan), "fails", "not a finite number"),
        (corner(raising(NotConverged("stuck (tolerance 1e-6)"))), "fails", "refused where an answer is due: stuck"),
        (corner(raising(ZeroDivisionError("division by zero"))), "fails", "ZeroDivisionError: division by zero"),
        (refusal("planted", lambda: 1, "radius"), "fails", "answered where a refusal that says 'radius' is due"),
        (refusal("planted", raising(SceneError("ball.radius must be positive")), "radius"), "refused", "ball.radius"),
        (refusal("planted", raising(SceneError("no way")), "radius"), "fails", "without the words 'radius'"),
        (refusal("planted", raising(SceneError("radius\nis bad")), "radius"), "fails", "more than one short sentence"),
        (refusal("planted", raising(SceneError("radius " * 100)), "radius"), "fails", "more than one short sentence"),
        (refusal("planted", raising(ValueError("radius")), "radius"), "fails", "ValueError: radius"),
    ],
)
def test_verdicts(planted, word, said):
    found = judge(planted)
    assert found.word == word
    assert said in found.message


def report_of(*corners, quick=False):
    feature = Feature(key="planted", title="Planted", reference="nothing", corners=corners)
    found = [one for _, one in run([feature], quick=quick) if isinstance(one, FeatureVerdict)]
    return Report(features=tuple(found), quick=quick)


def test_the_worst_corner_of_a_feature_is_that_of_the_largest_part_of_its_bound():
    near, far = corner(lambda: 5e-4), corner(lambda: 1e-2, bound=1.0)
    report = report_of(far, near, refusal("planted", raising(SceneError("radius")), "radius"))
    assert report.exit_code == 0
    worst = report.features[0].worst
    assert worst is not None
    assert worst.corner is near
    assert "3 corners (full): 2 within their bounds, 1 refused as they must be, 0 at fault" in report.summary


def test_a_fault_is_in_every_form_of_the_report():
    report = report_of(corner(lambda: 1e-4), corner(raising(RuntimeError("a|b <c>"))))
    assert report.exit_code == 1
    assert [key for key, _ in report.faults] == ["planted"]
    assert "fails: RuntimeError: a\\|b <c>" in as_markdown(report)
    assert "fails: RuntimeError: a|b &lt;c&gt;" in as_html(report)
    assert json.loads(json.dumps(report.to_dict()))["features"][0]["corners"][1]["verdict"] == "fails"


def test_a_feature_without_quick_corners_is_left_out_of_the_quick_campaign():
    assert report_of(corner(lambda: 0.0), quick=True).features == ()


# ---------------------------------------------------------------- the command and its page


def test_the_command_writes_its_report(command, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    found = command("extremes", "--quick", "--feature", "refusals", "--feature", "loads", "--markdown", "docs/page.md")
    assert found.code == 0, found.out + found.err
    assert "0 at fault" in found.out
    assert {"report.json", "report.md", "report.html"} == {file.name for file in (tmp_path / "extremes").iterdir()}
    assert (tmp_path / "docs" / "page.md").read_text().count("\n## ") == 2
    data = json.loads(command("extremes", "--quick", "--feature", "loads", "--json").out)
    assert data["exit_code"] == 0
    assert [one["key"] for one in data["features"]] == ["loads"]


def test_a_fault_is_an_exit_code(command, tmp_path, monkeypatch):
    planted = Feature(key="planted", title="Planted", reference="nothing", corners=(corner(lambda: 1.0),))
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(catalogue, "chosen", lambda _: (planted,))
    found = command("extremes")
    assert found.code == 1
    assert "planted, planted: off by 1, more than 0.001" in found.out


def test_features_are_listed_and_unknown_ones_refused(command):
    assert command("extremes", "--list").out.count("corners") == len(FEATURES)
    found = command("extremes", "--feature", "layer")
    assert found.code == 2
    assert "(got 'layer'); did you mean 'layers'?" in found.err


def test_the_page_has_every_feature_and_every_corner_without_a_fault():
    """Written by `eigencontact extremes --markdown FILE`; what is new in a feature must be in it."""
    parts = PAGE.read_text(encoding="utf-8").split("\n## ")
    assert "0 at fault" in parts[0]
    sections = {part.partition("\n")[0]: part for part in parts[1:]}
    assert list(sections) == [feature.key for feature in FEATURES]
    for feature in FEATURES:
        rows = [line for line in sections[feature.key].splitlines() if line.startswith("| ")]
        assert [row.split(" | ")[0].removeprefix("| ") for row in rows[2:]] == [one.name for one in feature.corners]
