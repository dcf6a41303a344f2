"""Families of tensor-product meshes for a loaded body, as fine as a number of unknowns allows.

Elements are `fine` long in the boxes of what loads or disturbs the body, in proportion to the size of each box, and
grow with the distance from them. Every segment between two lines that the mesh must have is cut into 4, 6 or 9 parts
(times a whole number) at the levels 0, 1, 2, along the same grading: element sizes have the exact ratio 1.5.

With the ratio 2 segments are cut into 1, 2 or 4 parts, and the lines follow the faces of small cells
(`followed_cells`): 4, 2 or 1 elements to a cell at the finest level, as the unknowns allow.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from eigencontact_verification.fem.followed_cells import MOST_EDGES, followed_faces, has_small_cells
from eigencontact_verification.fem.loaded_body import LoadedBody
from eigencontact_verification.fem.loaded_symmetry import boxes_of
from eigencontact_verification.fem.mesh import Grid
from eigencontact_verification.fem.model import Region

__all__ = ["PARTS", "RATIO", "breaks_of", "family_grid", "has_flat_ends", "is_box", "reach_of"]

FloatArray = NDArray[np.float64]
Anchor = tuple[float, float, float, str]

#: Parts of a segment at each level, by the ratio of element sizes; and the ratio where no small cells are followed.
PARTS: dict[float, tuple[int, int, int]] = {1.5: (4, 6, 9), 2.0: (1, 2, 4)}
RATIO = 1.5
#: Elements to a followed cell at the finest level, the first that the unknowns allow.
_PER_CELL = (4, 2, 1)
#: Growth per element of the finest mesh, away from what loads the body, by the ratio.
_RATES: dict[float, float] = {1.5: 0.25, 2.0: 0.2}
#: Distance, in sizes of the largest source, where that growth has doubled: what is far varies slowly and matters less.
_DOUBLED = 12.0
#: Length of elements below tractions along z over that along x: the field varies most there.
_STEEP = 0.6
#: Length of elements along a bar, which the mesh follows to its ends, over its own half length.
_LONG = 0.4
#: Size of the block in depths of eigenstrain, where there are no tractions.
_DEPTHS = 12.0
_TABLE = np.linspace(0.0, 1.0, 8001)


def is_box(region: Region) -> bool:
    """Whether a region fills its bounds: whether it has all corners."""
    low, high = (np.asarray(corner, dtype=float) for corner in region.bounds)
    at = np.array([(i, j, k) for i in (0, 1) for j in (0, 1) for k in (0, 1)])
    corners = low + (high - low) * (1e-6 + (1 - 2e-6) * at)
    return bool(np.all(region.contains(*corners.T)))


def has_flat_ends(region: Region, axis: int) -> bool:
    """Whether a region ends in planes across an axis, between which it has one section: a box, a round bar."""
    low, high = (np.asarray(corner, dtype=float) for corner in region.bounds)
    stations, across = np.array([1e-6, 0.3, 0.7, 1 - 1e-6]), (np.arange(11) + 0.5) / 11
    at = np.stack(np.meshgrid(stations, across, across, indexing="ij"), axis=-1)
    points = low + (high - low) * np.moveaxis(np.roll(np.moveaxis(at, -1, 0), axis, axis=0), 0, -1)
    inside = np.asarray(region.contains(*np.moveaxis(points, -1, 0)), dtype=bool)
    return bool(inside.any() and np.all(inside == inside[0])) or is_box(region)


def breaks_of(body: LoadedBody) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Coordinates along x, y, z where the field has kinks on planes: interfaces, faces of boxes and of large cells."""
    breaks: list[list[float]] = [[], [], np.cumsum([layer.thickness for layer in body.layers]).tolist()]
    for region in body.regions:
        for axis in (direction for direction in range(3) if has_flat_ends(region, direction)):
            breaks[axis] += [region.bounds[0][axis], region.bounds[1][axis]]
    for cells in body.cells:
        edges = (cells.x, cells.y, cells.z)
        if max(e.size for e in edges) <= MOST_EDGES:
            for axis in range(3):
                breaks[axis] += edges[axis].tolist()
    x, y, z = (np.unique(np.asarray(places, dtype=float)) for places in breaks)
    return x, y, z


def reach_of(body: LoadedBody, reaches: float) -> float:
    """Half width and depth of the block: so many sizes of the loaded patch, and well beyond all else."""
    boxes = list(boxes_of(body))
    loaded = [float((box[1] - box[0]).max()) / 2 for kind, box in boxes if kind == "tractions"]
    sizes = [float((box[1] - box[0]).max()) / 2 for kind, box in boxes if kind != "tractions"]
    far = max(float(np.abs(box).max()) for _, box in boxes)
    thick = sum(layer.thickness for layer in body.layers)
    # what eigenstrain alone displaces of the surface is small: as the square of its depth over that of the block
    deep = 0.0 if loaded else _DEPTHS * max(float(box[1, 2]) for _, box in boxes)
    return max(reaches * max(loaded + sizes), 1.0 * far + 0.6 * reaches * max(loaded + sizes), 4.0 * thick, deep)


def _anchors(body: LoadedBody, lows: FloatArray) -> list[list[Anchor]]:
    """Intervals (from, to, relative length of elements, of what) along x, y, z."""
    boxes = list(boxes_of(body, 1e-9))
    sizes = [float((box[1] - box[0])[:2].min()) / 2 for _, box in boxes]
    anchors: list[list[Anchor]] = [[], [], []]
    flat = [
        (np.array(region.bounds, dtype=float), [has_flat_ends(region, axis) for axis in range(3)])
        for region in body.regions
    ]
    for (kind, box), size in zip(boxes, sizes, strict=True):
        small = float((box[1] - box[0]).min()) / 2 if kind != "tractions" else size
        lengths = [min(size, 2 * small) / max(sizes)] * 3
        # the mesh follows the faces of a sheet or a bar, which is long where the field varies slowly
        follows = next((ends for of, ends in flat if kind == "region" and np.array_equal(box, of)), [False] * 3)
        halves = (box[1] - box[0]) / 2
        lengths = [
            max(length, min(1.0, half / max(sizes)), _LONG * half / max(sizes)) if ends else length
            for length, half, ends in zip(lengths, halves, follows, strict=True)
        ]
        depth = (0.0, 0.5 * size) if kind == "tractions" else (box[0, 2], box[1, 2])
        for axis, (low, high) in enumerate((tuple(box[:, 0]), tuple(box[:, 1]), depth)):
            # of a source on the other side of a plane of symmetry only its reflection is meshed
            if high > lows[axis]:
                share = _STEEP * lengths[axis] if kind == "tractions" and axis == 2 else lengths[axis]
                anchors[axis].append((max(low, lows[axis]), high, share, kind))
    # of a lattice of hundreds of regions few intervals differ
    return [
        list({(*np.round(np.divide(length[:3], max(sizes)), 9), length[3]): length for length in axis}.values())
        for axis in anchors
    ]


def _away(distance: FloatArray, largest: float, rate: float) -> FloatArray:
    """Growth of the elements with the distance from a source."""
    away = np.maximum(distance, 0.0)
    return np.asarray(rate * away * (1 + away / (_DOUBLED * largest)))


def _segments(
    low: float, high: float, breaks: FloatArray, anchors: Sequence[Anchor], fine: float, largest: float,
    followed: FloatArray, ratio: float,
) -> list[tuple[FloatArray, FloatArray, int]]:  # fmt: skip
    """Table of places and element counts of every segment, and how many times the most parts it gets at the finest."""
    tiny, most = 1e-9 * (high - low), PARTS[ratio][2]
    sources = [(a, b, fine * f) for a, b, f, kind in anchors if not (followed.size and kind == "cells")]
    inner = [float(b) for b in breaks]
    if followed.size:
        inner = [b for b in inner if np.abs(followed - b).min() > tiny] + followed.tolist()
        ends = np.diff(followed)[[0, -1]] / most  # beyond them elements grow at the pace that they have there
        sources += [(place, place, float(length)) for place, length in zip(followed[[0, -1]], ends, strict=True)]
    out = []
    for start, stop in pairwise([low, *sorted(b for b in inner if low + tiny < b < high - tiny), high]):
        t = start + (stop - start) * _TABLE
        if followed.size and followed[0] - tiny < start and stop < followed[-1] + tiny:
            out.append((t, _TABLE * most, 1))
            continue
        size = np.min([h + _away(np.maximum(a - t, t - b), largest, _RATES[ratio]) for a, b, h in sources], axis=0)
        count = np.concatenate(([0.0], np.cumsum((1 / size[1:] + 1 / size[:-1]) / 2 * np.diff(t))))
        out.append((t, count, max(1, round(count[-1] / most))))
    return out


def family_grid(
    body: LoadedBody, symmetry: tuple[str, str], reach: float, *, level: int, budget: int, ratio: float = RATIO,
    near: FloatArray | None = None,
) -> tuple[Grid, float]:  # fmt: skip
    """Mesh of one level, and the length of elements of the finest level in the largest source.

    Parameters
    ----------
    body : LoadedBody
        Its planes of symmetry at the origin.
    symmetry : (str, str)
        As in `fem.model.Model`.
    reach : float
        Half width and depth of the block.
    level : {0, 1, 2}
        Coarse, medium, fine.
    budget : int
        Unknowns that the fine mesh may have.
    ratio : {1.5, 2.0}
        Element size of a level over that of the next finer one; with 2 small cells are followed.
    near : (n, 3) array, optional
        Where stress is read: far from it, along each axis, fewer elements follow the cells. By default everywhere.

    Raises
    ------
    ValueError
        If the lines that the mesh must have are too many for the budget.
    """
    lows = np.array([-reach if kind == "none" else 0.0 for kind in symmetry] + [0.0])
    places = np.empty((0, 3)) if near is None else np.where(lows == 0.0, np.abs(near), near)
    breaks, anchors, most = breaks_of(body), _anchors(body, lows), PARTS[ratio][2]
    size = max(float((box[1] - box[0])[:2].min()) / 2 for _, box in boxes_of(body, 1e-9))

    @cache
    def faces(axis: int, per_cell: int) -> FloatArray:
        if per_cell == 0:
            return np.empty(0)
        return followed_faces(body, axis, lows[axis], most // per_cell, np.unique(places[:, axis]))

    def axes(per_cell: int, fine: float) -> tuple[list[list[tuple[FloatArray, FloatArray, int]]], int]:
        lines = [
            _segments(lows[a], reach, breaks[a], anchors[a], fine, size, faces(a, per_cell), ratio) for a in range(3)
        ]
        return lines, 3 * int(np.prod([2 * most * sum(number for *_, number in axis) + 1 for axis in lines]))

    lengths = size * np.geomspace(0.01, 2.0, 200)
    small = ratio != RATIO and has_small_cells(body)
    # cells that are small along some axes only leave more to the others
    thin = small and not all(faces(axis, 1).size for axis in range(3))
    choices = (*(_PER_CELL[int(thin) :] if small else ()), 0)
    fewest = {per_cell: axes(per_cell, float(lengths[-1]))[1] for per_cell in choices}
    per_cell = next((choice for choice, unknowns in fewest.items() if unknowns <= budget), None)
    if per_cell is None:
        raise ValueError(
            f"budget must be at least {min(fewest.values())} unknowns for this body (got {budget}); raise it"
        )
    # where all cells are followed, and where there are none, a third of the budget does for the rest
    shared = ratio != RATIO and not thin and (per_cell > 0 or not small)
    allowed = max(fewest[per_cell], budget // 3) if shared else budget
    for fine in map(float, lengths):
        chosen, unknowns = axes(per_cell, fine)
        if unknowns <= allowed:
            break
    lines = []
    for low, axis in zip(lows, chosen, strict=True):
        line = [np.array([low])]
        for t, count, number in axis:
            divisions = PARTS[ratio][level] * number
            piece = np.interp(np.arange(1, divisions + 1) / divisions * count[-1], count, t)
            piece[-1] = t[-1]
            line.append(piece)
        lines.append(np.concatenate(line))
    return Grid(lines=(lines[0], lines[1], lines[2]), order=2), fine
