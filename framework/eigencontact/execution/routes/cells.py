"""Routes from the eigenstrain in a box of cells: planes, volume, columns of points, points finer than the cells."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cached_property, reduce
from operator import add
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.array_types import FloatArray
from eigencontact.core.grid import Grid
from eigencontact.execution.blocks.block import Cost
from eigencontact.execution.blocks.precision import Precision, plane_round_off, settled, volume_round_off
from eigencontact.execution.routes.route import CellRoute, HalfSpace, Pace
from eigencontact.model.boxes import CellBox
from eigencontact.model.regions import RegionLattice
from eigencontact.solvers.cells import Cells

__all__ = ["Between", "CloseUp", "Columns", "Planes", "Volume", "cheapest"]


#: Largest number of surface positions with separate sums for each column of points: each takes about 0.3 s and 20 MB
#: for 35 000 cells.
_PLACES = 256
#: Number of surface positions with a predicted cost of their own; further positions count with the mean.
_PRICED = 16
#: Allowed number of extra cell centres for interpolation, relative to the cells of the box.
_ROOM = 64


class Planes(CellRoute):
    """Transforms in the plane, for each depth and each layer of cells."""

    #: Name of the method, which distinguishes its operators from those of other methods.
    name: ClassVar[str] = ""
    steps: ClassVar[bool] = True

    def round_off(self) -> float | None:
        """Relative round-off of the operator in single precision; None if it exists only in double."""
        return plane_round_off()

    @cached_property
    def _settled(self) -> tuple[HalfSpace, tuple[Precision, ...]]:
        numerics, precisions = settled(self.half_space.numerics, f"{self.quantity} by cells{self.name}", self.round_off)
        return replace(self.half_space, numerics=numerics), precisions

    @property
    def precisions(self) -> Sequence[Precision]:
        """See `PlanItem`."""
        return self._settled[1]

    @property
    def precision(self) -> str:
        """Precision of the operator."""
        return self._settled[0].numerics.precision

    @cached_property
    def pace(self) -> Pace:
        """Time and memory of the kernels."""
        return Pace.of(self._settled[0], self.quantity)

    @property
    def words(self) -> str:
        """See `Route.words`."""
        return f"{self.box.words}, FFT in the plane, layer by layer"

    @property
    def cost(self) -> Cost:
        """See `Route.cost`."""
        lattice = self.lattice
        return self.pace.planes(
            self.box.lattice, lattice.target, self.origin, lattice.depths.size, len(self.rows)
        )  # fmt: skip

    @property
    def origin(self) -> tuple[float, float]:
        """First point relative to the first cell, in cells along (y, x)."""
        first = self.box.lattice.first
        return self.lattice.origin[0] - first[1], self.lattice.origin[1] - first[2]

    @cached_property
    def _operator(self) -> Any:
        return self.planes(self.lattice.target, self.origin, self.lattice.depths)

    def planes(self, target: tuple[int, int], origin: tuple[float, float], depths: FloatArray) -> Any:
        """Operator for any planes."""
        from eigencontact.solvers.eigenstrain_planes import PlaneFields

        return PlaneFields(
            self.half_space.cell,
            self.box.cells(self.half_space.grid),
            target=target,
            origin=origin,
            depths=depths + 0.0,  # a depth of -0.0 would be the other side of the surface
            components=self.rows,
            precision=self.precision,
            applications=self.half_space.steps,
            **self.half_space.options(self.quantity),
        )

    def field(self, eigenstrain: FloatArray) -> FloatArray:
        """See `Route.field`."""
        return np.asarray(self._operator.apply(eigenstrain), dtype=float)


class Volume(Planes):
    """Route by transforms in space, for planes at the spacing of the cell layers; the surface separately."""

    name = ", in space"

    @property
    def words(self) -> str:
        """See `Route.words`."""
        return f"{self.box.words}, FFT in space"

    def round_off(self) -> float:
        """See `Planes.round_off`."""
        grid, inner = self.half_space.grid, _below(self.lattice.depths)
        depths = float(inner[0]), inner.size
        return volume_round_off(self.half_space, self.quantity, (grid.dx, grid.dy), self.box.lattice, depths)

    @staticmethod
    def fits(lattice: RegionLattice, height: float) -> bool:
        """Whether a lattice has two or more planes below the surface, one cell height apart."""
        inner = _below(lattice.depths)
        return inner.size > 1 and bool(np.allclose(np.diff(inner), height, rtol=1e-6, atol=0.0))

    @property
    def cost(self) -> Cost:
        """See `Route.cost`."""
        lattice, inner = self.lattice, _below(self.lattice.depths)
        total = self.pace.volume(self.box.lattice, lattice.target, self.origin, inner.size)
        if inner.size < lattice.depths.size:
            total += self.pace.planes(self.box.lattice, lattice.target, self.origin, 1, len(self.rows))
        return total

    @cached_property
    def _below_surface(self) -> Any:
        from eigencontact.solvers.eigenstrain import VolumeField

        lattice, inner = self.lattice, _below(self.lattice.depths)
        cells = self.box.cells(self.half_space.grid)
        target = Cells(
            first=(float(lattice.x[0]), float(lattice.y[0]), float(inner[0])),
            pitch=cells.pitch,
            shape=(inner.size, *lattice.target),
        )
        return VolumeField(
            self.half_space.cell,
            cells,
            target,
            precision=self.precision,
            applications=self.half_space.steps,
            **self.half_space.options(self.quantity),
        )

    @cached_property
    def _surface(self) -> Any:
        if _below(self.lattice.depths).size == self.lattice.depths.size:
            return None
        return self.planes(self.lattice.target, self.origin, np.zeros(1))

    def field(self, eigenstrain: FloatArray) -> FloatArray:
        """See `Route.field`."""
        out = np.empty(self.shape)
        if self._surface is not None:
            out[:, :1] = self._surface.apply(eigenstrain)
        out[:, self.lattice.depths.size - _below(self.lattice.depths).size :] = self._below_surface.apply(eigenstrain)[
            list(self.rows)
        ]
        return out


class Columns(Planes):
    """Route point by point; points above each other share a computation."""

    @property
    def words(self) -> str:
        """See `Route.words`."""
        return f"{self.box.words}, point by point"

    @property
    def cost(self) -> Cost:
        """See `Route.cost`."""
        count = len(self._columns)
        depths = -(-len(self._points) // count)
        sample = self._columns[:: -(-count // _PRICED)]
        # For a position in the middle, the cells are symmetric; it stores a quarter of the spectra.
        prices = [
            self.pace.planes(self.box.lattice, (1, 1), self._offset(column), depths, len(self.rows))
            for column in sample
        ]
        return reduce(add, prices).times(count / len(sample))

    @property
    def _points(self) -> FloatArray:
        assert self.lattice.points is not None
        return self.lattice.points

    @cached_property
    def _columns(self) -> list[NDArray[np.intp]]:
        """Indices of the points above each other, for every position on the surface."""
        _, column = np.unique(self._points[:, :2], axis=0, return_inverse=True)
        order = np.argsort(column.ravel(), kind="stable")
        return np.split(order, np.flatnonzero(np.diff(column.ravel()[order])) + 1)

    @cached_property
    def _operators(self) -> list[Any]:
        return [self.planes((1, 1), self._offset(where), self._points[where, 2]) for where in self._columns]

    def _offset(self, where: NDArray[np.intp]) -> tuple[float, float]:
        """Position (y, x) of a column relative to the first cell, in cells."""
        cells = self.box.cells(self.half_space.grid)
        (x0, y0, _), (dx, dy, _) = cells.first, cells.pitch
        x, y = self._points[where[0], :2]
        return float((y - y0) / dy), float((x - x0) / dx)

    def field(self, eigenstrain: FloatArray) -> FloatArray:
        """See `Route.field`."""
        out = np.empty(self.shape)
        for where, operator in zip(self._columns, self._operators, strict=True):
            out[:, where] = operator.apply(eigenstrain)[:, :, 0, 0]
        return out


class Between(Planes):
    """Route for many scattered points: interpolation of the field at cell centres around them, and on the surface."""

    note = "what eigenstrain causes is linear between the middles of its cells"
    steps = False

    @property
    def words(self) -> str:
        """See `Route.words`."""
        return f"{self._middles.words}, then linear between the middles"

    @property
    def cost(self) -> Cost:
        """See `Route.cost`."""
        return self._middles.cost

    @property
    def precisions(self) -> Sequence[Precision]:
        """See `PlanItem`."""
        return self._middles.precisions

    @staticmethod
    def fits(lattice: RegionLattice, box: CellBox, grid: Grid) -> bool:
        """Whether there are fewer cell centres around the points than points."""
        if lattice.points is None or len(np.unique(lattice.points[:, :2], axis=0)) <= _PLACES:
            return False
        return int(np.prod(_about(lattice.points, box, grid).shape)) <= _ROOM * box.lattice.cells

    @cached_property
    def _middles(self) -> Planes:
        assert self.lattice.points is not None
        lattice = _about(self.lattice.points, self.box, self.half_space.grid)

        def make(kind: type[Planes]) -> Planes:
            return kind(self.half_space, self.box, self.quantity, lattice, self.rows)

        return cheapest(make, lattice, self.box.lattice.edges[0])

    def field(self, eigenstrain: FloatArray) -> FloatArray:
        """See `Route.field`."""
        from scipy.interpolate import RegularGridInterpolator

        axes = (self._middles.lattice.depths, self._middles.lattice.y, self._middles.lattice.x)
        values = np.moveaxis(self._middles.field(eigenstrain), 0, -1)
        assert self.lattice.points is not None
        places = [
            np.clip(place, axis[0], axis[-1]) for place, axis in zip(self.lattice.points.T[::-1], axes, strict=True)
        ]
        return np.asarray(RegularGridInterpolator(axes, values)(np.stack(places, axis=-1)).T)


def _about(points: FloatArray, box: CellBox, grid: Grid) -> RegionLattice:
    """Cell centres around points, two or more along each axis, and the surface if it is nearer than a centre."""
    cells = box.cells(grid)
    low, high = (
        round_off((end - cells.first) / np.array(cells.pitch)).astype(int)
        for end, round_off in ((points.min(axis=0), np.floor), (points.max(axis=0), np.ceil))
    )
    high = np.maximum(high, low + 1)
    x, y, z = (
        first + pitch * np.arange(start, stop + 1)
        for first, pitch, start, stop in zip(cells.first, cells.pitch, low, high, strict=True)
    )
    if z[0] <= 0.0:
        z = np.append(0.0, z[z > 0.0])
    _, row, column = box.lattice.first
    return RegionLattice(
        target=(y.size, x.size), origin=(float(row + low[1]), float(column + low[0])), x=x, y=y, depths=z
    )  # fmt: skip


class CloseUp(Planes):
    """Route for points finer than the cells; its operators are used once, in double precision."""

    def round_off(self) -> None:
        """See `Planes.round_off`."""

    @property
    def words(self) -> str:
        """See `Route.words`."""
        my, mx = self.lattice.finer
        return f"{self.box.words}, {mx} x {my} points to a cell, seen from above"

    @property
    def cost(self) -> Cost:
        """See `Route.cost`."""
        count = self.lattice.finer[0] * self.lattice.finer[1]
        transform = self.pace.volume(self.box.lattice, self.lattice.target, (0.5, 0.5), self.lattice.depths.size)
        return Cost(transform.memory, 0.0, transform.seconds_once + count * transform.seconds_per_step)

    def field(self, eigenstrain: FloatArray) -> FloatArray:
        """See `Route.field`."""
        from eigencontact.solvers.close_up import close_up

        lattice, cells = self.lattice, self.box.cells(self.half_space.grid)
        (dx, dy, dz), (my, mx), depths = cells.pitch, lattice.finer, lattice.depths
        apart = dz / max(1, round(dz / float(np.diff(depths).min()))) if depths.size > 1 else dz
        if not np.allclose(np.diff(depths), apart, rtol=1e-6, atol=0.0) or depths[0] <= 0.0:
            return self._shifted(eigenstrain)
        target = Cells(
            first=(float(lattice.x[0]), float(lattice.y[0]), float(depths[0])),
            pitch=(dx / mx, dy / my, apart),
            shape=lattice.shape,  # type: ignore[arg-type]
        )
        values = close_up(
            self.half_space.cell, cells, eigenstrain, target, **self.half_space.options(self.quantity)
        )  # fmt: skip
        return np.asarray(values[list(self.rows)], dtype=float)

    def _shifted(self, eigenstrain: FloatArray) -> FloatArray:
        """Field at depths between those of the cells, on lattices with the pitch of the cells."""
        out, first = np.empty(self.shape), self.box.lattice.first
        for (rows, columns), sublattice in self.lattice.shifted:
            origin = (sublattice.origin[0] - first[1], sublattice.origin[1] - first[2])
            out[:, :, rows, columns] = self.planes(sublattice.target, origin, sublattice.depths).apply(eigenstrain)
        return out


def cheapest(make: Callable[[type[Planes]], Planes], lattice: RegionLattice, height: float) -> Planes:
    """Cheapest route for a lattice, from cells of a height [m]; `make` builds a route of a class."""
    if lattice.points is not None:
        return make(Columns)
    if lattice.finer != (1, 1):
        return make(CloseUp)
    routes = [make(Planes), *([make(Volume)] if Volume.fits(lattice, height) else [])]
    return min(routes, key=lambda route: route.cost.seconds_once + route.cost.seconds_per_step)


def _below(depths: FloatArray) -> FloatArray:
    """Depths below the surface."""
    return depths[1:] if depths.size and depths[0] == 0.0 else depths
