"""Report of a cross-check: report.json with everything, report.md and report.html to read."""

from __future__ import annotations

import html
from collections.abc import Iterable
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from eigencontact_verification.crosscheck import comparison
from eigencontact_verification.crosscheck.brief import totals
from eigencontact_verification.crosscheck.case import Gap
from eigencontact_verification.crosscheck.comparison import Comparison
from eigencontact_verification.crosscheck.figures import draw
from eigencontact_verification.crosscheck.judge import Coverage, JudgedCase, Row, coverage
from eigencontact_verification.reporting.files import report_names, write_json, write_report_files
from eigencontact_verification.reporting.page import (
    gigabytes,
    html_items,
    html_page,
    html_picture,
    html_table,
    markdown_table,
)
from eigencontact_verification.reporting.verdict import MARKS, WORDS, percent

__all__ = ["Report", "names_of", "write_report"]

_METHOD = (
    "Each kernel is compared with a finite-element model that shares no code with it. The model's own uncertainty, "
    "u_FE, is the sum of a grid convergence index (three meshes) and half the distance of fixed and free outer faces. "
    "A component agrees if |SA − FE| ≤ u_FE at every point of a profile and u_FE is at most {limit} of the field's "
    "largest value there; it disagrees if the difference exceeds u_FE anywhere; otherwise it is inconclusive, which is "
    "no agreement. Differences and uncertainties below are parts of the field's largest value. For wear, rings of "
    "uniform pressure stand for the finite elements, in three divisions of space and time."
)


@dataclass(frozen=True, kw_only=True)
class Report:
    """Result of a cross-check.

    Attributes
    ----------
    cases : tuple of JudgedCase
    gaps : tuple of Gap
        What no case covers.
    limit : float
        Largest u_FE that allows agreement, as a part of the field.
    quick : bool
        Whether only the quick cases were run.
    seconds : float
        Wall time of the cross-check.
    notes : tuple of str
        Anything else that a reader has to know: pictures that could not be made.
    pictures : dict of str to tuple of Path
        Mesh and field of some cases, by key; in the folder of the report.
    method : str
        How verdicts are found, with ``{limit}`` in place of the limit.
    """

    cases: tuple[JudgedCase, ...]
    gaps: tuple[Gap, ...] = ()
    limit: float = 0.02
    quick: bool = False
    seconds: float = 0.0
    notes: tuple[str, ...] = ()
    pictures: dict[str, tuple[Path, ...]] = field(default_factory=dict)
    method: str = _METHOD

    @property
    def rows(self) -> tuple[Row, ...]:
        """Verdicts of all cases."""
        return tuple(row for case in self.cases for row in case.rows)

    @property
    def counts(self) -> dict[str, int]:
        """Number of verdicts by word."""
        return {word: sum(row.word == word for row in self.rows) for word in WORDS}

    @property
    def inconclusive(self) -> float:
        """Part of the verdicts that is inconclusive, 0 to 1."""
        return self.counts["inconclusive"] / max(1, len(self.rows))

    @property
    def solves(self) -> tuple[tuple[float, int | None], ...]:
        """Wall time [s] and peak memory [byte] of each finite-element solution that was tried."""
        return tuple(
            (outcome.seconds, outcome.memory)
            for case in self.cases
            for task, outcome in case.outcomes
            if task.level is not None and outcome.seconds is not None
        )

    @property
    def computed(self) -> bool:
        """Whether any of them was computed by this cross-check: the others were found in the store."""
        outcomes = (outcome for case in self.cases for task, outcome in case.outcomes if task.level is not None)
        return any(not outcome.cached for outcome in outcomes)

    @property
    def exit_code(self) -> int:
        """0 unless something disagrees or could not be solved."""
        return 1 if self.counts["disagrees"] or self.counts["failed"] else 0

    def to_dict(self) -> dict[str, Any]:
        """Everything but the curves, for JSON."""
        from eigencontact_verification.reporting.machine import time_and_machine

        return {
            **time_and_machine(),
            "quick": self.quick,
            "limit": self.limit,
            "seconds": self.seconds,
            "counts": self.counts,
            "inconclusive": self.inconclusive,
            "longest_solve_seconds": max((seconds for seconds, _ in self.solves), default=None),
            "largest_solve_bytes": max((memory for _, memory in self.solves if memory is not None), default=None),
            "exit_code": self.exit_code,
            "coverage": [asdict(entry) for entry in coverage(self.rows)],
            "not_covered": [asdict(gap) for gap in self.gaps],
            "notes": list(self.notes),
            "cases": [_case_data(case) for case in self.cases],
        }


def _case_data(judged: JudgedCase) -> dict[str, Any]:
    case = judged.case
    return {
        "subject": case.subject,
        "name": case.name,
        "quick": case.quick,
        "parameters": case.parameters,
        "verdict": judged.word,
        "tasks": [
            {
                "task": task.label,
                "status": outcome.status,
                "reason": outcome.reason,
                "seconds": outcome.seconds,
                "peak_memory_bytes": outcome.memory,
                "cached": outcome.cached,
            }
            for task, outcome in judged.outcomes
        ],
        "rows": [asdict(row) for row in judged.rows],
    }


def _curves(judged: JudgedCase) -> dict[str, Any]:
    """Numbers behind the figure of a case; what is not finite becomes null."""

    def numbers(values: Any) -> Any:
        if values is None:
            return None
        shown = np.asarray(values).astype(object)
        shown[~np.isfinite(values)] = None
        return shown.tolist()

    curves = {}
    for profile in judged.case.profiles:
        reference = judged.estimates.get(profile.name)
        curves[profile.name] = {
            "quantity": profile.quantity,
            "unit": profile.unit,
            "components": list(profile.components),
            "label": profile.label,
            "along": profile.along.tolist(),
            "points": profile.points.tolist(),
            "semi_analytical": numbers(judged.judged.get(profile.name)),
            "finite_elements": numbers(reference.value) if reference else None,
            "uncertainty": numbers(reference.uncertainty) if reference else None,
        }
    return curves


# --- tables -----------------------------------------------------------------------------------------------------------


_COVERAGE_HEAD = (
    "subject",
    "quantity",
    "component",
    "verdict",
    "profiles that agree",
    "largest u_FE",
    "largest |SA−FE|",
)


def _coverage_cells(entry: Coverage) -> tuple[str, ...]:
    agreed = f"{entry.counts['agrees']} of {sum(entry.counts.values())}"
    return (
        entry.subject, entry.quantity, entry.component, f"{MARKS[entry.word]} {entry.word}", agreed,
        percent(entry.uncertainty), percent(entry.difference),
    )  # fmt: skip


_ROW_HEAD = ("profile", "component", "verdict", "u_FE", "mesh", "truncation", "|SA−FE|", "order", "why")


def _row_cells(row: Row) -> tuple[str, ...]:
    order = "–" if row.order is None else f"{row.order:.2f}" + ("" if row.credible else " (not credible)")
    return (
        row.profile, row.component, f"{MARKS[row.word]} {row.word}", percent(row.uncertainty),
        percent(row.discretisation), percent(row.truncation), percent(row.difference), order, row.reason,
    )  # fmt: skip


def _table_of_rows(judged: JudgedCase) -> tuple[tuple[str, ...], list[tuple[str, ...]]]:
    """Head and cells of the verdicts of a case."""
    numbers = [row for row in judged.rows if isinstance(row, Comparison)]
    if numbers:
        return comparison.HEAD, list(map(comparison.cells, numbers))
    return _ROW_HEAD, list(map(_row_cells, judged.rows))


_TASK_HEAD = ("solution", "status", "time", "peak memory")


def _task_cells(judged: JudgedCase) -> list[tuple[str, ...]]:
    rows: list[tuple[str, ...]] = []
    for task, outcome in judged.outcomes:
        status = f"{outcome.status} (from the store)" if outcome.cached else outcome.status
        text = f"{status}: {outcome.reason}" if outcome.reason else status
        seconds = "–" if outcome.seconds is None else f"{outcome.seconds:.2f} s"
        rows.append((task.label, text, seconds, gigabytes(outcome.memory)))
    return rows


def _markdown(report: Report, folder: Path, pictures: dict[str, str]) -> str:
    gaps = [(gap.subject, gap.what, gap.reason) for gap in report.gaps]
    lines = [
        "# Finite-element cross-check",
        "",
        totals(report),
        "",
        report.method.format(limit=percent(report.limit)),
        "",
    ]
    lines += ["## Coverage", "", markdown_table(_COVERAGE_HEAD, map(_coverage_cells, coverage(report.rows))), ""]
    lines += ["## Not covered", ""]
    lines += [markdown_table(("subject", "what", "why"), gaps) if gaps else "Nothing is listed.", ""]
    if report.notes:
        lines += ["## Notes", "", *(f"- {note}" for note in report.notes), ""]
    lines += ["## Cases", ""]
    for judged in report.cases:
        lines += [f"### {judged.case.key}: {judged.word}", ""]
        if judged.case.key in pictures:
            lines += [f"![{judged.case.key}]({pictures[judged.case.key]})", ""]
        for file in report.pictures.get(judged.case.key, ()):
            lines += [f"![{judged.case.key}, {file.stem}]({file.relative_to(folder).as_posix()})", ""]
        lines += [markdown_table(*_table_of_rows(judged)), ""]
        if judged.outcomes:
            lines += [markdown_table(_TASK_HEAD, _task_cells(judged)), ""]
    return "\n".join(lines)


def _html(report: Report, folder: Path, pictures: dict[str, str]) -> str:
    gaps = [(gap.subject, gap.what, gap.reason) for gap in report.gaps]
    blocks = [
        f"<p>{html.escape(totals(report))}</p>",
        f"<p>{html.escape(report.method.format(limit=percent(report.limit)))}</p><h2>Coverage</h2>",
        html_table(_COVERAGE_HEAD, map(_coverage_cells, coverage(report.rows))),
        "<h2>Not covered</h2>",
        html_table(("subject", "what", "why"), gaps) if gaps else "<p>Nothing is listed.</p>",
    ]
    if report.notes:
        blocks.append(f"<h2>Notes</h2>{html_items(report.notes)}")
    blocks.append("<h2>Cases</h2>\n")
    for judged in report.cases:
        opened = "" if judged.word == "agrees" else " open"
        title = f"{html.escape(judged.case.key)}: <span class='{judged.word}'>{MARKS[judged.word]} {judged.word}</span>"
        blocks.append(f"<details{opened}><summary>{title}</summary>")
        if judged.case.key in pictures:
            blocks.append(html_picture(folder / pictures[judged.case.key], f"profiles of {judged.case.key}"))
        drawn = report.pictures.get(judged.case.key, ())
        blocks += [html_picture(file, f"{file.stem} of {judged.case.key}") for file in drawn]
        blocks.append(html_table(*_table_of_rows(judged)))
        if judged.outcomes:
            blocks.append(html_table(_TASK_HEAD, _task_cells(judged)))
        blocks.append("</details>\n")
    return html_page("Finite-element cross-check", blocks)


def _stem(key: str) -> str:
    return key.replace("/", "-")


def names_of(keys: Iterable[str]) -> list[str]:
    """Names of the files that a report on these cases may have in its folder."""
    return [*report_names().values(), *(f"figures/{_stem(key)}.{ending}" for key in keys for ending in ("png", "json"))]


def write_report(report: Report, folder: Path) -> dict[str, Path]:
    """Write report.json, report.md, report.html, one figure a case and the numbers behind it.

    Parameters
    ----------
    report : Report
        What was found.
    folder : Path
        Made if it is not there; files of an earlier report are replaced.

    Returns
    -------
    dict of str to Path
        ``"json"``, ``"markdown"``, ``"html"``, ``"figures"`` (folder).
    """
    figures = folder / "figures"
    figures.mkdir(parents=True, exist_ok=True)
    pictures = {}
    for judged in report.cases:
        name = _stem(judged.case.key)
        if not judged.case.profiles:
            continue
        write_json(figures / f"{name}.json", _curves(judged))
        if judged.judged or judged.estimates:
            pictures[judged.case.key] = draw(judged, figures / f"{name}.png").relative_to(folder).as_posix()
    files = write_report_files(
        folder, report.to_dict(), markdown=_markdown(report, folder, pictures), html=_html(report, folder, pictures)
    )
    return {**files, "figures": figures}
