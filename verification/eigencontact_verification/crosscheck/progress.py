"""How a cross-check shows itself in a terminal: how far it is, and what it found."""

from __future__ import annotations

import sys
import time
from typing import TYPE_CHECKING, Any, Self

import typer

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from eigencontact_verification.crosscheck.report import Report
    from eigencontact_verification.crosscheck.worker import Outcome, Task

__all__ = ["Bar", "print_report"]

#: Least time between two lines on solutions [s].
_LINES = 10.0


class Bar:
    """Progress with the remaining time: the bar counts work, the words count solutions; lines without a terminal."""

    def __init__(self, *, show: bool) -> None:
        self._bar: Any = None
        self._task: Any = None
        self._left = self._total = 0
        self._lines = False
        self._began = self._said = time.monotonic()
        if show:
            from rich.console import Console
            from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

            from eigencontact.progress import draws_in_place

            console = Console(stderr=True)
            if draws_in_place(sys.stderr):
                words = (TextColumn("{task.description}"), BarColumn(), TimeElapsedColumn(), TextColumn("left"))
                self._bar = Progress(*words, TimeRemainingColumn(), console=console, transient=True)
            else:
                self._lines = True

    def __enter__(self) -> Self:
        if self._bar is not None:
            self._bar.start()
        return self

    def __exit__(self, *_: object) -> None:
        if self._bar is not None:
            self._bar.stop()

    def started(self, tasks: Sequence[Task]) -> None:
        """Show the work that is due."""
        self._left = self._total = len(tasks)
        self._began = self._said = time.monotonic()
        if self._lines and tasks:
            typer.echo(f"{self._total} solutions to compute", err=True)
        if self._bar is not None:
            self._task = self._bar.add_task(f"{self._left} solutions", total=sum(task.weight for task in tasks))

    def finished(self, task: Task, outcome: Outcome) -> None:
        """Count a solution; say what failed."""
        self._left -= 1
        if self._bar is not None:
            if outcome.status != "done":
                self._bar.console.print(f"{task.case.key}, {task.label}: {outcome.reason}", markup=False)
            self._bar.update(self._task, advance=task.weight, description=f"{self._left} solutions to go")
        elif self._lines:
            self._say(task, outcome)

    def _say(self, task: Task, outcome: Outcome) -> None:
        """A line for what failed, and for how far it is where the last one is some time ago."""
        from eigencontact.core.units import time_in_words

        now = time.monotonic()
        if outcome.status != "done":
            typer.echo(f"{task.case.key}, {task.label}: {outcome.reason}", err=True)
        if now - self._said >= _LINES:
            self._said, done = now, self._total - self._left
            typer.echo(f"solution {done} of {self._total} done after {time_in_words(now - self._began)}", err=True)


def print_report(report: Report, files: dict[str, Path]) -> None:
    """The coverage table, what is not agreement, and where the report is."""
    from rich.console import Console
    from rich.table import Table

    from eigencontact.core.text_table import print_table
    from eigencontact_verification.crosscheck.brief import totals
    from eigencontact_verification.crosscheck.judge import coverage

    console = Console(highlight=False)
    table = Table("kernel", "quantity", "component", "verdict", "profiles", "u_FE", "|SA−FE|", box=None, pad_edge=False)
    for one in coverage(report.rows):
        numbers = ("–" if value is None else f"{100 * value:.2g} %" for value in (one.uncertainty, one.difference))
        agreed = f"{one.counts['agrees']}/{sum(one.counts.values())}"
        table.add_row(one.kernel, one.quantity, one.component, one.word, agreed, *numbers)
    print_table(table, console)
    for row in report.rows:
        if row.word != "agrees":
            words = f"{row.word}: {row.kernel}/{row.case}, {row.profile}, {row.component}: {row.reason}"
            console.print(words, markup=False, soft_wrap=True)
    console.print(f"\n{totals(report)} {len(report.gaps)} known gaps.", markup=False, soft_wrap=True)
    console.print(f"report: {files['html'].resolve()}", markup=False, soft_wrap=True)
