"""A look at another region of an old run: nothing is solved again.

The fields at any points follow from the tractions of a stored step and from what the bodies remember after it. The
scene is planned anew with that region alone, and the block of the region is given the stored step.
"""

from __future__ import annotations

import json
import tomllib
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from eigencontact.errors import ResultsError, SceneError, shown
from eigencontact.execution.regions import Region
from eigencontact.execution.step import Step
from eigencontact.hooks.registry import Registry
from eigencontact.planning.planner import make_plan
from eigencontact.planning.provenance import run_info
from eigencontact.results.records import RunInfo, StepRecord
from eigencontact.results.stepfile import names_remembered, read_attributes, read_history, read_step, stored_steps
from eigencontact.scene.schema import Scene

__all__ = ["region_table", "revisit"]


def region_table(text: str) -> dict[str, Any]:
    """Table of a region from the text of a TOML inline table, with or without its braces.

    Examples
    --------
    >>> region_table('shape = "plane", depth-max = "2 mm"')
    {'shape': 'plane', 'depth-max': '2 mm'}
    """
    inside = text.strip()
    inside = inside[1:-1] if inside.startswith("{") and inside.endswith("}") else inside
    try:
        return dict(tomllib.loads(f"region = {{{inside}}}")["region"])
    except (tomllib.TOMLDecodeError, RecursionError) as problem:
        raise SceneError(
            f'region must be a table like those of [[stress]], shape = "plane", depth-max = "1 mm" '
            f"(got {shown(text)}: {problem})"
        ) from None


def revisit(
    results: Path, region: Mapping[str, Any], registry: Registry, step: int | None = None
) -> tuple[RunInfo, StepRecord]:
    """Fields in a region after a stored step.

    Parameters
    ----------
    results : Path
        The results file of a finished run.
    region : mapping
        A table as of ``[[stress]]``.
    registry : Registry
        Plugins.
    step : int, optional
        Number of the step, from 1; the last by default.

    Returns
    -------
    RunInfo, StepRecord
        Of the same scene with that region alone; the record has no surface fields.

    Raises
    ------
    SceneError
        A region that is refused.
    ResultsError
        A step that is not stored, or whose history was not kept; a name that a stored region has; cells that the scene
        no longer stands for.
    """
    stored, steps = read_attributes(results), stored_steps(results)
    index = steps[-1] if step is None else step
    if index not in steps:
        raise ResultsError(
            f"step must be one that is stored in {results}, {steps[0]} to {steps[-1]} (got {shown(step)})"
        )
    scene = Scene(**{**tomllib.loads(str(stored["scene"])), "stress": [dict(region)], "observers": []})
    label = scene.stress[0].label
    if label in json.loads(stored["regions"]):
        raise ResultsError(f"region.name must differ from those that the run has stored (got {label!r}); give a name")
    plan = make_plan(scene, scene.known_plugins(registry))
    info = run_info(plan)
    _refuse_other_plugins(results, json.loads(stored["versions"]), info.versions)
    record = read_step(results, str(stored["scene_hash"]), index)
    history = read_history(results, str(stored["scene_hash"]), index)
    _refuse_other_window(results, record, plan.grid.shape)
    block = next(block for block in plan.blocks if isinstance(block, Region))
    lacking = sorted(block.requires - set(record.fields) - set(history))
    if lacking:
        kept = (
            ""
            if set(lacking) - set(names_remembered(results))
            else ("; it is kept after the last step alone, unless output.history = 'all'")
        )
        raise ResultsError(f"{results} must hold {', '.join(lacking)} of step {index} (got none){kept}")
    seen = Step(index=index, time=record.time, fields=dict(record.fields), history=history)
    block.start()
    block.advance(seen)
    scalars = {**record.scalars, **seen.scalars}
    return info, replace(record, scalars=scalars, fields={}, regions=seen.regions, observed={}, history={})


def _refuse_other_plugins(results: Path, before: Mapping[str, str], now: Mapping[str, str]) -> None:
    """A plugin file may have been written anew since the run: its fields would not be those of the run."""
    for name, origin in now.items():
        if " sha256:" in origin and before.get(name) != origin:
            raise ResultsError(
                f"{results} must be of the plugin file as it is now, {origin} (got {before.get(name, 'none')}); "
                "run the scene again"
            )


def _refuse_other_window(results: Path, record: StepRecord, shape: tuple[int, int]) -> None:
    for values in record.fields.values():
        if np.shape(values) != shape:
            raise ResultsError(
                f"{results} must be of the window that its scene stands for now, {shape[1]} x {shape[0]} cells (got "
                f"{np.shape(values)[1]} x {np.shape(values)[0]}); run the scene again"
            )
