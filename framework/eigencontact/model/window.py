"""How large the contact will be, by a coarse solve; and from it the grid of an automatic scene."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.grid import Box, Grid
from eigencontact.errors import EigencontactError, PlanError, SceneError
from eigencontact.model.contact_estimate import ContactEstimate
from eigencontact.model.sizes import cut_down, most, refuse_more
from eigencontact.scene.schema import GridSpec
from eigencontact.solvers.control import Control
from eigencontact.solvers.normal import NormalOptions, NormalSolver
from eigencontact.solvers.operator import Coefficients

__all__ = ["Separation", "automatic_grid", "close_estimate", "coarse_contact", "estimate_contact"]

FloatArray = NDArray[np.float64]
Separation = Callable[[FloatArray, FloatArray], FloatArray]

_CELLS = 48
_FINER = 144


def coarse_contact(
    grid: Grid,
    separation: Separation,
    coefficients: Coefficients,
    control: Control,
    *,
    periodic: bool,
    cells: int = _CELLS,
) -> tuple[Grid, FloatArray] | None:
    """At most `cells` each way over the window of `grid`, and pressure [Pa] in them; None where it is not found."""
    width, height = grid.size
    nx, ny = min(grid.nx, cells), min(grid.ny, cells)
    coarse = Grid(nx=nx, ny=ny, dx=width / nx, dy=height / ny, center=grid.center)
    y, x = coarse.axes()
    h = np.broadcast_to(np.asarray(separation(x, y), dtype=float), coarse.shape)
    options = NormalOptions(tolerance=1e-2, periodic=periodic, allow_contact_at_edge=True)
    try:
        return coarse, NormalSolver(coarse, coefficients, options).solve(h, control).pressure
    except SceneError:  # a body that is refused, not a contact that is not found
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
    """Contact on at most `cells` each way over the window of `grid`; None where nothing touches or it fails."""
    found = coarse_contact(grid, separation, coefficients, control, periodic=periodic, cells=cells)
    box = None if found is None else Box.around(found[1] > 0)
    if found is None or box is None:
        return None
    coarse, pressure = found
    left, bottom = float(coarse.x[0]) - 0.5 * coarse.dx, float(coarse.y[0]) - 0.5 * coarse.dy
    return ContactEstimate(
        left + box.x0 * coarse.dx,
        left + box.x1 * coarse.dx,
        bottom + box.y0 * coarse.dy,
        bottom + box.y1 * coarse.dy,
        float(pressure.max()),
    )


def close_estimate(
    grid: Grid, separation: Separation, coefficients: Coefficients, control: Control
) -> ContactEstimate | None:
    """Contact on cells of its own size, however large the window of `grid` is; None where nothing touches."""
    return _settle(grid.center, separation, coefficients, control, max(grid.size))


def automatic_grid(
    spec: GridSpec,
    separation: Separation,
    coefficients: Coefficients,
    controls: Sequence[tuple[Control, tuple[float, float]]],
    start: float,
) -> Grid:
    """Grid that resolves the largest contact of the load history with the cells per contact radius asked for.

    Parameters
    ----------
    controls : sequence of (Control, (float, float))
        End of each step, and the place (x, y) [m] to which the geometry has rolled by then.
    start : float
        A first guess of the window's side [m]; windows are enlarged or cut until the contact fills about half.

    Raises
    ------
    PlanError
        Where no window holds the contact (no load, a geometry without rise).
    SceneError
        More cells than the memory of this machine can hold.
    """
    found: ContactEstimate | None = None
    across = 0.0
    for control, travel in controls:
        estimate = _settle(spec.center, separation, coefficients, control, start)
        if estimate is not None:
            across = max(across, min(estimate.extent))
            estimate = estimate.moved(travel)
            found = estimate if found is None else found.join(estimate)
    rolls = any(travel != (0.0, 0.0) for _, travel in controls)
    if found is None:
        raise PlanError(
            "grid must be given for this scene (got automatic); no step makes a contact from which cells could be "
            "chosen: give grid.cells and grid.size, or a load"
        )
    wide, high = found.extent
    edge = 0.5 * (across if rolls else min(wide, high)) / spec.cells_per_contact_radius
    center = (0.5 * (found.x0 + found.x1), 0.5 * (found.y0 + found.y1))
    # An even number of cells, symmetric about the contact.
    nx, ny = (2 * max(1, int(np.ceil(0.5 * spec.margin * extent / edge - 1e-6))) for extent in (wide, high))
    _refuse_many(nx * ny, spec)
    # A centre within a cell of the origin is the origin: symmetric scenes stay symmetric.
    center = tuple(0.0 if abs(value) < 0.06 * max(wide, high) else value for value in center)  # type: ignore[assignment]
    return Grid(nx=nx, ny=ny, dx=edge, dy=edge, center=center)


def _refuse_many(cells: int, spec: GridSpec) -> None:
    """Refuse more cells than fit: by the margin where the contact alone would have fewer, else by its cells."""
    usual = GridSpec.model_fields["margin"].default
    wide = spec.margin > usual and cells * (usual / spec.margin) ** 2 <= most()
    name = "margin" if wide else "cells_per_contact_radius"
    given = getattr(spec, name)
    where = f"grid.{name.replace('_', '-')}"
    refuse_more(cells, where, "cells", f"{given:g}", f"{cut_down(given, cells, 2):g} would do")


def _settle(
    place: tuple[float, float], separation: Separation, coefficients: Coefficients, control: Control, start: float
) -> ContactEstimate | None:
    """Contact of one control, on a window that it fills by a third to four fifths."""
    size = np.array([start, start])
    center = np.array(place, dtype=float)
    for _ in range(60):
        cell = size / _CELLS
        grid = Grid(nx=_CELLS, ny=_CELLS, dx=cell[0], dy=cell[1], center=(float(center[0]), float(center[1])))
        estimate = estimate_contact(grid, separation, coefficients, control, periodic=False)
        if estimate is None:
            return None
        extent = np.array(estimate.extent)
        middle = 0.5 * np.array([estimate.x0 + estimate.x1, estimate.y0 + estimate.y1])
        share = extent / size
        edge = 0.5 - np.abs(middle - center) / size - 0.5 * share
        if np.all(share < 0.8) and np.all(share > 0.3) and np.all(edge > 0.02):
            # Once more on finer cells: a box of whole cells overstates the contact by about one of them.
            cell = 1.25 * extent / _FINER
            close = Grid(nx=_FINER, ny=_FINER, dx=cell[0], dy=cell[1], center=(float(middle[0]), float(middle[1])))
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
