"""One accepted step in one file: written whole, read back whole, checked for damage."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact.errors import ResultsError
from eigencontact.results.atomic import DAMAGE, open_hdf5, reason, replacing
from eigencontact.results.history import history_name, history_of, write_history
from eigencontact.results.layout import FORMAT, attributes, create, variables
from eigencontact.results.records import HistoryRecord, RegionRecord, RunInfo, StepRecord

if TYPE_CHECKING:
    from pathlib import Path

__all__ = ["names_remembered", "read_attributes", "read_history", "read_step", "stored_steps", "write_step"]


def write_step(path: Path, info: RunInfo, record: StepRecord) -> None:
    """Store one step atomically, and before it, in a file beside it, what the bodies remember after it.

    Raises
    ------
    ResultsError
        When it cannot be stored; nothing is left behind then.
    """
    listed = variables(info, record)
    if record.history:
        write_history(history_name(path), info, record)
    with replacing(path, f"step {record.index}") as sink, open_hdf5(sink, "w") as file:
        for variable in listed:
            create(file, variable)
        file.attrs.update(attributes(info, record))


def read_attributes(path: Path) -> dict[str, Any]:
    """Attributes of a file of ours.

    Raises
    ------
    ResultsError
        When the file is damaged or not ours.
    """
    try:
        with open_hdf5(path, "r") as file:
            found = dict(file.attrs)
    except DAMAGE as error:
        raise ResultsError(_refusal(path, "complete", reason(error))) from error
    if found.get("format") != FORMAT:
        raise ResultsError(_refusal(path, f"of format {FORMAT!r}", str(found.get("format"))))
    if not isinstance(found.get("scene_hash"), str):
        raise ResultsError(_refusal(path, "complete", "no hash of its scene"))
    return found


def stored_steps(path: Path) -> list[int]:
    """Indices of the steps in a results file.

    Raises
    ------
    ResultsError
        When the file is damaged.
    """
    try:
        with open_hdf5(path, "r") as file:
            return [int(index) for index in file["step"][...]]
    except DAMAGE as error:
        raise ResultsError(_refusal(path, "complete", reason(error))) from error


def read_step(path: Path, scene_hash: str, index: int) -> StepRecord:
    """Read one step back from its own file or from the results of a run, without its history.

    Raises
    ------
    ResultsError
        When the file is damaged, not ours, of another scene, or does not hold that step.
    """
    found = _attributes_of(path, scene_hash)
    try:
        with open_hdf5(path, "r") as file:
            steps = [int(step) for step in file["step"][...]]
            if index not in steps:
                raise ResultsError(_refusal(path, f"holding step {index}", f"steps {steps}"))
            return _record(file, index, steps.index(index), json.loads(found["regions"]))
    except DAMAGE as error:
        raise ResultsError(_refusal(path, "complete", reason(error))) from error


def read_history(path: Path, scene_hash: str, index: int) -> dict[str, HistoryRecord]:
    """Read what the bodies remembered after a step, from beside the file of the step or from the results of a run.

    Empty where they remember nothing, or where it was not kept.

    Raises
    ------
    ResultsError
        When the file is damaged, not ours or of another scene.
    """
    beside = history_name(path)
    source = beside if beside.exists() else path
    _attributes_of(source, scene_hash)
    try:
        with open_hdf5(source, "r") as file:
            return history_of(file, index)
    except DAMAGE as error:
        raise ResultsError(_refusal(source, "complete", reason(error))) from error


def names_remembered(path: Path) -> list[str]:
    """Names of what bodies remember after a stored step, kept or not."""
    return [str(name) for name in json.loads(read_attributes(path).get("history", "[]"))]


def _attributes_of(path: Path, scene_hash: str) -> dict[str, Any]:
    found = read_attributes(path)
    if found["scene_hash"] != scene_hash:
        raise ResultsError(_refusal(path, "of this scene", f"scene hash {found['scene_hash']}"))
    return found


def _record(file: Any, index: int, at: int, described: dict[str, Any]) -> StepRecord:
    kept: dict[str, dict[str, Any]] = {"field": {}, "scalar": {}, "observed": {}}
    for name, variable in file.items():
        role = str(variable.attrs.get("role"))  # the dimensions of joined results have none
        if role in kept:
            value = variable[at]
            # A quantity that this step did not have is stored as NaN throughout when steps are joined.
            if "_FillValue" not in variable.attrs or not np.all(np.isnan(value)):
                kept[role][name] = value if role == "field" else float(value)
    regions = {}
    for name, region in described.items():
        coords = {axis: file[f"{name}_{axis}"] for axis in "xyz" if f"{name}_{axis}" in file}
        regions[name] = RegionRecord(
            name=name,
            shape=region["shape"],
            body=region["body"],
            dims=tuple(region["dims"]),
            coords={axis: v[...] if v.shape else float(v[()]) for axis, v in coords.items()},
            fields={quantity: file[f"{name}_{quantity}"][at] for quantity in region["fields"]},
            note=region.get("note", ""),
        )
    return StepRecord(
        index=index,
        time=float(file["time"][at]),
        scalars=kept["scalar"],
        fields=kept["field"],
        regions=regions,
        observed=kept["observed"],
    )


def _refusal(path: Path, rule: str, got: str) -> str:
    return f"{path} must be a results file {rule} (got: {got}); it is not used"
