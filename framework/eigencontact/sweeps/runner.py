"""Running the variants of a sweep: one after the other, or several at a time, each in a process of its own.

What is finished stays finished: a folder that holds the results of the very same variant is read, not solved again.
What fails is told, and stops nothing.
"""

from __future__ import annotations

import json
from collections.abc import Generator, Iterator, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact.core.parallel import available_threads
from eigencontact.errors import EigencontactError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from eigencontact.sweeps.variants import Variant

__all__ = ["Outcome", "outcomes"]

#: Beside the results of a variant: the scene that they belong to, and what could not be done.
_MARK, _FAILED = "variant.json", "failed.json"


@dataclass(frozen=True)
class Outcome:
    """What came of one variant.

    Attributes
    ----------
    place : tuple of int
        That of the variant.
    summary : dict
        Contents of ``summary.json``; empty where the variant failed.
    fields : dict of str to array
        Chosen fields at the last step, and their coordinates ``x`` and ``y``.
    failed : str
        Why it failed.
    seconds : float
        Wall time [s].
    """

    place: tuple[int, ...]
    summary: dict[str, Any]
    fields: dict[str, NDArray[Any]]
    failed: str
    seconds: float


@dataclass(frozen=True)
class _Task:
    """What one process is asked for."""

    variant: Variant
    folder: Path | None
    fields: tuple[str, ...]
    threads: int | None


def outcomes(
    variants: Sequence[Variant], folder: Path | None, *, fields: Sequence[str] = (), workers: int = 1
) -> Iterator[Outcome]:
    """Outcome of each variant as it is finished.

    Parameters
    ----------
    variants : sequence of Variant
        What is run.
    folder : Path or None
        Each variant has a folder in it; None keeps nothing on disk.
    fields : sequence of str
        Surface fields to bring back.
    workers : int
        Processes; with one the variants are run in this one.
    """
    threads = None if workers == 1 else max(1, available_threads() // workers)
    tasks = [_Task(variant, None if folder is None else folder / variant.label, tuple(fields), threads)
             for variant in variants]  # fmt: skip
    if workers == 1:
        yield from map(_outcome, tasks)
        return
    lost = yield from _in_pool(tasks, workers)
    for task in lost:  # whose process died, or that of a neighbour: each again, alone, so that one takes no other along
        if (yield from _in_pool([task], 1)):
            yield Outcome(task.variant.place, {}, {}, "its process died, twice (of memory, or killed)", 0.0)


def _in_pool(tasks: Sequence[_Task], workers: int) -> Generator[Outcome, None, list[_Task]]:
    """Outcomes of tasks in processes; returns the tasks whose process died."""
    lost = list[_Task]()
    with ProcessPoolExecutor(min(workers, len(tasks)), mp_context=get_context("spawn")) as pool:
        running: dict[Future[Outcome], _Task] = {pool.submit(_outcome, task): task for task in tasks}
        try:
            for done in as_completed(running):
                try:
                    yield done.result()
                except BrokenProcessPool:
                    lost.append(running[done])
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise
    return lost


def _outcome(task: _Task) -> Outcome:
    """Run one variant, or read what it left."""
    began, variant = perf_counter(), task.variant
    summary: dict[str, Any] = {}
    fields: dict[str, Any] = {}
    failed = variant.refused
    try:
        if not failed:
            summary, fields = _computed(task)
    except (EigencontactError, MemoryError) as problem:
        failed = " ".join(str(problem).split()) or type(problem).__name__
    except Exception as problem:  # noqa: BLE001 - one variant must not take the others along, whatever it meets
        failed = f"{type(problem).__name__}: {' '.join(str(problem).split())}"
    if failed and task.folder is not None:
        task.folder.mkdir(parents=True, exist_ok=True)
        words = {"values": variant.values, "failed": failed}
        (task.folder / _FAILED).write_text(json.dumps(words, indent=2, default=str) + "\n", encoding="utf-8")
    return Outcome(variant.place, summary, fields, failed, perf_counter() - began)


def _computed(task: _Task) -> tuple[dict[str, Any], dict[str, Any]]:
    from eigencontact.afterwards import open_results
    from eigencontact.app import run

    scene, folder = task.variant.scene, task.folder
    assert scene is not None
    mark = json.dumps(scene.resolved(), sort_keys=True)
    if folder is not None and _holds(folder, mark):
        summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
        if not task.fields:
            return summary, {}
        with open_results(folder) as dataset:
            return summary, _chosen(dataset, task.fields)
    if task.threads is not None and scene.numerics.threads is None:
        numerics = scene.numerics.model_copy(update={"threads": task.threads})
        scene = scene.model_copy(update={"numerics": numerics})
    result = run(scene, folder, overwrite=folder is not None and folder.exists())
    fields = _chosen(result.dataset, task.fields) if task.fields else {}
    if folder is not None:
        if task.fields:
            result.dataset.close()
        (folder / _FAILED).unlink(missing_ok=True)
        (folder / _MARK).write_text(mark, encoding="utf-8")
    return result.summary, fields


def _holds(folder: Path, mark: str) -> bool:
    path = folder / _MARK
    return path.is_file() and (folder / "summary.json").is_file() and path.read_text(encoding="utf-8") == mark


def _chosen(dataset: Any, names: Sequence[str]) -> dict[str, Any]:
    """Surface fields at the last step."""
    from eigencontact.errors import ResultsError, nearest

    known = [str(name) for name, field in dataset.data_vars.items() if field.dims[-2:] == ("y", "x")]
    for name in names:
        if name not in known:
            raise ResultsError(
                f"field must be one of {', '.join(known)} (got {name!r}){nearest(name, known)}; fields of regions are "
                "in the results of each variant"
            )
    last = {name: dataset[name].isel(step=-1) if "step" in dataset[name].dims else dataset[name] for name in names}
    return {name: np.asarray(dataset[name]) for name in ("x", "y")} | {k: np.asarray(v) for k, v in last.items()}
