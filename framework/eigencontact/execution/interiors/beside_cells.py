"""Interaction of whole inhomogeneities and cells of the same body.

One table serves both directions by reciprocity: the stress at the cell centres by each function of an inclusion is also
the work of a cell's eigenstrain on that function. Cells in the ground of the inclusion have the material of the body
and no eigenstrain. A cell cut by the boundary of the inclusion receives the stress outside the inclusion.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from eigencontact.core.array_types import FloatArray, IntArray
from eigencontact.execution.interiors.cells import Cells
from eigencontact.execution.interiors.interior import Interior
from eigencontact.execution.interiors.polynomial_wholes import PolynomialWholes
from eigencontact.halfspace.moments import moment_field

__all__ = ["BesideCells", "join_wholes"]

#: Sample points along each edge of a cell near the boundary of an inclusion; only points outside the inclusion count.
_POINTS = 3


class BesideCells:
    """Interaction tables between the whole inhomogeneities and the cells of one body, both started."""

    def __init__(self, wholes: PolynomialWholes, cells: Cells) -> None:
        self._wholes, self.cells = wholes, cells
        box = cells.box
        z, y, x = box.lattice.axes(cells.grid)
        self._shape = box.lattice.shape
        self._volume = float(np.prod(box.lattice.edges))
        at = [values.ravel() for values in np.meshgrid(z, y, x, indexing="ij")][::-1]
        self._tables = [self._table(number, at) for number in range(len(wholes.system.shapes))]

    def stress(self) -> FloatArray:
        """Stress ``(6, nz, ny, nx)`` [Pa] in the cells by the present eigenstrain of the wholes."""
        system, total = self._wholes.system, np.zeros((6, int(np.prod(self._shape))))
        for number, table in enumerate(self._tables):
            eigenstrains = np.concatenate((system.of(self._wholes.amplitudes, number), self._wholes.present[:, number]))
            total += np.tensordot(eigenstrains @ system.bases[number].mix, table, 1)
        return system.matrix.shear_modulus * total.reshape(6, *self._shape)

    def work(self) -> FloatArray:
        """Work [J] of the present eigenstrain of the cells on every function of the whole inhomogeneities."""
        system, strain = self._wholes.system, self.cells.eigenstrain.reshape(6, -1)
        parts = [
            basis.mix[: basis.size] @ np.tensordot(table, strain, 2)
            for table, basis in zip(self._tables, system.bases, strict=True)
        ]
        return system.matrix.shear_modulus * self._volume * np.concatenate(parts)

    def _table(self, number: int, at: Sequence[FloatArray]) -> FloatArray:
        """Stress at the cells by the eigenstrains of `span`, ``(r, 6, cells)``, in units of the shear modulus."""
        system = self._wholes.system
        shape, basis = self._wholes.sources[number].shape, system.bases[number]
        edges = self.cells.box.lattice.edges[::-1]
        out = np.zeros((len(basis.span), 6, at[0].size))
        shifts = [(np.arange(_POINTS) + 0.5) / _POINTS - 0.5 for _ in range(3)]
        near = self._near(number, at)
        inside = np.zeros(near.size)
        for dx in shifts[0]:
            for dy in shifts[1]:
                for dz in shifts[2]:
                    points = [axis[near] + d * edge for axis, d, edge in zip(at, (dx, dy, dz), edges, strict=True)]
                    outside = ~shape.contains(*points)
                    inside += ~outside
                    where = np.flatnonzero(outside)
                    out[:, :, near[where]] += self._stress_at(number, [axis[where] for axis in points])
        out[:, :, near] /= np.maximum(_POINTS**3 - inside, 1.0)
        far = np.setdiff1d(np.arange(at[0].size), near)
        out[:, :, far] = self._stress_at(number, [axis[far] for axis in at])
        return out

    def _near(self, number: int, at: Sequence[FloatArray]) -> IntArray:
        """Cells in the bounds of an inclusion, extended by one cell."""
        low, high = self._wholes.sources[number].shape.bounds
        edges = self.cells.box.lattice.edges[::-1]
        inside = [
            (first - edge < axis) & (axis < last + edge)
            for axis, first, last, edge in zip(at, low, high, edges, strict=True)
        ]
        return np.flatnonzero(np.logical_and.reduce(inside))

    def _stress_at(self, number: int, points: Sequence[FloatArray]) -> FloatArray:
        system = self._wholes.system
        x, y, z = points
        return moment_field(
            system.shapes[number], system.bases[number].span, (x, y, z), degree=system.bases[number].degree,
            poisson_ratio=system.matrix.poisson_ratio, quantity="stress", space=system.space, threads=system.threads,
        )  # fmt: skip


def join_wholes(interiors: Sequence[Interior]) -> None:
    """Make the missing interaction tables between whole inhomogeneities and cells of one body; all are started."""
    for wholes in interiors:
        if isinstance(wholes, PolynomialWholes):
            levels = [cells for cells in interiors if isinstance(cells, Cells) and cells.body == wholes.body]
            for cells in levels:
                if cells.beside is None:
                    cells.beside = BesideCells(wholes, cells)
                wholes.is_beside = cells.is_beside = True
            wholes.beside = [cells.beside for cells in levels if cells.beside is not None]
