"""The line of a scene in the table of audits: why nothing could be judged is the gap that takes away most."""

from __future__ import annotations

import pytest

from eigencontact_verification.audit.table import SceneAudit, line_of, markdown_of
from eigencontact_verification.crosscheck.case import Gap

SHALLOW = Gap(subject="a", what="stress in 'section'", reason="above a depth of 1 m the steps are felt")
UNSOLVED = Gap(subject="a", what="step-1", reason="not solved: budget must be at least 2 unknowns")
BODY = Gap(subject="a", what="body 1", reason="it repeats")
SURFACE = Gap(subject="a", what="displacement of the surface", reason="the elements cannot represent one of the bodies")


@pytest.mark.parametrize(
    ("gaps", "said"),
    [
        ((SHALLOW, UNSOLVED), UNSOLVED.reason),
        ((SHALLOW, UNSOLVED, BODY), BODY.reason),
        ((SHALLOW, SURFACE), SURFACE.reason),
        ((SHALLOW,), SHALLOW.reason),
        ((), "nothing is stored that could be judged"),
    ],
)
def test_where_nothing_is_judged_the_largest_gap_is_the_reason(gaps, said):
    audit = SceneAudit(name="a", step=1, judged=(), gaps=gaps)
    assert audit.word == "inconclusive"
    assert audit.reason == said


def test_a_page_has_two_tables_that_fit_and_the_reason_is_in_the_first():
    audit = SceneAudit(name="a", step=1, judged=(), gaps=(BODY,))
    text = markdown_of([line_of(audit)])
    verdicts, effort = (block.splitlines() for block in text.split("\n\n") if block.startswith("|"))
    assert [verdicts[-1].split(" | ")[0], verdicts[-1].split(" | ")[-1]] == ["| a", "it repeats |"]
    assert effort[0].startswith("| scene | step |")
    assert max(line.count(" | ") for line in (*verdicts, *effort)) < 8
