"""Contact area from the loaded cells, with a correction for the cells cut by the edge of the contact."""

from __future__ import annotations

from math import log, pi, sqrt

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.array_types import FloatArray
from eigencontact.core.grid import Grid

__all__ = ["area_under_pressure", "contact_area", "line_contact_area", "radius_of_area"]

#: Overestimate of the area, in cells, per boundary between a loaded and an unloaded cell.
PER_BOUNDARY = (pi - 1.0 + log(2.0)) / 24.0
#: Cells of a line, counted from 0 at an end of the contact, for the fit of the end: with few and with many cells.
_NEAR, _FAR = np.array([2, 3, 4]), np.array([2, 4, 6, 9])
#: Smallest number of cells of a contact for the second fit.
_MIN_CELLS = 20
#: Largest difference of the two ends, in cells, for which the second fit is used; on Hertz contacts it is below 0.055.
_APART = 0.08


def _powers(cells: NDArray[np.int64]) -> FloatArray:
    """Values of 1, t, t² and 1/t at cells, ``(len(cells), 4)``; t is the distance from the outermost cell, in cells."""
    t = cells.astype(float)
    return np.stack([np.ones_like(t), t, t**2, 1.0 / t], axis=1)


#: Inverses for the fits of an end: constant, slope and curvature by the values at the cells.
_OF_NEAR, _OF_FAR = np.linalg.inv(_powers(_NEAR)[:, :3]), np.linalg.inv(_powers(_FAR))


def contact_area(loaded: NDArray[np.bool_], grid: Grid, *, periodic: bool = False) -> float:
    """Area of contact [m^2].

    A cell cut by the edge of the contact is loaded as a whole. The number of loaded cells therefore overestimates the
    area, in proportion to the length of the edge. For edges with uniformly distributed directions the factor is known,
    and the function subtracts the excess.

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
        Area. Measured on Hertz contacts: radius within 0.5 % from 19 cells per radius on; the number of loaded cells
        alone gives up to 0.9 % too much. For contacts that end on cell boundaries (a sharp-edged punch) that number is
        exact, and this area is too small by 1/8.5 of a cell for each cell of the edge.

    References
    ----------
    V. A. Yastrebov, G. Anciaux, J.-F. Molinari, Tribol. Int. 114 (2017) 161, arXiv:1701.02727.

    Examples
    --------
    >>> contact_area(np.ones((4, 4), dtype=bool), Grid(nx=4, ny=4, dx=0.5, dy=0.5))
    4.0
    """
    boundaries = 0
    for axis, repeats in ((0, periodic or grid.repeats_y), (1, periodic)):
        boundaries += int(np.count_nonzero(np.diff(loaded, axis=axis)))
        if repeats:
            boundaries += int(np.count_nonzero(np.take(loaded, 0, axis) != np.take(loaded, -1, axis)))
    return (int(np.count_nonzero(loaded)) - PER_BOUNDARY * boundaries) * grid.cell_area


def line_contact_area(pressure: FloatArray, grid: Grid, *, periodic: bool = False) -> float:
    """Area of a line contact from its pressure ``(1, nx)``, per metre of its length [m^2].

    The square of the pressure of a smooth contact is a smooth function of the distance t from the end, and zero at the
    end. A parabola through the third to fifth loaded cell locates the end, in the last loaded cell or half a cell
    beyond. The discretization adds a term to the pressure that falls as 1/t (measured on Hertz contacts). If both
    methods give nearly the same end, a parabola with this term through four of the ten outermost cells replaces the
    first parabola; otherwise the pressure is not smooth over ten cells. If the pressure rises towards an end, as at a
    sharp edge, the number of cells is exact.

    Returns
    -------
    float
        Area. Measured on Hertz contacts: half width within 0.01 of a cell from 10 cells per half width on.
    """
    loaded, square = pressure[0] > 0, pressure[0] ** 2
    cells = float(np.count_nonzero(loaded))
    for step in (1, -1):  # inwards from the left ends, and from the right ends
        ends = loaded & ~np.roll(loaded, step)
        if not periodic:
            ends[[0, -1]] = False
        inward = square[(np.flatnonzero(ends) + step * np.arange(_MIN_CELLS)[:, None]) % square.size]
        smooth = (inward[2] > 0) & np.all(np.diff(inward[_NEAR], axis=0) > 0, axis=0)
        inward = inward[:, smooth]
        near = _outward(_OF_NEAR @ inward[_NEAR])
        far = _outward((_OF_FAR @ inward[_FAR])[:3])
        far[~np.all(inward[2:] > 0, axis=0)] = np.nan
        outward = np.where(abs(far - near) < _APART, far, near)  # NaN in `far` selects `near`
        cells -= float(np.nansum(0.5 - np.clip(outward, -0.5, 1.0)))
    return cells * grid.cell_area


def _outward(parabola: FloatArray) -> FloatArray:
    """Distance (ends,) from the middle of the outermost cell outwards to the zero of a parabola, in cells, or NaN.

    `parabola` has its constant, slope and curvature by the distance inwards.
    """
    constant, slope, bend = parabola
    root = slope**2 - 4.0 * bend * constant
    real = (root >= 0) & (slope > 0)
    out = np.full(constant.shape, np.nan)
    out[real] = 2.0 * constant[real] / (np.sqrt(root[real]) + slope[real])
    return out


def area_under_pressure(pressure: FloatArray, grid: Grid, *, periodic: bool = False) -> float:
    """Contact area from a pressure ``(ny, nx)`` [m^2]; of strips, per metre of their length."""
    if grid.line:
        return line_contact_area(pressure, grid, periodic=periodic)
    return contact_area(pressure > 0, grid, periodic=periodic)


def radius_of_area(area: float, grid: Grid) -> float:
    """Radius of the circle with this area [m]; half the width of a line contact with this area per metre."""
    return 0.5 * area / grid.dy if grid.line else sqrt(area / pi)
