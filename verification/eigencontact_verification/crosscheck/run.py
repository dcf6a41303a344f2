"""Perform the tasks of a cross-check in parallel processes, each within its limits; store finished solutions."""

from __future__ import annotations

import multiprocessing
import os
import time
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from itertools import islice
from multiprocessing.connection import wait
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

from eigencontact_verification.crosscheck.case import Case
from eigencontact_verification.crosscheck.store import Store, content_hash
from eigencontact_verification.crosscheck.worker import Outcome, Task, serve

if TYPE_CHECKING:
    from multiprocessing.connection import Connection

__all__ = ["Limits", "Progress", "Solved", "in_processes", "run_cases", "tasks_of"]

#: Seconds between two looks at the memory of the processes.
_PERIOD = 0.1
#: A process that has held more than this [byte] is replaced, so that the next task starts small.
_RENEW = 2**30


@dataclass(frozen=True, kw_only=True)
class Limits:
    """Limits of a task.

    Parameters
    ----------
    memory : float
        Resident memory of its process [byte]. Default 6 GB. Not enforced where the system does not tell (no /proc).
    seconds : float
        Wall time. Default two hours.
    """

    memory: float = 6e9
    seconds: float = 7200.0


class Progress(Protocol):
    """Observer of the progress of a cross-check."""

    def started(self, tasks: Sequence[Task]) -> None:
        """Called once, with all tasks that have to be computed."""

    def finished(self, task: Task, outcome: Outcome) -> None:
        """Called after each of them."""


#: Performs tasks in any order and yields each with its outcome.
Executor = Callable[[Sequence[Task]], Iterable[tuple[Task, Outcome]]]


@dataclass(frozen=True, kw_only=True, eq=False)
class Solved:
    """A case with the outcomes of its tasks, in the order of `tasks_of`."""

    case: Case
    outcomes: tuple[tuple[Task, Outcome], ...]


def tasks_of(case: Case) -> tuple[Task, ...]:
    """Semi-analytical solution, three meshes with fixed outer faces, and one with free ones."""
    return (
        Task(case=case, level=None),
        Task(case=case, level=0),
        Task(case=case, level=1),
        Task(case=case, level=2),
        Task(case=case, level=case.bracket_level, outer="free"),
    )


def run_cases(
    cases: Sequence[Case], store: Store, *, executor: Executor, progress: Progress | None = None
) -> list[Solved]:
    """Solve cases, reading from `store` what it has and writing to it what is finished.

    Semi-analytical solutions are always computed: they are what is judged, and cheap. A task that fails is not kept and
    will be tried again by the next run.

    Parameters
    ----------
    cases : sequence of Case
        Their keys must differ.
    store : Store
        Finished finite-element solutions.
    executor : callable
        `in_processes` with its limits bound, or that of a cluster.
    progress : Progress, optional
        Who is told.

    Returns
    -------
    list of Solved
        One a case, in the order given.
    """
    keys = [case.key for case in cases]
    if len(set(keys)) != len(keys):
        twice = sorted({key for key in keys if keys.count(key) > 1})
        raise ValueError(f"cases must have different names within a kernel (got {', '.join(twice)} twice); rename one")
    tasks = [task for case in cases for task in tasks_of(case)]
    hashes = {id(task): _key(task) for task in tasks}
    outcomes: dict[str, Outcome] = {}
    for task in tasks:
        stored = None if task.level is None else store.read(hashes[id(task)])
        if stored is not None:
            fields, facts = stored
            outcomes[hashes[id(task)]] = Outcome(
                status="done", fields=fields, seconds=facts["seconds"], memory=facts["memory"], cached=True
            )
    # long tasks first, so that no processor idles at the end; equal problems of two cases are solved once
    due: dict[str, Task] = {}
    for task in sorted(tasks, key=lambda task: -task.weight):
        if hashes[id(task)] not in outcomes:
            due.setdefault(hashes[id(task)], task)
    if progress is not None:
        progress.started(list(due.values()))
    for task, outcome in executor(list(due.values())):
        key = hashes[id(task)]
        outcomes[key] = outcome
        if task.level is not None and outcome.fields is not None:
            store.write(key, outcome.fields, {"seconds": outcome.seconds, "memory": outcome.memory, "task": task.label})
        if progress is not None:
            progress.finished(task, outcome)
    answers = iter([(task, outcomes[hashes[id(task)]]) for task in tasks])
    return [Solved(case=case, outcomes=tuple(islice(answers, len(tasks_of(case))))) for case in cases]


def _key(task: Task) -> str:
    """Name of a solution in the store; of a semi-analytical one, which is never stored, a name of its own."""
    return str(id(task)) if task.level is None else content_hash(task.case, task.level, task.outer)


# --- processes --------------------------------------------------------------------------------------------------------


@dataclass(kw_only=True)
class _Process:
    """A process at the other end of a pipe, and what it is doing."""

    process: Any
    connection: Connection
    task: Task | None = None
    since: float = 0.0
    peak: int = field(default=0)

    def resident(self) -> int | None:
        """Memory that the process holds now [byte]."""
        try:
            pages = Path(f"/proc/{self.process.pid}/statm").read_text(encoding="ascii").split()[1]
        except (OSError, IndexError):
            return None
        return int(pages) * os.sysconf("SC_PAGE_SIZE")

    def end(self) -> None:
        self.connection.close()
        self.process.kill()
        self.process.join()


@contextmanager
def _environment(threads: int) -> Iterator[None]:
    """Threads of the libraries in processes that are started inside: with one a core, more only wait for each other."""
    variables = {f"{pool}_NUM_THREADS": str(threads) for pool in ("OMP", "OPENBLAS", "MKL", "NUMBA")}
    before = {name: os.environ.get(name) for name in variables}
    os.environ.update(variables)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value


def _start(threads: int, plugins: Sequence[str]) -> _Process:
    context = multiprocessing.get_context("spawn")
    ours, theirs = context.Pipe()
    with _environment(threads):
        process = context.Process(target=serve, args=(theirs, plugins), daemon=True)
        process.start()
    theirs.close()
    return _Process(process=process, connection=ours)


def in_processes(
    tasks: Sequence[Task], *, workers: int = 1, limits: Limits | None = None, plugins: Sequence[str] = ()
) -> Iterator[tuple[Task, Outcome]]:
    """Perform tasks in fresh interpreters (spawned), each task within `limits`; yields them as they finish.

    Parameters
    ----------
    tasks : sequence of Task
        Taken in this order.
    workers : int
        Processes at a time; each may use ``cores // workers`` threads.
    limits : Limits, optional
        A task beyond them is ended and reported, and a new process takes the next.
    plugins : sequence of str
        Plugin files that the cases name.
    """
    if workers < 1:
        raise ValueError(f"workers must be at least 1 (got {workers}); give the number of processes")
    limits = limits or Limits()
    waiting, threads = deque(tasks), max(1, (os.cpu_count() or 1) // workers)
    idle: list[_Process] = []
    busy: list[_Process] = []
    try:
        while waiting or busy:
            while waiting and len(busy) < workers:
                process = idle.pop() if idle else _start(threads, plugins)
                process.task, process.since, process.peak = waiting.popleft(), time.monotonic(), 0
                busy.append(process)
                try:
                    process.connection.send(process.task)
                except Exception as problem:  # noqa: BLE001 - whatever pickling a stranger's case raises
                    busy.remove(process)
                    process.end()
                    yield process.task, Outcome(status="failed", reason=f"cannot be sent to a process: {problem}")
            wait([process.connection for process in busy], timeout=_PERIOD)
            for process in list(busy):
                outcome = _look(process, limits)
                if outcome is None:
                    continue
                busy.remove(process)
                if outcome.status == "done" and (outcome.memory or 0) < _RENEW:
                    idle.append(process)
                else:
                    process.end()
                task = process.task
                if task is not None:
                    yield task, outcome
    finally:
        for process in (*busy, *idle):
            process.end()


def _look(process: _Process, limits: Limits) -> Outcome | None:
    """The outcome of what a process does, or None while it is within its limits and not done."""
    elapsed = time.monotonic() - process.since
    if process.connection.poll():
        try:
            outcome: Outcome = process.connection.recv()
        except (EOFError, OSError):
            process.process.join(1.0)
            return Outcome(status="failed", reason=f"process ended with {process.process.exitcode}", seconds=elapsed)
        except Exception as problem:  # noqa: BLE001 - an answer that cannot be read is a failed task
            return Outcome(status="failed", reason=f"answer cannot be read: {problem}", seconds=elapsed)
        if outcome.memory is not None and outcome.memory > limits.memory:
            reason = f"used {outcome.memory / 1e9:.2f} GB, more than {limits.memory / 1e9:.2f} GB"
            return replace(outcome, status="memory", reason=reason, fields=None)
        return outcome
    resident = process.resident()
    process.peak = max(process.peak, resident or 0)
    if resident is not None and resident > limits.memory:
        reason = f"ended at {resident / 1e9:.2f} GB, more than {limits.memory / 1e9:.2f} GB"
        return Outcome(status="memory", reason=reason, seconds=elapsed, memory=process.peak)
    if elapsed > limits.seconds:
        reason = f"not done within {limits.seconds:.0f} s"
        return Outcome(status="time", reason=reason, seconds=elapsed, memory=process.peak or None)
    return None
