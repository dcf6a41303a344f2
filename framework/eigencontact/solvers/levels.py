"""Grids from coarse to fine: merged cells for the start, and interpolation of the pressure to the next finer grid."""

from __future__ import annotations

import numpy as np

from eigencontact.core.array_types import FloatArray
from eigencontact.core.grid import Box, Grid

__all__ = ["coarse_factors", "prolong", "restrict", "restrict_springs"]

#: Smallest number of cells along a coarsened axis.
COARSEST = 16


def coarse_factors(grid: Grid) -> tuple[int, int] | None:
    """Cells to merge along (y, x) for the next coarser grid; None if the grid is coarse enough.

    Only the finer direction of stretched cells is merged, until they are nearly square.
    """
    half_x, half_y = grid.half_widths
    merge_y = grid.ny >= 2 * COARSEST and half_y <= 1.5 * half_x
    merge_x = grid.nx >= 2 * COARSEST and half_x <= 1.5 * half_y
    return (2 if merge_y else 1, 2 if merge_x else 1) if merge_y or merge_x else None


def restrict(field: FloatArray, factors: tuple[int, int]) -> FloatArray:
    """Mean of each pair or square of merged cells; a remaining row or column is left out."""
    if factors[0] == 2:
        rows = field.shape[0] // 2 * 2
        field = field[0:rows:2] + field[1:rows:2]
    if factors[1] == 2:
        columns = field.shape[1] // 2 * 2
        field = field[:, 0:columns:2] + field[:, 1:columns:2]
    return field / (factors[0] * factors[1])


def restrict_springs(springs: FloatArray, factors: tuple[int, int], compliance: float) -> FloatArray:
    """Springs of merged cells: springs of cells in parallel, each on the `compliance` of a single cell.

    A spring without stiffness beside a cell without a spring carries nothing; the cell carries all pressure.
    """
    return np.maximum(1.0 / restrict(1.0 / (compliance + springs), factors) - compliance, 0.0)


def prolong(pressure: FloatArray, factors: tuple[int, int], shape: tuple[int, int]) -> FloatArray:
    """Pressure on the next finer grid, from linear interpolation of its square.

    Near the edge of a smooth contact the pressure is proportional to the square root of the distance. Its square is
    smooth, so that interpolation of the square places the edge nearly correctly.
    """
    out = np.zeros(shape)
    box = Box.around(pressure > 0)
    if box is None:
        return out
    box = box.grown(1, 1, pressure.shape)
    square = pressure[box.slices] ** 2
    for axis, factor in enumerate(factors):
        if factor == 2:
            square = _refine(square, axis)
    y0, x0 = factors[0] * box.y0, factors[1] * box.x0
    np.sqrt(square, out=out[y0 : y0 + square.shape[0], x0 : x0 + square.shape[1]])
    return out


def _refine(field: FloatArray, axis: int) -> FloatArray:
    """Two cells for each cell along an axis, with centres a quarter of a coarse cell to both sides."""
    coarse = np.moveaxis(field, axis, 0)
    fine = np.repeat(0.75 * coarse, 2, axis=0)
    fine[2::2] += 0.25 * coarse[:-1]
    fine[1:-1:2] += 0.25 * coarse[1:]
    return np.moveaxis(fine, 0, axis)
