"""Where regions of other material lie in a body: the cells that each fills, and the points where there is nothing."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.grid import Grid
from eigencontact.execution.cell_strain import fractions_in, place_in
from eigencontact.model.boxes import CellBox
from eigencontact.model.model import Model
from eigencontact.model.regions import RegionLattice
from eigencontact.model.sources import Inhomogeneity
from eigencontact.plugin import LinearLaw, VariesInSpace

__all__ = ["empty_points", "has_one_stiffness", "is_empty", "rises", "whole_cells"]

#: A share of a cell smaller than this is no part of it, as in `eigencontact.execution.material_cells`.
_LEAST = 1e-3

Points = tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]


def has_one_stiffness(source: Inhomogeneity) -> bool:
    """Whether a region is elastic with the same constants all over."""
    return isinstance(source.law, LinearLaw) and not isinstance(source.law, VariesInSpace)


def is_empty(source: Inhomogeneity) -> bool:
    """Whether a region carries no stress at all."""
    law = source.law  # the factors are bounded for every material; a rigid one has no stiffness to ask for
    return has_one_stiffness(source) and not np.any(law.factors(1.0)[1])  # type: ignore[attr-defined]


def rises(model: Model, body: int) -> bool:
    """Whether the regions of a body rise as its surface wears, so that they are no longer where the scene puts them."""
    return model.scene.wear is not None and body in model.scene.wear.parts


def whole_cells(box: CellBox, sources: Sequence[Inhomogeneity], grid: Grid, points: Points) -> NDArray[np.int_]:
    """Number (from 1) of the region of one stiffness that fills a cell wholly, else 0, ``(nz, ny, nx)``.

    Cells of regions that have no point in or next to them are left 0.
    """
    out = np.zeros(box.lattice.shape, dtype=int)
    for number, source in enumerate(sources, 1):
        assert source.lattice is not None
        if not _near(source, points, 2.0 * max(source.lattice.edges)).size:
            continue
        share = fractions_in(source, source.shape, grid)
        part = out[place_in(box, source.lattice)]
        part[share > _LEAST] = 0
        if has_one_stiffness(source):
            part[share > 1.0 - _LEAST] = number
    return out


def empty_points(sources: Sequence[Inhomogeneity], lattice: RegionLattice) -> NDArray[np.bool_] | None:
    """Whether points lie in a void, ``lattice.shape``; None if none does. Where regions overlap the later one wins."""
    if not any(map(is_empty, sources)):
        return None
    points = lattice.flat_points()
    out = np.zeros(points[0].size, dtype=bool)
    for source in sources:
        where = _near(source, points)
        if where.size:
            x, y, z = (axis[where] for axis in points)
            out[where[source.shape.contains(x, y, z)]] = is_empty(source)
    return out.reshape(lattice.shape) if out.any() else None


def _near(source: Inhomogeneity, points: Points, room: float = 0.0) -> NDArray[np.intp]:
    """Numbers of the points in the bounds of a region and a room about them."""
    low, high = source.shape.bounds
    inside = [(lo - room <= at) & (at <= hi + room) for lo, at, hi in zip(low, points, high, strict=True)]
    return np.flatnonzero(np.logical_and.reduce(inside))
