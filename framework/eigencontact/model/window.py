"""Window of a scene: its grid, prescribed or chosen, and the expected contact."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import isqrt

import numpy as np

from eigencontact.core.grid import Grid
from eigencontact.errors import shown
from eigencontact.model.bodies import Bodies
from eigencontact.model.sizes import comfortable, refuse_more
from eigencontact.model.sources import region_of_patch
from eigencontact.scene.schema import GridSpec, Scene
from eigencontact.solvers.contact_estimate import ContactEstimate
from eigencontact.solvers.contact_growth import ContactGrowth

__all__ = ["Window", "given_grid", "window_of_regions"]

Point = tuple[float, float, float]

#: Cells along the longer side of a window that was chosen from the inclusions.
_CELLS = 128


@dataclass(frozen=True, kw_only=True, slots=True)
class Window:
    """Cells of the surface.

    Attributes
    ----------
    grid : Grid
    reason : str
        Origin of the grid, for `explain`.
    box : (int, int)
        Cells along (y, x) of the contact, by estimate; all cells where there is no contact.
    expected : ContactEstimate or None
        Largest contact of the load history, by estimate, on homogeneous bodies or layers without inclusions; None
        without one.
    growth : ContactGrowth or None
        Growth of the contact radius; None where no load step is even in the radius.
    """

    grid: Grid
    reason: str
    box: tuple[int, int]
    expected: ContactEstimate | None = None
    growth: ContactGrowth | None = None

    @property
    def nbytes(self) -> int:
        """Memory of the curve of growth [bytes]."""
        return 0 if self.growth is None else self.growth.radius.nbytes + self.growth.normal_load.nbytes


def window_of_regions(scene: Scene, bodies: Bodies) -> Window:
    """Window of a scene without a contact: prescribed, or around its regions."""
    grid, reason = given_grid(scene.grid), "given in the scene"
    if grid is None:
        bounds = [source.shape.bounds for source in (*bodies.prescribed, *bodies.inhomogeneities)]
        bounds += [region_of_patch(scene, number, None).bounds for number in range(len(scene.eigenstrain))]
        grid, reason = _grid_around(bounds), "automatic: around all inclusions, and four times their depth"
    return Window(grid=grid, reason=reason, box=grid.shape)


def given_grid(spec: GridSpec) -> Grid | None:
    """Grid of two of cells, size, spacing; None for an automatic one.

    Raises
    ------
    SceneError
        More cells than the memory of this machine can hold.
    """
    if spec.automatic:
        return None
    counts, edges = spec.cells, spec.spacing
    if counts is None:
        assert spec.size is not None
        assert spec.spacing is not None
        nx, ny = (max(1, round(size / pitch)) for size, pitch in zip(spec.size, spec.spacing, strict=True))
        counts = nx, ny
    if spec.size is not None:
        edges = spec.size[0] / counts[0], spec.size[1] / counts[1]
    assert edges is not None
    grid = spec.with_cells(*counts, *edges, spec.center)
    _refuse_many(grid.nx, grid.ny, "grid.cells" if spec.cells is not None else "grid.spacing")
    return grid


def _refuse_many(nx: int, ny: int, where: str) -> None:
    """Refuse more cells than the memory permits; the message proposes a number that keeps the shorter side."""
    wide = min(nx, max(isqrt(comfortable()), comfortable() // ny))
    high = min(ny, comfortable() // wide)
    refuse_more(nx * ny, where, "cells", f"{shown(nx)} x {shown(ny)}", f"{wide} x {high} would do")


def _grid_around(bounds: Sequence[tuple[Point, Point]]) -> Grid:
    """Square cells, 128 along the longer side, over a window around regions.

    Each side is that of the box around all regions and four times the depth of its middle: the surface displacement
    of a small region falls to a tenth within twice its depth.
    """
    low = np.min([box[0] for box in bounds], axis=0)
    high = np.max([box[1] for box in bounds], axis=0)
    middle = 0.5 * (low + high)
    width, height = (high - low)[:2] + 4.0 * max(abs(float(middle[2])), 0.5 * float(high[2] - low[2]))
    edge = float(max(width, height)) / _CELLS
    nx, ny = (2 * max(1, int(np.ceil(0.5 * side / edge - 1e-6))) for side in (width, height))
    return Grid(nx=nx, ny=ny, dx=edge, dy=edge, center=(float(middle[0]), float(middle[1])))
