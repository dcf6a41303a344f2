"""Prescribed eigenstrain of regions that are divided into cells, at any time."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from eigencontact.core.array_types import FloatArray
from eigencontact.core.arrays import real_answer
from eigencontact.core.grid import Grid
from eigencontact.errors import require
from eigencontact.model.boxes import CellBox
from eigencontact.model.sources import Lattice, Patch, Source

if TYPE_CHECKING:
    from eigencontact.halfspace.voxels import Region

__all__ = ["CellStrain", "fractions_in", "place_in", "values_of"]

Place = tuple[slice, slice, slice]


class CellStrain:
    """Mandel eigenstrain of a group of sources in cells: centre value times volume fraction."""

    def __init__(self, box: CellBox, grid: Grid) -> None:
        self._box, self._grid = box, grid

    def __call__(self, time: float) -> FloatArray:
        """Mandel eigenstrain ``(6, nz, ny, nx)`` at one time [-]."""
        total = np.zeros((6, *self._box.lattice.shape))
        z, y, x = self._box.lattice.axes(self._grid)
        for source, (place, fractions) in zip(self._box.sources, self._fractions, strict=True):
            cells = total[:, *place]
            cells += fractions * values_of(source, x[place[2]], y[place[1]], z[place[0]], time)
        return total

    @cached_property
    def _fractions(self) -> list[tuple[Place, FloatArray]]:
        """Part of the box for each source, and the volume fraction of the source in each of its cells."""
        fractions = []
        for source in self._box.sources:
            assert source.lattice is not None
            whole = np.ones(source.lattice.shape)
            inside = whole if isinstance(source.shape, Patch) else fractions_in(source, source.shape, self._grid)
            rule = f"fine enough to find {source.name!r}"
            require(inside.any(), source.where, "cells", source.lattice.shape[::-1], rule)
            fractions.append((place_in(self._box, source.lattice), inside))
        return fractions


def place_in(box: CellBox, lattice: Lattice) -> Place:
    """Part of a box with the cells of a region, along (z, y, x)."""
    start = np.subtract(lattice.first, box.lattice.first)
    k, j, i = (slice(int(first), int(first) + count) for first, count in zip(start, lattice.shape, strict=True))
    return k, j, i


def fractions_in(source: Source, region: Region, grid: Grid) -> FloatArray:
    """Volume fraction of each cell of a source in a region, ``(nz, ny, nx)``."""
    from eigencontact.halfspace.voxels import Voxels, volume_fractions

    lattice = source.lattice
    assert lattice is not None
    low = [float(axis[0]) - 0.5 * edge for axis, edge in zip(lattice.axes(grid), lattice.edges, strict=True)]
    return volume_fractions(region, Voxels(low[::-1], lattice.edges[::-1], lattice.shape))


def values_of(source: Source, x: FloatArray, y: FloatArray, z: FloatArray, time: float) -> FloatArray:
    """Mandel eigenstrain of a source's field at the points of three axes, ``(6, nz, ny, nx)``."""
    shape = (6, z.size, y.size, x.size)
    answer = source.field.eigenstrain(x[None, None, :], y[None, :, None], z[:, None, None], time)
    values = real_answer(answer, f"{source.where}: eigenstrain of eigenstrain field {source.field.key!r}", shape)
    require(np.all(np.isfinite(values)), source.where, "eigenstrain", "NaN or infinity", "finite in every cell")
    return values
