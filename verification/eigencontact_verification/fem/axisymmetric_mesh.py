"""Quadratic quadrilaterals in the half plane (r, z): a graded tensor mesh, with curved patches around fitted regions.

A tensor mesh has lines on every bound and interface, elements of the size ``fine`` there and geometric growth away from
it. Around a region that is to be fitted the elements of a box are taken out and replaced by three blocks: a core inside
the region, a ring from the core to the region's boundary and a ring from there to the box. The boundary is found on
rays from the region's centre by bisection of ``contains``, so that any region that is star-shaped about the centre of
its bounds has edges of the mesh on its boundary; mid-edge nodes lie on it too (isoparametric elements).

``divisions`` splits every element of the basic mesh into that many parts each way: a family whose sizes fall together,
as Richardson's extrapolation asks for.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial import cKDTree
from skfem import MeshQuad1, MeshQuad2

__all__ = ["Fit", "Grid", "build", "graded_lines"]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
Interval = tuple[float, float]

#: Nodes of a nine-node element in its 3 x 3 lattice: corners, mid-edges, centre (scikit-fem's and VTK's order).
_NODES = ((0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1), (1, 1))
#: Margin of the box around a fitted region, in half widths of the region, and the gap that is not meshed by itself.
_MARGIN, _GAP = 0.5, 0.25
#: Size of the core, as a part of the way to the region's boundary on the ray where that is nearest.
_CORE = 0.6


def graded_lines(fixed: ArrayLike, fine: Sequence[Interval], size: ArrayLike, growth: float) -> FloatArray:
    """Coordinates from the first to the last of ``fixed`` with all of ``fixed`` among them.

    Parameters
    ----------
    fixed : (n,)
        Coordinates that must be lines.
    fine : sequence of (low, high)
        Intervals (or points, low = high) where the spacing is about ``size``.
    size : float or (intervals,)
        Spacing there, one for all or one for each interval.
    growth : float
        Ratio of neighbouring spacings away from them, > 1.

    Notes
    -----
    The spacing wanted is ``size + log(growth) * distance``, the smallest over the intervals; its integrated reciprocal
    between two fixed lines, rounded up, is the number of intervals there.
    """
    ends = np.unique(np.asarray(fixed, dtype=float))
    intervals = np.asarray(fine, dtype=float)
    sizes = np.broadcast_to(np.asarray(size, dtype=float), len(intervals))
    rate = float(np.log(growth))

    def spacing(x: FloatArray) -> FloatArray:
        away = np.maximum(0.0, np.maximum(intervals[:, 0] - x[:, None], x[:, None] - intervals[:, 1]))
        return np.asarray((sizes + rate * away).min(axis=1))

    # where one interval's spacing may pass another's: two that rise towards each other, or one that rises to a constant
    ahead = (sizes[:, None] - sizes[None]) / rate
    middles = (intervals[:, None, 0] + intervals[None, :, 1] + ahead) / 2
    levels = np.stack((intervals[None, :, 1] + ahead, intervals[None, :, 0] - ahead))
    breaks = np.unique(np.concatenate((ends, intervals.ravel(), middles.ravel(), levels.ravel())))
    breaks = breaks[(breaks >= ends[0]) & (breaks <= ends[-1])]
    h = spacing(breaks)
    length, rise = np.diff(breaks), np.diff(h)
    ratio = rise / h[:-1]
    logs = np.log1p(ratio) / np.where(ratio == 0, 1, ratio)
    count = length / h[:-1] * np.where(ratio == 0, 1.0, logs)
    total = np.concatenate(([0.0], np.cumsum(count)))
    lines = [ends[:1]]
    for low, high in itertools.pairwise(ends):
        first, last = total[np.searchsorted(breaks, (low, high))]
        divisions = max(1, int(np.ceil(last - first - 1e-9)))
        goal = first + (last - first) * np.arange(1, divisions) / divisions
        k = np.clip(np.searchsorted(total, goal, side="right") - 1, 0, len(length) - 1)
        slope = rise[k] / length[k]
        flat = slope == 0
        step = h[k] * np.where(flat, goal - total[k], np.expm1(slope * (goal - total[k])) / np.where(flat, 1, slope))
        lines += [breaks[k] + step, np.array([high])]
    return np.concatenate(lines)


@dataclass(frozen=True, kw_only=True)
class Fit:
    """A region to be fitted: ``contains(r, z)``, its bounds, and the number that its elements are marked with.

    In a `plane` r has no axis: the region may lie on both sides of 0, and the box leaves half of its roof.
    """

    contains: Callable[[FloatArray, FloatArray], NDArray[np.bool_]]
    low: tuple[float, float]
    high: tuple[float, float]
    mark: int
    plane: bool = False

    @property
    def on_axis(self) -> bool:
        """Whether the region meets the axis."""
        return not self.plane and self.low[0] <= 0

    @property
    def box(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """Low and high corner (r, z) of the box that the curved blocks fill."""
        half = (np.asarray(self.high) - np.asarray(self.low)) / 2
        if self.on_axis:
            half[0] *= 2
        low = np.asarray(self.low) - _MARGIN * half
        low = np.maximum(low, (-np.inf, self.low[1] / 2)) if self.plane else np.where(low < _GAP * half, 0.0, low)
        high = np.asarray(self.high) + _MARGIN * half
        return (float(low[0]), float(low[1])), (float(high[0]), float(high[1]))

    @property
    def centre(self) -> FloatArray:
        """Point (r, z) that the rays start from; on the axis if the region meets it."""
        middle = (np.asarray(self.low) + np.asarray(self.high)) / 2
        return np.asarray(middle * (not self.on_axis, 1))

    def boundary(self, towards: FloatArray) -> FloatArray:
        """Points (2, n) of the region's boundary on the rays from the centre to the points (2, n)."""
        centre = self.centre[:, None]
        inside, outside = np.zeros(towards.shape[1]), np.ones(towards.shape[1])
        if not np.all(self.contains(*np.broadcast_to(centre, towards.shape))) or np.any(self.contains(*towards)):
            raise ValueError(
                f"region to be fitted must contain the centre of its bounds and stay within them "
                f"(got bounds {self.low}, {self.high}); use fitted=False"
            )
        for _ in range(60):
            middle = (inside + outside) / 2
            hit = self.contains(*(centre + middle * (towards - centre)))
            inside, outside = np.where(hit, middle, inside), np.where(hit, outside, middle)
        return np.asarray(centre + (inside + outside) / 2 * (towards - centre))


def _elements(lattice: FloatArray) -> FloatArray:
    """Nodes (2, 9, elements) of the elements of a lattice (2, 2 n + 1, 2 m + 1); first index fastest in neither."""
    n, m = (lattice.shape[1] - 1) // 2, (lattice.shape[2] - 1) // 2
    nodes = [lattice[:, i : i + 2 * n - 1 : 2, j : j + 2 * m - 1 : 2].reshape(2, n * m) for i, j in _NODES]
    return np.stack(nodes, axis=1)


def _split(lines: FloatArray, count: int) -> FloatArray:
    """Every interval in ``parts`` equal ones; the given lines are kept to the last bit."""
    inner = lines[:-1, None] + np.diff(lines)[:, None] * np.arange(count) / count
    return np.append(inner.ravel(), lines[-1])


def _ring(inner: FloatArray, outer: FloatArray, layers: int) -> FloatArray:
    """Lattice (2, 2 layers + 1, n) between two rows of points (2, n)."""
    s = np.linspace(0.0, 1.0, 2 * layers + 1)[None, :, None]
    lattice = (1 - s) * inner[:, None] + s * outer[:, None]
    lattice[:, 0], lattice[:, -1] = inner, outer
    return np.asarray(lattice)


def _patch(fit: Fit, r: FloatArray, z: FloatArray, size: float, divisions: int) -> tuple[FloatArray, IntArray]:
    """Elements (2, 9, n) of the curved blocks and their marks (n,); r, z: the lattice's lines across the box."""
    centre = fit.centre[:, None]
    rows = [np.stack((r, np.full_like(r, z[0]))), np.stack((np.full_like(z, r[-1]), z))[:, 1:]]
    rows.append(np.stack((r, np.full_like(r, z[-1])))[:, -2::-1])
    if not fit.on_axis:
        rows.append(np.stack((np.full_like(z, r[0]), z))[:, -2::-1])
    loop = np.concatenate(rows, axis=1)
    edge = fit.boundary(loop)
    if fit.on_axis:
        edge[0, [0, -1]] = 0.0
    else:
        edge[:, -1] = edge[:, 0]
    reach = np.hypot(*(loop - centre))
    share = _CORE * float((np.hypot(*(edge - centre)) / reach).min())
    core = centre[:, :, None] + share * (np.stack(np.meshgrid(r, z, indexing="ij")) - centre[:, :, None])
    start = centre + share * (loop - centre)
    layers = [max(1, round(float(np.hypot(*(b - a)).mean()) / size)) for a, b in ((start, edge), (edge, loop))]
    blocks = [core, _ring(start, edge, divisions * layers[0]), _ring(edge, loop, divisions * layers[1])]
    elements = [_elements(block) for block in blocks]
    marks = [np.full(nodes.shape[2], mark) for nodes, mark in zip(elements, (fit.mark, fit.mark, -1), strict=True)]
    return np.concatenate(elements, axis=2), np.concatenate(marks)


@dataclass(frozen=True, kw_only=True)
class Grid:
    """The mesh, and how to find an element in it.

    Attributes
    ----------
    mesh : MeshQuad2
        Nine-node quadrilaterals in (r, z).
    marks : (elements,)
        Number of the fitted region that the element lies in, -1 elsewhere.
    nodes : (2, 9, elements)
        Coordinates of the nodes of each element.
    """

    mesh: MeshQuad2
    marks: IntArray
    nodes: FloatArray
    lines: tuple[FloatArray, FloatArray]
    table: IntArray
    curved: IntArray
    _tree: list[cKDTree] = field(default_factory=list, repr=False)

    @property
    def centres(self) -> FloatArray:
        """Middle node of each element, (2, elements)."""
        return np.asarray(self.nodes[:, 8])

    def find(self, r: FloatArray, z: FloatArray) -> tuple[IntArray, FloatArray]:
        """Element (n,) of each point and its local coordinates (2, n); on a line of the mesh the one beyond it.

        Raises
        ------
        ValueError
            If a point lies outside the mesh.
        """
        lr, lz = self.lines
        outside = (r < lr[0]) | (r > lr[-1]) | (z < lz[0]) | (z > lz[-1]) | ~np.isfinite(r + z)
        if np.any(outside):
            k = int(np.flatnonzero(outside)[0])
            raise ValueError(
                f"points must be in the body, {lr[0]:g} <= r <= {lr[-1]:g} and 0 <= z <= {lz[-1]:g} "
                f"(got r = {r[k]:g}, z = {z[k]:g}); use a larger reach"
            )
        i = np.clip(np.searchsorted(lr, r, side="right") - 1, 0, len(lr) - 2)
        j = np.clip(np.searchsorted(lz, z, side="right") - 1, 0, len(lz) - 2)
        element = self.table[i, j].copy()
        local = np.stack(((r - lr[i]) / (lr[i + 1] - lr[i]), (z - lz[j]) / (lz[j + 1] - lz[j])))
        loose = np.flatnonzero(element < 0)
        if loose.size:
            element[loose], local[:, loose] = self._find_curved(np.stack((r[loose], z[loose])))
        return element, local

    def _find_curved(self, points: FloatArray) -> tuple[IntArray, FloatArray]:
        if not self._tree:
            self._tree.append(cKDTree(self.centres[:, self.curved].T))
        count = min(24, self.curved.size)
        near = self.curved[self._tree[0].query(points.T, k=count)[1].reshape(-1, count)]
        mapping = self.mesh.mapping()
        best = np.full(points.shape[1], np.inf)
        element, local = near[:, 0].copy(), np.zeros_like(points)
        for k in range(count):
            todo = np.flatnonzero(best > 1e-9)
            if not todo.size:
                break
            ids, goal = near[todo, k], points[:, todo]
            x = np.full_like(goal, 0.5)
            for _ in range(30):
                slope = np.moveaxis(mapping.DF(x[:, :, None], ids)[..., 0], 2, 0)
                step = np.linalg.solve(slope, (goal - mapping.F(x[:, :, None], ids)[..., 0]).T[:, :, None])[:, :, 0].T
                x = np.clip(x + step, -0.5, 1.5)
                if np.abs(step).max() < 1e-13:
                    break
            miss = np.maximum(np.abs(x - 0.5).max(axis=0) - 0.5, 0.0) + np.abs(step).max(axis=0)
            better = miss < best[todo]
            take = todo[better]
            best[take], element[take], local[:, take] = miss[better], ids[better], x[:, better]
        if np.any(best > 1e-6):
            outside = points[:, int(best.argmax())]
            raise ValueError(f"points must be in an element of the mesh (got r, z = {outside}); report this mesh")
        return element, np.clip(local, 0.0, 1.0)


def build(r: FloatArray, z: FloatArray, fits: Sequence[Fit], size: float, divisions: int) -> Grid:
    """Mesh of nine-node elements from the lines of the basic mesh and the regions to be fitted.

    Parameters
    ----------
    r, z : (n,), (m,)
        Lines of the basic mesh (`graded_lines`), among them the sides of the boxes of ``fits``.
    size : float
        Element size in the curved blocks before the division.
    divisions : int
        Parts of every element each way.
    """
    half = [_split(x, 2 * divisions) for x in (r, z)]
    lines = (half[0][::2], half[1][::2])
    middle = [x[1::2] for x in half]
    unfitted = np.ones((len(middle[0]), len(middle[1])), dtype=bool)
    patches: list[FloatArray] = []
    marks: list[IntArray] = []
    for fit in fits:
        low, high = fit.box
        inside = [(m > low[k]) & (m < high[k]) for k, m in enumerate(middle)]
        cells = np.logical_and.outer(*inside)
        if not np.all(unfitted[cells]):
            raise ValueError(f"fitted regions must be apart (got one within {low}, {high}); use fitted=False for one")
        unfitted &= ~cells
        across = [x[(x >= low[k]) & (x <= high[k])] for k, x in enumerate(half)]
        elements, mark = _patch(fit, across[0], across[1], size, divisions)
        patches.append(elements)
        marks.append(mark)
    lattice = np.stack(np.meshgrid(*half, indexing="ij"))
    table = np.where(unfitted, np.cumsum(unfitted).reshape(unfitted.shape) - 1, -1).astype(np.int64)
    tensor = _elements(lattice)[:, :, unfitted.ravel()]
    nodes = np.concatenate([tensor, *patches], axis=2)
    corners, index = np.unique(nodes[:, :4].reshape(2, -1), axis=1, return_inverse=True)
    straight = MeshQuad1(np.ascontiguousarray(corners), np.ascontiguousarray(index.reshape(4, -1)), sort_t=False)
    mesh = MeshQuad2.from_mesh(straight)
    places = np.array(mesh.doflocs)
    places[:, mesh.dofs.element_dofs] = nodes
    mesh = MeshQuad2(places, mesh.t, sort_t=False)
    rim = mesh.p[:, mesh.facets[:, mesh.boundary_facets()]].reshape(2, -1)
    on_rim = (rim[0] == r[0]) | (rim[0] == r[-1]) | (rim[1] == z[0]) | (rim[1] == z[-1])
    if not np.all(on_rim):
        raise ValueError("blocks of the mesh must meet (got open edges inside the body); report this mesh")
    return Grid(
        mesh=mesh,
        marks=np.concatenate([np.full(tensor.shape[2], -1), *marks]).astype(np.int64),
        nodes=nodes,
        lines=lines,
        table=table,
        curved=np.arange(tensor.shape[2], nodes.shape[2]),
    )
