"""Stress and strain between the centres of cells, for an eigenstrain that varies smoothly from cell to cell.

An eigenstrain that is uniform in each cell has steps at the faces, and so have the fields between the centres. The
difference from a continuous eigenstrain is a sawtooth along each axis n, with one tooth per cell. Its field decays
within a cell, and equals that of layers with an eigenstrain δ that varies only across them,

    σ = -Q δ,    ε = δ - M Q δ,    Q = C - C n (n C n)^-1 n C,

with the stiffness C and the compliance M of the surrounding material; Q is plane stress in the layer. δ is the
eigenstrain of the cell minus a linear interpolation between its centre and the next.

References
----------
G. W. Milton 2002, The Theory of Composites, section 9.2 (fields in laminates).
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.array_types import FloatArray, IntArray
from eigencontact.core.tensors import COMPONENTS
from eigencontact.errors import require
from eigencontact.solvers.cells import Cells

__all__ = ["WithinCells"]

Cell = list[IntArray]

# Distance in cells below which a point lies on a face; such a point takes half from either side.
_ON_FACE = 1e-9


class WithinCells:
    """Correction of fields at points inside cells by the sawtooth.

    Parameters
    ----------
    cells : Cells
        Cells with eigenstrain.
    region : (nz, ny, nx) of int
        Number of the region that contains a cell; the interpolation joins cells of equal number. Cells with number 0
        have no correction.
    points : three of (n,)
        x, y, z [m].
    poisson_ratio, shear_modulus : float
        Constants of the surrounding material; ν up to 0.5, G [Pa].
    """

    def __init__(
        self,
        cells: Cells,
        region: NDArray[np.int_],
        points: tuple[FloatArray, FloatArray, FloatArray],
        *,
        poisson_ratio: float,
        shear_modulus: float,
    ) -> None:
        require(region.shape == cells.shape, "within cells", "region", region.shape, f"of shape {cells.shape}")
        layers = [_layer(axis, poisson_ratio) for axis in range(3)]
        self._operators = {
            "stress": [2.0 * shear_modulus * stress for stress, _ in layers],
            "strain": [-strain for _, strain in layers],
            "eigenstrain": [-np.eye(6)] * 3,
        }
        self._region, self._count = np.pad(region, 1), points[0].size
        placed = [(at - first) / d for at, first, d in zip(points, cells.first, cells.pitch, strict=True)]
        ends = np.array(cells.shape[::-1]) - 0.5 + _ON_FACE
        inside = [(at > -0.5 - _ON_FACE) & (at < end) for at, end in zip(placed, ends, strict=True)]
        self._near = np.flatnonzero(np.logical_and.reduce(inside))
        self._places = [at[self._near] for at in placed]

    def difference(self, quantity: str, eigenstrain: FloatArray) -> FloatArray:
        """Correction of the field of an eigenstrain inside cells, ``(6, n)``.

        Parameters
        ----------
        quantity : {"stress", "strain", "eigenstrain"}
            Mandel stress [Pa], total strain, or the eigenstrain itself.
        eigenstrain : (6, nz, ny, nx)
            Mandel components [-].
        """
        out = np.zeros((6, self._count))
        padded = np.pad(eigenstrain, ((0, 0), (1, 1), (1, 1), (1, 1)))
        for where, weight, cell in self._sides():
            for axis, operator in enumerate(self._operators[quantity]):
                offset = self._places[axis][where] - cell[axis]
                slope = self._slope(padded, cell, axis, np.where(offset > 0.0, 1, -1))
                out[:, self._near[where]] -= operator @ (weight * offset * slope)
        return out

    def inside(self, eigenstrain: FloatArray) -> tuple[IntArray, NDArray[np.int_], FloatArray]:
        """Points in a region, its number at each, and their eigenstrain ``(6, n)`` without steps between cells.

        A point on a face is included if both sides belong to the region.
        """
        smooth, padded = self.difference("eigenstrain", eigenstrain), np.pad(eigenstrain, ((0, 0), *[(1, 1)] * 3))
        number, mean = np.zeros(self._count, dtype=int), np.zeros(self._count)
        for where, weight, cell in self._sides():
            at = self._near[where]
            number[at] = _at(self._region, cell)
            mean[at] += weight * number[at]
            smooth[:, at] += weight * _at(padded, cell)
        points = np.flatnonzero((number > 0) & (mean == number))
        return points, number[points], smooth[:, points]

    def _sides(self) -> Iterator[tuple[IntArray, FloatArray, Cell]]:
        """Points, weights, and the cell (x, y, z) of a region that contains them; on a face, one for each side."""
        lower = [np.ceil(at - 0.5 - _ON_FACE).astype(int) for at in self._places]
        upper = [np.floor(at + 0.5 + _ON_FACE).astype(int) for at in self._places]
        on_face = [low != high for low, high in zip(lower, upper, strict=True)]
        weights = 0.5 ** np.sum(on_face, axis=0)
        for side in product((False, True), repeat=3):
            on_side = np.logical_and.reduce([face | (not second) for second, face in zip(side, on_face, strict=True)])
            where = np.flatnonzero(on_side)
            cell = [(high if second else low)[where] for second, low, high in zip(side, lower, upper, strict=True)]
            within_region = _at(self._region, cell) > 0
            yield where[within_region], weights[where[within_region]], [index[within_region] for index in cell]

    def _slope(self, padded: FloatArray, cell: Cell, axis: int, ahead: IntArray) -> FloatArray:
        """Change of the eigenstrain ``(6, n)`` per cell along an axis: to the next cell, or from the last one."""
        number, values = _at(self._region, cell), _at(padded, cell)
        slope = np.zeros_like(values)
        for offset in (-ahead, ahead):
            neighbour = [index + offset * (along == axis) for along, index in enumerate(cell)]
            same_region = _at(self._region, neighbour) == number
            slope = np.where(same_region, offset * (_at(padded, neighbour) - values), slope)
        return slope


def _at(padded: NDArray[Any], cell: Cell) -> NDArray[Any]:
    """Values in cells (x, y, z) of a box with one cell of padding."""
    x, y, z = (index + 1 for index in cell)
    return padded[..., z, y, x]


def _layer(axis: int, poisson_ratio: float) -> tuple[FloatArray, FloatArray]:
    """Q / 2G and 1 - M Q, ``(6, 6)``, of an eigenstrain that varies along one axis only."""
    flat = [k for k, name in enumerate(COMPONENTS) if "xyz"[axis] not in name]
    stress, strain = np.zeros((6, 6)), np.eye(6)
    stress[flat, flat] = 1.0
    strain[flat, flat] = 0.0
    stretches = [k for k in flat if k < 3]
    stress[np.ix_(stretches, stretches)] += poisson_ratio / (1.0 - poisson_ratio)
    strain[axis, stretches] = poisson_ratio / (1.0 - poisson_ratio)
    return stress, strain
