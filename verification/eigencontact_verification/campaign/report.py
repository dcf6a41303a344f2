"""Report of a campaign: the map, every verdict, and the costs of both sides; JSON, Markdown and one HTML page."""

from __future__ import annotations

import html
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from eigencontact.core.units import time_in_words
from eigencontact_verification.campaign.answer import answers, totals
from eigencontact_verification.campaign.figure import axes_of_map, draw_map, label_in, levels_in, quantities_of
from eigencontact_verification.campaign.tables import csv_table, latex_table
from eigencontact_verification.reporting.files import report_names, write_report_files, write_text
from eigencontact_verification.reporting.page import (
    gigabytes,
    html_items,
    html_page,
    html_picture,
    html_table,
    markdown_table,
    measured,
)
from eigencontact_verification.reporting.verdict import MARKS, percent
from eigencontact_verification.studies.run import source_in_words
from eigencontact_verification.studies.study import plain

if TYPE_CHECKING:
    from eigencontact_verification.campaign.campaign import Campaign
    from eigencontact_verification.campaign.finding import JudgedPoint

__all__ = ["FILES", "MapReport", "as_section", "write_map"]

_METHOD = (
    "Errors are largest differences on what is compared, as parts of the scale of the quantity; after ± stands the "
    "reference's own uncertainty, from three refinements. A point agrees where error and uncertainty together are "
    "within the tolerance, disagrees where the error is beyond it even less the uncertainty, and is inconclusive "
    "between, which is no agreement. A quantity with an error bar, u_SA, has the "
    "verdict of ASME V&V 20 instead. Disagreement outside of what is claimed is a finding; inside it is a fault."
)
_TRADE_METHOD = (
    "Times are wall times when each was computed, those of the reference of its finest solution and of all solutions "
    "that its own error needs; memory is the peak of the process, which of several runs in one is that of the largest."
)


@dataclass(frozen=True, kw_only=True, eq=False)
class MapReport:
    """Points and verdicts of a campaign."""

    campaign: Campaign
    points: tuple[JudgedPoint, ...]
    coarse: bool = False  #: whether it was a first look
    seconds: float = 0.0  #: wall time [s]

    @property
    def exit_code(self) -> int:
        """0 unless something disagrees, or has no numbers, where agreement is claimed; or has none anywhere."""
        broken = any(point.breaks_claim for point in self.points)
        return 1 if broken or all(point.word == "failed" for point in self.points) else 0

    def to_dict(self) -> dict[str, Any]:
        """Everything, for JSON."""
        from eigencontact_verification.reporting.machine import time_and_machine

        return {
            "campaign": self.campaign.name, "title": self.campaign.title, "judge": self.campaign.judge,
            **time_and_machine(), "coarse": self.coarse,
            "seconds": self.seconds, "tolerance": self.campaign.tolerance, "expect": self.campaign.expect,
            "summary": totals(self.campaign, self.points), "answers": answers(self.campaign, self.points),
            "exit_code": self.exit_code,
            "points": [
                {
                    "label": point.point.label, "values": dict(point.point.values),
                    "verdict": point.word, "findings": [finding.to_dict() for finding in point.findings],
                    "model_seconds": point.point.model.seconds, "model_memory_bytes": point.point.model.memory,
                    "reference_seconds": point.reference_seconds, "reference_seconds_all": point.all_seconds,
                    "reference_memory_bytes": point.reference_memory,
                    "not_judged": list(point.gaps),
                    "warnings": [warning["code"] for warning in (point.point.model.summary or {}).get("warnings", ())],
                }
                for point in self.points
            ],
        }  # fmt: skip


# --- tables -----------------------------------------------------------------------------------------------------------

_HEAD = ("point", "claimed", "quantity", "verdict", "error", "u_ref", "u_SA", "tolerance", "why")
_TRADE = ("point", "largest error", "model", "reference", "with its own error", "memory: model", "reference")


def _rows(points: Sequence[JudgedPoint]) -> list[tuple[str, ...]]:
    """Head and rows of the verdicts; u_SA has a column where any model has error bars."""
    rows = [
        (
            point.point.label, "yes" if finding.claimed else "no", finding.quantity,
            f"{MARKS[finding.word]} {finding.word}", percent(finding.error), percent(finding.uncertainty),
            percent(finding.run_error), percent(finding.tolerance), finding.reason,
        )
        for point in points
        for finding in point.findings
    ]  # fmt: skip
    barred = any(finding.run_error is not None for point in points for finding in point.findings)
    return [row if barred else (*row[:6], *row[7:]) for row in (_HEAD, *rows)]


def _trade_rows(points: Sequence[JudgedPoint]) -> Iterable[tuple[str, ...]]:
    for point in points:
        model = point.point.model
        yield (
            point.point.label, percent(point.error), _time(model.seconds), _time(point.reference_seconds),
            _time(point.all_seconds), gigabytes(model.memory), gigabytes(point.reference_memory),
        )  # fmt: skip


def _time(value: float | None) -> str:
    return "–" if value is None else time_in_words(value)


def _maps(report: MapReport) -> list[str]:
    """Map of each quantity as a table; none where there are not two parameters."""
    x, y, panel_axes = axes_of_map(report.campaign, report.points)
    if y is None or panel_axes:
        return []
    across, up = levels_in(report.points, x), levels_in(report.points, y)
    rows_and_columns = f"Rows are {label_in(report.campaign, y)}, columns {label_in(report.campaign, x)}"
    tables = [f"{rows_and_columns}; what stands in parentheses is not claimed."]
    for name in quantities_of(report.campaign, report.points):
        cells = {}
        for point in report.points:
            for finding in point.findings:
                if finding.quantity == name:
                    words = f"{MARKS[finding.word]} {finding.numbers}"
                    key = point.point.values[y], point.point.values[x]
                    cells[key] = words if finding.claimed else f"({words})"
        rows = [[plain(row), *(cells.get((row, column), "–") for column in across)] for row in reversed(up)]
        tables.append(markdown_table([name, *map(plain, across)], rows))
    return tables


def _gaps(report: MapReport) -> list[str]:
    """Fields that cannot be judged, each reason once, with the number of points that have it."""
    gaps = [gap for point in report.points for gap in dict.fromkeys(point.gaps)]
    return [f"{gap} ({gaps.count(gap)} of {len(report.points)} points)" for gap in dict.fromkeys(gaps)]


def _sentences(report: MapReport) -> list[str]:
    campaign = report.campaign
    words = [totals(campaign, report.points)]
    if campaign.trend:
        words.append(campaign.trend)
    words += [f"After {source_in_words(source)}." for source in campaign.sources]
    return words


def as_section(report: MapReport, *, trade: bool = False) -> str:
    """Markdown between the markers of a page: sentences, ranges of agreement, one table; not the whole report."""
    campaign = report.campaign
    blocks = [f"**{campaign.title}** {campaign.words[:1].upper()}{campaign.words[1:]}, judged by {campaign.reference}."]
    blocks += _sentences(report)
    ranges = answers(campaign, report.points)
    if ranges:
        blocks.append("\n".join([ranges[0], "", *(f"- {line}" for line in ranges[1:])]))
    if trade:
        blocks += [markdown_table(_TRADE, _trade_rows(report.points)), _TRADE_METHOD]
    else:
        blocks += _maps(report) or [_verdicts(report, words=False)]
    return "\n\n".join([*blocks, measured("Computed")]) + "\n"


def _markdown(report: MapReport) -> str:
    blocks = [f"# {report.campaign.title}", *_sentences(report), _METHOD, "![map](map.png)"]
    ranges = answers(report.campaign, report.points)
    if ranges:
        blocks.append("\n".join([ranges[0], "", *(f"- {line}" for line in ranges[1:])]))
    blocks += ["## Verdicts", _verdicts(report)]
    if gaps := _gaps(report):
        blocks += ["## Not judged", "\n".join(f"- {gap}" for gap in gaps)]
    blocks += ["## What both cost", markdown_table(_TRADE, _trade_rows(report.points)), _TRADE_METHOD]
    blocks.append(measured("Computed"))
    return "\n\n".join(blocks) + "\n"


def _verdicts(report: MapReport, *, words: bool = True) -> str:
    head, *rows = (row if words else row[:-1] for row in _rows(report.points))
    return markdown_table(head, rows)


def _html(report: MapReport, picture: Path) -> str:
    head, *rows = _rows(report.points)
    blocks = [f"<p>{html.escape(words)}</p>" for words in (*_sentences(report), _METHOD)]
    blocks.append(html_picture(picture, f"map of {report.campaign.title}"))
    ranges = answers(report.campaign, report.points)
    if ranges:
        blocks.append(f"<p>{html.escape(ranges[0])}</p>{html_items(ranges[1:])}")
    blocks.append(f"<h2>Verdicts</h2>{html_table(head, rows)}")
    if gaps := _gaps(report):
        blocks.append(f"<h2>Not judged</h2>{html_items(gaps)}")
    blocks.append(f"<h2>What both cost</h2>{html_table(_TRADE, _trade_rows(report.points))}")
    blocks.append(f"<p>{html.escape(_TRADE_METHOD)}</p><p>{html.escape(measured('Computed'))}</p>")
    return html_page(report.campaign.title, blocks)


#: Names of the files of a campaign by format.
FILES = {"map": "map.png", **report_names(), "csv": "table.csv", "latex": "table.tex"}


def write_map(report: MapReport, folder: Path) -> dict[str, Path]:
    """Write map.png, the report (JSON, Markdown, HTML) and the table (CSV, LaTeX); earlier files are replaced."""
    from eigencontact.viz.style import paper_style, save

    folder.mkdir(parents=True, exist_ok=True)
    files = {form: folder / name for form, name in FILES.items()}
    with paper_style():
        save(draw_map(report.campaign, report.points), files["map"])
    page = _html(report, files["map"])
    write_report_files(folder, report.to_dict(), markdown=_markdown(report), html=page, default=plain)
    write_text(files["csv"], csv_table(report.points))
    write_text(files["latex"], latex_table(report.campaign, report.points))
    return files
