"""Layout of a results file: names, dimensions, units and roles of its variables.

A stored step holds the same variables with one entry along ``step``; the results of a run are the steps joined.
Surface fields are ``<quantity>(step, y, x)``, scalars ``<name>(step)``, sub-surface fields
``<region>_<quantity>(step[, component | principal | axis], <region>_z, <region>_x ...)`` with coordinates
``<region>_x``, ``<region>_y``, ``<region>_z``. Stresses and strains are plain tensor components. Everything is SI.
"""

from __future__ import annotations

import json
from datetime import UTC, datetime
from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact.core.numbers import Number
from eigencontact.core.quantities import QUANTITIES, Quantity
from eigencontact.core.tensors import COMPONENTS
from eigencontact.errors import ResultsError
from eigencontact.results.borders import Variable, border_variables, line_variables

if TYPE_CHECKING:
    from collections.abc import Iterator

    from eigencontact.results.records import RegionRecord, RunInfo, StepRecord

__all__ = [
    "AXES", "FORMAT", "TEXT", "Variable", "attributes", "axis_attributes", "axis_coordinate", "coordinate",
    "described", "variables",
]  # fmt: skip

#: Value of the attribute ``format`` of every file of this layout.
FORMAT = "eigencontact-results-1"

#: Coordinates: unit and meaning.
AXES = {
    "x": Quantity("m", "x"),
    "y": Quantity("m", "y"),
    "z": Quantity("m", "depth below the surface, into the body"),
}
#: Dimension of a region's quantity before those of its points.
_LEADING = {"stress": ("component",), "strain": ("component",), "displacement": ("axis",), "principal": ("principal",)}
#: Places in the load history closer than this are one.
SAME_TIME = 1e-6
#: HDF5 strings of any length, as h5py.string_dtype() builds them.
TEXT = np.dtype("O", metadata={"vlen": str})


def attributes(info: RunInfo, record: StepRecord) -> dict[str, Any]:
    """Attributes of the whole file: conventions, provenance, and meanings of the variables."""
    from eigencontact import __version__

    described = {
        name: {
            "shape": region.shape,
            "body": region.body,
            "dims": list(region.dims),
            "fields": list(region.fields),
            "note": region.note,
            "mean_above": region.mean_above,
        }
        for name, region in record.regions.items()
    }
    return {
        "Conventions": "CF-1.8",
        "format": FORMAT,
        "title": info.title,
        "name": info.name,
        "source": f"eigencontact {__version__}",
        "eigencontact_version": __version__,
        "created": datetime.now(UTC).isoformat(timespec="seconds"),
        "references": "\n".join(info.references),
        "scene": info.scene_toml,
        "scene_hash": info.scene_hash,
        **_listed(info, "versions", "plan", "precisions"),
        **({} if info.contact_modulus is None else {"contact_modulus": info.contact_modulus}),
        "cell_size": np.array([info.grid.dx, info.grid.dy]),
        **({"line": 1} if info.grid.line else {}),
        "load_steps": info.steps,
        "regions": json.dumps(described),
        **_listed(info, "inclusions", "layers", "exposed_materials"),
        "prestrained": int(info.prestrained),
        "history": json.dumps(sorted(record.history)),
        "comment": "SI units; z points into the body; pressure positive in compression, stress positive in tension",
    }


def _listed(info: RunInfo, *names: str) -> dict[str, str]:
    return {name: info.texts[name] for name in names if name in info.texts}


def variables(info: RunInfo, record: StepRecord) -> list[Variable]:
    """Return all variables of one step, coordinates first.

    Raises
    ------
    ResultsError
        When two results would bear one name, a name holds a slash, or a field does not fit its grid.
    """
    listed = [*_coordinates(info, record), *_load_history(info, record), *_outlines(info)]
    listed += [*_surface(info, record), *_scalars(info, record)]
    if record.index == 1:  # the planes are the same in all steps: joined results take them from the first
        listed.extend(border_variables(info.sections))
    listed.extend(line_variables({name: line for name, line in info.lines.items() if name in record.regions}))
    for name, region in record.regions.items():
        listed.extend(_region(name, region))
    names = set(record.history)
    for variable in listed:
        if variable.name in names or "/" in variable.name or not variable.name:
            raise ResultsError(
                f"step {record.index}: name of a result must be unique and without '/' (got {variable.name!r}); "
                "rename the region or the number of the observer"
            )
        names.add(variable.name)
    return listed


def coordinate(name: str, values: Any, meaning: str, dim: str = "", unit: str = "1") -> Variable:
    """Coordinate along a dimension, by default with the name of the dimension."""
    attrs: dict[str, str | int] = {"role": "coordinate", "units": unit, "long_name": meaning}
    return Variable(name=name, dims=(dim or name,), values=np.asarray(values), attrs=attrs)


def axis_coordinate(axis: str, values: Any) -> Variable:
    """Coordinate of the cells of the surface along x or y."""
    return Variable(name=axis, dims=(axis,), values=values, attrs=axis_attributes(axis))


def _coordinates(info: RunInfo, record: StepRecord) -> Iterator[Variable]:
    yield coordinate("step", [record.index], "accepted step")
    yield coordinate("time", [record.time], "position in the load history, in load steps", "step")
    yield axis_coordinate("y", info.grid.y)
    yield axis_coordinate("x", info.grid.x)
    fields = {name for region in record.regions.values() for name in region.fields}
    if fields & {"stress", "strain"}:
        yield coordinate("component", np.array(COMPONENTS, dtype=TEXT), "component of stress or strain")
    if "displacement" in fields:
        yield coordinate("axis", np.array(["x", "y", "z"], dtype=TEXT), "direction")
    if "principal" in fields:
        yield coordinate("principal", [1, 2, 3], "principal stress, 1 is the largest")


def _load_history(info: RunInfo, record: StepRecord) -> Iterator[Variable]:
    """Cycle of a step, and path of sliding at its end, where the load history has some."""
    cycle, before = 0, 0
    for begin, ramps, repeat in info.cycles:
        if begin + SAME_TIME < record.time < begin + ramps * repeat + SAME_TIME:
            cycle = before + int(np.ceil((record.time - begin) / ramps - SAME_TIME))
        before += repeat
    if info.cycles:
        yield coordinate("load_cycle", [cycle], "cycle of the load history", "step")
    if info.sliding:
        path = np.interp([record.time], np.arange(len(info.sliding)), info.sliding)
        yield coordinate("sliding_path", path, "path that the surfaces slid all over the contact", "step", "m")


def _outlines(info: RunInfo) -> Iterator[Variable]:
    for region, segments in info.outlines.items():
        name = f"{region}_outline" if region else "outline"
        long_name = f"outline of inclusions on {region}" if region else "outline of inclusions seen from above"
        yield Variable(
            name=name,
            dims=(f"{name}_segment", "end", "place"),
            values=np.asarray(segments, dtype=float),
            attrs={"role": "outline", "units": "m", "long_name": long_name},
        )


def _surface(info: RunInfo, record: StepRecord) -> Iterator[Variable]:
    for name, values in record.fields.items():
        _fits(name, np.shape(values), info.grid.shape)
        attrs = {**described("field", QUANTITIES.get(name)), "coordinates": "time"}
        yield Variable(name=name, dims=("step", "y", "x"), values=np.asarray(values)[None], attrs=attrs)


def _scalars(info: RunInfo, record: StepRecord) -> Iterator[Variable]:
    listed = (("scalar", record.scalars, info.numbers), ("observed", record.observed, info.observed))
    for role, values, numbers in listed:
        ranks = {name: rank for rank, name in enumerate(numbers)}
        for name, value in values.items():
            number = numbers.get(name) or Number(name=name, unit="unknown", meaning=name)
            attrs = {"role": role, "rank": ranks.get(name, len(ranks)), **number.attributes(), "coordinates": "time"}
            yield Variable(name=name, dims=("step",), values=np.array([float(value)]), attrs=attrs)


def _region(name: str, region: RegionRecord) -> Iterator[Variable]:
    name_of = {axis: f"{name}_{axis}" for axis in (*region.coords, *region.dims)}
    for axis, values in region.coords.items():
        dims: tuple[str, ...] = ()
        if np.ndim(values) == 1:
            dims = (name_of[axis] if axis in region.dims else f"{name}_point",)
        attrs = {**axis_attributes(axis), "region": name}
        yield Variable(name=name_of[axis], dims=dims, values=np.asarray(values, dtype=float), attrs=attrs)
    coordinate_names = " ".join(["time", *(name_of[axis] for axis in region.coords if axis not in region.dims)])
    sizes = {axis: np.size(region.coords[axis]) for axis in region.dims if axis in region.coords}
    sizes["point"] = max((np.size(values) for values in region.coords.values()), default=1)
    grid = tuple(sizes[axis] for axis in region.dims)
    for quantity, values in region.fields.items():
        lead = _LEADING.get(quantity, ())
        _fits(f"{name}.{quantity}", np.shape(values), (*((6,) if lead == ("component",) else (3,) * len(lead)), *grid))
        attrs = {
            **described("region", QUANTITIES.get(quantity, Quantity("unknown", quantity))),
            "coordinates": coordinate_names,
            "region": name,
            "shape": region.shape,
            "body": region.body,
            **({"comment": region.note} if region.note else {}),
        }
        dims = ("step", *lead, *(name_of[axis] for axis in region.dims))
        yield Variable(name=f"{name}_{quantity}", dims=dims, values=np.asarray(values)[None], attrs=attrs)


def axis_attributes(axis: str) -> dict[str, str | int]:
    """Attributes of a coordinate along x, y or z by the CF conventions: its axis, and the downward direction of z."""
    down = {"positive": "down", "standard_name": "depth"} if axis == "z" else {}
    return {**described("coordinate", AXES[axis]), "axis": axis.upper(), **down}


def described(role: str, quantity: Quantity | None) -> dict[str, str | int]:
    """Attributes of a variable."""
    entry = quantity or Quantity("unknown", "no entry in the vocabulary of quantities")
    return {"role": role, "units": entry.unit, "long_name": entry.long_name}


def _fits(name: str, shape: tuple[int, ...], expected: tuple[int, ...]) -> None:
    if shape != expected:
        raise ResultsError(f"{name} must be of shape {expected} (got {shape}); the field does not fit its points")
