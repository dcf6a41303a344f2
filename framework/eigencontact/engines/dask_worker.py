"""What a worker of dask.distributed holds for one engine; imported on workers, and where a cluster is asked for."""

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

__all__ = ["MEMORY", "ONE", "THREADS", "Beginning", "perform"]

#: Resources of dask: one task of ours at a time in each worker, and the memory [bytes] and threads that it may take.
ONE, MEMORY, THREADS = "eigencontact", "eigencontact-memory", "eigencontact-threads"


class Beginning(WorkerPlugin):  # type: ignore[misc]
    """Makes a worker ready, also one that joins later: the same version, a folder that it sees, what its tasks share.

    Parameters
    ----------
    begin : callable
        Makes what the tasks of the worker share.
    seen : Path or None
        A file of the folder of results.
    """

    def __init__(self, begin: Callable[[Share], Any], seen: Path | None) -> None:
        self.held: Any = None
        self._begin, self._seen, self._versions = begin, seen, versions()

    async def setup(self, worker: Any) -> None:
        """Refuse a worker that is unlike this machine; else declare what it has."""
        if words := unlike(self._versions, versions()):
            raise ClusterError(f"worker {worker.address} {words}")
        if self._seen is not None and not self._seen.is_file():
            raise ClusterError(f"worker {worker.address} must see the folder {self._seen.parent}")
        memory = float(worker.memory_manager.memory_limit or machine_bytes())
        threads = worker.state.nthreads
        self.held = self._begin(Share(threads, memory))
        await worker.set_resources(**{ONE: 1, MEMORY: memory, THREADS: threads})

    def teardown(self, worker: Any) -> None:  # noqa: ARG002 - as dask calls it
        """Give up what was shared."""
        self.held = None


def perform(question: bytes, name: str) -> Any:
    """Perform a task in this worker: a function and its task, pickled, as a scheduler lacks what workers have."""
    function, task = loads(question)
    return function(task, get_worker().plugins[name].held)
