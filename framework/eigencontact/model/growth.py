"""Growth of the cells of yielding bodies: larger lattices, and lattices of stored results."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.array_types import FloatArray
from eigencontact.core.grid import Grid
from eigencontact.model.sources import Inhomogeneity, Lattice

__all__ = ["enlarged", "filling", "lattice_of"]

IntArray = NDArray[np.intp]

#: Growth beyond a face that is reached, in parts of the size of the box, and at least [cells].
_SHARE, _LEAST = 0.35, 2


def enlarged(lattice: Lattice, reached: IntArray, width: tuple[int, int, int] = (1, 1, 1)) -> Lattice:
    """Lattice with room beyond the faces that some cells reach.

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


def filling(sources: Sequence[Inhomogeneity], lattice: Lattice, *, beside: bool = False) -> tuple[Inhomogeneity, ...]:
    """Inhomogeneities of a body whose yielding cells fill a lattice; `beside` also keeps their present cells."""
    return tuple(
        replace(source, lattice=_union(source.lattice, lattice) if beside else lattice)
        if source.guessed and source.lattice is not None
        else source
        for source in sources
    )


def _union(first: Lattice, second: Lattice) -> Lattice:
    """Smallest lattice that contains two lattices, with the cells of the second."""
    low = np.minimum(first.first, second.first)
    high = np.maximum(np.add(first.first, first.shape), np.add(second.first, second.shape))
    return _between(low, high, second.edges)


def _between(first: IntArray, stop: IntArray, edges: tuple[float, float, float]) -> Lattice:
    """Lattice from its first cell to a last cell, which is excluded."""
    k, j, i = (int(value) for value in first)
    nz, ny, nx = (int(value) for value in stop - first)
    return Lattice((k, j, i), (nz, ny, nx), edges)
