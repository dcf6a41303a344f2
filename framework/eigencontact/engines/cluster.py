"""Execution of tasks on the workers of a dask.distributed cluster (extra ``cluster``), remote or local.

A worker performs one task at a time, with all its threads and memory. Dask gives the tasks of a worker that dies to
others. Few tasks wait at the scheduler at a time, so that their number costs it nothing.
"""

from __future__ import annotations

import json
import re
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import CancelledError
from contextlib import ExitStack, suppress
from pathlib import Path
from time import monotonic
from typing import Any, Self, TypeVar
from uuid import uuid4

from eigencontact.core.memory import machine_bytes
from eigencontact.core.parallel import available_threads
from eigencontact.engines.engine import DeadTask, Share
from eigencontact.engines.guard import GUARD, refuse_unguarded
from eigencontact.errors import ClusterError, shown

__all__ = ["Cluster", "cluster_of"]

Task = TypeVar("Task")
Result = TypeVar("Result")
State = TypeVar("State")

#: Longest wait for a scheduler [s].
_CONNECT = 10.0
#: Longest wait for the first worker of a scheduler [s].
_WORKER = 60.0
#: Time after which the workers are counted again [s]; a cluster may grow.
_COUNT = 5.0
#: A worker that dies with a task, by dask's default, may do so three times; on this machine once is enough.
_LOCAL = {
    "distributed.scheduler.allowed-failures": 1,
    # results are small and tasks hold what they were given: a pause would never end
    "distributed.worker.memory.target": False,
    "distributed.worker.memory.spill": False,
    "distributed.worker.memory.pause": False,
}


class Cluster:
    """Engine of dask.distributed; opened by ``with``; opening it twice costs nothing.

    Parameters
    ----------
    address : str
        ``local:N`` for N processes of this machine, which share its threads and memory; else the scheduler's, as
        ``tcp://host:8786``, or the file that it wrote with ``--scheduler-file``.
    memory : float, optional
        What a task needs [bytes]; workers that have less get none.
    threads : int, optional
        What a task needs; workers that have fewer get none, and one that gets a task gives it all its threads.
    say : callable, optional
        Called with one line about the workers and the dashboard.

    Raises
    ------
    ClusterError
        What is none of these; dask.distributed is not installed.
    EigencontactError
        A script that asks for ``local:N`` without ``if __name__ == "__main__":``.

    Examples
    --------
    >>> Cluster("local:none")
    Traceback (most recent call last):
    eigencontact.errors.ClusterError: cluster must be local:N, N from 1 to 1024 (got 'local:none')
    """

    def __init__(
        self, address: str, *, memory: float | None = None, threads: int | None = None,
        say: Callable[[str], None] | None = None,
    ) -> None:  # fmt: skip
        local = re.fullmatch(r"local:(\d{1,4})", address)
        self._local = int(local[1]) if local else 0
        if address.startswith("local") and not 1 <= self._local <= 1024:
            raise ClusterError(f"cluster must be local:N, N from 1 to 1024 (got {address!r})")
        if not self._local and not Path(address).is_file() and not re.fullmatch(r"(\w+://)?\S+:\d+", address):
            raise ClusterError(f"cluster must be local:N, host:port or a scheduler's file (got {address!r})")
        try:
            import distributed  # noqa: F401
        except ImportError:
            message = "cluster must have dask.distributed (not installed); install eigencontact[cluster]"
            raise ClusterError(message) from None
        if self._local:
            refuse_unguarded(f"cluster={address!r}")
        self._address, self._say = address, say
        self._memory, self._threads = memory or 0.0, threads or 0
        self._client: Any = None
        self._open = ExitStack()
        #: Where results are written; workers must see it.
        self.folder: Path | None = None

    def __enter__(self) -> Self:
        from distributed import Client

        address = self._address
        if Path(address).is_file():
            address = _address_in(Path(address))
        try:
            client = (
                Client(self._open.enter_context(self._local_cluster()))
                if self._local
                else Client(address, timeout=_CONNECT)
            )
        except (OSError, ValueError, RuntimeError) as problem:  # TimeoutError is an OSError
            self._open.close()
            reason = " ".join(str(problem).split()) or type(problem).__name__
            if self._local:
                raise ClusterError(
                    f"cluster {address} must start its workers (got: {reason}); a worker died while it started: it ran "
                    f"out of memory, was killed, or {GUARD}"
                ) from None
            raise ClusterError(
                f"cluster must be reachable within {_CONNECT:g} s (got {self._address}: {reason})"
            ) from None
        self._client = client
        self._open.callback(_closed, client)
        return self

    def __exit__(self, *_: object) -> None:
        self._client = None
        self._open.close()

    def _local_cluster(self) -> Any:
        """Cluster of this machine."""
        import logging

        import dask
        from distributed import LocalCluster

        self._open.enter_context(dask.config.set(_LOCAL))
        return LocalCluster(
            n_workers=self._local, threads_per_worker=max(1, available_threads() // self._local),
            memory_limit=int(machine_bytes() / self._local), processes=True, silence_logs=logging.CRITICAL,
            host="127.0.0.1", dashboard_address="127.0.0.1:0",  # no other machine may reach either
        )  # fmt: skip

    def map(
        self, function: Callable[[Task, State], Result], tasks: Sequence[Task], begin: Callable[[Share], State]
    ) -> Iterator[tuple[Task, Result | DeadTask]]:
        """As `Engine.map`.

        Raises
        ------
        ClusterError
            No worker, or one of another version, or that does not see the folder, named; no worker with the memory;
            a scheduler that is lost while tasks are left.
        """
        from eigencontact.engines.dask_worker import Beginning

        name = f"eigencontact-{uuid4().hex}"
        probe = None if self.folder is None else self.folder.resolve() / f".{name}"
        try:
            if probe is not None:
                probe.touch()
            try:
                self._check(probe)
                self._client.register_plugin(Beginning(begin, probe), name=name)
            except ClusterError:
                raise
            except Exception as problem:
                raise ClusterError(
                    f"workers of {self._address} must stay connected during the query of their resources (got "
                    f"{type(problem).__name__}: {' '.join(str(problem).split())}); run the same command again"
                ) from problem
            lost_tasks = deque[tuple[Task, str]]()
            for task, result in self._answers(function, tasks, name, workers=0):
                if isinstance(result, DeadTask):
                    lost_tasks.append((task, result.reason))
                else:
                    yield task, result
            for task, _ in lost_tasks:  # perhaps it only waited at a worker that another task took along: again, alone
                yield from self._answers(function, [task], name, workers=1)
        finally:
            if probe is not None:
                probe.unlink(missing_ok=True)
            with suppress(Exception):  # of a scheduler that is gone
                if self._client.status == "running":
                    self._client.unregister_worker_plugin(name)

    def _answers(
        self, function: Callable[[Task, State], Result], tasks: Sequence[Task], name: str, *, workers: int
    ) -> Iterator[tuple[Task, Result | DeadTask]]:
        """Results of tasks; twice as many tasks as workers are submitted; `workers` 0 counts the workers."""
        from distributed import as_completed
        from distributed.protocol.pickle import dumps

        from eigencontact.engines.dask_worker import MEMORY, TASK_SLOT, THREADS, perform

        needs = {TASK_SLOT: 1, MEMORY: self._memory, THREADS: self._threads}
        waiting, running, completed = deque(tasks), dict[Any, Task](), as_completed()
        room, counted = 1, -_COUNT
        finished = 0
        try:
            while waiting or running:
                if not workers and monotonic() - counted > _COUNT and self._client.status == "running":
                    room, counted = 2 * len(self._client.nthreads()) + 2, monotonic()
                while waiting and len(running) < room:
                    task = waiting.popleft()
                    try:
                        question = dumps((function, task))
                    except Exception as refused:  # noqa: BLE001 - whatever pickling a stranger's task raises
                        yield task, DeadTask(f"cannot be sent to a worker: {' '.join(str(refused).split())}")
                        continue
                    future = self._client.submit(perform, question, name, pure=False, resources=needs)
                    running[future] = task
                    completed.add(future)
                if not running:  # none of the rest could be sent
                    continue
                future = next(completed)
                if future.status in ("lost", "pending") and self._client.status == "running":
                    # Its worker died with the answer before that was fetched: the answer is computed anew.
                    completed.add(future)
                    continue
                task = running.pop(future)
                if future.status == "finished":
                    result = future.result()
                    finished += 1
                    yield task, result
                elif future.status == "error":
                    problem = future.exception()
                    words = " ".join(f"{type(problem).__name__}: {problem}".split())
                    yield task, DeadTask(f"its worker failed: {words}")
                else:
                    raise self._lost_scheduler(finished, len(tasks))
        except (OSError, RuntimeError, CancelledError) as problem:  # how a client that has lost its scheduler refuses
            raise self._lost_scheduler(finished, len(tasks)) from problem
        finally:
            with suppress(Exception):
                self._client.cancel(list(running))

    def _lost_scheduler(self, finished: int, total: int) -> ClusterError:
        return ClusterError(
            f"scheduler of {self._address} must stay until the end (lost after {finished} of {total}); "
            "the same command resumes and reuses what is finished"
        )

    def _check(self, probe: Path | None) -> None:
        """Refuse workers that differ from this machine, and report the workers."""
        from eigencontact.engines.versions import unlike, versions

        try:
            self._client.wait_for_workers(1, timeout=_WORKER)
        except TimeoutError:
            raise ClusterError(f"cluster {self._address} must have a worker (none within {_WORKER:g} s)") from None
        facts: dict[str, dict[str, Any]] = self._client.run(_asking(None if probe is None else str(probe)))
        packages = versions()
        for worker, facts_of_worker in facts.items():
            if difference := unlike(packages, facts_of_worker["versions"]):
                raise ClusterError(f"worker {worker} {difference}")
            if not facts_of_worker["sees"] and probe is not None:
                raise ClusterError(f"worker {worker} must have access to {probe.parent}; use a shared folder")
        limits: dict[str, float] = self._client.run(_limit)
        threads_of: dict[str, int] = self._client.nthreads()
        memory, threads = max(limits.values()), max(threads_of.values())
        if self._memory > memory:
            sizes = f"{self._memory / 1e9:.3g} GB, the largest worker {memory / 1e9:.3g} GB"
            raise ClusterError(f"memory of a task must not exceed that of a worker (got {sizes})")
        if self._threads > threads:
            sizes = f"{self._threads}, the largest worker {threads}"
            raise ClusterError(f"threads of a task must not exceed those of a worker (got {sizes})")
        if not any(limits[worker] >= self._memory and threads_of.get(worker, 0) >= self._threads for worker in limits):
            sizes = f"{self._memory / 1e9:.3g} GB and {self._threads} threads"
            raise ClusterError(f"a worker must have the memory and the threads of a task (none has {sizes})")
        if self._say is not None:
            self._say(
                f"cluster {self._address}: {len(facts)} workers, {sum(threads_of.values())} threads, "
                f"{memory / 1e9:.3g} GB each; dashboard: {self._client.dashboard_link}"
                f"{' (this machine only)' if self._local else ''}"
            )


def cluster_of(
    address: str | None, gigabytes: float | None, threads: int | None, *, say: Callable[[str], None]
) -> Cluster | None:
    """Cluster of the options ``--cluster``, ``--memory`` and ``--threads``; None without the first."""
    if address is None:
        if gigabytes is not None:
            raise ClusterError(f"memory must be used with --cluster, because it selects workers (got {gigabytes:g} GB)")
        if threads is not None:
            raise ClusterError(f"threads must be used with --cluster, because it selects workers (got {threads})")
        return None
    return Cluster(address, memory=None if gigabytes is None else 1e9 * gigabytes, threads=threads, say=say)


def _address_in(file: Path) -> str:
    """Address of the scheduler that wrote a file."""
    try:
        content = json.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError) as problem:
        content = " ".join(str(problem).split())
    address = content.get("address") if isinstance(content, dict) else None
    if not isinstance(address, str) or not address:
        raise ClusterError(
            f"cluster file {file} must contain the address of a scheduler (got {shown(content)}); "
            f"`dask scheduler --scheduler-file {file}` writes it"
        )
    return address


def _asking(probe: str | None) -> Callable[[], dict[str, Any]]:
    """Function for a worker without this package: pickle sends a local function by its code."""

    def ask() -> dict[str, Any]:
        from pathlib import Path

        packages: dict[str, str] = {}
        try:
            import eigencontact

            packages = {"eigencontact": eigencontact.__version__}
            from eigencontact.engines.versions import versions

            packages = versions()
        except ImportError:  # it is not there, or a version without this module
            pass
        return {"versions": packages, "sees": probe is None or Path(probe).is_file()}

    return ask


def _limit(dask_worker: Any) -> float:
    return float(dask_worker.memory_manager.memory_limit or machine_bytes())


def _closed(client: Any) -> None:
    with suppress(Exception):  # of a scheduler that is gone
        client.close(timeout=5)
