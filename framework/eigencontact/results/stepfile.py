"""One accepted step in one file: written whole, read back whole, checked for damage; or one of a dataset in memory.

Functions that read a file raise `ResultsError` when it is damaged, not ours, or of another scene where one is given,
or does not hold the step.
"""

from __future__ import annotations

import json
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact.errors import ResultsError, SceneError, shown
from eigencontact.results.atomic import DAMAGE, reason, replacing
from eigencontact.results.history import history_name, history_of, history_variables
from eigencontact.results.layout import FORMAT, attributes, variables
from eigencontact.results.part import StoredPart, open_part, part_of, write_part
from eigencontact.results.records import HistoryRecord, RegionRecord, RunInfo, StepRecord

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    import xarray as xr

__all__ = [
    "history_part",
    "names_remembered",
    "read_attributes",
    "read_history",
    "read_step",
    "step_of",
    "step_part",
    "stored_rows",
    "stored_steps",
    "write_step",
]


def step_part(info: RunInfo, record: StepRecord, *, copied: bool = True) -> StoredPart:
    """Build a step for joining, in memory; raises `ResultsError` like `eigencontact.results.layout.variables`."""
    return part_of(attributes(info, record), variables(info, record), copied=copied)


def history_part(info: RunInfo, record: StepRecord, *, copied: bool = True) -> StoredPart:
    """History fields of the bodies after a step, in memory."""
    return part_of(_marked(info), list(history_variables(record)), copied=copied)


def write_step(path: Path, info: RunInfo, record: StepRecord, *, lasting: bool = True) -> None:
    """Store one step atomically, after a separate file with the history of the bodies.

    `lasting` is that of `eigencontact.results.atomic.replacing`. `ResultsError` when it cannot be stored; nothing is
    left behind then.
    """
    listed = variables(info, record)
    if record.history:
        with replacing(history_name(path), f"the history of step {record.index}", lasting=lasting) as sink:
            write_part(sink, _marked(info), list(history_variables(record)))
    with replacing(path, f"step {record.index}", lasting=lasting) as sink:
        write_part(sink, attributes(info, record), listed)


def _marked(info: RunInfo) -> dict[str, str]:
    return {"format": FORMAT, "scene_hash": info.scene_hash}


def read_attributes(path: Path) -> dict[str, Any]:
    """Attributes of a file of ours."""
    with _opened(path) as file:
        return dict(file.attrs)


def stored_steps(path: Path) -> list[int]:
    """Indices of the steps in a results file."""
    with _opened(path) as file:
        return [int(index) for index in file["step"][...]]


def stored_rows(path: Path) -> list[dict[str, Any]]:
    """Numbers of each step in a file by name; NaN where a step has none."""
    with _opened(path) as file:
        roles = {name: str(variable.attrs.get("role")) for name, variable in file.items()}
        names = ["step", "time", *(name for name, role in roles.items() if role in ("scalar", "observed"))]
        columns = [file[name][...] for name in names]
    return [dict(zip(names, row, strict=True)) for row in zip(*columns, strict=True)]


def read_step(path: Path, scene_hash: str, index: int) -> StepRecord:
    """Read one step, without its history, from its own file or from the results of a run."""
    with _opened(path, scene_hash) as file:
        steps = [int(step) for step in file["step"][...]]
        if index not in steps:
            raise ResultsError(_refusal(path, f"holding step {index}", f"steps {steps}"))
        return _record(file, index, steps.index(index), json.loads(file.attrs["regions"]))


def read_history(path: Path, scene_hash: str, index: int) -> dict[str, HistoryRecord]:
    """Read the history of the bodies after a step, from its own file or from the results of a run.

    Empty where they remember nothing, or where it was not kept.
    """
    history_path = history_name(path)
    with _opened(history_path if history_path.exists() else path, scene_hash) as file:
        return history_of(file, index)


def names_remembered(path: Path) -> list[str]:
    """Names of the history fields after a stored step."""
    return [str(name) for name in json.loads(read_attributes(path).get("history", "[]"))]


@contextmanager
def _opened(path: Path, scene_hash: str | None = None) -> Iterator[Any]:
    """Open a file of this program, and optionally of this scene; reports damaged files."""
    try:
        with open_part(path) as file:
            file_format, stored_hash = file.attrs.get("format"), file.attrs.get("scene_hash")
            if file_format != FORMAT:
                raise ResultsError(_refusal(path, f"of format {FORMAT!r}", str(file_format)))
            if not isinstance(stored_hash, str):
                raise ResultsError(_refusal(path, "complete", "no hash of its scene"))
            if scene_hash not in (None, stored_hash):
                raise ResultsError(_refusal(path, "of this scene", f"scene hash {stored_hash}"))
            yield file
    except DAMAGE as error:
        raise ResultsError(_refusal(path, "complete", reason(error))) from error


def _record(file: Any, index: int, at: int, described: dict[str, Any]) -> StepRecord:
    by_role: dict[str, dict[str, Any]] = {"field": {}, "scalar": {}, "observed": {}}
    for name, variable in file.items():
        role = str(variable.attrs.get("role"))  # the dimensions of joined results have none
        if role in by_role:
            value = variable[at]
            # A quantity that this step did not have is stored as NaN throughout when steps are joined.
            if "_FillValue" not in variable.attrs or not np.all(np.isnan(value)):
                by_role[role][name] = value if role == "field" else float(value)
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
            note=region["note"],
            mean_above=region["mean_above"],
        )
    return StepRecord(
        index=index,
        time=float(file["time"][at]),
        scalars=by_role["scalar"],
        fields=by_role["field"],
        regions=regions,
        observed=by_role["observed"],
    )


def _refusal(path: Path, rule: str, content: str) -> str:
    return f"{path} must be a results file {rule} (got: {content}); it is not used"


class _Variable:
    """Variable of a dataset with the face of one in a file."""

    def __init__(self, array: xr.DataArray) -> None:
        self.attrs, self._array = array.attrs, array

    def __getitem__(self, place: Any) -> Any:
        """Values at a place."""
        return self._array.values[place]


def step_of(dataset: xr.Dataset, index: int | None = None) -> tuple[StepRecord, list[str]]:
    """Step of results, the last by default, with its surface fields and the history of the bodies.

    The record has no regions; the names of what the bodies remember after a step, kept or not, come with it.
    `SceneError` for a step that the results do not hold.
    """
    steps = [int(step) for step in dataset["step"].values]
    number = steps[-1] if index is None else index
    if number not in steps:
        raise SceneError(f"step must be one that was solved, {steps[0]} to {steps[-1]} (got {shown(index)})")
    at = steps.index(number)
    fields, scalars = dict[str, Any](), dict[str, Any]()
    for name, variable in dataset.data_vars.items():
        role = variable.attrs.get("role")
        if role in ("field", "scalar") and not np.all(np.isnan(values := variable.values[at])):
            (fields if role == "field" else scalars)[str(name)] = values
    record = StepRecord(
        index=number,
        time=float(dataset["time"][at]),
        scalars={name: float(value) for name, value in scalars.items()},
        fields=fields,
        history=history_of({name: _Variable(dataset[name]) for name in dataset.variables}, number),
    )
    return record, [str(name) for name in json.loads(dataset.attrs.get("history", "[]"))]
