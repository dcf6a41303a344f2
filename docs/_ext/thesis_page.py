"""Figures and tables of the thesis as Markdown: counts, a table for each chapter, verdicts on claims, errata."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from eigencontact.scene.loader import bundled_names
from eigencontact_verification.thesis.entries import Entry
from eigencontact_verification.thesis.judge import VERDICTS
from eigencontact_verification.thesis.reading import thesis_index

#: Titles of the chapters, in our words.
CHAPTERS = {
    1: "Contacts in aircraft engines",
    2: "Contact with yield",
    3: "Inclusions",
    4: "Coatings, wear, concrete, bone",
}


def thesis_tables(verdicts: Path) -> str:
    """Markdown of the index and of stored verdicts.

    Parameters
    ----------
    verdicts : Path
        ``thesis.json`` of ``eigencontact study thesis``.
    """
    found = json.loads(verdicts.read_text("utf-8"))["claims"]
    entries = thesis_index().entries()
    parts = [_counts(entries, found)]
    for chapter, title in CHAPTERS.items():
        parts += [f"## Chapter {chapter}: {title}", _chapter([one for one in entries if one.chapter == chapter], found)]
    errata = ["| place | wrong | right |", "|---|---|---|"]
    errata += [f"| {one.place} | {_cell(one.wrong)} | {_cell(one.right)} |" for one in thesis_index().erratum]
    return "\n\n".join([*parts, "## Errata of formulas", "\n".join(errata)]) + "\n"


def _counts(entries: Sequence[Entry], found: Sequence[Mapping[str, Any]]) -> str:
    states, verdicts = Counter(one.state for one in entries), Counter(one["verdict"] for one in found)
    head = ["figures and tables", "computed", "open", "no result", "claims", *VERDICTS]
    row = [len(entries), states["computed"], states["open"], states["no result"], len(found)]
    row += [verdicts[name] for name in VERDICTS]
    return "\n".join("| " + " | ".join(map(str, line)) + " |" for line in (head, ["--:"] * len(head), row))


def _chapter(entries: Sequence[Entry], found: Sequence[Mapping[str, Any]]) -> str:
    drawn = [f"{one.name} {one.shows}" for one in entries if one.state == "no result" and not one.claim]
    rows = ["| figure | shows | by | claim | here | text | verdict |", "|---|---|---|---|--:|--:|---|"]
    for entry in entries:
        if entry.state == "no result" and not entry.claim:
            continue
        claims = [one for one in found if one["name"] == entry.name] or [{}]
        for number, one in enumerate(claims):
            first = (entry.name, _cell(entry.shows), _source(entry)) if number == 0 else ("", "", "")
            verdict = one.get("verdict", "") + (f": {one['why']}" if one.get("why") else "")
            cells = (*first, one.get("says", ""), one.get("found", ""), one.get("text", ""), verdict)
            rows.append("| " + " | ".join(map(_cell, cells)) + " |")
    parts = ["\n".join(rows)] if len(rows) > 2 else []
    if drawn:
        parts.append("Sketches, photographs and lists, which show no result: " + _cell("; ".join(drawn)) + ".")
    return "\n\n".join(parts)


def _source(entry: Entry) -> str:
    if entry.scene in bundled_names():
        return f"scene [{entry.scene}](../gallery/{entry.scene}.md)"
    if entry.study:
        return f"study `{entry.study}`"
    if entry.state == "no result":
        return "arithmetic"
    return "a test" if entry.test else f"not computed; lacks {entry.lacks}"


def _cell(text: str) -> str:
    return text.replace("|", "\\|").replace("<", "\\<").replace("*", "\\*").replace("_", "\\_")
