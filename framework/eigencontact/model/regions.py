"""Requested stress regions as lattices of target points on, or between, the cells of a grid."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from eigencontact.core.array_types import FloatArray
from eigencontact.core.grid import Grid
from eigencontact.errors import SceneError, shown
from eigencontact.model.sizes import comfortable, cut_down, most, refuse_more
from eigencontact.scene.schema import StressRequest

__all__ = ["RegionLattice", "region_lattice", "surface_lattice"]


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
        """Split this lattice into lattices of the grid's pitch, each with its slices (y, x) of the points."""
        for j, i in np.ndindex(*self.finer):
            slices = (slice(j, None, self.finer[0]), slice(i, None, self.finer[1]))
            x, y = self.x[slices[1]], self.y[slices[0]]
            if not (x.size and y.size):
                continue
            first = [_snap(o + n / m) for o, n, m in zip(self.origin, (j, i), self.finer, strict=True)]
            origin = (first[0], first[1])
            yield slices, replace(self, target=(y.size, x.size), origin=origin, x=x, y=y, finer=(1, 1))

    @property
    def on_cells(self) -> bool:
        """Whether every point lies above or below a cell centre (parity then reduces the spectra)."""
        return all(value == round(value) for value in self.origin)

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of a field on the lattice: ``(nz, ny, nx)``, or ``(n,)`` for scattered points."""
        return (self.depths.size, *self.target) if self.points is None else (len(self.points),)

    @property
    def words(self) -> str:
        """Its size in words."""
        if self.points is not None:
            return f"{len(self.points)} points"
        return f"{self.target[1]} x {self.target[0]} points at {self.depths.size} depths"

    def flat_points(self, stride: int = 1) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Coordinates x, y, z of all points (or every n-th point) in the order of `shape`, each ``(n,)`` [m]."""
        if self.points is not None:
            x, y, z = self.points[::stride].T
            return x, y, z + 0.0  # a depth of -0.0 would be the other side of the surface
        number = np.arange(0, int(np.prod(self.shape)), stride)
        layer, row, column = np.unravel_index(number, self.shape)
        return self.x[column], self.y[row], self.depths[layer] + 0.0


def region_lattice(request: StressRequest, grid: Grid) -> RegionLattice:
    """Lattice of a request: planes and volumes follow the cells of the window; planes lie exactly at their position.

    Raises
    ------
    SceneError
        No points, or more than the memory of this machine can hold.
    """
    request = request if 1 in grid.bounded_axes else _in_plane(request)
    _refuse_many(request, grid)
    if request.shape in ("line", "points"):
        return RegionLattice(
            target=(0, 0), origin=(0.0, 0.0), x=np.empty(0), y=np.empty(0), depths=np.empty(0), points=_points(request)
        )
    depths = _depths(request)
    x, y, origin, finer = grid.x, grid.y, [0.0, 0.0], [1, 1]
    if request.start is not None or request.refinement is not None:
        finer = [request.refinement or 1 if axis in grid.bounded_axes else 1 for axis in (1, 0)]
        across, along = _spans(request, grid)
        (x, origin[1]), (y, origin[0]) = (
            _between(grid.x, grid.dx, finer[1], across), _between(grid.y, grid.dy, finer[0], along),
        )  # fmt: skip
    if request.shape == "plane" and request.normal == "x":
        x, finer[1] = np.array([request.at]), 1
        origin[1] = _snap((request.at - grid.x[0]) / grid.dx)
    if request.shape == "plane" and request.normal == "y":
        y, finer[0] = np.array([request.at]), 1
        origin[0] = _snap((request.at - grid.y[0]) / grid.dy)
    return RegionLattice(
        target=(y.size, x.size), origin=(origin[0], origin[1]), x=x, y=y, depths=depths, finer=(finer[0], finer[1])
    )


def _in_plane(request: StressRequest) -> StressRequest:
    """Request with all places at y = 0: fields in plane strain are the same for all y."""
    changes: dict[str, object] = {}
    if request.shape == "plane" and request.normal == "y":
        changes["position"] = 0.0
    for name in ("start", "end"):
        if (corner := getattr(request, name)) is not None:
            changes[name] = (corner[0], 0.0, corner[2])
    if request.points is not None:
        changes["points"] = [(x, 0.0, z) for x, _, z in request.points]
    return request.model_copy(update=changes)


def _spans(request: StressRequest, grid: Grid) -> list[tuple[int, int]]:
    """First and last of the points along x, and along y, numbered from the window's first; one across a plane."""
    low, high = request.start or (-np.inf, -np.inf, 0.0), request.end or (np.inf, np.inf, 0.0)
    normal = "xyz".index(request.normal) if request.shape == "plane" else None
    finer = request.refinement or 1
    return [
        (0, 0)  # the position counts
        if axis == normal or axis not in grid.bounded_axes
        else _span(first - 0.5 * pitch, pitch / finer, count * finer, (low[axis], high[axis]))
        for axis, (first, pitch, count) in enumerate(
            ((float(grid.x[0]), grid.dx, grid.nx), (float(grid.y[0]), grid.dy, grid.ny))
        )
    ]


def _span(begin: float, pitch: float, count: int, limits: tuple[float, float]) -> tuple[int, int]:
    """Numbers of the first and last refined cell with centres within the limits, which may lie outside the window."""
    low, high = limits
    first = int(np.ceil((low - begin) / pitch - 0.5 - 1e-6)) if np.isfinite(low) else 0
    stop = int(np.floor((high - begin) / pitch - 0.5 + 1e-6)) if np.isfinite(high) else count - 1
    if stop < first:
        raise SceneError(
            f"stress region must hold points (got none between {low:g} m and {high:g} m, {pitch:g} m apart); "
            "give start and end of a larger box, or a finer refinement"
        )
    return first, stop


def _between(axis: FloatArray, pitch: float, finer: int, span: tuple[int, int]) -> tuple[FloatArray, float]:
    """Centres of the refined cells of a span, and the position of the first in cells.

    They never lie on faces of cells; with an odd number to a cell the middles of the cells are among them.
    """
    numbers = np.arange(span[0], span[1] + 1) + 0.5
    return np.asarray(axis[0] - 0.5 * pitch + numbers * (pitch / finer)), _snap(numbers[0] / finer - 0.5)


def _refuse_many(request: StressRequest, grid: Grid) -> None:
    """Refuse more points than the memory permits; the message names the field with the number of points."""
    where = f"stress region {request.label!r}:"
    if request.shape in ("line", "points"):
        count = request.count if request.shape == "line" else len(request.points or [])
        refuse_more(count, f"{where} count", "points", shown(count), f"{comfortable()} would do")
        return
    across = [last - first + 1 for first, last in _spans(request, grid)]
    depths = _depth_count(request)
    count, finer, power = across[0] * across[1] * depths, request.refinement or 1, sum(n > 1 for n in across)
    if count <= most():
        return
    extent = f"{shown(across[0])} x {shown(across[1])} points at {shown(depths)} depths"
    if request.depth_max is not None and count // depths <= most():
        refuse_more(count, f"{where} depth-cells", "points", extent, f"{comfortable() // (count // depths)} would do")
    if count // finer**power <= most():
        advice = f"{max(1, int(cut_down(finer, count, power)))} is the most"
        refuse_more(count, f"{where} refinement", "points", extent, advice)
    refuse_more(count, f"{where} start and end", "points", extent, "ask for a smaller box, or a coarser refinement")


def surface_lattice(grid: Grid) -> RegionLattice:
    """Centres of the cells in z = 0."""
    return RegionLattice(target=grid.shape, origin=(0.0, 0.0), x=grid.x, y=grid.y, depths=np.zeros(1))


def _snap(value: float) -> float:
    """Round a position in cells to a whole number if it is one within round-off."""
    return float(round(value)) if abs(value - round(value)) < 1e-9 else float(value)


def _depth_count(request: StressRequest) -> int:
    if request.shape == "plane" and request.normal == "z":
        return 1
    return request.depth_steps + 1 if request.depths is None else len(request.depths)


def _depths(request: StressRequest) -> FloatArray:
    if request.shape == "plane" and request.normal == "z":
        return np.array([request.at])
    if request.depths is not None:
        return np.array(sorted(request.depths))
    assert request.depth_max is not None
    return np.linspace(0.0, request.depth_max, request.depth_steps + 1)


def _points(request: StressRequest) -> FloatArray:
    if request.shape == "points":
        return np.array(request.points, dtype=float)
    share = np.linspace(0.0, 1.0, request.count)[:, None]
    start, end = np.array(request.start, dtype=float), np.array(request.end, dtype=float)
    # What is constant stays exactly so: rounded, one depth would become several that differ in their last digits.
    return np.where(start == end, start, (1.0 - share) * start + share * end)
