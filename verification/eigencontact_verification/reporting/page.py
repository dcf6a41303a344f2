"""Tables and pages of reports, in Markdown and HTML; a verdict in a cell has the colour of its word."""

from __future__ import annotations

import base64
import html
from collections.abc import Iterable, Sequence
from datetime import UTC, datetime
from pathlib import Path

from eigencontact_verification.reporting.files import GENERATOR
from eigencontact_verification.reporting.machine import describe, facts

__all__ = ["gigabytes", "html_items", "html_page", "html_picture", "html_table", "markdown_table", "measured"]

_STYLE = """
body { font: 15px/1.5 system-ui, sans-serif; max-width: 74rem; margin: 2rem auto; padding: 0 1rem; color: #1a1a1a; }
table { border-collapse: collapse; margin: 0.6rem 0 1.2rem; font-variant-numeric: tabular-nums; }
th, td { padding: 0.2rem 0.7rem; border-bottom: 1px solid #ddd; text-align: left; vertical-align: top; }
th { border-bottom: 2px solid #888; }
.agrees { color: #005a8c; } .inconclusive, .refused { color: #7a5200; }
.failed, .disagrees, .fails { color: #b33c00; font-weight: 600; }
summary { cursor: pointer; padding: 0.2rem 0; } img { max-width: 100%; }
"""
_CLASSES = ("agrees", "inconclusive", "failed", "disagrees", "refused", "fails")


def markdown_table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Table in Markdown.

    Examples
    --------
    >>> print(markdown_table(["a", "b"], [["1", "2 %"]]))
    | a | b |
    | --- | --- |
    | 1 | 2 % |
    """
    lines = (head, ["---"] * len(head), *rows)
    escaped = ([cell.replace("|", "\\|").replace("\n", " ") for cell in line] for line in lines)
    return "\n".join(f"| {' | '.join(line)} |" for line in escaped)


def html_table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Table in HTML; a cell with a verdict, after its mark and before its reason, has the class of its word."""

    def cell(text: str) -> str:
        word = text.partition(":")[0].rpartition(" ")[2]
        mark = f' class="{word}"' if word in _CLASSES and len(text.partition(":")[0]) <= len(word) + 2 else ""
        return f"<td{mark}>{html.escape(text)}</td>"

    top = "".join(f"<th>{html.escape(text)}</th>" for text in head)
    body = "".join("<tr>" + "".join(map(cell, row)) + "</tr>\n" for row in rows)
    return f"<table><thead><tr>{top}</tr></thead><tbody>\n{body}</tbody></table>\n"


def html_items(lines: Iterable[str]) -> str:
    """List in HTML."""
    return f"<ul>{''.join(f'<li>{html.escape(line)}</li>' for line in lines)}</ul>"


def html_picture(file: Path, caption: str) -> str:
    """Picture as a part of the page, which then needs no other file."""
    data = base64.b64encode(file.read_bytes()).decode("ascii")
    return f'<img loading="lazy" alt="{html.escape(caption)}" src="data:image/png;base64,{data}">'


def html_page(title: str, parts: Iterable[str]) -> str:
    """Page with a title and the HTML of its parts."""
    name = html.escape(title)
    return (
        f'<!doctype html>\n<html lang="en"><head><meta charset="utf-8"><title>{name}</title>'
        f'<meta name="generator" content="{GENERATOR}"><meta name="viewport" content="width=device-width">'
        f"<style>{_STYLE}</style></head><body>\n<h1>{name}</h1>{''.join(parts)}</body></html>\n"
    )


def gigabytes(value: float | None) -> str:
    """Memory in GB; a dash where it is unknown."""
    return "–" if value is None else f"{value / 1e9:.2f} GB"


def measured(verb: str = "Measured") -> str:
    """Sentence with the date and the machine."""
    return f"{verb} {datetime.now(UTC):%Y-%m-%d} on {describe(facts())}."
