"""Displacement of surface cells by polynomial eigenstrain of whole inclusions, and work of tractions on it.

A table stores the mean displacement of each cell by each function of an inclusion. By Betti's theorem it also gives the
work of tractions in the inclusion at any distance, without integration of a stress over it. Inclusions that differ by
whole cells along x and y share a table.
"""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass, field

import numpy as np

from eigencontact.core.array_types import FloatArray
from eigencontact.core.grid import Grid
from eigencontact.halfspace.moments import surface_displacement
from eigencontact.solvers.polynomial_inclusions import PolynomialInclusions

__all__ = ["WholeSurface", "table_key"]

#: Tolerance for equal offsets, in cells.
_ALIKE = 1e-7
#: Gauss points along an edge of a cell far from the inclusion, and largest number close to it.
_FAR_POINTS, _NEAR_POINTS = 2, 6


Bounds = tuple[tuple[float, float, float], tuple[float, float, float]]


@dataclass(slots=True)
class _Group:
    """Inclusions with a common table: their numbers, and the first column and row of each in the table."""

    members: list[int] = field(default_factory=list)
    cells: list[tuple[int, int]] = field(default_factory=list)


class WholeSurface:
    """Tables for one arrangement of inclusions below a grid.

    Parameters
    ----------
    system : PolynomialInclusions
    grid : Grid
        Grid of the surface.
    directions : str
        Directions of the displacement and of the tractions, out of ``"xyz"``.
    threads : int, optional
        Cores to use; by default all.
    """

    def __init__(
        self, system: PolynomialInclusions, grid: Grid, directions: str, *, threads: int | None = None
    ) -> None:
        self._system, self._grid, self._rows = system, grid, ["xyz".index(name) for name in directions]
        self._threads = threads
        groups: dict[Hashable, _Group] = {}
        for number, shape in enumerate(system.shapes):
            (column, row), shares = _place(shape.bounds, grid)
            group = groups.setdefault((system.key_of(number), shares), _Group())
            group.members.append(number)
            group.cells.append((column, row))
        self._groups = [(group, self._table(group)) for group in groups.values()]

    def displacement(self, amplitudes: FloatArray, prestrain: FloatArray) -> FloatArray:
        """Mean displacement of the cells, ``(directions, ny, nx)`` [m]."""
        ny, nx = self._grid.shape
        out = np.zeros((len(self._rows), ny, nx))
        for group, table in self._groups:
            for number, window in self._windows(group):
                weights = np.concatenate((self._system.of(amplitudes, number), prestrain[:, number]))
                weights = weights @ self._system.bases[number].mix
                out += np.einsum("f,fdyx->dyx", weights, table[..., *window])
        return out

    def work(self, tractions: FloatArray) -> FloatArray:
        """Work of tractions ``(directions, ny, nx)`` [Pa] on every function, ``(unknowns,)`` [J]."""
        out = np.zeros(self._system.size)
        loaded_y, loaded_x = (np.flatnonzero(tractions.any(axis=axes)) for axes in ((0, 2), (0, 1)))
        if not loaded_y.size:
            return out
        y, x = (slice(int(loaded[0]), int(loaded[-1]) + 1) for loaded in (loaded_y, loaded_x))
        load = tractions[:, y, x] * self._grid.cell_area
        for group, table in self._groups:
            for number, (rows, columns) in self._windows(group):
                basis, displacement = self._system.bases[number], table[:, :, rows, columns][..., y, x]
                start, end = self._system.starts[number : number + 2]
                out[start:end] = basis.mix[: basis.size] @ np.einsum("fdyx,dyx->f", displacement, load)
        return out

    def _windows(self, group: _Group) -> list[tuple[int, tuple[slice, slice]]]:
        """Part of the table inside the window, for each member."""
        ny, nx = self._grid.shape
        right, high = (max(cell[axis] for cell in group.cells) for axis in (0, 1))
        return [
            (number, (slice(high - row, high - row + ny), slice(right - column, right - column + nx)))
            for number, (column, row) in zip(group.members, group.cells, strict=True)
        ]

    def _table(self, group: _Group) -> FloatArray:
        """Mean displacement by the eigenstrains of `InclusionBasis.span`, ``(r, directions, rows, columns)``."""
        grid, system, number = self._grid, self._system, group.members[0]
        columns, rows = (np.array([cell[axis] for cell in group.cells]) for axis in (0, 1))
        x = grid.x[0] + grid.dx * (np.arange(grid.nx + int(np.ptp(columns))) + columns[0] - columns.max())
        y = grid.y[0] + grid.dy * (np.arange(grid.ny + int(np.ptp(rows))) + rows[0] - rows.max())
        ligament = system.centers[number, 2] - system.radii[number]
        wide = max(grid.edges) / max(ligament, 1e-3 * system.radii[number])
        order = int(np.clip(np.ceil(_FAR_POINTS * wide), _FAR_POINTS, _NEAR_POINTS))
        nodes, weights = np.polynomial.legendre.leggauss(order)
        basis, shape = system.bases[number], system.shapes[number]
        out = np.zeros((len(basis.span), len(self._rows), y.size, x.size))
        for node_y, weight_y in zip(nodes, weights, strict=True):
            for node_x, weight_x in zip(nodes, weights, strict=True):
                at_y, at_x = np.meshgrid(y + 0.5 * grid.dy * node_y, x + 0.5 * grid.dx * node_x, indexing="ij")
                values = surface_displacement(
                    shape, basis.span, (at_x.ravel(), at_y.ravel()), self._rows, degree=basis.degree,
                    poisson_ratio=system.matrix.poisson_ratio, threads=self._threads,
                )  # fmt: skip
                out += 0.25 * weight_x * weight_y * values.reshape(out.shape)
        return out


def table_key(bounds: Bounds, grid: Grid) -> Hashable:
    """Key of inclusions of one shape with a common table: equal depth and equal position in a cell."""
    low, high = bounds
    return round((low[2] + high[2]) / (_ALIKE * grid.dx)), _place(bounds, grid)[1]


def _place(bounds: Bounds, grid: Grid) -> tuple[tuple[int, int], tuple[int, int]]:
    """Cell (column, row) above the centre of an inclusion, and the position in this cell."""
    low, high = bounds
    column, row = (
        (0.5 * (low[axis] + high[axis]) - first) / edge
        for axis, first, edge in ((0, grid.x[0], grid.dx), (1, grid.y[0], grid.dy))
    )
    cells = int(np.floor(column + _ALIKE)), int(np.floor(row + _ALIKE))
    return cells, (round((column - cells[0]) / _ALIKE), round((row - cells[1]) / _ALIKE))
