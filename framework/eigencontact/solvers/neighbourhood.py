"""Means over a neighbourhood in cells of a box, for softening materials."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.array_types import FloatArray

__all__ = ["Neighbourhood", "reach_of"]

#: Means below this fraction of the largest are round-off of the transforms, and set to zero.
_ROUNDING = 1e-12


def reach_of(radius: float, edges: tuple[float, float, float]) -> tuple[int, int, int]:
    """Number of neighbouring cells on each side along z, y, x; the weight is zero at the radius."""
    k, j, i = (max(int(np.ceil(radius / edge)) - 1, 0) for edge in edges)
    return k, j, i


class Neighbourhood:
    """Means over a radius R with the weight ``(1 - r²/R²)²``, with the distance r of two cell centres.

    Only the given cells contribute, with weights that sum to one: a constant field keeps its value at their boundary.

    Parameters
    ----------
    cells : (nz, ny, nx) of bool
        Cells that contribute.
    edges : (float, float, float)
        Edges of a cell along z, y, x [m].
    radius : float
        R [m].

    Examples
    --------
    >>> about = Neighbourhood(np.ones((1, 1, 4), dtype=bool), (1.0, 1.0, 1.0), 2.0)
    >>> about.means(np.array([[0.0, 0.0, 1.0, 1.0]])).round(3).tolist()
    [[0.0, 0.265, 0.735, 1.0]]
    """

    def __init__(self, cells: NDArray[np.bool_], edges: tuple[float, float, float], radius: float) -> None:
        self._cells = cells
        reach = np.minimum(reach_of(radius, edges), np.subtract(cells.shape, 1))
        z, y, x = np.ogrid[tuple(slice(-int(n), int(n) + 1) for n in reach)]
        squared = (z * edges[0]) ** 2 + (y * edges[1]) ** 2 + (x * edges[2]) ** 2
        self._weight = np.maximum(1.0 - squared / radius**2, 0.0) ** 2
        self._whole = self._summed(np.ones((1, int(cells.sum()))))

    def means(self, values: FloatArray) -> FloatArray:
        """Means ``(k, n)`` of k variables in each of the n contributing cells, in their order in the box."""
        out = self._summed(values) / self._whole
        out[np.abs(out) <= _ROUNDING * np.abs(values).max(initial=0.0)] = 0.0
        return np.asarray(out)

    def _summed(self, values: FloatArray) -> FloatArray:
        if self._weight.size == 1:
            return np.array(values)
        from scipy.signal import fftconvolve  # the import takes half a second, and few scenes need it

        box = np.zeros((len(values), *self._cells.shape))
        box[:, self._cells] = values
        return np.asarray(fftconvolve(box, self._weight[None], mode="same", axes=(1, 2, 3)))[:, self._cells]
