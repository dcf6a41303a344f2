"""Perform the tasks of a cross-check on a cluster that dask.distributed knows (extra ``cluster``)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path

from eigencontact.engines.cluster import Cluster
from eigencontact.engines.engine import DeadTask, Share
from eigencontact_verification.crosscheck.worker import Outcome, Task, perform

__all__ = ["on_cluster"]


def on_cluster(
    tasks: Sequence[Task], *, engine: Cluster, plugins: Sequence[str] = ()
) -> Iterator[tuple[Task, Outcome]]:
    """Perform tasks on the workers of a cluster; yields them as they finish.

    Parameters
    ----------
    tasks : sequence of Task
        The same packages must be installed on the workers.
    engine : Cluster
        Its limits of memory are those that its workers were started with: a worker that passes them is ended by its
        nanny, and the task is reported as failed, with the words of dask, when it has ended several.
    plugins : sequence of str
        Plugin files that the cases name; the workers get their texts.
    """
    from eigencontact.hooks.files import texts_of

    with engine:
        for task, answer in engine.map(_performed, tasks, partial(_begin, texts=texts_of(map(Path, plugins)))):
            yield task, Outcome(status="failed", reason=answer.reason) if isinstance(answer, DeadTask) else answer


def _performed(task: Task, _: None) -> Outcome:
    return perform(task)


def _begin(_: Share, *, texts: Mapping[str, str]) -> None:
    """Let a worker know plugin files by their texts, and none that an earlier cross-check had sent."""
    from eigencontact.hooks.files import hold_texts
    from eigencontact.scene.installed import add_plugin_files, installed_plugins

    installed_plugins.cache_clear()
    hold_texts(texts)
    add_plugin_files(texts)
