"""Figures and tables of the thesis as Markdown: counts; small pictures, claims and verdicts by chapter; errata."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from gallery_page import pictures_of

from eigencontact.scene.loader import bundled_names
from eigencontact_verification.thesis.entries import Entry
from eigencontact_verification.thesis.judge import VERDICTS
from eigencontact_verification.thesis.pictures import picture_name
from eigencontact_verification.thesis.reading import thesis_index

#: Folder of the small pictures, in that of the site.
PICTURES = Path("pictures") / "thesis"
#: Colour of a verdict on a card.
BADGES = dict(zip(VERDICTS, ("success", "info", "warning", "secondary", "danger", "light"), strict=True))

#: Titles of the chapters, in our words.
CHAPTERS = {
    1: "Contacts in aircraft engines",
    2: "Contact with yield",
    3: "Inclusions",
    4: "Coatings, wear, concrete, bone",
}


def thesis_tables(verdicts: Path) -> str:
    """Markdown of the index and of stored verdicts, for a page that lies beside these.

    Parameters
    ----------
    verdicts : Path
        ``thesis.json`` of ``eigencontact study thesis``, in a folder of the site.
    """
    found = json.loads(verdicts.read_text("utf-8"))["claims"]
    entries = thesis_index().entries()
    parts = [_counts(entries, found)]
    for chapter, title in CHAPTERS.items():
        own = [one for one in entries if one.chapter == chapter]
        parts += [f"## Chapter {chapter}: {title}", *_cards(own, found, verdicts.parents[1]), _chapter(own, found)]
    errata = ["| place | wrong | right |", "|---|---|---|"]
    errata += [f"| {one.place} | {_cell(one.wrong)} | {_cell(one.right)} |" for one in thesis_index().erratum]
    return "\n\n".join([*parts, "## Errata of formulas", "\n".join(errata)]) + "\n"


def _counts(entries: Sequence[Entry], found: Sequence[Mapping[str, Any]]) -> str:
    states, verdicts = Counter(one.state for one in entries), Counter(one["verdict"] for one in found)
    head = ["figures and tables", "computed", "open", "no result", "claims", *VERDICTS]
    row = [len(entries), states["computed"], states["open"], states["no result"], len(found)]
    row += [verdicts[name] for name in VERDICTS]
    table = "\n".join("| " + " | ".join(map(str, line)) + " |" for line in (head, ["--:"] * len(head), row))
    compared = len(found) - verdicts["not comparable"] - verdicts["open"]
    settled = verdicts["agrees"] + verdicts["erratum"]
    share = f"{settled} of the {compared} claims that can be compared ({100 * settled / max(compared, 1):.1f} %)"
    return f"{table}\n\n{share} agree, or an independent computation shows that the text is wrong."


def _cards(entries: Sequence[Entry], found: Sequence[Mapping[str, Any]], docs: Path) -> list[str]:
    """A card of each figure that has a picture; it leads to the row of the table."""
    lines = []
    for entry in entries:
        picture = _picture(entry, docs)
        if picture is None:
            continue
        counts = Counter(one["verdict"] for one in found if one["name"] == entry.name)
        badges = " ".join(f"{{bdg-{BADGES[name]}}}`{counts[name]} {name}`" for name in VERDICTS if counts[name])
        lines.append(
            f":::{{grid-item-card}} {entry.name}\n:img-top: ../{picture.as_posix()}\n:img-alt: figure {entry.name}\n"
            f':link: "#{_anchor(entry)}"\n:link-type: url\n\n{_cell(entry.shows)}\n\n{badges}\n:::'
        )
    return [] if not lines else ["::::{grid} 2 3 4 5\n:gutter: 2\n:class-container: thesis-cards", *lines, "::::"]


def _picture(entry: Entry, docs: Path) -> Path | None:
    """Picture of an entry, or the most telling of its scene, where there is one; relative to the site."""
    drawn = PICTURES / picture_name(entry)
    if entry.study and (docs / drawn).is_file():
        return drawn
    folder = Path("gallery") / "pictures" / entry.scene
    if entry.scene and (docs / folder).is_dir():
        return next((folder / f"small-{name}" for name in pictures_of(docs / folder)), None)
    return None


def _anchor(entry: Entry) -> str:
    return "thesis-" + entry.name.replace(" ", "-").replace(".", "-")


def _chapter(entries: Sequence[Entry], found: Sequence[Mapping[str, Any]]) -> str:
    drawn = [f"{one.name} {one.shows}" for one in entries if one.state == "no result" and not one.claim]
    rows = ["| figure | shows | by | claim | here | text | verdict |", "|---|---|---|---|--:|--:|---|"]
    for entry in entries:
        if entry.state == "no result" and not entry.claim:
            continue
        claims = [one for one in found if one["name"] == entry.name] or [{}]
        for number, one in enumerate(claims):
            first = (
                (f'<a id="{_anchor(entry)}"></a>{entry.name}', _cell(entry.shows), _cell(_source(entry)))
                if number == 0
                else ("", "", "")
            )
            verdict = one.get("verdict", "") + (f": {one['why']}" if one.get("why") else "")
            own = one.get("found", "") + (" (full size)" if one.get("size") else "")
            cells = map(_cell, (one.get("says", ""), own, one.get("text", ""), verdict))
            rows.append("| " + " | ".join((*first, *cells)) + " |")
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
