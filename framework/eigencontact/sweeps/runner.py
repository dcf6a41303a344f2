"""Running the variants of a sweep: one after the other, in several processes, or on a cluster.

What is finished stays finished: a folder that holds the results of the very same variant is read, not solved again.
What fails is told, and stops nothing.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact.core.kept import Kept
from eigencontact.engines.cluster import Cluster
from eigencontact.engines.engine import Engine, Lost, Processes, Share, ThisProcess
from eigencontact.errors import EigencontactError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from eigencontact.sweeps.variants import Variant

__all__ = ["Outcome", "outcomes"]

#: Beside the results of a variant: the scene that they belong to, and what could not be done.
_MARK, _FAILED = "variant.json", "failed.json"
#: Memory of what the variants of a process share [bytes], and the part of its memory that it may be.
_MOST_KEPT, _PART_KEPT = 1e9, 0.1


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


def outcomes(
    variants: Sequence[Variant],
    folder: Path | None,
    *,
    fields: Sequence[str] = (),
    workers: int = 1,
    engine: Engine | None = None,
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
    engine : Engine, optional
        Who runs them instead, a cluster for one.
    """
    engine = engine or (ThisProcess() if workers == 1 else Processes(workers))
    tasks = [_Task(variant, None if folder is None else (folder / variant.label).resolve(), tuple(fields))
             for variant in variants]  # fmt: skip
    if isinstance(engine, Cluster):
        engine.folder = folder
    begin = _Held.within
    if isinstance(engine, Cluster):
        from eigencontact.hooks.files import texts_of

        scenes = [variant.scene for variant in variants if variant.scene is not None]
        files = dict.fromkeys(path for scene in scenes for path in scene.plugin_files)
        begin = partial(_Held.within, texts=texts_of(files))
    with engine:
        for task, answer in engine.map(_outcome, tasks, begin):
            if isinstance(answer, Lost):
                yield Outcome(task.variant.place, {}, {}, answer.reason, 0.0)
            else:
                yield answer


@dataclass(frozen=True)
class _Held:
    """What the variants of one process share: spectra of stress in regions, and the threads."""

    kept: Kept
    threads: int | None

    @classmethod
    def within(cls, share: Share, texts: Mapping[str, str] | None = None) -> _Held:
        """Make it, of a share of a machine, which may not see plugin files that scenes name: their `texts` by path."""
        if texts is not None:
            from eigencontact.hooks.files import hold_texts

            hold_texts(texts)
        return cls(Kept(min(_MOST_KEPT, _PART_KEPT * share.memory)), share.threads)


def _outcome(task: _Task, held: _Held) -> Outcome:
    """Run one variant, or read what it left."""
    began, variant = perf_counter(), task.variant
    summary: dict[str, Any] = {}
    fields: dict[str, Any] = {}
    failed = variant.refused
    try:
        if not failed:
            with held.kept.offered():
                summary, fields = _computed(task, held.threads)
    except (EigencontactError, MemoryError) as problem:
        failed = " ".join(str(problem).split()) or type(problem).__name__
    except Exception as problem:  # noqa: BLE001 - one variant must not take the others along, whatever it meets
        failed = f"{type(problem).__name__}: {' '.join(str(problem).split())}"
    if failed and task.folder is not None:
        task.folder.mkdir(parents=True, exist_ok=True)
        words = {"values": variant.values, "failed": failed}
        (task.folder / _FAILED).write_text(json.dumps(words, indent=2, default=str) + "\n", encoding="utf-8")
    return Outcome(variant.place, summary, fields, failed, perf_counter() - began)


def _computed(task: _Task, threads: int | None) -> tuple[dict[str, Any], dict[str, Any]]:
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
    if threads is not None and scene.numerics.threads is None:
        numerics = scene.numerics.model_copy(update={"threads": threads})
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
    from eigencontact.errors import SceneError, nearest

    known = [str(name) for name, field in dataset.data_vars.items() if field.dims[-2:] == ("y", "x")]
    for name in names:
        if name not in known:
            raise SceneError(
                f"field must be one of {', '.join(known)} (got {name!r}){nearest(name, known)}; fields of regions are "
                "in the results of each variant"
            )
    last = {name: dataset[name].isel(step=-1) if "step" in dataset[name].dims else dataset[name] for name in names}
    return {name: np.asarray(dataset[name]) for name in ("x", "y")} | {k: np.asarray(v) for k, v in last.items()}
