"""Interface of engines for independent tasks, and the two engines on the local machine.

An engine yields what comes of a task as soon as it has come. A task whose process dies costs no other: it is tried
again alone, and is `DeadTask` when it dies again.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from multiprocessing import get_context
from typing import Any, Protocol, Self, TypeVar

from eigencontact.core.memory import machine_bytes
from eigencontact.core.parallel import available_threads
from eigencontact.engines.guard import GUARD, refuse_unguarded

__all__ = ["DeadTask", "Engine", "Processes", "Share", "ThisProcess"]

Task = TypeVar("Task")
Result = TypeVar("Result")
State = TypeVar("State")


@dataclass(frozen=True, slots=True)
class Share:
    """Share of a machine for one process that performs tasks one after the other.

    Attributes
    ----------
    threads : int or None
        Threads; None where the task may choose.
    memory : float
        Memory [bytes].
    """

    threads: int | None
    memory: float


@dataclass(frozen=True, slots=True)
class DeadTask:
    """Marker in place of a result: the process of the task died more than once; `reason` is one line."""

    reason: str


class Engine(Protocol):
    """Executor of tasks while it is open (``with``)."""

    def __enter__(self) -> Self:
        """Acquire the resources."""

    def __exit__(self, *_: object) -> None:
        """Release the resources."""

    def map(
        self, function: Callable[[Task, State], Result], tasks: Sequence[Task], begin: Callable[[Share], State]
    ) -> Iterator[tuple[Task, Result | DeadTask]]:
        """Yield tasks and their results in the order of completion.

        Parameters
        ----------
        function : callable
            Gets a task and what its process holds; must not raise. Named in a module, so that processes find it.
        tasks : sequence
            What is done, begun in this order.
        begin : callable
            Called once in each process; makes what the tasks of that process share.
        """


class _Local:
    """Engine without resources between its tasks."""

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        return


class ThisProcess(_Local):
    """Performs tasks one after the other, here."""

    def map(
        self, function: Callable[[Task, State], Result], tasks: Sequence[Task], begin: Callable[[Share], State]
    ) -> Iterator[tuple[Task, Result | DeadTask]]:
        """As `Engine.map`."""
        state = begin(Share(None, machine_bytes()))
        for task in tasks:
            yield task, function(task, state)


class Processes(_Local):
    """Engine with processes of this machine, which share its threads and memory evenly.

    Parameters
    ----------
    workers : int
        Processes.

    Raises
    ------
    EigencontactError
        A script that makes one without ``if __name__ == "__main__":``.
    """

    def __init__(self, workers: int) -> None:
        refuse_unguarded(f"workers={workers}")
        self._workers = workers

    def map(
        self, function: Callable[[Task, State], Result], tasks: Sequence[Task], begin: Callable[[Share], State]
    ) -> Iterator[tuple[Task, Result | DeadTask]]:
        """As `Engine.map`."""
        lost_tasks = yield from self._pool(function, tasks, begin, self._workers)
        for task in lost_tasks:  # their process died, or that of a neighbour: each again in its own process
            if (yield from self._pool(function, [task], begin, 1)):
                yield task, DeadTask(f"its process died twice: it ran out of memory, was killed, or {GUARD}")

    def _pool(
        self,
        function: Callable[[Task, State], Result],
        tasks: Sequence[Task],
        begin: Callable[[Share], State],
        count: int,
    ) -> Generator[tuple[Task, Result | DeadTask], None, list[Task]]:
        """Yield results of tasks; return the tasks whose process died."""
        lost_tasks, count = list[Task](), min(count, len(tasks))
        share = Share(max(1, available_threads() // self._workers), machine_bytes() / self._workers)
        with ProcessPoolExecutor(max(1, count), get_context("spawn"), _begin, (begin, share)) as pool:
            running: dict[Future[Result], Task] = {pool.submit(_perform, function, task): task for task in tasks}
            try:
                for future in as_completed(running):
                    try:
                        yield running[future], future.result()
                    except BrokenProcessPool:
                        lost_tasks.append(running[future])
            except BaseException:
                pool.shutdown(wait=False, cancel_futures=True)
                raise
        return lost_tasks


#: What the tasks of this process share, where it is one of a pool.
_STATE: Any = None


def _begin(begin: Callable[[Share], Any], share: Share) -> None:
    global _STATE  # noqa: PLW0603 - a process of a pool serves one pool
    _STATE = begin(share)


def _perform(function: Callable[[Any, Any], Result], task: Any) -> Result:
    return function(task, _STATE)
