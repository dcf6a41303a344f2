"""Volume that a closed surface encloses in each cell of a lattice, by the divergence theorem: exact to round-off.

The triangles are cut along the planes of the lattice. With the area A of a piece projected along z, positive for an
outward normal along +z, the volume in a cell that begins at z_k is the sum of A (z - z_k) over the pieces in that cell
and of A times the height of a cell over all pieces beyond it in its column.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from eigencontact.plugin import FloatArray

__all__ = ["volumes_in_cells"]

IntArray = NDArray[np.intp]

#: Polygons per block.
PIECES = 1 << 15


def volumes_in_cells(corners: FloatArray, shape: tuple[int, int, int]) -> FloatArray:
    """Volume in each cell, ``(nz, ny, nx)``, in cells.

    Parameters
    ----------
    corners : (m, 3, 3)
        Corners (x, y, z) of the triangles, counter-clockwise as seen from outside, counted in cells from the lowest
        corner of the lattice. The body may reach beyond the lattice.
    shape : (nz, ny, nx)
        Numbers of cells.

    Notes
    -----
    Regions with winding number two count twice, and regions of opposite orientation count as negative.
    """
    nz, ny, nx = shape
    layers = (nz + 2, ny, nx)  # one above the lattice, outside all cells, and one below it, which adds to all
    area, moment = np.zeros(layers), np.zeros(layers)
    for strips, _, i in _cut(corners, 0, (0, nx - 1)):
        for columns, row, j in _cut(strips, 1, (0, ny - 1)):
            for pieces, column, k in _cut(columns, 2, (-1, nz)):
                place = np.ravel_multi_index((k + 1, j[column], i[row[column]]), layers)
                x, y, z = np.moveaxis(pieces, 2, 0)
                u, v = x - x[:, :1], y - y[:, :1]
                fan = 0.5 * (u[:, 1:-1] * v[:, 2:] - u[:, 2:] * v[:, 1:-1])
                height = (z[:, :1] + z[:, 1:-1] + z[:, 2:]) / 3.0 - k[:, None]
                area += np.bincount(place, fan.sum(axis=1), minlength=area.size).reshape(layers)
                moment += np.bincount(place, (fan * height).sum(axis=1), minlength=area.size).reshape(layers)
    area_above = np.cumsum(area[::-1], axis=0)[::-1]
    return np.asarray(moment[1:-1] + area_above[2:])


def _cut(polygons: FloatArray, axis: int, cells: tuple[int, int]) -> Iterator[tuple[FloatArray, IntArray, IntArray]]:
    """Pieces of convex polygons ``(n, vertices, 3)`` in unit cells along an axis, the polygon of each, and its cell.

    The outermost cells of the axis z, some of which are outside the lattice, are infinite.
    """
    along, (lowest, highest) = polygons[:, :, axis], cells
    endless = (-np.inf, np.inf) if axis == 2 else (lowest, highest + 1)
    first = np.floor(np.clip(along.min(axis=1), lowest - 1, highest + 1)).astype(np.intp)
    last = np.ceil(np.clip(along.max(axis=1), lowest - 1, highest + 2)).astype(np.intp) - 1
    last = np.maximum(first, last)
    if axis == 2:
        first, last = np.clip(first, lowest, highest), np.clip(last, lowest, highest)
    else:
        first, last = np.maximum(first, lowest), np.minimum(last, highest)
    number = np.maximum(last - first + 1, 0)
    polygon = np.repeat(np.arange(len(polygons)), number)
    cell = first[polygon] + np.arange(polygon.size) - np.repeat(np.cumsum(number) - number, number)
    for start in range(0, polygon.size, PIECES):
        chunk = slice(start, start + PIECES)
        low, high = cell[chunk].astype(float), cell[chunk] + 1.0
        low[cell[chunk] == lowest] = endless[0]
        high[cell[chunk] == highest] = endless[1]
        pieces, sources = _clipped(polygons[polygon[chunk]], axis, low, 1.0)
        pieces, among = _clipped(pieces, axis, high[sources], -1.0)
        sources = sources[among]
        yield pieces, polygon[chunk][sources], cell[chunk][sources]


def _clipped(polygons: FloatArray, axis: int, plane: FloatArray, side: float) -> tuple[FloatArray, IntArray]:
    """Convex polygons clipped to one side of a plane normal to an axis, and the numbers of the remaining polygons.

    All have as many vertices as the largest one; the last vertex is repeated.
    """
    above = np.where(np.isinf(plane)[:, None], 0.0, side * (polygons[:, :, axis] - plane[:, None]))
    following, above_next = np.roll(polygons, -1, axis=1), np.roll(above, -1, axis=1)
    crossing = above * above_next < 0
    share = np.where(crossing, above, 0.0) / np.where(crossing, above - above_next, 1.0)
    intersection = polygons + share[:, :, None] * (following - polygons)
    count, size, _ = polygons.shape
    vertices = np.stack([polygons, intersection], axis=2).reshape(count, 2 * size, 3)
    valid = np.stack([above >= 0, crossing], axis=2).reshape(count, 2 * size)
    number = valid.sum(axis=1)
    polygon = np.flatnonzero(number >= 3)
    if not polygon.size:
        return np.empty((0, 3, 3)), polygon
    order = np.argsort(~valid[polygon], axis=1, kind="stable")
    corners = np.minimum(np.arange(number[polygon].max()), number[polygon, None] - 1)
    order = np.take_along_axis(order, corners, axis=1)
    return np.take_along_axis(vertices[polygon], order[:, :, None], axis=1), polygon
