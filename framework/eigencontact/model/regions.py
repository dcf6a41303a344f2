"""Requested stress regions as lattices of target points on, or between, the cells of a grid."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.grid import Grid
from eigencontact.errors import SceneError
from eigencontact.scene.schema import StressRequest

__all__ = ["RegionLattice", "region_lattice", "surface_lattice"]

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True, slots=True)
class RegionLattice:
    """Target points of one region.

    Attributes
    ----------
    target : (int, int)
        Points along (y, x).
    origin : (float, float)
        First point relative to the grid's first cell, in cells along (y, x).
    x, y : (target[1],), (target[0],) [m]
    depths : (nz,) [m]
    points : (n, 3) [m] or None
        Scattered points (lines, lists) instead of a lattice.
    finer : (int, int)
        Points to an edge of the grid's cells along (y, x).
    """

    target: tuple[int, int]
    origin: tuple[float, float]
    x: FloatArray
    y: FloatArray
    depths: FloatArray
    points: FloatArray | None = None
    finer: tuple[int, int] = (1, 1)

    @property
    def shifted(self) -> Iterator[tuple[tuple[slice, slice], RegionLattice]]:
        """Lattices of the grid's own pitch that make up this one, and the part (y, x) of its points that each is."""
        for j, i in np.ndindex(*self.finer):
            part = (slice(j, None, self.finer[0]), slice(i, None, self.finer[1]))
            x, y = self.x[part[1]], self.y[part[0]]
            if not (x.size and y.size):
                continue
            first = [_whole(o + n / m) for o, n, m in zip(self.origin, (j, i), self.finer, strict=True)]
            origin = (first[0], first[1])
            yield part, replace(self, target=(y.size, x.size), origin=origin, x=x, y=y, finer=(1, 1))

    @property
    def on_cells(self) -> bool:
        """Whether every point lies above or below a cell centre (parity then packs the spectra)."""
        return all(value == round(value) for value in self.origin)

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of a field on it: ``(nz, ny, nx)``, or ``(n,)`` for scattered points."""
        return (self.depths.size, *self.target) if self.points is None else (len(self.points),)

    @property
    def words(self) -> str:
        """Its size in words."""
        if self.points is not None:
            return f"{len(self.points)} points"
        return f"{self.target[1]} x {self.target[0]} points at {self.depths.size} depths"

    def flat_points(self, every: int = 1) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Coordinates x, y, z of all points (or every so many of them) in the order of `shape`, each ``(n,)`` [m]."""
        if self.points is not None:
            x, y, z = self.points[::every].T
            return x, y, z + 0.0  # a depth of -0.0 would be the other side of the surface
        number = np.arange(0, int(np.prod(self.shape)), every)
        layer, row, column = np.unravel_index(number, self.shape)
        return self.x[column], self.y[row], self.depths[layer] + 0.0


def region_lattice(request: StressRequest, grid: Grid) -> RegionLattice:
    """Lattice of a request: planes and volumes follow the cells of the window, planes lie exactly where asked."""
    if request.shape in ("line", "points"):
        return RegionLattice(
            target=(0, 0), origin=(0.0, 0.0), x=np.empty(0), y=np.empty(0), depths=np.empty(0), points=_points(request)
        )
    depths = _depths(request)
    x, y, origin, finer = grid.x, grid.y, [0.0, 0.0], [1, 1]
    if request.start is not None or request.refinement is not None:
        low, high = request.start or (-np.inf, -np.inf, 0.0), request.end or (np.inf, np.inf, 0.0)
        if request.shape == "plane":  # along its normal the position counts
            low, high = _without(low, request.normal, -np.inf), _without(high, request.normal, np.inf)
        finer = [request.refinement or 1] * 2
        (x, origin[1]), (y, origin[0]) = (
            _between(axis, pitch, finer[0], low[n], high[n])
            for n, (axis, pitch) in enumerate(((grid.x, grid.dx), (grid.y, grid.dy)))
        )
    if request.shape == "plane" and request.normal == "x":
        x, finer[1] = np.array([request.at]), 1
        origin[1] = _whole((request.at - grid.x[0]) / grid.dx)
    if request.shape == "plane" and request.normal == "y":
        y, finer[0] = np.array([request.at]), 1
        origin[0] = _whole((request.at - grid.y[0]) / grid.dy)
    return RegionLattice(
        target=(y.size, x.size), origin=(origin[0], origin[1]), x=x, y=y, depths=depths, finer=(finer[0], finer[1])
    )


def _between(axis: FloatArray, pitch: float, finer: int, low: float, high: float) -> tuple[FloatArray, float]:
    """Middles of the cells' parts between limits, which may lie beyond the window, and the place of the first in cells.

    They never lie on faces of cells; with an odd number to a cell the middles of the cells are among them.
    """
    begin, part = axis[0] - 0.5 * pitch, pitch / finer
    first = int(np.ceil((low - begin) / part - 0.5 - 1e-6)) if np.isfinite(low) else 0
    stop = int(np.floor((high - begin) / part - 0.5 + 1e-6)) if np.isfinite(high) else axis.size * finer - 1
    if stop < first:
        raise SceneError(
            f"stress region must hold points (got none between {low:g} m and {high:g} m, {part:g} m apart); "
            "give start and end of a larger box, or a finer refinement"
        )
    numbers = np.arange(first, stop + 1) + 0.5
    return np.asarray(begin + numbers * part), _whole(numbers[0] / finer - 0.5)


def surface_lattice(grid: Grid) -> RegionLattice:
    """Centres of the cells in z = 0."""
    return RegionLattice(target=grid.shape, origin=(0.0, 0.0), x=grid.x, y=grid.y, depths=np.zeros(1))


def _without(ends: tuple[float, float, float], normal: str, value: float) -> tuple[float, float, float]:
    """Limits with no limit along one axis."""
    x, y, z = (value if axis == normal else end for axis, end in zip("xyz", ends, strict=True))
    return x, y, z


def _whole(value: float) -> float:
    """Snap a position in cells to a whole number where it is one up to round-off."""
    return float(round(value)) if abs(value - round(value)) < 1e-9 else float(value)


def _depths(request: StressRequest) -> FloatArray:
    if request.shape == "plane" and request.normal == "z":
        return np.array([request.at])
    if request.depths is not None:
        return np.array(sorted(request.depths))
    assert request.depth_max is not None
    return np.linspace(0.0, request.depth_max, request.depth_cells + 1)


def _points(request: StressRequest) -> FloatArray:
    if request.shape == "points":
        return np.array(request.points, dtype=float)
    share = np.linspace(0.0, 1.0, request.count)[:, None]
    start, end = np.array(request.start, dtype=float), np.array(request.end, dtype=float)
    return np.asarray((1.0 - share) * start + share * end)
