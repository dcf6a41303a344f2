"""Run the variants of a sweep in sequence, in several processes, or on a cluster.

A finished variant is read, not solved again: its folder says of which scene it is, and has checksums of its files. A
damaged one is computed again. A failed variant is reported and recorded; the others continue.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from eigencontact.core.kept import ObjectCache
from eigencontact.engines.cluster import Cluster
from eigencontact.engines.engine import DeadTask, Engine, Processes, Share, ThisProcess
from eigencontact.errors import EigencontactError
from eigencontact.results.atomic import read_json, replacing
from eigencontact.results.ownership import RESULTS, STEPS, SUMMARY, is_ours, refuse_foreign_file
from eigencontact.sweeps.folder import AGAIN, checksum, scene_digest

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from eigencontact.planning.plan import Plan
    from eigencontact.results.run_result import RunResult
    from eigencontact.sweeps.variants import Variant

__all__ = ["Outcome", "outcomes"]

#: File beside the results of a variant: the scene that they belong to, with checksums.
_MARK = "variant.json"
#: File with the reason why a variant has no results.
_FAILED = "failed.json"
#: Most memory of the objects that the variants of a process share [bytes].
_MOST_KEPT = 1e9
#: Largest part of the memory of a process for these objects.
_PART_KEPT = 0.1


class Measure(Protocol):
    """Further numbers of a run in memory, found in the process that ran it; its class is named in a module."""

    def planned(self, plan: Plan) -> Plan:
        """Plan with no more than the numbers need."""
        ...

    def numbers(self, plan: Plan, result: RunResult) -> Mapping[str, float]:
        """Numbers of the run of a plan, by name."""
        ...


@dataclass(frozen=True)
class Outcome:
    """Outcome of one variant.

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
    problem : str
        Damage of its earlier results, which were computed again.
    """

    place: tuple[int, ...]
    summary: dict[str, Any]
    fields: dict[str, NDArray[Any]]
    failed: str
    seconds: float
    problem: str = ""


@dataclass(frozen=True)
class _Task:
    """Task of one process."""

    variant: Variant
    folder: Path | None
    fields: tuple[str, ...]
    overwrite: bool
    measure: Measure | None = None


def outcomes(
    variants: Sequence[Variant],
    folder: Path | None,
    *,
    fields: Sequence[str] = (),
    workers: int = 1,
    engine: Engine | None = None,
    overwrite: bool = False,
    measure: Measure | None = None,
) -> Iterator[Outcome]:
    """Outcome of each variant in the order of completion.

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
    overwrite : bool
        Run finished variants again, and replace other results in their folders.
    measure : Measure, optional
        Further numbers of each run, which the summary then holds as those of an observer; without a folder only.
    """
    assert measure is None or folder is None
    engine = engine or (ThisProcess() if workers == 1 else Processes(workers))
    tasks = [
        _Task(
            variant, None if folder is None else (folder / variant.label).resolve(), tuple(fields), overwrite, measure
        )
        for variant in variants
    ]
    if isinstance(engine, Cluster):
        engine.folder = folder
    begin = _WorkerState.within
    if isinstance(engine, Cluster):
        from eigencontact.hooks.files import texts_of

        scenes = [variant.scene for variant in variants if variant.scene is not None]
        files = dict.fromkeys(path for scene in scenes for path in scene.plugin_files)
        begin = partial(_WorkerState.within, texts=texts_of(files))
    with engine:
        for task, outcome in engine.map(_outcome, tasks, begin):
            if isinstance(outcome, DeadTask):
                yield Outcome(task.variant.place, {}, {}, outcome.reason, 0.0)
            else:
                yield outcome


@dataclass(frozen=True)
class _WorkerState:
    """Shared data of the variants of one process: spectra of stress in regions, and the threads."""

    cache: ObjectCache
    threads: int | None

    @classmethod
    def within(cls, share: Share, texts: Mapping[str, str] | None = None) -> _WorkerState:
        """Set up shared data for a part of a machine; `texts` replace plugin files that it cannot read."""
        if texts is not None:
            from eigencontact.hooks.files import hold_texts

            hold_texts(texts)
        return cls(ObjectCache(min(_MOST_KEPT, _PART_KEPT * share.memory)), share.threads)


def _outcome(task: _Task, state: _WorkerState) -> Outcome:
    """Run one variant, or read its stored results."""
    began, variant = perf_counter(), task.variant
    summary: dict[str, Any] = {}
    fields: dict[str, Any] = {}
    failed, problem = variant.refused, ""
    try:
        if not failed:
            with state.cache.offered():
                summary, fields, problem = _computed(task, state.threads)
    except (EigencontactError, MemoryError) as refusal:
        failed = " ".join(str(refusal).split()) or type(refusal).__name__
    except Exception as refusal:  # noqa: BLE001 - one variant must not take the others along, whatever it meets
        failed = f"{type(refusal).__name__}: {' '.join(str(refusal).split())}"
    if failed and task.folder is not None and _is_of_sweep(task.folder, task):
        try:
            _record(task, failed)
        except (EigencontactError, OSError) as refusal:  # a full disk fails variants, and cannot hold the reason
            if str(refusal) not in failed:
                failed += f"; this reason is not recorded: {' '.join(str(refusal).split())}"
    return Outcome(variant.place, summary, fields, failed, perf_counter() - began, problem)


def _record(task: _Task, failed: str) -> None:
    """Record the reason of failure in the folder of a variant."""
    assert task.folder is not None
    task.folder.mkdir(parents=True, exist_ok=True)
    refuse_foreign_file(task.folder / _FAILED)
    content = {"scene_hash": None, "values": task.variant.values, "failed": failed}
    with replacing(task.folder / _FAILED, "the reason of a failed variant", lasting=False, consequence=AGAIN) as sink:
        sink.write((json.dumps(content, indent=2, default=str) + "\n").encode())


def _computed(task: _Task, threads: int | None) -> tuple[dict[str, Any], dict[str, Any], str]:
    """Summary and fields of a variant, and any damage of its earlier results; runs an unfinished variant."""
    from eigencontact.app import plan, run
    from eigencontact.postprocess.stored_run import open_results

    scene, folder = task.variant.scene, task.folder
    assert scene is not None
    problem, replaced = "", False
    if folder is not None:
        digest = scene_digest(scene)
        mark = {} if task.overwrite else read_json(folder / _MARK)
        if mark.get("scene_hash") == digest and isinstance(mark.get("checksums"), dict):
            problem = _damage(folder, mark)
            if not problem:
                summary = json.loads((folder / SUMMARY).read_text(encoding="utf-8"))
                if not task.fields:
                    return summary, {}, ""
                with open_results(folder) as dataset:
                    return summary, _last_fields(dataset, task.fields), ""
        replaced = _is_of_sweep(folder, task)
        if replaced:
            _record(task, "it was interrupted")
    if threads is not None and scene.numerics.threads is None:
        numerics = scene.numerics.model_copy(update={"threads": threads})
        scene = scene.model_copy(update={"numerics": numerics})
    planned = plan(scene)
    if task.measure is not None:
        planned = task.measure.planned(planned)
    result = run(planned, folder, overwrite=replaced)
    fields = _last_fields(result.dataset, task.fields) if task.fields else {}
    if folder is not None:
        if task.fields:
            result.dataset.close()
        content = {"scene_hash": digest, "checksums": {name: checksum(folder / name) for name in (RESULTS, SUMMARY)}}
        with replacing(folder / _MARK, "the mark of a finished variant", lasting=False, consequence=AGAIN) as sink:
            sink.write(json.dumps(content).encode())
        (folder / _FAILED).unlink(missing_ok=True)
    summary = result.summary
    if task.measure is not None:
        summary = {**summary, "observed": {**summary.get("observed", {}), **task.measure.numbers(planned, result)}}
    return summary, fields, problem


def _is_of_sweep(folder: Path, task: _Task) -> bool:
    """Whether the sweep may replace the results in a folder; results of other runs are protected."""
    marked = any(is_ours(folder / name) for name in (_MARK, _FAILED))
    return marked or task.overwrite or not any((folder / name).exists() for name in (RESULTS, STEPS))


def _damage(folder: Path, mark: Mapping[str, Any]) -> str:
    """Fault of the files of a finished variant as text; empty without a fault."""
    for name in (RESULTS, SUMMARY):
        path = folder / name
        if not path.is_file():
            return f"{path} was missing; the variant is computed again"
        if checksum(path) != mark["checksums"].get(name):
            return f"{path} was damaged (its checksum does not fit); the variant is computed again"
    return ""


def _last_fields(dataset: Any, names: Sequence[str]) -> dict[str, Any]:
    """Surface fields at the last step."""
    from eigencontact.errors import SceneError, nearest

    fields = [str(name) for name, field in dataset.data_vars.items() if field.dims[-2:] == ("y", "x")]
    for name in names:
        if name not in fields:
            raise SceneError(
                f"field must be one of {', '.join(fields)} (got {name!r}){nearest(name, fields)}; fields of regions "
                "are in the results of each variant"
            )
    last = {name: dataset[name].isel(step=-1) if "step" in dataset[name].dims else dataset[name] for name in names}
    return {name: np.asarray(dataset[name]) for name in ("x", "y")} | {k: np.asarray(v) for k, v in last.items()}
