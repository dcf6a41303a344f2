"""Outlines of inclusions for pictures: from above, and on the plane regions of a scene."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.array_types import FloatArray
from eigencontact.core.borders import border
from eigencontact.core.grid import Grid
from eigencontact.model.model import Model
from eigencontact.model.sources import Patch, Source

__all__ = ["outlines", "section_outline"]


_NODES = 49
#: With more regions than this their outlines are drawn on fewer nodes.
_MAX_FINE_REGIONS = 50


def outlines(model: Model) -> dict[str, FloatArray]:
    """Line segments ``(n, 2, 2)`` [m] by name.

    ``""`` is the view from above, places (x, y); a plane region has its name, places in the order horizontal, vertical
    of its picture: (x, z), (y, z) or (x, y). Regions that no inclusion touches are left out, and so are boxes that were
    guessed: nothing changes at their faces.
    """
    sources = [source for source in model.sources if not source.guessed]
    nodes = _NODES if len(sources) <= _MAX_FINE_REGIONS else _NODES // 2
    lines = {"": [_above(source, nodes) for source in sources if not _fills(source, model.grid)]}
    for request in model.cells.requests:
        if request.shape == "plane":
            inner = [source for source in sources if source.body == request.body]
            lines[request.label] = [section_outline(source, request.normal, request.at, nodes) for source in inner]
    joined = {name: np.concatenate([np.empty((0, 2, 2)), *parts]) for name, parts in lines.items()}
    return {name: segments for name, segments in joined.items() if len(segments)}


def _fills(source: Source, grid: Grid) -> bool:
    """Whether a patch fills the whole window."""
    (x0, y0, _), (x1, y1, _) = source.shape.bounds
    width, height = grid.size
    return isinstance(source.shape, Patch) and x1 - x0 >= 0.999 * width and y1 - y0 >= 0.999 * height


def _above(source: Source, nodes: int) -> FloatArray:
    low, high = source.shape.bounds
    share = (np.arange(25) + 0.5) / 25  # the middle, where most shapes are widest, among them
    depths = low[2] + share * (high[2] - low[2])

    def inside(x: FloatArray, y: FloatArray) -> NDArray[np.bool_]:
        return np.asarray(source.shape.contains(x[..., None], y[..., None], depths).any(axis=-1))

    return border(inside, (low[0], low[1]), (high[0], high[1]), nodes)


def section_outline(source: Source, axis: str, place: float, nodes: int = _NODES) -> FloatArray:
    """Outline on a plane, as segments ``(n, 2, 2)`` [m] of coordinates like those of `outlines`.

    Parameters
    ----------
    source : Source
        Inclusion.
    axis, place : str, float
        Axis normal to the plane, and where it cuts it [m].
    nodes : int
        Of the mesh in which the outline is found, each way.
    """
    normal = "xyz".index(axis)
    low, high = source.shape.bounds
    if not low[normal] < place < high[normal]:
        return np.empty((0, 2, 2))
    first, second = (direction for direction in range(3) if direction != normal)

    def inside(u: FloatArray, v: FloatArray) -> NDArray[np.bool_]:
        at = [np.full(np.shape(u), place)] * 3
        at[first], at[second] = u, v
        return np.asarray(source.shape.contains(*at))

    return border(inside, (low[first], low[second]), (high[first], high[second]), nodes)
