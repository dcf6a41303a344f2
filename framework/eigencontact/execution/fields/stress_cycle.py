"""Stress of one cycle in a region of stored results, for fatigue criteria."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from eigencontact.core.array_types import FloatArray
from eigencontact.core.tensors import SQRT2
from eigencontact.errors import SceneError, nearest, shown
from eigencontact.plugin.fatigue import StressCycle
from eigencontact.results.cycles import OF_CYCLES, last_cycle
from eigencontact.scene.fatigue import elastic_constants

if TYPE_CHECKING:
    from eigencontact.results.stored import Results

__all__ = ["Cycle", "CycleOfRegion", "NewRegion", "StressAt", "cycle_of_region", "cycle_steps", "elastic_strain"]

#: Values that `cycle_steps` accepts.
Cycle = Literal["last", "all"] | tuple[int, int]
#: Function from step numbers to the name of a new region, and the results with this region by step number.
NewRegion = Callable[[list[int]], tuple[str, Mapping[int, Any]]]
#: Function from points, as of `CycleOfRegion.at`, to Mandel stress ``(steps, 6, n)``.
StressAt = Callable[[Any], FloatArray]


@dataclass(frozen=True, slots=True, eq=False)
class CycleOfRegion:
    """Stress of a cycle in a region.

    Attributes
    ----------
    region, body : str, int
        Name of the region, and the body that contains it.
    dims, shape : tuple
        Dimensions of its points in the results, and their sizes.
    places : (3, points)
        Coordinates x, y, z of the points [m].
    steps : tuple of int
        Numbers of the load steps of the cycle.
    at : callable
        Returns the stress, and the strain if requested, at some points: their indices, a slice or a mask.
    """

    region: str
    body: int
    dims: tuple[str, ...]
    shape: tuple[int, ...]
    places: FloatArray
    steps: tuple[int, ...]
    at: Callable[[Any], StressCycle]

    @property
    def cycle(self) -> StressCycle:
        """Stress and strain of all points, read anew."""
        return self.at(slice(None))


def cycle_steps(dataset: Results, cycle: Any) -> list[int]:
    """Positions along ``step`` of a cycle: the last closed one, all steps, or between two numbers of steps.

    Raises
    ------
    SceneError
        There is no closed cycle, or steps are not stored.
    """
    numbers = [int(number) for number in dataset["step"].values]
    if cycle == "all":
        return list(range(len(numbers)))
    if cycle == "last":
        scalars = {name: np.asarray(item.values) for name, item in dataset.data_vars.items() if name in OF_CYCLES}
        closed_cycle = last_cycle(scalars) or last_cycle(scalars, "twist")
        if closed_cycle is None:
            raise SceneError(
                "cycle must be given where the load history has no closed cycle (got 'last'); say 'all', or the "
                f"numbers of its first and last step within {numbers[0]} and {numbers[-1]}"
            )
        return list(range(closed_cycle.first, closed_cycle.last + 1))
    ends: Any = cycle if isinstance(cycle, list | tuple) and len(cycle) == 2 else (None, None)
    if not (all(end in numbers for end in ends) and ends[0] <= ends[1]):
        raise SceneError(
            f"cycle must be 'last', 'all', or two numbers of steps, the first before the last, within {numbers[0]} "
            f"and {numbers[-1]} (got {shown(cycle)})"
        )
    return list(range(numbers.index(ends[0]), numbers.index(ends[1]) + 1))


def cycle_of_region(
    dataset: Results,
    region: str | None,
    cycle: Any,
    *,
    strain: bool,
    new: NewRegion | None = None,
    computed: Callable[[str, list[int]], StressAt | None] = lambda _region, _steps: None,
) -> CycleOfRegion:
    """Stress, and optionally strain, over a cycle at the points of a region.

    Parameters
    ----------
    region : str, optional
        Name of a stored region, by default the only one with stress.
    cycle : str or (int, int)
        See `cycle_steps`.
    new : callable, optional
        Computes a missing region; returns its name and the results with it by step number.
    computed : callable, optional
        Receives the name of a stored region and the positions of the steps; returns the function that computes the
        stress there, or None if all steps of the region are stored.

    Raises
    ------
    SceneError
        The region has no stress, or strain is requested and the body is not elastic throughout and stores no strain.
    """
    steps = cycle_steps(dataset, cycle)
    if new is None:
        name = _stored_region(dataset, region)
        parts: Mapping[int, Any] = {0: dataset}
        rows = [(0, step) for step in steps]
    else:
        name, parts = new([int(dataset["step"][step]) for step in steps])
        rows = [(number, -1) for number in parts]
    compute = None if new is not None else computed(name, steps)
    first = parts[rows[0][0]]
    described = json.loads(first.attrs["regions"])[name]
    dims = tuple(f"{name}_{axis}" for axis in described["dims"])
    stored = f"{name}_strain" in first
    constants = None
    if strain and not stored:
        body = tomllib.loads(str(dataset.attrs["scene"])).get(f"body{described['body']}", {})
        materials = [item for item in ("inclusions", "layers") if item in dataset.attrs]
        constants = elastic_constants(body, materials, name)

    def at(points: Any) -> StressCycle:
        stress = _paths(parts, f"{name}_stress", rows, points) if compute is None else compute(points)
        if constants is not None:
            return StressCycle(stress=stress, strain=elastic_strain(stress, *constants))
        return StressCycle(stress=stress, strain=_paths(parts, f"{name}_strain", rows, points) if strain else None)

    return CycleOfRegion(
        region=name,
        body=int(described["body"]),
        dims=dims,
        shape=tuple(first.sizes[dim] for dim in dims),
        places=_places(first, name, list(described["dims"])),
        steps=tuple(int(dataset["step"][step]) for step in steps),
        at=at,
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
    trace = stress[:, 0] + stress[:, 1] + stress[:, 2]
    strain[:, :3] -= (poisson_ratio / young_modulus * trace)[:, None]
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


def _paths(parts: Mapping[int, Any], name: str, rows: Sequence[tuple[int, int]], points: Any) -> FloatArray:
    """Mandel vectors ``(steps, 6, points)`` of a field at some points, by part and step."""
    out = np.stack([np.asarray(parts[record][name][step].values).reshape(6, -1)[:, points] for record, step in rows])
    out[:, 3:] *= SQRT2
    return out


def _places(dataset: Any, name: str, dims: list[str]) -> FloatArray:
    sizes = [dataset.sizes[f"{name}_{axis}"] for axis in dims]
    out = []
    for axis in "xyz":
        values = np.asarray(dataset[f"{name}_{axis}"].values, dtype=float)
        if axis in dims:
            values = values.reshape([-1 if dim == axis else 1 for dim in dims])
        out.append(np.broadcast_to(values, sizes).ravel())
    return np.array(out)
