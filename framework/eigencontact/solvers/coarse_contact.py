"""Extent and largest pressure of a contact from a solution on few cells."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from eigencontact.core.array_types import FloatArray
from eigencontact.core.grid import Box, Grid, MakeGrid
from eigencontact.errors import EigencontactError, SceneError
from eigencontact.solvers.contact_estimate import ContactEstimate
from eigencontact.solvers.control import Control
from eigencontact.solvers.normal import NormalOptions, NormalSolver
from eigencontact.solvers.operator import Coefficients

__all__ = ["Separation", "close_estimate", "coarse_contact", "estimate_contact", "settled_estimate"]

Separation = Callable[[FloatArray, FloatArray], FloatArray]

#: Cells across the window of a coarse solve, and of the last solve with a window fitted to the contact.
_CELLS, _FINER = 48, 144


def coarse_contact(
    grid: Grid,
    separation: Separation,
    coefficients: Coefficients,
    control: Control,
    *,
    periodic: bool,
    cells: int = _CELLS,
) -> tuple[Grid, FloatArray] | None:
    """Grid of at most `cells` in each direction over the window of `grid`, and its pressure [Pa]; None if it fails."""
    width, height = grid.size
    nx, ny = min(grid.nx, cells), min(grid.ny, cells)
    coarse = replace(grid, nx=nx, ny=ny, dx=width / nx, dy=height / ny)
    y, x = coarse.axes()
    h = np.broadcast_to(np.asarray(separation(x, y), dtype=float), coarse.shape)
    options = NormalOptions(tolerance=1e-2, periodic=periodic, allow_contact_at_edge=True)
    try:
        return coarse, NormalSolver(coarse, coefficients, options).solve(h, control).pressure
    except SceneError:  # invalid body
        raise
    except EigencontactError:
        return None


def estimate_contact(
    grid: Grid,
    separation: Separation,
    coefficients: Coefficients,
    control: Control,
    *,
    periodic: bool,
    cells: int = _CELLS,
) -> ContactEstimate | None:
    """Contact on at most `cells` in each direction over the window of `grid`; None without contact or convergence."""
    solution = coarse_contact(grid, separation, coefficients, control, periodic=periodic, cells=cells)
    if solution is None:
        return None
    coarse, pressure = solution
    box = Box.around(pressure > 0)
    if box is None:
        return None
    left, bottom = float(coarse.x[0]) - 0.5 * coarse.dx, float(coarse.y[0]) - 0.5 * coarse.dy
    x0, x1 = left + box.x0 * coarse.dx, left + box.x1 * coarse.dx
    if 1 not in grid.bounded_axes:
        half = 0.5 * (x1 - x0)
        return ContactEstimate(x0, x1, -half, half, float(pressure.max()))
    return ContactEstimate(
        x0,
        x1,
        bottom + box.y0 * coarse.dy,
        bottom + box.y1 * coarse.dy,
        float(pressure.max()),
    )


def close_estimate(
    grid: Grid, separation: Separation, coefficients: Coefficients, control: Control
) -> ContactEstimate | None:
    """Contact on cells of suitable size, independent of the window of `grid`; None without contact."""
    return settled_estimate(grid.center, separation, coefficients, control, max(grid.sides), grid.with_cells)


def settled_estimate(
    place: tuple[float, float],
    separation: Separation,
    coefficients: Coefficients,
    control: Control,
    start: float,
    cells: MakeGrid = Grid.of,
) -> ContactEstimate | None:
    """Contact on a window that it fills by a third to four fifths; the search starts with a side of `start` [m]."""
    size = np.array([start, start])
    center = np.array(place, dtype=float)
    for _ in range(60):
        dx, dy = size / _CELLS
        grid = cells(_CELLS, _CELLS, float(dx), float(dy), (float(center[0]), float(center[1])))
        estimate = estimate_contact(grid, separation, coefficients, control, periodic=False)
        if estimate is None:
            return None
        extent = np.array(estimate.extent)
        middle = 0.5 * np.array([estimate.x0 + estimate.x1, estimate.y0 + estimate.y1])
        share = extent / size
        edge = 0.5 - np.abs(middle - center) / size - 0.5 * share
        if np.all(share < 0.8) and np.all(share > 0.3) and np.all(edge > 0.02):
            # Repeat on finer cells: a box of whole cells overestimates the contact by about one cell.
            dx, dy = 1.25 * extent / _FINER
            close = cells(_FINER, _FINER, float(dx), float(dy), (float(middle[0]), float(middle[1])))
            return estimate_contact(close, separation, coefficients, control, periodic=False, cells=_FINER)
        if np.all(share <= 2.5 / _CELLS):
            size = size / 8.0
        else:
            size = np.where((share > 0.8) | (edge < 0.02), 2.5 * size, np.clip(1.8 * extent, 0.1 * size, size))
        if not (size.min() > 1e-30 and size.max() < 1e12):
            break
        if np.any(share < 0.3):
            center = np.where(share < 0.3, middle, center)
    return None
