"""State of a dask.distributed worker for one engine; imported on workers and by the cluster engine."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from distributed import WorkerPlugin, get_worker
from distributed.protocol.pickle import loads

from eigencontact.core.memory import machine_bytes
from eigencontact.engines.engine import Share
from eigencontact.engines.versions import unlike, versions
from eigencontact.errors import ClusterError

__all__ = ["MEMORY", "TASK_SLOT", "THREADS", "Beginning", "perform"]

#: Resource of dask that gives each worker one task of ours at a time.
TASK_SLOT = "eigencontact"
#: Resource of dask: memory of a task [bytes].
MEMORY = "eigencontact-memory"
#: Resource of dask: threads of a task.
THREADS = "eigencontact-threads"


class Beginning(WorkerPlugin):  # type: ignore[misc]
    """Preparation of a worker, also of a late one: version check, visible folder, shared data of its tasks.

    Parameters
    ----------
    begin : callable
        Makes what the tasks of the worker share.
    seen : Path or None
        A file of the folder of results.
    """

    def __init__(self, begin: Callable[[Share], Any], probe: Path | None) -> None:
        self.state: Any = None
        self._begin, self._probe, self._versions = begin, probe, versions()

    async def setup(self, worker: Any) -> None:
        """Refuse a worker that is unlike this machine; else declare what it has."""
        if difference := unlike(self._versions, versions()):
            raise ClusterError(f"worker {worker.address} {difference}")
        if self._probe is not None and not self._probe.is_file():
            raise ClusterError(f"worker {worker.address} must have access to {self._probe.parent}")
        memory = float(worker.memory_manager.memory_limit or machine_bytes())
        threads = worker.state.nthreads
        self.state = self._begin(Share(threads, memory))
        await worker.set_resources(**{TASK_SLOT: 1, MEMORY: memory, THREADS: threads})

    def teardown(self, worker: Any) -> None:  # noqa: ARG002 - as dask calls it
        """Release the shared resources."""
        self.state = None


def perform(question: bytes, name: str) -> Any:
    """Perform a task in this worker: a pickled function and its task (a scheduler lacks the packages of workers)."""
    function, task = loads(question)
    return function(task, get_worker().plugins[name].state)
