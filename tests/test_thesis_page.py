"""The page of the thesis: stored verdicts are those of the index, and its tables hold every figure and claim."""

import json
import re
import sys
from pathlib import Path

from eigencontact_verification.thesis.judge import VERDICTS
from eigencontact_verification.thesis.pictures import picture_name
from eigencontact_verification.thesis.reading import thesis_index

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT / "docs" / "_ext"))

from thesis_page import thesis_tables  # noqa: E402 - lies with the site

STORED = ROOT / "docs" / "measured" / "thesis.json"


def test_stored_verdicts_are_on_the_claims_of_the_index():
    """Claims that were added or reworded since: `eigencontact study thesis --quick` writes the file anew."""
    found = json.loads(STORED.read_text("utf-8"))["claims"]
    known = [(one.name, claim.says) for one in thesis_index().entries() for claim in one.claim]
    assert [(one["name"], one["says"]) for one in found] == known
    assert {one["verdict"] for one in found} <= set(VERDICTS)


def test_tables_hold_every_figure_and_every_claim():
    text = thesis_tables(STORED)
    rows = [line for line in text.splitlines() if line.startswith("| ")]
    for entry in thesis_index().entries():
        assert entry.name in text
        for claim in entry.claim:
            assert any(claim.says.replace("*", "\\*").replace("_", "\\_") in row for row in rows), claim.says
    assert {line.count(" | ") for line in rows} <= {6, 10, 2}


def test_every_picture_stands_on_a_card_that_leads_to_its_row():
    text = thesis_tables(STORED)
    pictures = {path.name for path in (ROOT / "docs" / "pictures" / "thesis").glob("*.png")}
    drawn = re.findall(r":img-top: \.\./pictures/thesis/(\S+)", text)
    assert len(drawn) == len(set(drawn))
    assert set(drawn) == pictures == {picture_name(one) for one in thesis_index().entries() if one.study}
    anchors = re.findall(r'<a id="([^"]+)"></a>', text)
    assert set(re.findall(r':link: "#(.+)"', text)) <= set(anchors)
    assert len(anchors) == len(set(anchors))


def test_counts_are_those_of_the_verdicts():
    found = json.loads(STORED.read_text("utf-8"))
    for name, count in found["counts"]["claims"].items():
        assert sum(one["verdict"] == name for one in found["claims"]) == count
