"""Straight path of a crack below a surface, and the stress of a cycle along it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact.core.array_types import FloatArray
from eigencontact.core.tensors import from_mandel
from eigencontact.core.units import readable
from eigencontact.errors import SceneError
from eigencontact.postprocess.stress_cycle import CycleOfRegion, cycle_of_region

if TYPE_CHECKING:
    from eigencontact.results.stored import Results

__all__ = ["CrackPath", "PathStress", "path_stress"]

#: Points of a path whose stress is found afresh, denser towards the mouth.
_POINTS = 97


@dataclass(frozen=True, slots=True)
class CrackPath:
    """Straight path from the surface, in a plane y.

    Attributes
    ----------
    x, y : float
        Mouth [m].
    angle : float
        Between path and inward normal [rad], positive towards +x.
    length : float
        Longest crack [m].
    """

    x: float
    y: float
    angle: float
    length: float

    def at(self, distances: FloatArray) -> tuple[FloatArray, FloatArray]:
        """X and z at distances from the mouth [m]."""
        return self.x + distances * np.sin(self.angle), distances * np.cos(self.angle)


@dataclass(frozen=True, slots=True, eq=False)
class PathStress:
    """Stress of a cycle along a path.

    Attributes
    ----------
    region : str
        Region from which it is read.
    body : int
        Body in which it lies.
    steps : tuple of int
        Numbers of the load steps.
    distances : (points,)
        Distances from the mouth [m], increasing.
    normal, shear : (steps, points)
        Stress across the path, and ``t . sigma . n``, see `eigencontact.halfspace.edge_crack` [Pa].
    """

    region: str
    body: int
    steps: tuple[int, ...]
    distances: FloatArray
    normal: FloatArray
    shear: FloatArray


def path_stress(
    dataset: Results, path: CrackPath, region: str | None, cycle: Any, source: Path | None, body: int
) -> PathStress:
    """Stress of a cycle along a path, from a stored section or computed at points of the path.

    Parameters
    ----------
    region : str or None
        Stored plane normal to y that holds the path; by default the stress is found at points of the path if `source`
        is stored, else the only region with stress is read.
    source : Path, optional
        Results file or folder.

    Raises
    ------
    SceneError
        A place outside the window; a path that leaves the region; a region that is no section; a cycle of one step.
    """
    for axis, place in (("x", path.x), ("y", path.y)):
        cells = np.asarray(dataset[axis].values)
        if cells.size > 1 and not abs(2 * place - cells[0] - cells[-1]) <= cells[-1] - cells[0] + 2 * (
            cells[1] - cells[0]
        ):
            raise SceneError(
                f"place must lie within the window, {axis} = {readable(float(cells[0]), 'm')} to "
                f"{readable(float(cells[-1]), 'm')} (got {readable(place, 'm')})"
            )
    if region is None and source is not None:
        distances = path.length * np.linspace(0.0, 1.0, _POINTS) ** 2
        x, z = path.at(distances)
        points = [[float(a), path.y, float(b)] for a, b in zip(x, z, strict=True)]
        table = {"name": "crack", "shape": "points", "points": points, "body": body, "quantities": []}
        cycle_stress = cycle_of_region(dataset, table, cycle, strain=False, source=source)
        stress = from_mandel(np.moveaxis(cycle_stress.cycle.stress, 1, 0))
    else:
        cycle_stress = cycle_of_region(dataset, region, cycle, strain=False, source=source)
        distances, stress = _in_section(cycle_stress, path)
    if len(cycle_stress.steps) < 2:
        raise SceneError(
            "cycle must have two load steps or more (got one): a single one has no range; store loading and unloading"
        )
    xx, _, zz, _, xz, _ = stress
    c, s = np.cos(path.angle), np.sin(path.angle)
    return PathStress(
        region=cycle_stress.region,
        body=cycle_stress.body,
        steps=cycle_stress.steps,
        distances=distances,
        normal=c * c * xx - 2 * s * c * xz + s * s * zz,
        shear=s * c * (zz - xx) + (s * s - c * c) * xz,
    )


def _in_section(section: CycleOfRegion, path: CrackPath) -> tuple[FloatArray, FloatArray]:
    """Distances, and stress (6, steps, points), linear between the points of a plane normal to y."""
    from scipy.interpolate import RegularGridInterpolator

    name = section.region
    if sorted(section.dims) != [f"{name}_x", f"{name}_z"]:
        raise SceneError(
            f"region must be a plane normal to y for a crack (got {name!r}, over {', '.join(section.dims)})"
        )
    x, y, z = (places.reshape(section.shape) for places in section.places)
    axes = (z[:, 0], x[0]) if section.dims[0].endswith("_z") else (z[0], x[:, 0])
    pitch = min(float(np.diff(axis).min()) for axis in axes)
    plane = float(y.flat[0])
    if abs(plane - path.y) > pitch:
        raise SceneError(
            f"place must lie in the plane of region {name!r}, y = {readable(plane, 'm')} (got y = "
            f"{readable(path.y, 'm')})"
        )
    distances = np.linspace(0.0, path.length, max(8, int(2 * path.length / pitch) + 1))
    coordinates = dict(zip("xz", path.at(distances), strict=True))
    for axis, values in zip("zx", axes, strict=True):
        low, high = values[0] - (axis == "z") * pitch, values[-1]
        if not low <= coordinates[axis].min() <= coordinates[axis].max() <= high * (1 + 1e-12):
            raise SceneError(
                f"path must stay within region {name!r}, {axis} = {readable(float(values[0]), 'm')} to "
                f"{readable(float(high), 'm')} (got {readable(float(coordinates[axis][-1]), 'm')} at its end); "
                "give a shorter length or a larger region"
            )
    points = np.stack(
        [np.clip(coordinates[axis], values[0], values[-1]) for axis, values in zip("zx", axes, strict=True)], axis=-1
    )
    grid = section.cycle.stress.reshape(-1, 6, *section.shape)
    grid = np.moveaxis(grid, (0, 1), (-1, -2))
    if not section.dims[0].endswith("_z"):
        grid = np.swapaxes(grid, 0, 1)
    values = RegularGridInterpolator(axes, grid)(points)  # (points, 6, steps)
    return distances, from_mandel(np.transpose(values, (1, 2, 0)))
