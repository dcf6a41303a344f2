"""Outlines of inclusions for pictures: as seen from above, and on the plane regions of a scene."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from eigencontact.planning.sources import Patch, Source

if TYPE_CHECKING:
    from eigencontact.planning.plan import Plan
    from eigencontact.scene.schema import StressRequest

__all__ = ["border", "outlines", "requests_of"]

FloatArray = NDArray[np.float64]
Inside = Callable[[FloatArray, FloatArray], NDArray[np.bool_]]

_NODES = 49
#: With more regions than this their outlines are drawn on fewer nodes.
_MANY = 50
_HALVINGS = 24


def outlines(plan: Plan) -> dict[str, FloatArray]:
    """Line segments ``(n, 2, 2)`` [m] by name.

    ``""`` is the view from above, places (x, y); a plane region has its name, places in the order horizontal, vertical
    of its picture: (x, z), (y, z) or (x, y). Regions that no inclusion touches are left out.
    """
    nodes = _NODES if len(plan.sources) <= _MANY else _NODES // 2
    found = {"": [_above(source, nodes) for source in plan.sources if not _fills(source, plan)]}
    for request in requests_of(plan):
        if request.shape == "plane":
            inner = [source for source in plan.sources if source.body == request.body]
            found[request.label] = [_section(source, request, nodes) for source in inner]
    joined = {name: np.concatenate([np.empty((0, 2, 2)), *parts]) for name, parts in found.items()}
    return {name: segments for name, segments in joined.items() if len(segments)}


def requests_of(plan: Plan) -> list[StressRequest]:
    """Regions as the blocks evaluate them, their places filled in."""
    from eigencontact.planning.close_up import resolved

    return resolved(plan.scene.stress, plan.sources, plan.grid)


def _fills(source: Source, plan: Plan) -> bool:
    """Whether a patch fills the whole window."""
    (x0, y0, _), (x1, y1, _) = source.shape.bounds
    width, height = plan.grid.size
    return isinstance(source.shape, Patch) and x1 - x0 >= 0.999 * width and y1 - y0 >= 0.999 * height


def _above(source: Source, nodes: int) -> FloatArray:
    low, high = source.shape.bounds
    share = (np.arange(25) + 0.5) / 25  # the middle, where most shapes are widest, among them
    depths = low[2] + share * (high[2] - low[2])

    def inside(x: FloatArray, y: FloatArray) -> NDArray[np.bool_]:
        return np.asarray(source.shape.contains(x[..., None], y[..., None], depths).any(axis=-1))

    return border(inside, (low[0], low[1]), (high[0], high[1]), nodes)


def _section(source: Source, request: StressRequest, nodes: int) -> FloatArray:
    """Outline on the plane of a region."""
    normal = "xyz".index(request.normal)
    low, high = source.shape.bounds
    if not low[normal] < request.at < high[normal]:
        return np.empty((0, 2, 2))
    first, second = (axis for axis in range(3) if axis != normal)

    def inside(u: FloatArray, v: FloatArray) -> NDArray[np.bool_]:
        at = [np.full(np.shape(u), request.at)] * 3
        at[first], at[second] = u, v
        return np.asarray(source.shape.contains(*at))

    return border(inside, (low[first], low[second]), (high[first], high[second]), nodes)


def border(inside: Inside, low: tuple[float, float], high: tuple[float, float], nodes: int = _NODES) -> FloatArray:
    """Border of a plane region as segments: marching squares, with crossings of the mesh found by halving.

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
    """Where the border crosses edges of the mesh, NaN where it does not, ``(..., 2)``."""
    out = np.full(begin.shape, np.nan)
    where = first != last
    a, b, known = begin[where].copy(), end[where].copy(), first[where]
    for _ in range(_HALVINGS if len(a) else 0):
        middle = 0.5 * (a + b)
        same = inside(middle[:, 0], middle[:, 1]) == known
        a[same], b[~same] = middle[same], middle[~same]
    out[where] = 0.5 * (a + b)
    return out
