"""Sides of interfaces and borders of inclusions for the points of a section: contours do not cross a jump.

Stress jumps where the material does: at interfaces of layers, at borders of inclusions. A picture must not join points
of both sides. Three kinds of points carry the stress of neither side: points in cells that a border cuts, points finer
than cells in the cells next to those, whose values show the faces of the cells, and points on the border itself. A
picture continues the values of the trusted points of the same side, and looks for no extreme value there. The middle
of a whole cell is trusted, however fine the points are.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact.viz.outline import paths_of
from eigencontact.viz.worn import interfaces

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from eigencontact.results.stored import Results

    FloatArray = NDArray[np.float64]

__all__ = ["LineSides", "Plane", "Side", "Sides", "interface_depths", "line_sides", "sides_of", "twice_area"]

#: A depth this close to an interface, in parts of its depth, is on it; the lower layer has it, as in the kernels.
DEPTH_TOLERANCE = 1e-12
#: A border this close to a face of cells, in parts of their edge, runs along it and cuts none.
ON_A_FACE = 1e-6
#: Points of a border to a cell.
PER_CELL = 4
#: Points closer than this part of an edge of cells are finer than cells.
FINER = 0.5
#: Part of the edge of a whole cell, on both sides of its middle, whose points are trusted beside cells that are cut.
MIDDLE = 0.2
#: More points than this are filled without the smooth continuation.
MOST_FILLED = 50_000
#: Weight of the nearest value in the smooth continuation.
NEAREST = 1e-6
#: Points closer to a border than this part of their spacing are on it. Stored borders are polygons: their sides pass
#: inside of a curved border, by less than that.
ON_A_BORDER = 0.05


@dataclass(frozen=True)
class Plane:
    """Points of a section of body 1 or 2: vertical and horizontal axis, and coordinates along them, (m,), (n,) [m]."""

    body: int
    dims: tuple[str, str]
    v: FloatArray
    h: FloatArray


@dataclass(frozen=True)
class Side:
    """Region between interfaces and borders.

    Attributes
    ----------
    points : (m, n) bool
        Points of the section that lie there.
    outline : (k, 2) or None
        Border (horizontal, vertical) [m] of an inclusion; None for what lies around all of them.
    depths : (float, float)
        It lies between these [m].
    """

    points: NDArray[np.bool_]
    outline: FloatArray | None
    depths: tuple[float, float]


@dataclass(frozen=True)
class Sides:
    """Sides of a section, in drawing order, and its whole cells.

    Attributes
    ----------
    parts : tuple of Side
        Layers first, then inclusions from the largest to the smallest.
    whole : (m, n) bool
        Points that lie in no cell which a border cuts.
    trusted : (m, n) bool
        Those of them that may hold an extreme value.
    interfaces : tuple of float
        Depths [m] of interfaces in the section.
    """

    parts: tuple[Side, ...]
    whole: NDArray[np.bool_]
    trusted: NDArray[np.bool_]
    interfaces: tuple[float, ...]

    def filled(self, values: FloatArray, side: Side) -> FloatArray:
        """Values (m, n) of one side, extrapolated to the other sides and to points without valid values.

        A side without trusted points keeps the values of its whole cells; without those, all of its values.
        """
        finite = side.points & np.isfinite(values)
        source = next((points for points in (finite & self.trusted, finite & self.whole) if points.any()), finite)
        if source.all() or not source.any():
            return values
        from scipy.ndimage import distance_transform_edt

        index = distance_transform_edt(~source, return_distances=False, return_indices=True)
        return _smoothed(np.asarray(values[tuple(index)]), side.points & ~source, side.points)

    def largest(self, values: FloatArray) -> tuple[int, int]:
        """Row and column of the largest magnitude among trusted points; of several alike, nearest to the middle."""
        size = np.where(self.trusted, np.abs(np.nan_to_num(values)), -1.0)
        size = size if self.trusted.any() else np.abs(np.nan_to_num(values))
        rows, columns = np.nonzero(size >= (1.0 - 1e-9) * size.max())
        best = int(np.argmin(np.abs(columns - (values.shape[1] - 1) / 2) + np.abs(rows - (values.shape[0] - 1) / 2)))
        return int(rows[best]), int(columns[best])


def interface_depths(dataset: Results, body: int, step: int = -1) -> tuple[float, ...]:
    """Depths [m] of the interfaces of a layered body in a step, below the surface that its kernels have then."""
    name = f"layer_lost_{body}"
    worn_depth = float(dataset[name][step]) if name in dataset else 0.0
    return tuple(depth - worn_depth for depth in interfaces(dataset, body) if depth > worn_depth)


def sides_of(dataset: Results, plane: Plane, segments: FloatArray, step: int = -1) -> Sides:
    """Sides of a section, from the stored borders (n, 2, 2) [m] of its inclusions: (horizontal, vertical)."""
    layer = np.zeros((plane.v.size, plane.h.size), dtype=int)
    cuts: tuple[float, ...] = ()
    if plane.dims[0] == "z":
        cuts = tuple(at for at in interface_depths(dataset, plane.body, step) if plane.v[0] < at < plane.v[-1])
        layer += np.searchsorted(np.array(cuts) * (1.0 - DEPTH_TOLERANCE), plane.v, side="right")[:, None]
    ends = (-np.inf, *cuts, np.inf)
    closed = [path for path in paths_of(segments) if len(path) > 3 and np.array_equal(path[0], path[-1])]
    owner = np.full(layer.shape, -1)
    closed.sort(key=lambda path: abs(twice_area(path[:-1])), reverse=True)
    for number, path in enumerate(closed):
        owner[_inside(path, plane)] = number
    sides = []
    for number in range(-1, len(closed)):
        for n, depths in enumerate(pairwise(ends)):
            points = (owner == number) & (layer == n)
            if points.any():
                sides.append(Side(points, closed[number] if number >= 0 else None, depths))
    uncut, trusted = _uncut_points(dataset, plane, closed)
    return Sides(tuple(sides), uncut, trusted & ~_on_border(plane, closed), cuts)


def _smoothed(values: FloatArray, unknown: NDArray[np.bool_], side: NDArray[np.bool_]) -> FloatArray:
    """Harmonic extension of values to the unknown points of a side, without flux across its border."""
    from scipy.sparse import coo_array, diags_array
    from scipy.sparse.linalg import spsolve

    count = int(np.count_nonzero(unknown))
    if not 0 < count <= MOST_FILLED:
        return values
    number = np.full(values.shape, -1)
    number[unknown] = np.arange(count)
    degree, right = np.full(count, NEAREST), NEAREST * values[unknown]
    pairs: list[NDArray[np.intp]] = []
    full, but_first, but_last = slice(None), slice(1, None), slice(-1)
    for first, second in (((but_first, full), (but_last, full)), ((full, but_first), (full, but_last))):
        for cell, neighbour in ((first, second), (second, first)):
            joined = unknown[cell] & side[neighbour]
            rows, columns = number[cell][joined], number[neighbour][joined]
            np.add.at(degree, rows, 1.0)
            fixed = columns < 0
            np.add.at(right, rows[fixed], values[neighbour][joined][fixed])
            pairs.append(np.stack([rows[~fixed], columns[~fixed]]))
    rows, columns = np.concatenate(pairs, axis=1)
    joints = coo_array((np.ones(rows.size), (rows, columns)), shape=(count, count))
    values = values.copy()
    values[unknown] = spsolve((diags_array(degree) - joints).tocsc(), right)
    return values


def twice_area(path: FloatArray) -> float:
    """Twice the area inside of a closed path, with the sign of its sense."""
    x, y = path.T
    return float(x @ np.roll(y, -1) - y @ np.roll(x, -1))


def _inside(path: FloatArray, plane: Plane) -> NDArray[np.bool_]:
    """Points of a section within a closed path; rays towards larger places along the vertical are counted."""
    inside = np.zeros((plane.v.size, plane.h.size), dtype=bool)
    unit = float(np.ptp(path, axis=0).max())
    for (h0, v0), (h1, v1) in pairwise(path):
        crossed = (plane.h >= h0) != (plane.h >= h1)
        if not crossed.any():
            continue
        at = v0 + (plane.h[crossed] - h0) * (v1 - v0) / (h1 - h0)
        inside[:, crossed] ^= plane.v[:, None] < at - DEPTH_TOLERANCE * unit
    return inside


def _uncut_points(
    dataset: Results, plane: Plane, paths: list[FloatArray]
) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Points outside the cells that paths cut, and the valid points among them; all without stored cells."""
    uncut = np.ones((plane.v.size, plane.h.size), dtype=bool)
    grids = [f"cells_{plane.body}_{axis}" for axis in plane.dims]
    if not paths or any(name not in dataset.variables for name in grids):
        return uncut, uncut
    middles = [np.asarray(dataset[name].values, dtype=float) for name in grids]
    if any(places.size < 2 for places in middles):
        return uncut, uncut
    edges = [float(places[1] - places[0]) for places in middles]
    starts = [float(places[0]) - 0.5 * edge for places, edge in zip(middles, edges, strict=True)]
    cells = set[tuple[int, int]]().union(*(_cells_cut(path, edges, starts) for path in paths))
    if not cells:
        return uncut, uncut
    cut_cells = np.array(sorted(cells))
    first = cut_cells.min(axis=0) - 2
    cut = np.zeros(tuple(cut_cells.max(axis=0) - first + 3), dtype=bool)
    cut[tuple((cut_cells - first).T)] = True
    places = [(at - start) / edge for at, start, edge in zip((plane.v, plane.h), starts, edges, strict=True)]
    uncut = ~_touching(cut, places, first)
    if not any(at.size > 1 and at[-1] - at[-2] < FINER for at in places):
        return uncut, uncut
    from scipy.ndimage import binary_dilation

    near = _touching(binary_dilation(cut, np.ones((3, 3))), places, first)
    rows, columns = (np.abs(at - np.floor(at) - 0.5) <= MIDDLE for at in places)
    return uncut, uncut & (~near | (rows[:, None] & columns))


def _on_border(plane: Plane, paths: list[FloatArray]) -> NDArray[np.bool_]:
    """Points of a section that lie on a path."""
    spacing = min((float(np.diff(at).min()) for at in (plane.v, plane.h) if at.size > 1), default=0.0)
    on = np.zeros((plane.v.size, plane.h.size), dtype=bool)
    for start, end in (pair for path in paths for pair in pairwise(path)):
        near = tuple(
            np.flatnonzero((at >= min(ends) - ON_A_BORDER * spacing) & (at <= max(ends) + ON_A_BORDER * spacing))
            for at, ends in ((plane.v, (start[1], end[1])), (plane.h, (start[0], end[0])))
        )
        if not all(index.size for index in near):
            continue
        (across, down), reach = end - start, float(np.hypot(*(end - start)))
        away = across * (plane.v[near[0]][:, None] - start[1]) - down * (plane.h[near[1]] - start[0])
        on[np.ix_(*near)] |= np.abs(away) <= ON_A_BORDER * spacing * reach
    return on


def _touching(cells: NDArray[np.bool_], places: list[FloatArray], first: NDArray[Any]) -> NDArray[np.bool_]:
    """Points (row, column), in edges of cells, in or on the faces of some cells; `first` is cell (0, 0)."""
    ends = []
    for at, start, count in zip(places, first, cells.shape, strict=True):
        sides = [np.floor(at + side).astype(int) - start for side in (-ON_A_FACE, ON_A_FACE)]
        ends.append([np.clip(side, 0, count - 1) for side in sides])  # the outermost cells are never among them
    points = np.zeros((places[0].size, places[1].size), dtype=bool)
    for rows in ends[0]:
        for columns in ends[1]:
            points |= cells[np.ix_(rows, columns)]
    return points


def _cells_cut(path: FloatArray, edges: list[float], starts: list[float]) -> set[tuple[int, int]]:
    """Cells (row, column) with a path in their interior, not only along their faces."""
    lengths = np.abs(np.diff(path, axis=0)) / np.array(edges[::-1])
    counts = np.maximum(1, np.ceil(PER_CELL * lengths.max(axis=1)).astype(int))
    shares = [(np.arange(count) + 0.5) / count for count in counts]
    points = np.concatenate([a + share[:, None] * (b - a) for a, b, share in zip(path, path[1:], shares, strict=False)])
    places = (points[:, ::-1] - np.array(starts)) / np.array(edges)
    inner = (np.abs(places - np.round(places)) > ON_A_FACE).all(axis=1)
    return {(int(row), int(column)) for row, column in np.floor(places[inner])}


@dataclass(frozen=True)
class LineSides:
    """Sides of the points of a line.

    Attributes
    ----------
    number : (n,) int
        Side of each point; neighbours of different numbers have a jump between them.
    shares : (m,)
        Where each jump lies, as a part of the way from one point to the next.
    whole : (n,) bool
        Points that lie on no border, and in no cell which a border cuts; stress in those is that of neither side.
    """

    number: NDArray[np.intp]
    shares: FloatArray
    whole: NDArray[np.bool_]


def line_sides(dataset: Results, region: str, body: int, z: FloatArray, step: int) -> LineSides:
    """Sides of the points of a line region in a body at depths z (n,) [m]."""
    depths = np.array(interface_depths(dataset, body, step))
    number = np.searchsorted(depths * (1.0 - DEPTH_TOLERANCE), z, side="right")
    border, whole = np.full(z.size, np.nan), np.ones(z.size, dtype=bool)
    if f"{region}_inclusion" in dataset:
        inclusion, border, uncut = (dataset[f"{region}_{name}"].values for name in ("inclusion", "border", "uncut"))
        number, whole = number + inclusion * (depths.size + 1), uncut != 0
    breaks = np.flatnonzero(number[1:] != number[:-1])
    shares = [border[breaks]]
    for depth in depths:
        with np.errstate(divide="ignore", invalid="ignore"):  # a line along an interface does not cross it
            share = (depth - z[breaks]) / (z[breaks + 1] - z[breaks])
        shares.append(np.where((share >= 0.0) & (share <= 1.0), share, np.nan))
    return LineSides(number, np.fmin.reduce(shares), whole)
