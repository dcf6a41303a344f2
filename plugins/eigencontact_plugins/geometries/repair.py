"""Preparation of measured heights: least-squares plane, and interpolation of missing points."""

from __future__ import annotations

import numpy as np

from eigencontact.plugin import FloatArray

__all__ = ["fitted_plane", "harmonic_fill"]


def fitted_plane(height: FloatArray) -> FloatArray:
    """Least-squares plane through the valid points of ``height (ny, nx)``; same shape."""
    ny, nx = height.shape
    row, column = np.linspace(-1, 1, ny)[:, None], np.linspace(-1, 1, nx)[None, :]
    basis = np.stack([np.ones((ny, nx)), row + 0 * column, column + 0 * row], axis=-1)
    measured = np.isfinite(height)
    coefficients, *_ = np.linalg.lstsq(basis[measured], height[measured], rcond=None)
    return np.asarray(basis @ coefficients)


def harmonic_fill(values: FloatArray, dx: float, dy: float) -> FloatArray:
    """Replace NaN in ``values (ny, nx)`` by the discrete harmonic function with zero slope across the border."""
    from scipy.sparse import coo_array
    from scipy.sparse.linalg import spsolve

    number = np.arange(values.size).reshape(values.shape)
    pairs = [(number[:, :-1], number[:, 1:], dx), (number[:-1], number[1:], dy)]
    a = np.concatenate([np.concatenate([p.ravel(), q.ravel()]) for p, q, _ in pairs])
    b = np.concatenate([np.concatenate([q.ravel(), p.ravel()]) for p, q, _ in pairs])
    weight = np.concatenate([np.full(2 * p.size, (dx * dy) / step**2) for p, _, step in pairs])
    unknown = np.isnan(values).ravel()
    rows = unknown[a]
    a, b, weight = a[rows], b[rows], weight[rows]
    place = np.cumsum(unknown) - 1
    filled = values.ravel().copy()
    n, inner = int(unknown.sum()), unknown[b]
    diagonal = np.bincount(place[a], weight, n)
    matrix = coo_array(
        (
            np.concatenate([diagonal, -weight[inner]]),
            (np.concatenate([np.arange(n), place[a[inner]]]), np.concatenate([np.arange(n), place[b[inner]]])),
        ),
        shape=(n, n),
    ).tocsc()
    right = np.bincount(place[a[~inner]], weight[~inner] * filled[b[~inner]], n)
    filled[unknown] = np.atleast_1d(spsolve(matrix, right))
    return filled.reshape(values.shape)
