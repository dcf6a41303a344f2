"""Routes from the eigenstrain in a box of cells: planes, volume, columns of points, points finer than the cells."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigencontact.execution.block import Cost
from eigencontact.execution.routes.route import CellRoute
from eigencontact.model.regions import RegionLattice
from eigencontact.solvers.cells import Cells

__all__ = ["CloseUp", "Columns", "Planes", "Volume", "cheapest"]

FloatArray = NDArray[np.float64]


class Planes(CellRoute):
    """Transforms in the plane, for each depth and each layer of cells."""

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
            precision=self.half_space.numerics.precision,
            **self.half_space.options(self.quantity),
        )

    def field(self, eigenstrain: FloatArray) -> FloatArray:
        """See `Route.field`."""
        return np.asarray(self._operator.apply(eigenstrain), dtype=float)


class Volume(Planes):
    """Transforms in space, for planes as far apart as the layers of cells are high; the surface apart."""

    @property
    def words(self) -> str:
        """See `Route.words`."""
        return f"{self.box.words}, FFT in space"

    @staticmethod
    def fits(lattice: RegionLattice, height: float) -> bool:
        """Whether the planes of a lattice are two or more, a height apart; one in the surface does not count."""
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
            precision=self.half_space.numerics.precision,
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
    """Points one by one, those above each other together."""

    @property
    def words(self) -> str:
        """See `Route.words`."""
        return f"{self.box.words}, point by point"

    @property
    def cost(self) -> Cost:
        """See `Route.cost`."""
        count = len(self._columns)
        one = self.pace.planes(self.box.lattice, (1, 1), (0.5, 0.5), -(-len(self._points) // count), len(self.rows))
        return one.times(count)

    @property
    def _points(self) -> FloatArray:
        assert self.lattice.points is not None
        return self.lattice.points

    @cached_property
    def _columns(self) -> list[NDArray[np.intp]]:
        """Numbers of the points that lie one above the other, for every place of the surface."""
        _, column = np.unique(self._points[:, :2], axis=0, return_inverse=True)
        order = np.argsort(column.ravel(), kind="stable")
        return np.split(order, np.flatnonzero(np.diff(column.ravel()[order])) + 1)

    @cached_property
    def _operators(self) -> list[Any]:
        cells = self.box.cells(self.half_space.grid)
        (x0, y0, _), (dx, dy, _) = cells.first, cells.pitch
        found = []
        for where in self._columns:
            x, y = self._points[where[0], :2]
            found.append(self.planes((1, 1), (float((y - y0) / dy), float((x - x0) / dx)), self._points[where, 2]))
        return found

    def field(self, eigenstrain: FloatArray) -> FloatArray:
        """See `Route.field`."""
        out = np.empty(self.shape)
        for where, operator in zip(self._columns, self._operators, strict=True):
            out[:, where] = operator.apply(eigenstrain)[:, :, 0, 0]
        return out


class CloseUp(Planes):
    """Points finer than the cells; its operators serve once."""

    @property
    def words(self) -> str:
        """See `Route.words`."""
        my, mx = self.lattice.finer
        return f"{self.box.words}, {mx} x {my} points to a cell, seen from above"

    @property
    def cost(self) -> Cost:
        """See `Route.cost`."""
        count = self.lattice.finer[0] * self.lattice.finer[1]
        one = self.pace.volume(self.box.lattice, self.lattice.target, (0.5, 0.5), self.lattice.depths.size)
        return Cost(one.memory, 0.0, one.seconds_once + count * one.seconds_per_step)

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
        found = close_up(
            self.half_space.cell, cells, eigenstrain, target, **self.half_space.options(self.quantity)
        )  # fmt: skip
        return np.asarray(found[list(self.rows)], dtype=float)

    def _shifted(self, eigenstrain: FloatArray) -> FloatArray:
        """Field on depths that do not follow the cells: lattices of the cells' pitch, one after the other."""
        out, first = np.empty(self.shape), self.box.lattice.first
        for (rows, columns), part in self.lattice.shifted:
            origin = (part.origin[0] - first[1], part.origin[1] - first[2])
            out[:, :, rows, columns] = self.planes(part.target, origin, part.depths).apply(eigenstrain)
        return out


def cheapest(make: Callable[[type[Planes]], Planes], lattice: RegionLattice, height: float) -> Planes:
    """Cheapest route that serves a lattice, from cells of a height [m]; `make` builds one of a class."""
    if lattice.points is not None:
        return make(Columns)
    if lattice.finer != (1, 1):
        return make(CloseUp)
    routes = [make(Planes), *([make(Volume)] if Volume.fits(lattice, height) else [])]
    return min(routes, key=lambda route: route.cost.seconds_once + route.cost.seconds_per_step)


def _below(depths: FloatArray) -> FloatArray:
    """Depths without one in the surface."""
    return depths[1:] if depths.size and depths[0] == 0.0 else depths
