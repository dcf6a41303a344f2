"""A look at another region of an old run: nothing is solved again.

The fields at any points follow from the tractions of a stored step and from what the bodies remember after it. The
scene is planned anew with that region alone, and the block of the region is given the stored step.
"""

from __future__ import annotations

import json
import tomllib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from eigencontact.core.bulk import recorded_bulk
from eigencontact.errors import ResultsError, SceneError, shown
from eigencontact.execution.blocks.block import Run
from eigencontact.execution.blocks.step import Step
from eigencontact.execution.fields.regions import Region
from eigencontact.hooks.registry import OF_FILE, Registry
from eigencontact.planning.plan import Plan
from eigencontact.planning.planner import make_plan
from eigencontact.planning.provenance import run_info
from eigencontact.results.atomic import of_this_version
from eigencontact.results.records import RunInfo, StepRecord
from eigencontact.results.stepfile import names_remembered, read_attributes, read_history, read_step, stored_steps
from eigencontact.scene.inline_table import inline_table
from eigencontact.scene.schema import Scene

__all__ = ["look", "plan_of_region", "region_table", "revisit"]


def region_table(text: str) -> dict[str, Any]:
    """Table of a region from the text of a TOML inline table, with or without its braces.

    Examples
    --------
    >>> region_table('shape = "plane", depth-max = "2 mm"')
    {'shape': 'plane', 'depth-max': '2 mm'}
    """
    return inline_table(text, 'region must be a table like those of [[stress]], shape = "plane", depth-max = "1 mm"')


def revisit(
    results: Path, region: Mapping[str, Any], registry: Registry, step: int | None = None
) -> tuple[RunInfo, StepRecord]:
    """Fields in a region, a table as of ``[[stress]]``, after a stored step, by its number from 1; the last by default.

    Returns what holds for a run of the same scene with that region alone, and a record without surface fields.

    Raises
    ------
    SceneError
        A region that is refused, a name that a stored region has, or a step that is not stored.
    ResultsError
        A step whose history was not kept; cells that the scene no longer stands for; damaged results.
    """
    stored, steps = read_attributes(results), stored_steps(results)
    index = steps[-1] if step is None else step
    if index not in steps:
        raise SceneError(f"step must be one that is stored in {results}, {steps[0]} to {steps[-1]} (got {shown(step)})")
    with of_this_version(results):
        tables = tomllib.loads(str(stored["scene"]))
        regions, versions = json.loads(stored["regions"]), dict(json.loads(stored["versions"]))
    plan = plan_of_region(tables, region, registry, regions)
    info = run_info(plan)
    _refuse_other_plugins(results, versions, info.versions)
    record = read_step(results, str(stored["scene_hash"]), index)
    history = read_history(results, str(stored["scene_hash"]), index)
    return info, look(plan, replace(record, history=history), str(results), names_remembered(results))


def plan_of_region(
    tables: Mapping[str, Any], region: Mapping[str, Any], registry: Registry, stored: Iterable[str] = ()
) -> Plan:
    """Plan of a solved scene with a single region, whose name must not be `stored`.

    Raises
    ------
    SceneError, ResultsError
        See `revisit`.
    """
    scene = Scene(**{**tables, "stress": [dict(region)], "observers": [], "fatigue": []})
    label = scene.stress[0].label
    if label in stored:
        raise SceneError(f"region.name must differ from those that the run has stored (got {label!r}); give a name")
    return make_plan(scene, scene.known_plugins(registry))


def look(plan: Plan, record: StepRecord, where: str, remembered: Sequence[str] = ()) -> StepRecord:
    """Fields in the region of a plan (`plan_of_region`) after a step, from its surface fields and history.

    `where` names the origin of the step in messages, `remembered` what the bodies remember after a step, kept or not.
    Errors are those of `revisit`.
    """
    _refuse_other_window(where, record, plan.grid.shape)
    block = next(block for block in plan.blocks if isinstance(block, Region))
    lacking = sorted(block.requires - set(record.fields) - set(record.history))
    if lacking:
        remedy = "" if set(lacking) - set(remembered) else (
            "; it is kept after the last step alone, unless output.history = 'all'"
        )  # fmt: skip
        raise ResultsError(f"{where} must hold {', '.join(lacking)} of step {record.index} (got none){remedy}")
    bulk = recorded_bulk(record.scalars)
    evaluated_step = Step(
        index=record.index, time=record.time, bulk=(bulk, bulk), fields=dict(record.fields),
        history=dict(record.history),
    )  # fmt: skip
    Run().started(block.start).advance(evaluated_step)
    scalars = {**record.scalars, **evaluated_step.scalars}
    return replace(record, scalars=scalars, fields={}, regions=evaluated_step.regions, observed={}, history={})


def _refuse_other_plugins(results: Path, run_origins: Mapping[str, str], origins: Mapping[str, str]) -> None:
    """Refuse plugin files that changed since the run, because their fields would differ from those of the run."""
    for name, origin in origins.items():
        if f" {OF_FILE}" in origin and run_origins.get(name) != origin:
            raise ResultsError(
                f"{results} must be of the plugin file as it is now, {origin} (got {run_origins.get(name, 'none')}); "
                "run the scene again"
            )


def _refuse_other_window(results: str, record: StepRecord, shape: tuple[int, int]) -> None:
    for values in record.fields.values():
        if np.shape(values) != shape:
            raise ResultsError(
                f"{results} must be of the window that its scene stands for now, {shape[1]} x {shape[0]} cells (got "
                f"{np.shape(values)[1]} x {np.shape(values)[0]}); run the scene again"
            )
