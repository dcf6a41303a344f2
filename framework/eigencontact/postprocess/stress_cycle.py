"""Stress of one cycle in a region of stored results, for fatigue criteria."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from eigencontact.core.array_types import FloatArray
from eigencontact.core.tensors import to_mandel
from eigencontact.errors import SceneError, nearest, shown
from eigencontact.plugin.fatigue import StressCycle
from eigencontact.results.cycles import last_cycle

if TYPE_CHECKING:
    from eigencontact.results.stored import Results

__all__ = ["CycleOfRegion", "cycle_of_region", "cycle_steps", "elastic_strain"]

#: What `cycle_steps` accepts.
Cycle = Literal["last", "all"] | tuple[int, int]


@dataclass(frozen=True, slots=True, eq=False)
class CycleOfRegion:
    """Stress of a cycle in a region.

    Attributes
    ----------
    region, body : str, int
        Name of the region, and the body in which it lies.
    dims, shape : tuple
        Dimensions of its points as of results, and their sizes.
    places : (3, points)
        x, y, z of the points [m].
    steps : tuple of int
        Numbers of the load steps of the cycle.
    cycle : StressCycle
        Its stress, and strain if it was asked for.
    """

    region: str
    body: int
    dims: tuple[str, ...]
    shape: tuple[int, ...]
    places: FloatArray
    steps: tuple[int, ...]
    cycle: StressCycle


def cycle_steps(dataset: Results, cycle: Any) -> list[int]:
    """Positions along ``step`` of a cycle: the last closed one, all steps, or between two numbers of steps.

    Raises
    ------
    SceneError
        No closed cycle; steps that are not stored.
    """
    numbers = [int(number) for number in dataset["step"].values]
    if cycle == "all":
        return list(range(len(numbers)))
    if cycle == "last":
        scalars = {
            name: np.asarray(item.values)
            for name, item in dataset.data_vars.items()
            if tuple(item.dims) == ("step",) and np.asarray(item.values).dtype.kind == "f"
        }
        found = last_cycle(scalars) or last_cycle(scalars, "twist")
        if found is None:
            raise SceneError(
                "cycle must be given where the load history has no closed cycle (got 'last'); say 'all', or the "
                f"numbers of its first and last step within {numbers[0]} and {numbers[-1]}"
            )
        return list(range(found.first, found.last + 1))
    ends: Any = cycle if isinstance(cycle, list | tuple) and len(cycle) == 2 else (None, None)
    if not (all(end in numbers for end in ends) and ends[0] <= ends[1]):
        raise SceneError(
            f"cycle must be 'last', 'all', or two numbers of steps, the first before the last, within {numbers[0]} "
            f"and {numbers[-1]} (got {shown(cycle)})"
        )
    return list(range(numbers.index(ends[0]), numbers.index(ends[1]) + 1))


def cycle_of_region(
    dataset: Results, region: str | Mapping[str, Any] | None, cycle: Any, *, strain: bool, source: Path | None
) -> CycleOfRegion:
    """Stress, and strain if it is asked for, over a cycle at the points of a region.

    Parameters
    ----------
    region : str, mapping or None
        Name of a stored region, by default the only one with stress; or the table of a new one, found at each step.
    cycle : str or (int, int)
        See `cycle_steps`.
    source : Path, optional
        The results file, from which a new region is found.

    Raises
    ------
    SceneError
        A region without stress; strain of a body that is not elastic throughout and did not store it.
    """
    steps = cycle_steps(dataset, cycle)
    if region is None or (isinstance(region, str) and "=" not in region):
        name = _stored_region(dataset, region)
        parts: Any = {0: dataset}
        rows = [(0, step) for step in steps]
    else:
        name, parts = _new_region(region, [int(dataset["step"][step]) for step in steps], source)
        rows = [(number, -1) for number in parts]
    first = parts[rows[0][0]]
    described = json.loads(first.attrs["regions"])[name]
    dims = tuple(f"{name}_{axis}" for axis in described["dims"])
    stress = np.stack([_field(parts[part], f"{name}_stress", step) for part, step in rows])
    strains = None
    if strain and f"{name}_strain" in first:
        strains = np.stack([_field(parts[part], f"{name}_strain", step) for part, step in rows])
    elif strain:
        strains = elastic_strain(stress, *_constants(dataset, int(described["body"]), name))
    return CycleOfRegion(
        region=name,
        body=int(described["body"]),
        dims=dims,
        shape=tuple(first.sizes[dim] for dim in dims),
        places=_places(first, name, list(described["dims"])),
        steps=tuple(int(dataset["step"][step]) for step in steps),
        cycle=StressCycle(stress=stress, strain=strains),
    )


def elastic_strain(stress: FloatArray, young_modulus: float, poisson_ratio: float) -> FloatArray:
    """Elastic strain of isotropic bodies, Mandel vectors ``(steps, 6, points)``.

    Examples
    --------
    >>> tension = np.array([1e6, 0, 0, 0, 0, 0]).reshape(1, 6, 1)
    >>> elastic_strain(tension, 1e11, 0.3)[0, :3, 0].round(9).tolist()
    [1e-05, -3e-06, -3e-06]
    """
    strain = (1.0 + poisson_ratio) / young_modulus * stress
    strain[:, :3] -= poisson_ratio / young_modulus * stress[:, :3].sum(axis=1, keepdims=True)
    return np.asarray(strain)


def _stored_region(dataset: Results, region: str | None) -> str:
    names = [name for name in json.loads(dataset.attrs["regions"]) if f"{name}_stress" in dataset]
    if region is None and len(names) == 1:
        return str(names[0])
    if region not in names:
        listed = ", ".join(map(repr, names)) or "none; give the table of a new one"
        hint = nearest(region, names) if region else ""
        raise SceneError(f"region must name one with stress: {listed} (got {shown(region)}){hint}")
    return str(region)


def _new_region(region: Any, steps: list[int], source: Path | None) -> tuple[str, dict[int, Any]]:
    """Name of a region that the run did not have, and its results by step."""
    from eigencontact.postprocess.stored_run import region as found_region

    if source is None:
        raise SceneError("region must name one of the results where these are no folder (got a table)")
    parts = {step: found_region(source, region, step=step) for step in steps}
    return next(iter(json.loads(parts[steps[0]].attrs["regions"]))), parts


def _field(dataset: Any, name: str, step: int) -> FloatArray:
    """Mandel vectors ``(6, points)``."""
    return to_mandel(np.asarray(dataset[name][step].values, dtype=float).reshape(6, -1))


def _places(dataset: Any, name: str, dims: list[str]) -> FloatArray:
    sizes = [dataset.sizes[f"{name}_{axis}"] for axis in dims]
    out = []
    for axis in "xyz":
        values = np.asarray(dataset[f"{name}_{axis}"].values, dtype=float)
        if axis in dims:
            values = values.reshape([-1 if other == axis else 1 for other in dims])
        out.append(np.broadcast_to(values, sizes).ravel())
    return np.array(out)


def _constants(dataset: Results, body: int, region: str) -> tuple[float, float]:
    """Young's modulus and Poisson's ratio of a body that is elastic throughout."""
    table = tomllib.loads(str(dataset.attrs["scene"])).get(f"body{body}", {})
    table = {name.replace("_", "-"): value for name, value in table.items()}
    names = ("young-modulus", "poisson-ratio")
    others = [name for name in table if name not in (*names, "rigid")]
    others += [name for name in ("inclusions", "layers") if name in dataset.attrs]
    if others or not all(isinstance(table.get(name), int | float) for name in names):
        raise SceneError(
            f"region {region!r} must store its strain where the body is not elastic and of one material (got "
            f'{", ".join(others) or "a body without constants"}); run with fields = ["stress", "strain"] in its table'
        )
    return float(table[names[0]]), float(table[names[1]])
