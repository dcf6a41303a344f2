"""From coarse to fine: merged cells for the start, and the pressure carried down to the next grid."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.grid import Grid

__all__ = ["coarse_factors", "prolong", "restrict"]

FloatArray = NDArray[np.float64]

#: An axis is not coarsened below this many cells.
COARSEST = 16


def coarse_factors(grid: Grid) -> tuple[int, int] | None:
    """Cells to merge along (y, x) for the next coarser grid; None where the grid is coarse enough.

    Only the finer direction of stretched cells is merged, until they are nearly square.
    """
    merge_y = grid.ny >= 2 * COARSEST and grid.dy <= 1.5 * grid.dx
    merge_x = grid.nx >= 2 * COARSEST and grid.dx <= 1.5 * grid.dy
    return (2 if merge_y else 1, 2 if merge_x else 1) if merge_y or merge_x else None


def restrict(field: FloatArray, factors: tuple[int, int]) -> FloatArray:
    """Mean of each group of merged cells; left-over rows and columns are dropped."""
    fy, fx = factors
    ny, nx = field.shape[0] // fy, field.shape[1] // fx
    return np.asarray(field[: ny * fy, : nx * fx].reshape(ny, fy, nx, fx).mean(axis=(1, 3)))


def prolong(pressure: FloatArray, factors: tuple[int, int], shape: tuple[int, int]) -> FloatArray:
    """Pressure on the next finer grid, interpolated linearly in its square.

    Near the edge of a smooth contact the pressure falls like the square root of the distance; its square is smooth
    there, so interpolating the square puts the edge nearly right.
    """
    square = pressure * pressure
    for axis, factor in enumerate(factors):
        if factor == 2:
            pad = [(0, 0), (0, 0)]
            pad[axis] = (1, 1)
            wide = np.moveaxis(np.pad(square, pad), axis, 0)
            middle = wide[1:-1]
            fine = np.stack([0.75 * middle + 0.25 * wide[:-2], 0.75 * middle + 0.25 * wide[2:]], axis=1)
            square = np.moveaxis(fine.reshape(-1, *middle.shape[1:]), 0, axis)
    missing = [(0, full - have) for full, have in zip(shape, square.shape, strict=True)]
    return np.sqrt(np.pad(square, missing))
