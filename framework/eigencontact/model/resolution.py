"""Resolution of contacts and regions by cells: expected errors, and the coarsest accepted cells."""

from __future__ import annotations

from collections.abc import Iterable
from math import inf, sqrt

from eigencontact.core.grid import Grid
from eigencontact.core.units import readable
from eigencontact.errors import SceneError
from eigencontact.model.sources import Source
from eigencontact.solvers.contact_estimate import ContactEstimate

__all__ = [
    "COARSEST",
    "FINE",
    "cells_above",
    "cells_across",
    "cells_per_radius",
    "edges_of_cells",
    "error_above",
    "percent",
    "pressure_error",
    "refuse_coarse",
    "refuse_coarse_regions",
]

#: Cells to a radius below which a contact is refused, and below which it is warned of.
COARSEST, FINE = 2.0, 8.0
#: A given number of cells may miss the bounds by this share: the radius is an estimate.
_SLACK = 0.05
_ROUND_OFF = 1e-9


def pressure_error(cells: float) -> float:
    """Bound of the relative error of the largest pressure of a contact with so many cells to a radius.

    Notes
    -----
    0.24 / n² for n of 2 and more; below, 0.5 / n², at most 1. Measured against Hertz's closed form, with the middle of
    the contact at 6 to 12 places in a cell: the largest error times n² is 0.16 to 0.23 for n from 2 to 32 (4 % at
    2, 1.5 % at 4, 0.4 % at 8), with either sign below n = 8. Under n = 1 the contact is one to four cells, the pressure
    the load over them: 0.48 of it is missing at 1, 0.87 at 0.5, 0.98 at 0.2.

    Examples
    --------
    >>> [f"{pressure_error(n):.4f}" for n in (0.1, 1, 2, 8)]
    ['1.0000', '0.5000', '0.0600', '0.0037']
    """
    return 0.24 / cells**2 if cells >= COARSEST else min(1.0, 0.5 / cells**2)


def cells_per_radius(contact: ContactEstimate, grid: Grid) -> float:
    """Cells to the half of the narrower side of a contact; a contact all along a period counts by its width."""
    pairs = list(zip(contact.extent, grid.edges, strict=False))
    along = grid.repeats_y and contact.extent[1] > (1.0 - _ROUND_OFF) * grid.size[1]
    return 0.5 * min(extent / edge for extent, edge in (pairs[:1] if along else pairs))


def refuse_coarse(contact: ContactEstimate, grid: Grid) -> None:
    """Refuse cells that are too coarse for a contact.

    Raises
    ------
    SceneError
        Fewer than `COARSEST` cells to a radius.
    """
    cells = cells_per_radius(contact, grid)
    if cells < COARSEST * (1.0 - _SLACK):
        radius = 0.5 * min(contact.extent)
        raise SceneError(
            f"grid must have at least {COARSEST:g} cells to a radius of the contact (got {cells:.2g}: cells of "
            f"{readable(max(grid.edges), 'm')} for an expected {readable(radius, 'm')}; the largest pressure may "
            f"be wrong by {percent(pressure_error(cells))}); give cells of {readable(radius / FINE, 'm')}, a smaller "
            'window, grid = "auto", or numerics.allow-coarse = true'
        )


def cells_across(source: Source, grid: Grid) -> float:
    """Cells across the narrowest extent of a region that is divided into cells; else infinity."""
    if source.lattice is None:
        return inf
    low, high = source.shape.bounds
    extents = zip(low, high, source.lattice.edges[::-1], strict=True)
    cells = [(hi - lo) / edge for lo, hi, edge in extents]
    return min(cells[axis] for axis in grid.bounded_axes)


def edges_of_cells(source: Source, grid: Grid) -> list[float]:
    """Edges of the cells of a region along its bounded axes [m]."""
    assert source.lattice is not None
    return [source.lattice.edges[2 - axis] for axis in grid.bounded_axes]


def refuse_coarse_regions(sources: Iterable[Source], grid: Grid) -> None:
    """Refuse cells wider than a region.

    Raises
    ------
    SceneError
        Naming the region.
    """
    for source in sources:
        cells = cells_across(source, grid)
        if cells < 1.0 - _ROUND_OFF:
            assert source.lattice is not None
            edges = " x ".join(readable(edge, "m") for edge in edges_of_cells(source, grid))
            raise SceneError(
                f"{source.where} ({source.name!r}) must have at least 1 cell across its narrowest extent (got "
                f"{cells:.2g} of {edges}); give a finer grid or numerics.inclusion-pitch, or set "
                "numerics.allow-coarse = true"
            )


def error_above(cells: float, least: float, most: float) -> float:
    """Bound of the error of the pressure above an inhomogeneity with so many cells between its top and the surface.

    Parameters
    ----------
    cells : float
        Depth of its top in cells.
    least, most : float
        Ratios of its stiffness to that of the body around, 0 for a void.

    Returns
    -------
    float
        In parts of the larger of the pressure above it and of the pressure without it.

    Notes
    -----
    K / max(cells, 0.8)², K the larger of 0.4 (1 - least)² and 0.065 (1 - 1 / most). Measured with balls of a quarter of
    the contact radius, 0.1 to 2 of their radii r below the surface, in 4 to 24 cells a radius, against the limit of
    fine cells: in the middle of the pressure, error x cells² is at most 0.03 for twice the stiffness, 0.06 for ten
    times, 0.05 for half, 0.16 for a tenth, 0.37 for a void. A void 0.25 r deep misses 5.2 % with 8 cells a radius and
    2.3 % with 16; 0.5 r deep 3.2 % with 4, 0.8 % with 6; 1 r deep 1.2 % with 4. Nearer than a cell the error no longer
    grows (8 % at most for ten times the stiffness, 0.1 r deep); that of a void there is not known, the limit of fine
    cells is not reached.

    Examples
    --------
    >>> [f"{error_above(cells, 0.0, 1.0):.3f}" for cells in (2, 4, 8)]
    ['0.100', '0.025', '0.006']
    """
    return _factor_above(least, most) / max(cells, 0.8) ** 2


def cells_above(error: float, least: float, most: float) -> float:
    """Cells between the top of an inhomogeneity and the surface for an error of the pressure."""
    return sqrt(_factor_above(least, most) / error)


def _factor_above(least: float, most: float) -> float:
    return max(0.4 * (1.0 - min(least, 1.0)) ** 2, 0.065 * (1.0 - 1.0 / max(most, 1.0)))


def percent(share: float) -> str:
    """Share in words."""
    return f"{100 * share:.0f} %" if share >= 0.1 else f"{100 * share:.2g} %"
