"""Progress and result of a cross-check in a terminal."""

from __future__ import annotations

from contextlib import ExitStack
from typing import TYPE_CHECKING, Self

import typer

from eigencontact_verification.reporting.progress import counted

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from eigencontact_verification.crosscheck.report import Report
    from eigencontact_verification.crosscheck.worker import Outcome, Task

__all__ = ["Bar", "print_report"]

#: Least time between two lines on solutions [s].
_LINES = 10.0


class Bar:
    """Progress of solutions by the share of their work; a failed solution has a line of its own."""

    def __init__(self, *, show: bool) -> None:
        self._show, self._open = show, ExitStack()
        self._tell = self._open.enter_context(counted("solutions", "solution ", show=show, interval=_LINES))
        self._done, self._total, self._work, self._all_work = 0, 0, 0.0, 0.0

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._open.close()

    def started(self, tasks: Sequence[Task]) -> None:
        """Show the work that is due."""
        self._total, self._all_work = len(tasks), sum(task.weight for task in tasks)
        if self._show and tasks:
            typer.echo(f"{self._total} solutions to compute", err=True)

    def finished(self, task: Task, outcome: Outcome) -> None:
        """Count a solution; say what failed."""
        self._done, self._work = self._done + 1, self._work + task.weight
        label = f"{task.case.key}, {task.label}"
        if self._show and outcome.status != "done":
            typer.echo(f"{label}: {outcome.reason}", err=True)
        self._tell(label, self._done, self._total, share=self._work / self._all_work)


def print_report(report: Report, files: dict[str, Path]) -> None:
    """The coverage table, what is not agreement, and where the report is."""
    from rich.console import Console
    from rich.table import Table

    from eigencontact.core.text_table import print_table
    from eigencontact_verification.crosscheck.brief import totals
    from eigencontact_verification.crosscheck.comparison import Comparison, line
    from eigencontact_verification.crosscheck.judge import coverage

    console = Console(highlight=False)
    head = ("subject", "quantity", "component", "verdict", "profiles", "u_FE", "|SA−FE|")
    table = Table(*head, box=None, pad_edge=False)
    numbers_of_run = [row for row in report.rows if isinstance(row, Comparison)]
    for entry in coverage(row for row in report.rows if not isinstance(row, Comparison)):
        numbers = ("–" if value is None else f"{100 * value:.2g} %" for value in (entry.uncertainty, entry.difference))
        agreed = f"{entry.counts['agrees']}/{sum(entry.counts.values())}"
        table.add_row(entry.subject, entry.quantity, entry.component, entry.word, agreed, *numbers)
    print_table(table, console)
    for case in dict.fromkeys(f"{row.subject}/{row.case}" for row in numbers_of_run):
        console.print(f"\n{case}, after ASME V&V 20, in parts of S:", markup=False)
        lines = (line(row) for row in numbers_of_run if f"{row.subject}/{row.case}" == case)
        console.print("\n".join(lines), markup=False, soft_wrap=True)
    for row in report.rows:
        if row.word != "agrees" and row not in numbers_of_run:
            words = f"{row.word}: {row.subject}/{row.case}, {row.profile}, {row.component}: {row.reason}"
            console.print(words, markup=False, soft_wrap=True)
    console.print(f"\n{totals(report)} {len(report.gaps)} known gaps.", markup=False, soft_wrap=True)
    console.print(f"report: {files['html'].resolve()}", markup=False, soft_wrap=True)
