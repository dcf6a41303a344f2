"""Small cells that a mesh follows: which they are, their faces as lines of a mesh, and where their content jumps.

Stress jumps at faces of cells that differ, and elements across these do not converge to it. In the middle of cells,
where the law of a run holds, elements that lie within one cell each are most exact.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from eigencontact_verification.fem.loaded_body import Cells, LoadedBody
from eigencontact_verification.fem.loaded_symmetry import boxes_of
from eigencontact_verification.fem.mesh import Grid

__all__ = ["MOST_EDGES", "followed_faces", "has_small_cells", "jumps_on_lines"]

FloatArray = NDArray[np.float64]

#: Cells with no more edges than this along an axis are large: each edge is a line of every mesh.
MOST_EDGES = 5
#: Part of the largest content of cells below which it does not count.
_COUNTS = 1e-3
#: Of a stretch of cells, the distance from where stress is read at which one element may stand for all of it.
_APART = 0.5


def _edges(cells: Cells, axis: int) -> FloatArray:
    return (cells.x, cells.y, cells.z)[axis]


def has_small_cells(body: LoadedBody) -> bool:
    """Whether some axis of a body has more cells than every mesh follows."""
    return any(_edges(cells, axis).size > MOST_EDGES for cells in body.cells for axis in range(3))


def followed_faces(body: LoadedBody, axis: int, low: float, step: int, near: FloatArray) -> FloatArray:
    """Faces of small cells along an axis, for the lines of a coarse mesh.

    They cover what cells hold, and the places where stress is read as far as there are cells.

    Parameters
    ----------
    body : LoadedBody
    axis : {0, 1, 2}
    low : float
        Where the mesh begins.
    step : int
        Cells between two of these faces; twice and four times as many at a distance from where stress is read, and
        from what cells hold.
    near : (n,) array
        Coordinates where stress is read; none: everywhere.

    Returns
    -------
    (m,) array
        Ascending; empty without small cells along this axis.
    """
    small = [_edges(cells, axis) for cells in body.cells if _edges(cells, axis).size > MOST_EDGES]
    boxes = [box for kind, box in boxes_of(replace(body, tractions=None, regions=()), _COUNTS) if kind == "cells"]
    if not (small and boxes):
        return np.empty(0)
    edges = min(small, key=lambda line: float(np.diff(line).min()))
    edges = edges[edges >= low - 1e-6 * (edges[1] - edges[0])]
    size = float(edges[1] - edges[0])
    filled = min(float(box[0, axis]) for box in boxes), max(float(box[1, axis]) for box in boxes)
    targets = np.clip(np.append(near, filled), edges[0], edges[-1])
    start = edges[edges <= targets.min() + 1e-6 * size][-1]
    (top, bottom), last = ((place - start) / size for place in filled), (float(targets.max()) - start) / size
    read, at, faces = (near - start) / size, 0, [0]
    while at < last - 1e-6:
        stride = step
        for longer in (4 * step, 2 * step):
            gap = np.maximum(at - read, read - at - longer).min() if read.size else 0.0
            if max(gap, top - at - longer, at - bottom) >= _APART * longer:
                stride = longer
                break
        at += stride
        faces.append(at)
    return np.asarray(start + size * np.asarray(faces, dtype=float))


def jumps_on_lines(body: LoadedBody, grid: Grid) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Coordinates along x, y, z of lines of a mesh at which the content of small cells jumps."""
    coordinates: list[list[float]] = [[], [], []]
    for cells in body.cells:
        strain = cells.eigenstrain.reshape(9, *cells.eigenstrain.shape[2:])
        fields = [(strain, _COUNTS * float(np.abs(strain).max()))]
        fields += [] if cells.stiffness_factor is None else [(1.0 - cells.stiffness_factor[None], _COUNTS)]
        for axis in range(3):
            edges, along = _edges(cells, axis), 3 - axis
            if edges.size <= MOST_EDGES:
                continue
            jumps = np.zeros(edges.size, dtype=bool)
            for field, least in fields:
                outside = [(1, 1) if k == along else (0, 0) for k in range(4)]
                steps = np.abs(np.diff(np.pad(field, outside), axis=along))
                jumps |= steps.max(axis=tuple(k for k in range(4) if k != along)) > least
            lines = np.abs(edges[:, None] - grid.lines[axis]).min(axis=1) < 1e-6 * float(np.diff(edges).min())
            coordinates[axis] += edges[jumps & lines].tolist()
    x, y, z = (np.unique(np.asarray(places, dtype=float)) for places in coordinates)
    return x, y, z[z > 0.0]
