"""Grids of a scene: given in it, or chosen from the inclusions where there is no contact."""

from __future__ import annotations

from collections.abc import Sequence
from math import isqrt

import numpy as np

from eigencontact.core.grid import Grid
from eigencontact.errors import shown
from eigencontact.model.sizes import comfortable, refuse_more
from eigencontact.scene.schema import GridSpec

__all__ = ["given_grid", "grid_around"]

Point = tuple[float, float, float]

#: Cells along the longer side of a window that was chosen from the inclusions.
_CELLS = 128


def given_grid(spec: GridSpec) -> Grid | None:
    """Grid of two of cells, size, spacing; None for an automatic one.

    Raises
    ------
    SceneError
        More cells than the memory of this machine can hold.
    """
    if spec.cells is not None:
        nx, ny = spec.cells
        _refuse_many(nx, ny, "grid.cells")
        if spec.size is not None:
            dx, dy = spec.size[0] / nx, spec.size[1] / ny
        else:
            assert spec.spacing is not None
            dx, dy = spec.spacing
        return Grid(nx=nx, ny=ny, dx=dx, dy=dy, center=spec.center)
    if spec.size is not None:
        assert spec.spacing is not None
        nx, ny = (max(1, round(size / pitch)) for size, pitch in zip(spec.size, spec.spacing, strict=True))
        _refuse_many(nx, ny, "grid.spacing")
        return Grid(nx=nx, ny=ny, dx=spec.size[0] / nx, dy=spec.size[1] / ny, center=spec.center)
    return None


def _refuse_many(nx: int, ny: int, where: str) -> None:
    """Refuse more cells than fit; those named instead keep the shorter side where they can."""
    wide = min(nx, max(isqrt(comfortable()), comfortable() // ny))
    high = min(ny, comfortable() // wide)
    refuse_more(nx * ny, where, "cells", f"{shown(nx)} x {shown(ny)}", f"{wide} x {high} would do")


def grid_around(bounds: Sequence[tuple[Point, Point]]) -> Grid:
    """Square cells, 128 along the longer side, over a window that shows the field of regions.

    Each side is that of the box around all regions and four times the depth of its middle: the surface displacement
    of a small region falls to a tenth within twice its depth.
    """
    low = np.min([box[0] for box in bounds], axis=0)
    high = np.max([box[1] for box in bounds], axis=0)
    middle = 0.5 * (low + high)
    wide, high_ = (high - low)[:2] + 4.0 * max(abs(float(middle[2])), 0.5 * float(high[2] - low[2]))
    edge = float(max(wide, high_)) / _CELLS
    nx, ny = (2 * max(1, int(np.ceil(0.5 * side / edge - 1e-6))) for side in (wide, high_))
    return Grid(nx=nx, ny=ny, dx=edge, dy=edge, center=(float(middle[0]), float(middle[1])))
