"""History fields of bodies, stored beside the steps for the next step and for fields in new regions.

The history of a step is a file of its own, so that a run can keep that of its last steps alone. Variables are
``<name>(history_step[, mandel], cells_<body>_z, cells_<body>_y, cells_<body>_x)`` with the centres of the cells as
coordinates (``finer_cells_<body>_z`` and so on for finer cells at inclusions), ``(history_step, y, x)`` in the cells
of a surface, or
``(history_step[, mandel][, density_<body>], inclusion_<body>)``; their role is ``history``. Six components are those of
a Mandel vector: shears times √2.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact.core.tensors import COMPONENTS
from eigencontact.results.layout import TEXT, Variable, axis_attributes, axis_coordinate, coordinate
from eigencontact.results.records import HistoryRecord, StepRecord

if TYPE_CHECKING:
    from pathlib import Path

__all__ = ["HISTORY_STEP", "history_name", "history_of", "history_variables"]

#: Dimension along which the steps lie whose history is kept.
HISTORY_STEP = "history_step"
_MANDEL = [name if name[0] == name[1] else f"sqrt2 {name}" for name in COMPONENTS]


def history_name(step: Path) -> Path:
    """File of the history that belongs to the file of a step."""
    return step.with_suffix(f".history{step.suffix}")


def history_of(file: Any, index: int) -> dict[str, HistoryRecord]:
    """History fields of bodies after a step, from an open file; empty if the file has none."""
    if HISTORY_STEP not in file:
        return {}
    steps = [int(step) for step in file[HISTORY_STEP][...]]
    if index not in steps:
        return {}
    records = {}
    for name, variable in file.items():
        if str(variable.attrs.get("role")) == "history":
            body = int(np.ravel(variable.attrs["body"])[0])  # an array of one in joined results
            by_density = "densities" in variable.attrs
            if by_density:
                coords = {}
            elif "surface" in variable.attrs:
                coords = {axis: file[axis][...] for axis in "yx"}
            else:
                cells = _cells(body, finer="finer" in variable.attrs)
                coords = {axis: file[place][...] for axis in "zyx" if (place := f"{cells}_{axis}") in file}
            values, points = variable[steps.index(index)], len(coords) or 1 + by_density
            records[name] = HistoryRecord(
                name=name,
                body=body,
                values=values.reshape(-1, *values.shape[values.ndim - points :]),
                coords=coords,
                unit=str(variable.attrs["units"]),
                meaning=str(variable.attrs["long_name"]),
                finer="finer" in variable.attrs,
            )
    return records


def history_variables(record: StepRecord) -> Iterator[Variable]:
    """Coordinates, and everything remembered, each once."""
    yield coordinate(HISTORY_STEP, [record.index], "step whose history is kept")
    if any(len(item.values) == len(_MANDEL) for item in record.history.values()):
        yield coordinate("mandel", np.array(_MANDEL, dtype=TEXT), "component of a Mandel vector")
    of_cells = {(item.body, item.finer): item.coords for item in record.history.values() if "z" in item.coords}
    on_surface = [item.coords for item in record.history.values() if item.coords and "z" not in item.coords]
    for (body, finer), coords in of_cells.items():
        for axis, values in coords.items():
            name = f"{_cells(body, finer=finer)}_{axis}"
            attrs = {**axis_attributes(axis), "long_name": f"centres of cells, {axis}"}
            yield Variable(name=name, dims=(name,), values=np.asarray(values, dtype=float), attrs=attrs)
    for axis, values in on_surface[0].items() if on_surface else ():
        yield axis_coordinate(axis, values)
    for item in record.history.values():
        yield _variable_of(item)


def _cells(body: int, *, finer: bool) -> str:
    """Beginning of the names of the coordinates of cells."""
    return f"finer_cells_{body}" if finer else f"cells_{body}"


def _variable_of(item: HistoryRecord) -> Variable:
    surface = bool(item.coords) and "z" not in item.coords
    prefix = "" if surface else f"{_cells(item.body, finer=item.finer)}_"
    points = [f"{prefix}{axis}" for axis in item.coords] or [f"inclusion_{item.body}"]
    values = np.asarray(item.values, dtype=float)
    by_density = not item.coords and values.ndim == 3
    if by_density:
        points = [f"density_{item.body}", *points]
    components = {1: [], len(_MANDEL): ["mandel"]}.get(len(values), [f"{item.name}_component"])
    attrs: dict[str, str | int] = {
        "role": "history", "units": item.unit, "long_name": item.meaning, "body": item.body,
        **({"surface": 1} if surface else {}), **({"finer": 1} if item.finer else {}),
        **({"densities": values.shape[1]} if by_density else {}),
    }  # fmt: skip
    values = values if components else values[0]
    return Variable(name=item.name, dims=(HISTORY_STEP, *components, *points), values=values[None], attrs=attrs)
