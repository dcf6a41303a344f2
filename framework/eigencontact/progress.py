"""Progress of a run: bars on a terminal; elsewhere, or on request, a line for each load step."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from math import log10
from time import monotonic
from typing import TYPE_CHECKING, Any, TextIO

from eigencontact.core.units import readable, time_in_words

if TYPE_CHECKING:
    from eigencontact.execution.run.driver import Watcher
    from eigencontact.execution.run.loading import LoadPoint
    from eigencontact.results.records import StepRecord

__all__ = ["ProgressLines", "VerboseLines", "draws_in_place", "progress"]

#: Shortest time between two lines on load steps, and longest silence while one of them is solved [s].
_LINES, _SILENCE = 1.0, 15.0
#: Scalars of a step that a full line tells, those of which one goes without saying, and the least time of a block [s].
_REACHED = (
    ("normal_load", "load", "N"), ("approach", "approach", "m"), ("shift_magnitude", "shift", "m"),
    ("tangential_load", "tangential load", "N"), ("torsion_moment", "torsion", "N m"),
)  # fmt: skip
_COUNTS = (
    ("iterations", "iterations"),
    ("convolutions", "convolutions"),
    ("tangential_convolutions", "convolutions of the shear"),
    ("coupling_rounds", "rounds"),
    ("inclusion_iterations", "iterations of inclusions"),
)
_ONCE, _SHOWN = ("coupling_rounds",), 1e-3
#: Loads and motions below this part of the largest of their kind are round-off.
_NOTHING = 1e-12


@contextmanager
def progress(*, enabled: bool, verbose: bool = False, unit: Callable[[str], str] = str) -> Iterator[Watcher | None]:
    """Watcher of a run that shows its progress on the standard error stream; None if not enabled.

    If `verbose`, each load step has a line of its own, with iterations, residuals and times: see `VerboseLines`. `unit`
    gives the unit of a force, which is per length in a line contact: see `Grid.unit`.
    """
    if not enabled:
        yield None
        return
    if verbose:
        yield VerboseLines(sys.stderr, unit=unit)
        return
    if not draws_in_place(sys.stderr):
        yield ProgressLines(sys.stderr)
        return
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True) as bars:
        yield _ProgressBars(bars)


def draws_in_place(stream: TextIO) -> bool:
    """Whether a bar can be redrawn in place: on a terminal with a cursor, not in a notebook cell.

    Jupyter runs the commands of a cell on a terminal, and shows every state of a bar below the one before.

    Examples
    --------
    >>> from io import StringIO
    >>> draws_in_place(StringIO())
    False
    """
    dumb = os.environ.get("TERM") in {"dumb", "unknown"} or "JPY_PARENT_PID" in os.environ
    return stream.isatty() and not dumb


class _ProgressBars:
    """Two progress bars: load steps, and residual of the current solution."""

    def __init__(self, bars: Any) -> None:
        self._bars = bars
        self._steps: Any = None
        self._solve: Any = None

    def step_started(self, point: LoadPoint, total: int) -> None:
        """Show the current load step."""
        if self._steps is None:
            self._steps = self._bars.add_task("load steps", total=total, completed=point.index - 1)
            self._solve = self._bars.add_task("residual", total=60)
        self._bars.update(self._steps, completed=point.index - 1)

    def announced(self, text: str) -> None:
        """Write a line above the bars."""
        self._bars.console.print(text, highlight=False)

    def iterated(self, text: str, residual: float, tolerance: float) -> None:
        """Show the decades of the residual that are reached."""
        if not 0 < residual < float("inf"):
            return
        decades = max(0.0, min(1.0, log10(residual) / log10(tolerance)))
        self._bars.update(self._solve, completed=round(60 * decades), description=f"{text}, residual {residual:.0e}")

    def step_finished(self, record: StepRecord, total: int) -> None:
        """Count the accepted step."""
        self._bars.update(self._steps, completed=record.index, total=total)


class ProgressLines:
    """Watcher that writes at most one line a second, and one for the last load step, to a stream.

    The clock gives the time [s] from any moment on.
    """

    def __init__(self, stream: TextIO, clock: Callable[[], float] = monotonic) -> None:
        self._stream, self._clock = stream, clock
        self._ends: list[float] = []  # of the run so far and of each step
        self._said, self._spoke = clock(), False
        self._now = ""

    def step_started(self, point: LoadPoint, total: int) -> None:
        """Store the number of the current load step."""
        self._ends = self._ends or [self._clock()]
        self._now = f"load step {point.index} of {total}"

    def announced(self, text: str) -> None:
        """Write a line."""
        self._say(text)

    def iterated(self, text: str, residual: float, tolerance: float) -> None:
        """Report the progress of a load step that takes long."""
        if self._clock() - self._said >= _SILENCE:
            self._say(f"{self._now}: {text}, residual {residual:.1e}, to fall to {tolerance:.1e}")

    def step_finished(self, record: StepRecord, total: int) -> None:
        """Write the number of finished load steps, the elapsed time and the estimated remaining time."""
        self._ends.append(self._clock())
        least = _LINES if record.index < total or not self._spoke else 0.0
        if self._ends[-1] - self._said < least:
            return
        text = f"load step {record.index} of {total} done after {time_in_words(self._ends[-1] - self._ends[0])}"
        if record.index < total:
            ends = self._ends[1:] if len(self._ends) > 2 else self._ends  # the first step builds what all need
            pace = (ends[-1] - ends[0]) / (len(ends) - 1)
            text += f", about {time_in_words((total - record.index) * pace)} left"
        self._say(text)

    def _say(self, text: str) -> None:
        print(text, file=self._stream, flush=True)
        self._said, self._spoke = self._clock(), True


class VerboseLines(ProgressLines):
    """Watcher that writes a line for every load step: results, iterations, residuals, time of each block."""

    def __init__(
        self, stream: TextIO, clock: Callable[[], float] = monotonic, *, unit: Callable[[str], str] = str
    ) -> None:
        super().__init__(stream, clock)
        self._unit = unit
        self._elapsed: Mapping[str, float] = {}

    def step_took(self, seconds: Mapping[str, float]) -> None:
        """Note the time [s] of each block in the step."""
        self._elapsed = seconds

    def step_finished(self, record: StepRecord, total: int) -> None:
        """Write the numbers, residuals and times of the step."""
        numbers = record.scalars
        reached = [
            f"{text} {readable(numbers[name], self._unit(unit))}"
            for name, text, unit in _REACHED
            if abs(numbers.get(name, 0.0)) > _NOTHING * (numbers.get("normal_load", 0.0) if unit == "N" else 1e-6)
        ]
        counts = [f"{numbers[name]:.0f} {text}" for name, text in _COUNTS if numbers.get(name, 0.0) > (name in _ONCE)]
        residuals = [
            f"{name.removesuffix('_residual')} {value:.0e}"
            for name, value in numbers.items()
            if name.endswith("_residual") and value > 0.0
        ]
        times = [f"{name} {time_in_words(elapsed)}" for name, elapsed in self._elapsed.items() if elapsed >= _SHOWN]
        parts = [", ".join([*reached, *counts]), "", ", ".join(times)]
        parts[1] = f"residuals: {', '.join(residuals)}" if residuals else ""
        self._say(f"load step {record.index} of {total}: " + "; ".join(phrase for phrase in parts if phrase))
