"""Stress of one cycle in a region of stored results, also in a region that the run did not have."""

from __future__ import annotations

import json
from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from eigencontact.errors import SceneError
from eigencontact.execution.fields.stress_cycle import CycleOfRegion, cycle_steps, elastic_strain
from eigencontact.execution.fields.stress_cycle import cycle_of_region as stored_cycle

if TYPE_CHECKING:
    from eigencontact.results.stored import Results

__all__ = ["CycleOfRegion", "cycle_of_region", "cycle_steps", "elastic_strain"]


def cycle_of_region(
    dataset: Results, region: str | Mapping[str, Any] | None, cycle: Any, *, strain: bool, source: Path | None
) -> CycleOfRegion:
    """Stress, and optionally strain, over a cycle at the points of a stored or of a new region.

    Parameters
    ----------
    region : str, mapping or None
        Name of a stored region, by default the only one with stress; or the table of a new one, evaluated at each step.
    source : Path, optional
        The results file, from which a new region is evaluated.

    Raises
    ------
    SceneError
        As of `eigencontact.execution.fields.stress_cycle.cycle_of_region`; a table for results without a file.
    """
    if region is None or (isinstance(region, str) and "=" not in region):
        return stored_cycle(dataset, region, cycle, strain=strain)
    return stored_cycle(dataset, None, cycle, strain=strain, new=partial(_new_region, region, source))


def _new_region(table: Any, source: Path | None, steps: list[int]) -> tuple[str, dict[int, Any]]:
    """Name of a region that the run did not have, and its results by step."""
    from eigencontact.postprocess.stored_run import region

    if source is None:
        raise SceneError("region must name one of the results where these are no folder (got a table)")
    parts = {step: region(source, table, step=step) for step in steps}
    return next(iter(json.loads(parts[steps[0]].attrs["regions"]))), parts
