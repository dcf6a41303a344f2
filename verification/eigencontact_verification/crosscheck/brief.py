"""The coverage of a cross-check in one compact table, for a README: a row per kernel, a column per component."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from eigencontact.core.units import time_in_words
from eigencontact_verification.crosscheck.judge import Coverage, coverage
from eigencontact_verification.reporting.page import measured
from eigencontact_verification.reporting.verdict import MARKS

if TYPE_CHECKING:
    from eigencontact_verification.crosscheck.case import Gap
    from eigencontact_verification.crosscheck.report import Report

__all__ = ["brief", "totals"]

#: Columns in their usual order; components of other names follow.
_COMPONENTS = ("u_x", "u_y", "u_z", "s_xx", "s_yy", "s_zz", "s_yz", "s_xz", "s_xy")
#: Part of inconclusive verdicts above which the summary says that they are many.
_LARGE_SHARE = 0.15


def totals(report: Report) -> str:
    """Sentences with the number of verdicts, the part that is inconclusive, and what the largest solve took.

    Parameters
    ----------
    report : Report
        What was found.
    """
    total = len(report.rows)
    words = ", ".join(f"{count} {word}" for word, count in report.counts.items() if count or word == "disagrees")
    share = report.inconclusive
    kind = "quick" if report.quick else "full"
    cases = "1 case" if len(report.cases) == 1 else f"{len(report.cases)} cases"
    sentence = f"{cases} ({kind}), {total} verdicts: {words}; {100 * share:.1f} % inconclusive"
    sentence += f"; {time_in_words(report.seconds)}."
    solves = report.solves
    if solves:
        computed = "" if report.computed else " (all from the store)"
        together, longest = (time_in_words(of(seconds for seconds, _ in solves)) for of in (sum, max))
        sentence += f" {len(solves)} finite-element solves, together {together}, the longest {longest}"
        if any(memory for _, memory in solves):
            sentence += f", peak memory of the largest {max(memory or 0 for _, memory in solves) / 1e9:.2f} GB"
        sentence += f"{computed}."
    if share > _LARGE_SHARE:
        sentence += f" More than {100 * _LARGE_SHARE:.0f} % is inconclusive, which is no agreement; read the reasons."
    return sentence


def brief(report: Report) -> str:
    """Markdown that stands between the markers of a README: sentences, the table, what is not covered."""
    from eigencontact_verification.reporting.machine import installed as version

    covered = coverage(report.rows)
    names = {entry.component for entry in covered}
    columns = [name for name in _COMPONENTS if name in names] + sorted(names - set(_COMPONENTS))
    cells = {(entry.subject, entry.component): _cell(entry) for entry in covered}
    rows = [
        (kernel, *(cells.get((kernel, name), "") for name in columns))
        for kernel in dict.fromkeys(entry.subject for entry in covered)
    ]
    legend = (
        "✓ profiles that agree of all profiles · largest u_FE as a part of the field (at most "
        f"{100 * report.limit:g} % where they agree); ? some are inconclusive; ✗ some disagree; ! some could not be "
        "solved; empty: zero by symmetry, or no case."
    )
    libraries = ", ".join(f"{name} {version(name)}" for name in ("scikit-fem", "pyamg") if version(name))
    return "\n\n".join(
        [
            totals(report),
            _table(("kernel", *columns), rows),
            legend,
            "Not covered:" if report.gaps else "Nothing is listed as not covered.",
            *(["\n".join(_gaps(report.gaps))] if report.gaps else []),
            f"{measured()[:-1]}; {libraries}.",
        ]
    )


def _cell(entry: Coverage) -> str:
    band = "" if entry.uncertainty is None else f" · {100 * entry.uncertainty:.2g} %"
    return f"{MARKS[entry.word]} {entry.counts['agrees']}/{sum(entry.counts.values())}{band}"


def _gaps(gaps: Iterable[Gap]) -> list[str]:
    """One line for each thing that is not covered, with the kernels that share it."""
    shared: dict[tuple[str, str], list[str]] = {}
    for gap in gaps:
        shared.setdefault((gap.what, gap.reason), []).append(gap.subject)
    return [f"- {', '.join(kernels)}: {quantity} ({reason})" for (quantity, reason), kernels in shared.items()]


def _table(head: tuple[str, ...], rows: list[tuple[str, ...]]) -> str:
    widths = [max(3, *(len(line[k]) for line in (head, *rows))) for k in range(len(head))]
    lines = [head, tuple("-" * width for width in widths), *rows]
    padded = (" | ".join(cell.ljust(width) for cell, width in zip(line, widths, strict=True)) for line in lines)
    return "\n".join(f"| {line} |" for line in padded)
