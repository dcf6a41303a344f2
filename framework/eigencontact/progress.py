"""Progress bars of a run: one for the load steps, one for the residual of the solve under way."""

from __future__ import annotations

from math import log10
from types import TracebackType
from typing import TYPE_CHECKING, Any, Self

if TYPE_CHECKING:
    from eigencontact.execution.loading import LoadPoint
    from eigencontact.results.records import StepRecord

__all__ = ["ProgressBars"]


class ProgressBars:
    """Watcher that draws bars on the terminal; silent where there is none, or when not enabled."""

    def __init__(self, *, enabled: bool) -> None:
        self._enabled = enabled
        self._bars: Any = None
        self._steps: Any = None
        self._solve: Any = None

    def __enter__(self) -> Self:
        if self._enabled:
            from rich.console import Console
            from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

            console = Console(stderr=True)
            if console.is_terminal:
                columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
                self._bars = Progress(*columns, console=console, transient=True)
                self._bars.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._bars is not None:
            self._bars.stop()

    def step_started(self, point: LoadPoint, total: int) -> None:
        """Show the load step that begins."""
        if self._bars is None:
            return
        if self._steps is None:
            self._steps = self._bars.add_task("load steps", total=total, completed=point.index - 1)
            self._solve = self._bars.add_task("residual", total=60)
        self._bars.update(self._steps, completed=point.index - 1)

    def iterated(self, text: str, residual: float, tolerance: float) -> None:
        """Show the decades of the residual that are behind us."""
        if self._bars is None or not 0 < residual < float("inf"):
            return
        decades = max(0.0, min(1.0, log10(residual) / log10(tolerance)))
        self._bars.update(self._solve, completed=round(60 * decades), description=f"{text}, residual {residual:.0e}")

    def step_finished(self, record: StepRecord, total: int) -> None:
        """Count the accepted step."""
        if self._bars is not None:
            self._bars.update(self._steps, completed=record.index, total=total)
