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
        return tuple(
            (feature.feature.key, c) for feature in self.features for c in feature.corners if c.word == "fails"
        )

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
                    "key": feature.feature.key,
                    "title": feature.feature.title,
                    "reference": feature.feature.reference,
                    "verdict": feature.word,
                    "seconds": feature.seconds,
                    "corners": [_corner_data(corner) for corner in feature.corners],
                }
                for feature in self.features
            ],
        }


def _corner_data(verdict: CornerVerdict) -> dict[str, Any]:
    corner = verdict.corner
    return {
        "corner": corner.name,
        "error": verdict.error,
        "bound": None if corner.refused else corner.bound,
        "reason": corner.reason,
        "must_refuse_with": corner.refused or None,
        "verdict": verdict.word,
        "message": verdict.message,
        "seconds": verdict.seconds,
    }


def _rows(report: Report) -> Iterator[tuple[str, ...]]:
    """One row a feature."""
    for feature in report.features:
        worst = feature.worst
        worst_cells = ("–", "–", "–")
        if worst is not None and worst.error is not None:
            worst_cells = (f"{worst.error:.1e}", f"{worst.corner.bound:.1e}", worst.corner.name)
        refused = sum(corner.word == "refused" for corner in feature.corners)
        yield feature.feature.key, str(len(feature.corners)), *worst_cells, str(refused), feature.word


def _corner_rows(feature: FeatureVerdict) -> Iterator[tuple[str, ...]]:
    for corner in feature.corners:
        error = "–" if corner.error is None or corner.corner.refused else f"{corner.error:.1e}"
        bound = "–" if corner.corner.refused else f"{corner.corner.bound:.1e}"
        why = corner.message if corner.word == "refused" else corner.corner.reason
        yield (
            corner.corner.name,
            error,
            bound,
            why,
            f"fails: {corner.message}" if corner.word == "fails" else corner.word,
        )


def table(report: Report) -> Table:
    """One row a feature, for a terminal."""
    from rich.table import Table

    rows = Table(*_HEAD, box=None, pad_edge=False)
    for row in _rows(report):
        rows.add_row(*row, style="bold red" if row[-1] == "fails" else None)
    return rows


def as_markdown(report: Report) -> str:
    """The whole report as one page."""
    blocks = ["# Extremes", report.summary, METHOD]
    blocks.append("Written by `eigencontact extremes --markdown FILE`; errors are parts of the largest value.")
    blocks.append(markdown_table(_HEAD, _rows(report)))
    for feature in report.features:
        blocks += [
            f"## {feature.feature.key}",
            f"{feature.feature.title}. Compared with: {feature.feature.reference}.",
            markdown_table(_CORNER_HEAD, _corner_rows(feature)),
        ]
    blocks.append(measured())
    return "\n\n".join(blocks) + "\n"


def as_html(report: Report) -> str:
    """The whole report as one page that needs no other file; features at fault are open."""
    blocks = [
        f"<p>{html.escape(report.summary)}</p><p>{html.escape(METHOD)}</p>",
        html_table(_HEAD, _rows(report)),
    ]
    for feature in report.features:
        opened = " open" if feature.word == "fails" else ""
        blocks.append(
            f"<details{opened}><summary>{html.escape(f'{feature.feature.key}: {feature.feature.title}')}</summary>"
        )
        blocks.append(f"<p>Compared with: {html.escape(feature.feature.reference)}.</p>")
        blocks.append(html_table(_CORNER_HEAD, _corner_rows(feature)) + "</details>\n")
    return html_page("Extremes", blocks)


def write_report(report: Report, folder: Path) -> dict[str, Path]:
    """Write report.json, report.md and report.html; files of an earlier report are replaced."""
    return write_report_files(folder, report.to_dict(), markdown=as_markdown(report), html=as_html(report))
