"""One task of a cross-check, and the process that performs one after another."""

from __future__ import annotations

import time
import traceback
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from eigencontact_verification.crosscheck.case import HALVED, UNKNOWNS, Case, Fields, Level, Outer, error_key

if TYPE_CHECKING:
    from collections.abc import Sequence
    from multiprocessing.connection import Connection

__all__ = ["Outcome", "Status", "Task", "perform", "serve"]

Status = Literal["done", "failed", "memory", "time"]


@dataclass(frozen=True, kw_only=True)
class Task:
    """One solution of one case: by finite elements on a mesh, or (``level`` None) semi-analytically.

    Parameters
    ----------
    case : Case
        What is solved.
    level : {0, 1, 2} or None
        Mesh; None for the semi-analytical code.
    outer : {"fixed", "free"}
        Condition on the outer faces.
    """

    case: Case
    level: Level | None
    outer: Outer = "fixed"

    @property
    def label(self) -> str:
        """Words for progress and report."""
        if self.level is None:
            return "semi-analytical"
        return f"elements, {('coarse', 'medium', 'fine')[self.level]} mesh, {self.outer} outer faces"

    @property
    def weight(self) -> float:
        """Share of the work, for the progress: a finer mesh has some six times the unknowns."""
        return 1.0 if self.level is None else 6.0**self.level


@dataclass(frozen=True, kw_only=True, eq=False)
class Outcome:
    """Result of a task.

    Attributes
    ----------
    status : {"done", "failed", "memory", "time"}
        ``memory`` and ``time``: ended because it passed the limit.
    reason : str
        Why it is not done; one line.
    fields : dict or None
        Values by name of profile, each (n, components).
    seconds : float or None
        Wall time of the task itself.
    memory : int or None
        Peak resident memory of the process meanwhile [byte]; None where the system does not tell.
    cached : bool
        Found in the store; then seconds and memory are those of the run that computed it.
    """

    status: Status
    reason: str = ""
    fields: Fields | None = None
    seconds: float | None = None
    memory: int | None = None
    cached: bool = False

    @property
    def unknowns(self) -> int | None:
        """Number of unknowns of the largest system; None where the case does not tell."""
        count = None if self.fields is None else self.fields.get(UNKNOWNS)
        return None if count is None else int(count[0])


def perform(task: Task) -> Outcome:
    """Solve, measure, and turn every failure into words."""
    from eigencontact_verification.reporting.memory import PeakMemory

    memory, start = PeakMemory(), time.perf_counter()

    def measured() -> dict[str, Any]:
        grown = memory.peak()
        peak = None if grown is None or memory.baseline is None else grown + memory.baseline
        return {"seconds": time.perf_counter() - start, "memory": peak}

    try:
        answer = task.case.judged() if task.level is None else task.case.reference(task.level, task.outer)
        fields = _checked(task.case, answer)
    except MemoryError:
        return Outcome(status="memory", reason="no memory left", **measured())
    except Exception as problem:  # noqa: BLE001 - a stranger's case may raise anything, and the cross-check goes on
        place = traceback.extract_tb(problem.__traceback__)[-1]
        words = " ".join(str(problem).split())
        reason = f"{type(problem).__name__}: {words} ({place.name}, line {place.lineno})"
        return Outcome(status="failed", reason=reason, **measured())
    return Outcome(status="done", fields=fields, **measured())


def _checked(case: Case, answer: Fields) -> Fields:
    """Fields as the profiles ask for them."""
    fields: Fields = {}
    for profile in case.profiles:
        if profile.name not in answer:
            raise ValueError(f"profile '{profile.name}' must be returned (got {sorted(answer)}); add its values")
        values = np.asarray(answer[profile.name], dtype=float)
        expected = (len(profile.points), len(profile.components))
        if values.shape != expected:
            raise ValueError(
                f"profile '{profile.name}' must be {expected} (got {values.shape}); one column a component"
            )
        fields[profile.name] = values
        if error_key(profile.name) in answer:
            fields[error_key(profile.name)] = np.abs(answer[error_key(profile.name)]).reshape(expected)
    fields |= {name: np.asarray(answer[name], dtype=float).reshape(1) for name in (HALVED, UNKNOWNS) if name in answer}
    return fields


def serve(connection: Connection, plugins: Sequence[str] = ()) -> None:
    """Perform what comes through the pipe until None comes, or nobody is left at the other end.

    Parameters
    ----------
    connection : Connection
        The pipe.
    plugins : sequence of str
        Plugin files that the cases name.
    """
    from eigencontact.scene.installed import add_plugin_files

    try:
        add_plugin_files(plugins)
        while (task := connection.recv()) is not None:
            connection.send(perform(task))
    except (EOFError, BrokenPipeError, KeyboardInterrupt):
        return
