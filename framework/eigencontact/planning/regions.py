"""Requested stress regions as lattices of target points on, or between, the cells of a grid."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.grid import Grid
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
    """

    target: tuple[int, int]
    origin: tuple[float, float]
    x: FloatArray
    y: FloatArray
    depths: FloatArray
    points: FloatArray | None = None

    @property
    def on_cells(self) -> bool:
        """Whether every point lies above or below a cell centre (parity then packs the spectra)."""
        return all(value == round(value) for value in self.origin)

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of a field on it: ``(nz, ny, nx)``, or ``(n,)`` for scattered points."""
        return (self.depths.size, *self.target) if self.points is None else (len(self.points),)

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
    x, y, origin = grid.x, grid.y, [0.0, 0.0]
    if request.shape == "plane" and request.normal == "x":
        x = np.array([request.position])
        origin[1] = _whole((request.position - grid.x[0]) / grid.dx)
    if request.shape == "plane" and request.normal == "y":
        y = np.array([request.position])
        origin[0] = _whole((request.position - grid.y[0]) / grid.dy)
    return RegionLattice(target=(y.size, x.size), origin=(origin[0], origin[1]), x=x, y=y, depths=depths)


def surface_lattice(grid: Grid) -> RegionLattice:
    """Centres of the cells in z = 0."""
    return RegionLattice(target=grid.shape, origin=(0.0, 0.0), x=grid.x, y=grid.y, depths=np.zeros(1))


def _whole(value: float) -> float:
    """Snap a position in cells to a whole number where it is one up to round-off."""
    return float(round(value)) if abs(value - round(value)) < 1e-9 else float(value)


def _depths(request: StressRequest) -> FloatArray:
    if request.shape == "plane" and request.normal == "z":
        return np.array([request.position])
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
