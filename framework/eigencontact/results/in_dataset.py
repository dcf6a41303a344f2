"""A step read back from results that are a dataset in memory."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact.errors import SceneError, shown
from eigencontact.results.history import history_of
from eigencontact.results.records import StepRecord

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["step_of"]


class _Variable:
    """Variable of a dataset with the face of one in a file."""

    def __init__(self, array: xr.DataArray) -> None:
        self.attrs, self._array = array.attrs, array

    def __getitem__(self, place: Any) -> Any:
        """Values at a place."""
        return self._array.values[place]


def step_of(dataset: xr.Dataset, index: int | None = None) -> tuple[StepRecord, list[str]]:
    """Step of results, the last by default, with its surface fields and what the bodies remember after it.

    Returns
    -------
    StepRecord, list of str
        Without regions; and the names of what the bodies remember after a step, kept or not.

    Raises
    ------
    SceneError
        A step that the results do not hold.
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
