"""Tables of the audits of many runs: elements, effort, verdicts and reasons; and of their whole contacts."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from eigencontact_verification.audit.cases import AuditCase
from eigencontact_verification.crosscheck.case import HALVED, Gap
from eigencontact_verification.crosscheck.judge import JudgedCase, Row
from eigencontact_verification.reporting.machine import describe, facts
from eigencontact_verification.reporting.page import markdown_table, measured
from eigencontact_verification.reporting.table import Column, table
from eigencontact_verification.reporting.verdict import WORDS, worst

__all__ = ["ENOUGH", "SceneAudit", "contacts_of", "halved_in_words", "line_of", "markdown_of"]

#: Part of the verdicts of a scene that may be inconclusive where the scene is said to agree.
ENOUGH = 0.2
_WAYS = {"revolution": "of revolution", "solid": "three dimensions"}
_HEAD = (
    "scene", "step", "elements", "meshes", "unknowns", "wall time [s]", "longest solve [s]", "peak memory [GB]",
    "agree", "inconclusive", "disagree", "largest difference in u", "in stress", "verdict", "why",
)  # fmt: skip
#: The columns of the two tables of a page: what the audit found, and what it took.
_VERDICTS = ("scene", "verdict", "agree", "inconclusive", "disagree", "largest difference in u", "in stress", "why")
_EFFORT = ("scene", "step", "elements", "meshes", "unknowns", "wall time [s]", "longest solve [s]", "peak memory [GB]")
#: First words of the profiles of whole contacts, of revolution and along a line: a column each that any of them has,
#: largest difference ± uncertainty.
_KINDS = (
    "approach", "contact radius", "half width", "pressure", "shear", "slip", "print", "history of stress",
    "stress in the middle", "stress near the edge", "stress through", "stress on the axis", "plastic strain",
)  # fmt: skip


@dataclass(frozen=True, kw_only=True, eq=False)
class SceneAudit:
    """Audit of one run.

    Attributes
    ----------
    name : str
    step : int
    judged : tuple of JudgedCase
        Checks included.
    gaps : tuple of Gap
    seconds : float or None
        Wall time of the audit; None where solutions were kept from an earlier one.
    """

    name: str
    step: int
    judged: tuple[JudgedCase, ...]
    gaps: tuple[Gap, ...]
    seconds: float | None = None

    @property
    def rows(self) -> tuple[Row, ...]:
        """Verdicts by finite elements."""
        return tuple(row for case in self.judged for row in case.rows if row.quantity != "check")

    @property
    def counts(self) -> dict[str, int]:
        """Verdicts by word."""
        counts = Counter(row.word for row in self.rows)
        return {word: counts.get(word, 0) for word in WORDS}

    @property
    def word(self) -> str:
        """Of the scene: it agrees where nothing disagrees or failed and few verdicts are inconclusive."""
        if any(row.word == "disagrees" for case in self.judged for row in case.rows):
            return "disagrees"
        counts = self.counts
        if not self.rows or counts["failed"] or counts["inconclusive"] > ENOUGH * len(self.rows):
            return "inconclusive"
        return "agrees"

    @property
    def reason(self) -> str:
        """Commonest reasons of verdicts other than agreement, or the reason why nothing could be judged."""
        if not self.rows:
            return min(self.gaps, key=_rank).reason if self.gaps else "nothing is stored that could be judged"
        worst = [row for row in self.rows if row.word == self.word and self.word != "agrees"]
        worst += [row for case in self.judged for row in case.rows if row.quantity == "check" and row.word != "agrees"]
        if worst and self.word == "disagrees":
            row = max(worst, key=lambda case: case.ratio or 0.0)
            return f"{row.profile}, {row.component}: {row.reason}"
        reasons = Counter(row.reason for row in self.rows if row.word != "agrees")
        return "; ".join(f"{reason} ({count})" for reason, count in reasons.most_common(2))


def _rank(gap: Gap) -> int:
    """Rank of a gap by its size, the largest first: a body, a whole case, the surface, a part of a region."""
    if gap.what.startswith("body "):
        return 0
    return 1 if gap.reason.startswith("not solved: ") else 2 if gap.what == "displacement of the surface" else 3


def _largest(rows: Iterable[Row], quantity: str) -> str:
    differences = [row.difference for row in rows if row.quantity == quantity and row.difference is not None]
    return f"{100 * max(differences):.2g} %" if differences else "–"


def _cells(audit: SceneAudit) -> tuple[str, ...]:
    outcomes = [
        outcome for judged in audit.judged for task, outcome in judged.outcomes
        if task.level is not None and outcome.seconds is not None
    ]  # fmt: skip
    cases = [judged.case for judged in audit.judged if isinstance(judged.case, AuditCase)]
    engines, meshes = (dict.fromkeys(which) for which in ((case.engine for case in cases), (_mesh(c) for c in cases)))
    seconds = [outcome.seconds or 0.0 for outcome in outcomes]
    memory = [outcome.memory for outcome in outcomes if outcome.memory]
    unknowns = [outcome.unknowns for outcome in outcomes if outcome.unknowns]
    counts = audit.counts
    return (
        audit.name, str(audit.step), " and ".join(_WAYS[engine] for engine in engines) or "–",
        " and ".join(meshes) or "–",
        f"{max(unknowns):,}".replace(",", " ") if unknowns else "–",
        f"{audit.seconds:.0f}" if seconds and audit.seconds else "–", f"{max(seconds):.1f}" if seconds else "–",
        f"{max(memory) / 1e9:.2f}" if memory else "–",
        str(counts["agrees"]), str(counts["inconclusive"]), str(counts["disagrees"] + counts["failed"]),
        _largest(audit.rows, "displacement"), _largest(audit.rows, "stress"), audit.word, audit.reason or "–",
    )  # fmt: skip


def _mesh(case: AuditCase) -> str:
    return "quick" if case.quick else "full"


def line_of(audit: SceneAudit) -> dict[str, Any]:
    """Row of a run for JSON; an interrupted table continues from these rows."""
    checks = [row for judged in audit.judged for row in judged.rows if row.quantity == "check"]
    return {
        "word": audit.word,
        "counts": audit.counts,
        "checks": [sum(row.word == "agrees" for row in checks), len(checks)],
        "cells": list(_cells(audit)),
    }


def markdown_of(lines: Sequence[dict[str, Any]]) -> str:
    """Sentences and two tables, for a page, of what `line_of` says of runs."""
    counts = Counter(line["word"] for line in lines)
    verdicts: Counter[str] = Counter()
    for line in lines:
        verdicts.update(line["counts"])
    hold, checks = (sum(line["checks"][k] for line in lines) for k in (0, 1))
    total = sum(verdicts.values())
    summary = (
        f"{len(lines)} scenes: {counts['agrees']} agree, {counts['inconclusive']} are inconclusive, "
        f"{counts['disagrees']} disagree. {total} verdicts: {verdicts['agrees']} agree, {verdicts['inconclusive']} are "
        f"inconclusive, {verdicts['disagrees']} disagree, {verdicts['failed']} failed. {checks} checks without "
        f"elements: {hold} hold."
    )
    return "\n\n".join([summary, _table(_VERDICTS, lines), "Meshes and cost:", _table(_EFFORT, lines), measured()])


def _table(names: Sequence[str], lines: Sequence[dict[str, Any]]) -> str:
    """Some columns of the lines."""
    columns = [_HEAD.index(name) for name in names]
    return markdown_table(names, ([line["cells"][at] for at in columns] for line in lines))


def contacts_of(judged: Sequence[JudgedCase], gaps: Sequence[Gap]) -> str:
    """Table of whole contacts, for a page, with all verdicts that are no agreement and what is left out."""
    rows = [row for case in judged for row in case.rows if row.word != "agrees"]
    disputed = [f"- {row.subject}, {row.profile}, {row.component}: {row.word}, {row.reason}" for row in rows]
    left_out = [f"- {gap.subject}: {gap.reason}." for gap in gaps] + [f"- {words}" for words in halved_in_words(judged)]
    rows_of = [_contact_row(case) for case in judged]
    columns = [
        Column("scene", "scene"),
        Column("agrees / inconclusive / disagrees", "verdicts"),
        *(Column(f"{kind} [%]", kind) for kind in _KINDS if any(kind in row for row in rows_of)),
        Column("elements [s]", "seconds", ".0f"),
        Column("peak [MB]", "memory", ".0f", scale=1e-6),
    ]
    sections = [table(rows_of, columns)]
    for title, lines in (("Not agreed:", disputed), ("Left out, or taken otherwise:", left_out)):
        if lines:
            sections += [title, "\n".join(lines)]
    return "\n\n".join([*sections, f"{describe(facts())}."])


def halved_in_words(judged: Iterable[JudgedCase]) -> list[str]:
    """Sentences with the largest number of increments that the elements halved in one solution of a case."""
    words = []
    for case in judged:
        count = max((int((outcome.fields or {}).get(HALVED, [0])[0]) for _, outcome in case.outcomes), default=0)
        if count:
            words.append(
                f"{case.case.subject}: the elements halved {count} increment{'s' * (count > 1)} that had no solution "
                "as a whole; friction and laws of a body depend on the increments, and the run did not halve these."
            )
    return words


def _contact_row(contact: JudgedCase) -> dict[str, Any]:
    """Verdicts, largest difference by kind of profile, effort."""
    verdicts = [row.word for row in contact.rows]
    cells: dict[str, Any] = {
        "scene": contact.case.subject,
        "verdicts": f"{verdicts.count('agrees')} / {verdicts.count('inconclusive')} / {verdicts.count('disagrees')}",
        "seconds": sum(outcome.seconds for task, outcome in contact.outcomes if task.level is not None),
        "memory": max((outcome.memory or 0 for _, outcome in contact.outcomes), default=0),
    }
    for kind in _KINDS:
        rows = [row for row in contact.rows if row.profile.startswith(kind) and row.difference is not None]
        if rows:
            largest = max(rows, key=lambda row: row.ratio or 0.0)
            mark = {"agrees": "", "inconclusive": " ?"}.get(worst(row.word for row in rows), " ✗")
            cells[kind] = f"{100 * (largest.difference or 0.0):.2g} ± {100 * (largest.uncertainty or 0.0):.2g}{mark}"
    return cells
