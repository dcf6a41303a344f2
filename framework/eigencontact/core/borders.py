"""Borders of plane regions, as line segments."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.array_types import FloatArray

__all__ = ["Inside", "border"]

Inside = Callable[[FloatArray, FloatArray], NDArray[np.bool_]]

#: Nodes of the mesh each way.
_NODES = 49
#: Halvings that find a crossing of an edge of the mesh.
_HALVINGS = 24


def border(inside: Inside, low: tuple[float, float], high: tuple[float, float], nodes: int = _NODES) -> FloatArray:
    """Border of a plane region as segments: marching squares, with mesh crossings located by bisection.

    Parameters
    ----------
    inside : callable
        Whether points (u, v), two arrays of one shape, lie in the region.
    low, high : (float, float)
        Box that holds the region.

    Returns
    -------
    (n, 2, 2)
        Segments: number, end, (u, v).
    """
    (u0, v0), (u1, v1) = low, high
    inner = 1e-9
    corners = np.array([[u0, v0], [u1, v0], [u1, v1], [u0, v1]])
    near = corners + inner * (corners.mean(axis=0) - corners)
    if inside(near[:, 0], near[:, 1]).all():  # a rectangle, whose corners a mesh would cut
        return np.stack([corners, np.roll(corners, -1, axis=0)], axis=1)
    u, v = (np.linspace(lo - 0.02 * (hi - lo), hi + 0.02 * (hi - lo), nodes) for lo, hi in ((u0, u1), (v0, v1)))
    points = np.stack(np.meshgrid(u, v, indexing="xy"), axis=-1)
    mask = inside(points[..., 0], points[..., 1])
    along = _crossings(inside, points[:, :-1], points[:, 1:], mask[:, :-1], mask[:, 1:])
    across = _crossings(inside, points[:-1], points[1:], mask[:-1], mask[1:])
    # The four edges of every square, in order around it; NaN where the border does not cross.
    edges = np.stack([along[:-1], across[:, 1:], along[1:], across[:, :-1]], axis=2).reshape(-1, 4, 2)
    crossed = np.isfinite(edges[..., 0])
    edges = np.take_along_axis(edges, np.argsort(~crossed, axis=1, kind="stable")[..., None], axis=1)
    count = crossed.sum(axis=1)
    return np.concatenate([edges[count >= 2][:, :2], edges[count == 4][:, 2:]])


def _crossings(
    inside: Inside, begin: FloatArray, end: FloatArray, first: NDArray[np.bool_], last: NDArray[np.bool_]
) -> FloatArray:
    """Crossings of the border with edges of the mesh ``(..., 2)``; NaN for edges without one."""
    out = np.full(begin.shape, np.nan)
    where = first != last
    a, b, start_inside = begin[where].copy(), end[where].copy(), first[where]
    for _ in range(_HALVINGS if len(a) else 0):
        middle = 0.5 * (a + b)
        as_start = inside(middle[:, 0], middle[:, 1]) == start_inside
        a[as_start], b[~as_start] = middle[as_start], middle[~as_start]
    out[where] = 0.5 * (a + b)
    return out
