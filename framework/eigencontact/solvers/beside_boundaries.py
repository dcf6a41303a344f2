r"""Stress at points near the boundaries of regions, from the material at the point.

A cut cell has one eigenstrain for both of its materials, E = f ε_1, with the fraction f of the region. At points in and
next to such cells, the field of the cells is that of neither material. Across a boundary of normal n the traction is
continuous, and so is the strain in its plane. With T of `eigencontact.solvers.cell_conditions.constraint_of_layer` and
the stress F at the centre of a cell by the eigenstrain of all cells, the stress in the surrounding body is

    F + T E.

This field is smooth across the cells of the boundary and is interpolated between their centres. In the region the
stress is smooth from cell to cell, and is continued linearly from whole cells into the cut cells.

References
----------
G. W. Milton 2002, The Theory of Composites, chapter 9 (laminates); R. Hill 1961, in Problems of Continuum Mechanics,
SIAM (jumps at interfaces); D. L. Youngs 1982, in Numerical Methods for Fluid Dynamics (normals from shares of cells).
"""

from __future__ import annotations

from itertools import product

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.array_types import FloatArray, IntArray
from eigencontact.core.material import Material
from eigencontact.solvers.cell_conditions import constraint_of_layer
from eigencontact.solvers.cells import Cells

__all__ = ["Between", "continued", "outer_stress", "outward"]

#: Cells on either side for the fit of a linear continuation.
_REACH = 3
#: Regularization of the slopes, relative to the sum of the weights: a region with a single layer has no slope across
#: it.
_LEVEL = 1e-3
#: Distance in cells below which a point lies on a face or at a centre.
_SNAP = 1e-9
#: Cells on both sides of a face.
_SIDES = ((np.ceil, -0.5), (np.floor, 0.5))


class Between:
    """Points between the cell centres: the eight cells around each point, and their weights.

    Parameters
    ----------
    cells : Cells
        Cells of the box. Values are continued linearly above the centres of the first layer; elsewhere the box must
        extend beyond all points.
    points : three of (n,)
        x, y, z [m].

    Attributes
    ----------
    about : (8, n) of int
        Flat indices of the cells; cells without weight are replaced by the nearest cell.
    on : (8, n) of int
        Flat indices of the cells that contain a point: all equal, except for points on faces.
    """

    def __init__(self, cells: Cells, points: tuple[FloatArray, FloatArray, FloatArray]) -> None:
        placed = [_snapped((at - first) / d) for at, first, d in zip(points, cells.first, cells.pitch, strict=True)]
        lower = [np.floor(at).astype(int) for at in placed]
        lower[2] = np.maximum(lower[2], 0)
        ahead = [at - low for at, low in zip(placed, lower, strict=True)]
        before, after = ([rounded(at + half).astype(int) for at in placed] for rounded, half in _SIDES)
        about, on, weights = [], [], []
        for side in product((0, 1), repeat=3):
            cell = [low + upper for low, upper in zip(lower, side, strict=True)]
            parts = [at if upper else 1.0 - at for at, upper in zip(ahead, side, strict=True)]
            about.append(_flat(cell, cells.shape))
            on.append(_flat([(b if s else a) for a, b, s in zip(before, after, side, strict=True)], cells.shape))
            weights.append(parts[0] * parts[1] * parts[2])
        self.on, self._weights = np.array(on), np.array(weights)
        most = np.take_along_axis(np.array(about), self._weights.argmax(axis=0)[None], axis=0)
        self.about = np.where(self._weights != 0.0, about, most)

    def values(self, field: FloatArray, where: NDArray[np.intp]) -> FloatArray:
        """Values ``(c, len(where))`` of a field ``(c, nz, ny, nx)`` at some of the points."""
        flat = field.reshape(field.shape[0], -1)
        out = np.zeros((field.shape[0], where.size))
        for cell, weight in zip(self.about[:, where], self._weights[:, where], strict=True):
            out += weight * flat[:, cell]
        return out


def outward(share: FloatArray, pitch: tuple[float, float, float], *, flush: bool) -> FloatArray:
    """Vectors ``(3, nz, ny, nx)`` out of a region, by the decrease of its fraction over the 26 neighbours of each cell.

    They are zero away from the boundary. Outside the box the fraction is zero; above the surface it equals the first
    layer if the box is `flush` with the surface. `pitch` is (dx, dy, dz).
    """
    padded = np.pad(share, 1)
    if flush:
        padded[0] = padded[1]
    out = np.empty((3, *share.shape))
    for axis in range(3):
        values = padded
        for along in range(3):
            low, middle, high = (np.take(values, np.arange(values.shape[along] - 2) + k, axis=along) for k in range(3))
            values = low - high if along == 2 - axis else low + 2.0 * middle + high
        out[axis] = values * (min(pitch) / pitch[axis])
    return out


def outer_stress(stress: FloatArray, eigenstrain: FloatArray, normal: FloatArray, matrix: Material) -> FloatArray:
    """F + T E [Pa] of cells ``(6, n)``; the normals ``(3, n)`` are zero in cells without a boundary."""
    out, boundary_cells = stress.copy(), np.flatnonzero(normal.any(axis=0) & eigenstrain.any(axis=0))
    if boundary_cells.size:
        constraint = constraint_of_layer(matrix, normal[:, boundary_cells].T)
        out[:, boundary_cells] += np.einsum("nij,jn->in", constraint, eigenstrain[:, boundary_cells])
    return out


def continued(values: FloatArray, weight: FloatArray, where: IntArray) -> FloatArray:
    """Values ``(c, m)`` in cells `where` (flat indices), by a linear fit to the weighted cells around each.

    Parameters
    ----------
    values : (c, nz, ny, nx)
    weight : (nz, ny, nx)
        Zero in cells without a value. The weight in the fit also decreases with the distance.
    """
    place = np.stack(np.unravel_index(where, weight.shape)) + _REACH
    weights = np.pad(weight, _REACH)
    padded = np.pad(values * weight, ((0, 0), *[(_REACH, _REACH)] * 3))
    system, right = np.zeros((where.size, 4, 4)), np.zeros((where.size, 4, values.shape[0]))
    for offset in product(range(-_REACH, _REACH + 1), repeat=3):
        basis = np.array([1.0, *offset])
        near = 1.0 / float(basis @ basis)
        k, j, i = (index + step for index, step in zip(place, offset, strict=True))
        system += near * weights[k, j, i][:, None, None] * np.outer(basis, basis)
        right += near * basis[None, :, None] * padded[:, k, j, i].T[:, None, :]
    slopes = np.arange(1, 4)
    system[:, slopes, slopes] += _LEVEL * system[:, :1, 0]
    return np.asarray(np.linalg.solve(system, right)[:, 0].T)


def _snapped(placed: FloatArray) -> FloatArray:
    """Coordinates in cells, set to multiples of a half if equal within round-off."""
    near = np.rint(2.0 * placed) / 2.0
    return np.where(np.abs(placed - near) <= _SNAP, near, placed)


def _flat(cell: list[IntArray], shape: tuple[int, int, int]) -> IntArray:
    """Flat indices of cells (x, y, z); cells outside the box have the index of the outermost cell."""
    x, y, z = (np.clip(index, 0, n - 1) for index, n in zip(cell, shape[::-1], strict=True))
    return np.asarray(np.ravel_multi_index((z, y, x), shape))
