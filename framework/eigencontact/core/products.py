"""Matrix products and vector norms in the calling thread only."""

from __future__ import annotations

import numpy as np

from eigencontact.core.array_types import FloatArray

__all__ = ["distance_of", "norm_of", "product"]

# Edge of the tiles. OpenBLAS starts threads of its own for more than 2^18 = 64³ multiplications, and these wait for
# each other where other work holds the cores: on two shared cores the 101 depths of 'coated-sphere' took 9 s instead of
# 0.4 s. Tiles take up to twice the time of one call on one thread.
TILE = 64
# A left matrix of so few entries, as of Mandel components, is multiplied without OpenBLAS.
_MAX_SMALL_ENTRIES = 64
# Numbers of which differences are taken at a time: they stay in a cache.
_AT_ONCE = 1 << 14


def product(left: FloatArray, right: FloatArray) -> FloatArray:
    """Product ``(m, n)`` of matrices ``(m, k)`` and ``(k, n)``.

    Examples
    --------
    >>> float(product(np.ones((100, 70)), np.ones((70, 90)))[99, 89])
    70.0
    """
    (m, k), n = left.shape, right.shape[1]
    if m * k * n <= TILE**3:
        return np.asarray(left @ right)
    if m * k <= _MAX_SMALL_ENTRIES:
        return np.asarray(np.einsum("ij,jn->in", left, right))
    out = np.zeros((m, n))
    for z in range(0, k, TILE):
        for x in range(0, n, TILE):
            tile = right[z : z + TILE, x : x + TILE]
            for y in range(0, m, TILE):
                out[y : y + TILE, x : x + TILE] += left[y : y + TILE, z : z + TILE] @ tile
    return out


def norm_of(values: FloatArray) -> float:
    """Root of the sum of squares of all entries.

    Examples
    --------
    >>> norm_of(np.array([[3.0], [4.0]]))
    5.0
    """
    flat = values.ravel()
    return float(np.sqrt(np.einsum("i,i->", flat, flat)))


def distance_of(left: FloatArray, right: FloatArray) -> float:
    """`norm_of` the difference of two arrays of one shape, without an array of the difference.

    Examples
    --------
    >>> distance_of(np.array([[3.0], [4.0]]), np.array([[0.0], [8.0]]))
    5.0
    """
    left, right, total = left.ravel(), right.ravel(), 0.0
    for first in range(0, left.size, _AT_ONCE):
        difference = left[first : first + _AT_ONCE] - right[first : first + _AT_ONCE]
        total += float(np.einsum("i,i->", difference, difference))
    return float(np.sqrt(total))
