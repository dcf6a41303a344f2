"""Contact area from the loaded cells, corrected for the cells that the edge of the contact cuts."""

from __future__ import annotations

from math import log, pi, sqrt

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.grid import Grid

__all__ = ["contact_area", "radius_of_area"]

#: Share of a cell by which each boundary between a loaded and an unloaded cell overstates the area.
PER_BOUNDARY = (pi - 1.0 + log(2.0)) / 24.0


def contact_area(loaded: NDArray[np.bool_], grid: Grid, *, periodic: bool = False) -> float:
    """Area of contact [m^2].

    A cell that the edge of the contact cuts is loaded as a whole, so the count of loaded cells overstates the area
    by an amount proportional to the length of the edge. For edges that run in all directions alike that amount is
    known, and taken off.

    Parameters
    ----------
    loaded : (ny, nx) bool
        Cells under pressure.
    grid : Grid
        Cells.
    periodic : bool
        Whether the window repeats.

    Returns
    -------
    float
        Measured on Hertz contacts: radius within 0.5 % from 19 cells per radius on, where the count alone is up to
        0.9 % too large. For contacts that end on cell boundaries (a sharp-edged punch) the count is exact and this is
        too small by 1/8.5 of a cell for each cell of the edge.

    References
    ----------
    V. A. Yastrebov, G. Anciaux, J.-F. Molinari, Tribol. Int. 114 (2017) 161, arXiv:1701.02727.

    Examples
    --------
    >>> contact_area(np.ones((4, 4), dtype=bool), Grid(nx=4, ny=4, dx=0.5, dy=0.5))
    4.0
    """
    boundaries = 0
    for axis in (0, 1):
        boundaries += int(np.count_nonzero(np.diff(loaded, axis=axis)))
        if periodic:
            boundaries += int(np.count_nonzero(np.take(loaded, 0, axis) != np.take(loaded, -1, axis)))
    return (int(np.count_nonzero(loaded)) - PER_BOUNDARY * boundaries) * grid.cell_area


def radius_of_area(area: float, grid: Grid) -> float:
    """Radius of the circle with this area [m]; of a line contact half the width, as `area` is that of one metre."""
    return 0.5 * area / grid.dy if grid.line else sqrt(area / pi)
