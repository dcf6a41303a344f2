"""Report of the extremes: a table for the terminal, report.json with everything, Markdown and HTML to read."""

from __future__ import annotations

import html
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from eigencontact_verification.extremes.judge import CornerVerdict, FeatureVerdict
from eigencontact_verification.reporting.files import write_report_files
from eigencontact_verification.reporting.page import html_page, html_table, markdown_table, measured

if TYPE_CHECKING:
    from rich.table import Table

__all__ = ["Report", "as_html", "as_markdown", "table", "write_report"]

METHOD = (
    "Each corner of the parameter space is computed and compared with a closed form, another method that shares no "
    "code with it, or an invariant. Its bound follows from the discretisation, the tolerance or round-off, and stands "
    "with its reason beside it. Where there is no answer, one clear message must say so: an answer where a refusal is "
    "due, a refusal that nobody declared, any other exception, and a number that is not finite are faults."
)
_HEAD = ("feature", "corners", "largest error", "its bound", "where", "refused", "verdict")
_CORNER_HEAD = ("corner", "error", "bound", "why this bound", "verdict")


@dataclass(frozen=True, kw_only=True)
class Report:
    """Verdicts on all features."""

    features: tuple[FeatureVerdict, ...]
    quick: bool = False  #: whether only quick corners were computed

    @property
    def faults(self) -> tuple[tuple[str, CornerVerdict], ...]:
        """Corners that fail, with the key of their feature."""
        return tuple((one.feature.key, c) for one in self.features for c in one.corners if c.word == "fails")

    @property
    def exit_code(self) -> int:
        """0 unless a corner fails."""
        return 1 if self.faults else 0

    @property
    def summary(self) -> str:
        """The numbers of corners in a sentence."""
        corners = [corner for feature in self.features for corner in feature.corners]
        counts = {word: sum(corner.word == word for corner in corners) for word in ("holds", "refused", "fails")}
        kind = "quick" if self.quick else "full"
        return (
            f"{len(self.features)} features, {len(corners)} corners ({kind}): {counts['holds']} within their bounds, "
            f"{counts['refused']} refused as they must be, {counts['fails']} at fault."
        )

    def to_dict(self) -> dict[str, Any]:
        """Everything, for JSON."""
        from eigencontact_verification.reporting.machine import time_and_machine

        return {
            **time_and_machine(),
            "quick": self.quick,
            "summary": self.summary,
            "exit_code": self.exit_code,
            "features": [
                {
                    "key": one.feature.key,
                    "title": one.feature.title,
                    "reference": one.feature.reference,
                    "verdict": one.word,
                    "seconds": one.seconds,
                    "corners": [_corner_data(found) for found in one.corners],
                }
                for one in self.features
            ],
        }


def _corner_data(found: CornerVerdict) -> dict[str, Any]:
    corner = found.corner
    return {
        "corner": corner.name,
        "error": found.error,
        "bound": None if corner.refused else corner.bound,
        "reason": corner.reason,
        "must_refuse_with": corner.refused or None,
        "verdict": found.word,
        "message": found.message,
        "seconds": found.seconds,
    }


def _rows(report: Report) -> Iterator[tuple[str, ...]]:
    """One row a feature."""
    for one in report.features:
        worst = one.worst
        told = ("–", "–", "–")
        if worst is not None and worst.error is not None:
            told = (f"{worst.error:.1e}", f"{worst.corner.bound:.1e}", worst.corner.name)
        refused = sum(found.word == "refused" for found in one.corners)
        yield one.feature.key, str(len(one.corners)), *told, str(refused), one.word


def _corner_rows(one: FeatureVerdict) -> Iterator[tuple[str, ...]]:
    for found in one.corners:
        error = "–" if found.error is None or found.corner.refused else f"{found.error:.1e}"
        bound = "–" if found.corner.refused else f"{found.corner.bound:.1e}"
        why = found.message if found.word == "refused" else found.corner.reason
        yield found.corner.name, error, bound, why, f"fails: {found.message}" if found.word == "fails" else found.word


def table(report: Report) -> Table:
    """One row a feature, for a terminal."""
    from rich.table import Table

    rows = Table(*_HEAD, box=None, pad_edge=False)
    for row in _rows(report):
        rows.add_row(*row, style="bold red" if row[-1] == "fails" else None)
    return rows


def as_markdown(report: Report) -> str:
    """The whole report as one page."""
    parts = ["# Extremes", report.summary, METHOD]
    parts.append("Written by `eigencontact extremes --markdown FILE`; errors are parts of the largest value.")
    parts.append(markdown_table(_HEAD, _rows(report)))
    for one in report.features:
        parts += [
            f"## {one.feature.key}",
            f"{one.feature.title}. Compared with: {one.feature.reference}.",
            markdown_table(_CORNER_HEAD, _corner_rows(one)),
        ]
    parts.append(measured())
    return "\n\n".join(parts) + "\n"


def as_html(report: Report) -> str:
    """The whole report as one page that needs no other file; features at fault are open."""
    parts = [
        f"<p>{html.escape(report.summary)}</p><p>{html.escape(METHOD)}</p>",
        html_table(_HEAD, _rows(report)),
    ]
    for one in report.features:
        opened = " open" if one.word == "fails" else ""
        parts.append(f"<details{opened}><summary>{html.escape(f'{one.feature.key}: {one.feature.title}')}</summary>")
        parts.append(f"<p>Compared with: {html.escape(one.feature.reference)}.</p>")
        parts.append(html_table(_CORNER_HEAD, _corner_rows(one)) + "</details>\n")
    return html_page("Extremes", parts)


def write_report(report: Report, folder: Path) -> dict[str, Path]:
    """Write report.json, report.md and report.html; files of an earlier report are replaced."""
    return write_report_files(folder, report.to_dict(), markdown=as_markdown(report), html=as_html(report))
