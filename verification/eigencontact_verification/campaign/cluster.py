"""Perform the tasks of a campaign on a cluster that dask.distributed knows (extra ``cluster``)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from eigencontact.engines.cluster import Cluster
from eigencontact.engines.engine import Lost, Share
from eigencontact_verification.campaign.worker import Outcome, Task, perform

__all__ = ["on_cluster"]


def on_cluster(tasks: Sequence[Task], *, engine: Cluster) -> Iterator[tuple[Task, Outcome]]:
    """Perform tasks on the workers of a cluster; yields them as they finish.

    Parameters
    ----------
    tasks : sequence of Task
        The same packages must be installed on the workers.
    engine : Cluster
        Its limits of memory are those that its workers were started with: a worker that passes them is ended by its
        nanny, and the task is reported as failed, with the words of dask, when it has ended several.
    """
    with engine:
        for task, answer in engine.map(_performed, tasks, _nothing):
            yield task, Outcome(status="failed", reason=answer.reason) if isinstance(answer, Lost) else answer


def _performed(task: Task, _: None) -> Outcome:
    return perform(task)


def _nothing(_: Share) -> None:
    return
