"""Larger boxes of cells for bodies whose law reaches the rim of the box that was guessed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.grid import Grid
from eigencontact.model.model import Model
from eigencontact.model.sources import Inhomogeneity, Lattice

__all__ = ["enlarged", "lattice_of", "with_lattice"]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.intp]

#: What a box gains beyond a face that was reached, in parts of its size, and at least [cells].
_SHARE, _LEAST = 0.35, 2


def enlarged(lattice: Lattice, reached: IntArray, width: tuple[int, int, int] = (1, 1, 1)) -> Lattice:
    """Lattice with room beyond the faces that some of its cells have reached.

    Parameters
    ----------
    lattice : Lattice
    reached : (n, 3) of int
        Indices (layer, row, column) of the cells, counted in the lattice.
    width : (int, int, int)
        Of the rim along z, y, x [cells].
    """
    low, high = np.zeros(3, dtype=int), np.array(lattice.shape)
    more = np.maximum(np.ceil(_SHARE * high).astype(int), np.maximum(width, _LEAST))
    below = (reached.min(axis=0) < width) * more
    above = (reached.max(axis=0) >= high - width) * more
    below[0] = min(int(below[0]), lattice.first[0])  # no cell lies above the surface
    return _between(np.array(lattice.first) + low - below, np.array(lattice.first) + high + above, lattice.edges)


def lattice_of(coords: Mapping[str, FloatArray], edges: tuple[float, float, float], grid: Grid) -> Lattice:
    """Lattice of cells by their centres along z, y, x."""
    starts = (0.5 * edges[0], float(grid.y[0]), float(grid.x[0]))
    first = [
        round((float(coords[axis][0]) - start) / edge) for axis, start, edge in zip("zyx", starts, edges, strict=True)
    ]
    low = np.array(first)
    return _between(low, low + [len(coords[axis]) for axis in "zyx"], edges)


def with_lattice(model: Model, body: int, lattice: Lattice) -> Model:
    """Model in which the cells of a body's own law fill a lattice, and whatever they filled."""

    def changed(source: Inhomogeneity) -> Inhomogeneity:
        if not (source.guessed and source.body == body and source.lattice is not None):
            return source
        low = np.minimum(source.lattice.first, lattice.first)
        ends = [np.add(one.first, one.shape) for one in (source.lattice, lattice)]
        return replace(source, lattice=_between(low, np.maximum(*ends), lattice.edges))

    return replace(model, inhomogeneities=tuple(map(changed, model.inhomogeneities)))


def _between(first: IntArray, stop: IntArray, edges: tuple[float, float, float]) -> Lattice:
    k, j, i = (int(value) for value in first)
    nz, ny, nx = (int(value) for value in stop - first)
    return Lattice((k, j, i), (nz, ny, nx), edges)
