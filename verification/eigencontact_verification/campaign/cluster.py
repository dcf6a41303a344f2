"""Perform the tasks of a campaign on a cluster that dask.distributed knows (extra ``cluster``)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from eigencontact_verification.campaign.worker import Outcome, Task, perform

__all__ = ["on_cluster"]


def on_cluster(tasks: Sequence[Task], *, client: Any) -> Iterator[tuple[Task, Outcome]]:
    """Perform tasks on the workers of a cluster; yields them as they finish.

    Parameters
    ----------
    tasks : sequence of Task
        The same packages must be installed on the workers.
    client : distributed.Client
        Connected to the scheduler. Limits of memory are those that its workers were started with: a worker that passes
        them is ended by its nanny, and the task is reported as failed, with the words of dask.
    """
    from distributed import as_completed

    futures = {client.submit(perform, task, pure=False, retries=0): task for task in tasks}
    for future in as_completed(futures):
        task = futures[future]
        problem = future.exception()
        if problem is None:
            yield task, future.result()
        else:
            yield task, Outcome(status="failed", reason=" ".join(f"{type(problem).__name__}: {problem}".split()))
        future.release()
