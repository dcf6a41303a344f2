"""Fields of many regions: point sources for distant regions, potentials of the shapes for near regions.

Beyond a distance a shape is replaced by a few points (a sphere by one, everywhere outside), further away by fewer. All
of them are summed over all field points in one compiled loop. The pairs of a region and a point close to it remain:
equal shapes evaluate theirs together, and equal pairs, as of a regular array on a grid, are evaluated once.

With a tolerance, large sums are hierarchical: regions far from many points act by an expansion (`expansions`), with as
few points as the tolerance allows. The error is measured at points drawn at random, where the regions are also summed
one by one; if it is too large, the sum is repeated with a smaller tolerance.
"""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import fields, replace
from functools import partial
from importlib.util import find_spec
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.array_types import FloatArray, IntArray
from eigencontact.core.parallel import available_threads, in_parallel, parts
from eigencontact.core.places import place_field
from eigencontact.core.tensors import from_mandel, to_mandel
from eigencontact.errors import require
from eigencontact.halfspace.expansions import APART, Tree, degree_for, distances_for
from eigencontact.halfspace.points import field_at_points, unit_fields_at_points
from eigencontact.halfspace.potentials import HasFarField, HasPotentials, PointSources
from eigencontact.halfspace.theorem import QUANTITIES

__all__ = ["cloud_sources", "expansions_pay", "field_of_cloud", "is_large", "likeness", "relaxed"]

# A shape whose far field takes more points than this is cheaper by its own formulas.
_MOST_SOURCES = 800
# Points that are summed together, so that their sums stay in cache.
_BLOCK = 256
# Pairs of a region and a point that are evaluated together: their 36 fields take 12 MB.
_PAIRS = 40_000
# Points at which the error of a hierarchical sum is measured.
_CHECKED = 256
# Factor on this error for all other points: in 48 sums the largest error of 40 000 points was 3.6 times that of the
# measured points on average, and 7 times at most.
_UNSEEN = 10.0
# Point sources, the fewest of all regions together, from which on expansions are faster than sums: they cost some 200
# sources of every point (128 x 128 x 64 points, spheres and ellipsoids).
_MIN_SOURCES = 300
# Points up to which few nodes of a tree hold enough of them and are far from anything.
_MAX_DIRECT_POINTS = 20_000
# Tolerance below which the sums without expansions differ as much.
_LEAST = 1e-13
# So many pairs are summed to round-off: nothing is gained by less.
_SMALL = 2_000_000
_HASH = np.array([0x9E3779B97F4A7C15, 0xC2B2AE3D27D4EB4F, 0x165667B19E3779F9], dtype=np.uint64).astype(np.int64)
# Nodes, the nodes above them, and how far apart a region must be: none.
_NO_TREE = (np.zeros((0, 5)), np.zeros(0, dtype=np.intp), 0.0)


def cloud_sources(shape: HasPotentials) -> PointSources | None:
    """Point sources in place of a distant shape; None if the formulas of the shape are cheaper."""
    if find_spec("numba") is None or not isinstance(shape, HasFarField):
        return None
    far = shape.far_field()
    return far if len(far.positions) <= _MOST_SOURCES else None


def is_large(regions: int, points: int, tolerance: float) -> bool:
    """Whether a sum to a tolerance is hierarchical."""
    return tolerance > 0 and regions * points > _SMALL


def expansions_pay(regions: Sequence[PointSources], points: int) -> bool:
    """Whether regions and points are so many that expansions are faster than sums."""
    return points > _MAX_DIRECT_POINTS and sum(far.levels[0].volumes.size for far in regions) > _MIN_SOURCES


def relaxed(finest: PointSources, tolerance: float) -> PointSources:
    """The same point sources, used from as close as a tolerance allows."""
    return _at_distances(finest, distances_for(finest, tolerance))


def field_of_cloud(
    shapes: Sequence[HasPotentials],
    eigenstrains: FloatArray,
    points: tuple[FloatArray, FloatArray, FloatArray],
    *,
    poisson_ratio: float,
    quantity: str,
    space: str = "half",
    threads: int | None = None,
    tolerance: float = 0.0,
) -> FloatArray:
    """Sum of the fields of many regions, each with a uniform eigenstrain.

    Parameters
    ----------
    shapes : sequence of HasPotentials
        The regions; they do not influence each other (prescribed eigenstrain).
    eigenstrains : (len(shapes), 6)
        Mandel eigenstrains [-].
    points, poisson_ratio, quantity, space, threads
        As for `eigencontact.halfspace.points.field_at_points`.
    tolerance : float
        Error allowed in large sums, relative to the largest value of the field; 0 sums to round-off.

    Returns
    -------
    (3, n) or (6, n)
        Displacement [m], or Mandel strain, or Mandel stress in units of the shear modulus.
    """
    require(len(shapes) == len(eigenstrains), "cloud", "eigenstrains", len(eigenstrains), f"{len(shapes)} rows")
    x, y, z = (np.ascontiguousarray(values, dtype=float) for values in points)
    out = np.zeros((QUANTITIES[quantity], x.size))
    options: dict[str, Any] = {"poisson_ratio": poisson_ratio, "quantity": quantity, "threads": threads}
    if len(shapes) == 1:
        return field_at_points(shapes[0], eigenstrains[0], (x, y, z), space=space, **options)
    distant: dict[int, PointSources] = {}
    large = is_large(len(shapes), x.size, tolerance)
    for number, shape in enumerate(shapes):
        far = cloud_sources(shape)
        if far is not None:
            distant[number] = far
        else:
            out += field_at_points(shape, eigenstrains[number], (x, y, z), space=space, **options)
    if distant:
        regions = _DistantRegions(shapes, distant, eigenstrains, _Finder(x, y, z), space, options)
        regions.add_far_fields(out, tolerance if large else None)
        regions.add_near_fields(out)
    return out


def _at_distances(finest: PointSources, distances: Sequence[float]) -> PointSources:
    """The same levels of point sources, each from another distance on."""
    chain: PointSources | None = None
    for level, distance in zip(finest.levels, distances, strict=True):
        chain = replace(level, distance=distance, coarser=chain)
    assert chain is not None
    return chain


class _Sources:
    """Point sources of regions, as tables for the compiled sums."""

    def __init__(self, regions: Sequence[PointSources], eigenstrains: FloatArray) -> None:
        levels = [far for region in regions for far in region.levels]
        counts = np.array([far.volumes.size for far in levels])
        depths = np.array([len(region.levels) for region in regions])
        ends, starts = np.cumsum(counts), np.cumsum([0, *depths])
        owner = np.repeat(np.repeat(np.arange(len(regions)), depths), counts)  # of each source
        positions = np.concatenate([far.positions for far in levels])
        centers, distances = np.array([far.center for far in regions]), np.array([far.distance for far in regions])
        away = np.sqrt(((positions - centers[owner]) ** 2).sum(axis=1))
        reaches = np.maximum.reduceat(away, (ends - counts)[starts[:-1]])
        rows = np.column_stack(
            [
                positions,
                np.concatenate([far.volumes for far in levels]),
                np.concatenate([far.spreads for far in levels]),
                from_mandel(eigenstrains.T).T[owner],
            ]
        )
        table = np.column_stack([[far.distance**2 for far in levels], ends - counts, ends])
        self.tables = (rows, np.column_stack([centers, reaches, distances]), starts, table)


def _blocks(count: int) -> IntArray:
    """Blocks of so many points, rows (first, stop, node, role), without a tree."""
    starts = np.arange(0, count, _BLOCK)
    return np.column_stack(
        [starts, np.minimum(starts + _BLOCK, count), np.full_like(starts, -1), np.zeros_like(starts)]
    )


def _sum_of_sources(
    sources: _Sources,
    points: tuple[FloatArray, FloatArray, FloatArray],
    *,
    space: str,
    poisson_ratio: float,
    quantity: str,
    threads: int | None,
    tree: Tree | None = None,
) -> FloatArray:
    """Compiled sum over point sources; strain follows from stress, because there is no eigenstrain at the points.

    With a tree over the points, in its order, what is far from many of them reaches them by an expansion.
    """
    from eigencontact.halfspace.cloud_kernels import sum_sources

    nu = float(poisson_ratio)
    rows, *tables = sources.tables
    rows = rows.copy()
    rows[:, 3] *= (1.0 if quantity == "displacement" else 2.0) / (8.0 * np.pi * (1.0 - nu))
    threads = threads or available_threads()

    def summed(
        points: Sequence[FloatArray] | FloatArray, blocks: IntArray, nodes: tuple[FloatArray, IntArray, float]
    ) -> FloatArray:
        out = np.zeros((QUANTITIES[quantity], points[0].size))
        options = (nodes, (rows, *tables), nu, space == "half", out)
        in_parallel(threads, [partial(sum_sources, *points, chunk, *options) for chunk in parts(blocks, threads)])
        return out

    if tree is None:
        out = summed(points, _blocks(points[0].size), _NO_TREE)
    else:
        count = points[0].size
        everywhere = np.concatenate([np.array(points), tree.expansion_points.reshape(3, -1)], axis=1)
        point_fields = summed(everywhere, tree.blocks, (tree.nodes, tree.parents, APART))
        out = np.ascontiguousarray(point_fields[:, :count])
        values = (
            point_fields[:, count:].reshape(len(point_fields), tree.expansion_points.shape[1], -1).transpose(1, 0, 2)
        )
        tree.add(np.array(points), np.ascontiguousarray(values), out, threads)
    if quantity == "displacement":
        return out
    if quantity == "strain":
        out[:3] -= nu / (1.0 + nu) * out[:3].sum(axis=0)
        out *= 0.5
    return to_mandel(out)


def likeness(shape: Any) -> Hashable:
    """Key of equal shapes up to a translation; a unique key for shapes without a position."""
    place = place_field(type(shape))
    if place is None:
        return id(shape)
    values = [(item.name, repr(getattr(shape, item.name))) for item in fields(shape) if item.name != place]
    return (type(shape), *values)


class _DistantRegions:
    """Regions with point sources, and the points at which their fields are summed.

    Parameters
    ----------
    shapes, eigenstrains
        Of all regions.
    sources : mapping of int to PointSources
        Point sources by number of the region.
    finder : _Finder
        The points.
    space, options
        Arguments of `field_at_points`.
    """

    def __init__(
        self, shapes: Sequence[HasPotentials], sources: Mapping[int, PointSources], eigenstrains: FloatArray,
        finder: _Finder, space: str, options: dict[str, Any],
    ) -> None:  # fmt: skip
        self._shapes, self._sources, self._eigenstrains = shapes, sources, eigenstrains
        self._finder, self._space, self._options = finder, space, options

    def add_far_fields(self, out: FloatArray, tolerance: float | None) -> None:
        """Add the point sources: one by one, or hierarchically to a tolerance."""
        if tolerance is not None:
            out += self._hierarchical(tolerance)
            return
        # Neighbours in space are neighbours in the sum, so that a block of points can do with few sources.
        order = self._finder.order
        out[:, order] += self._sum(list(self._sources.values()), self._finder.points[order].T)

    def _sum(self, regions: Sequence[PointSources], points: FloatArray, tree: Tree | None = None) -> FloatArray:
        x, y, z = np.ascontiguousarray(points)
        sources = _Sources(regions, self._eigenstrains[list(self._sources)])
        return _sum_of_sources(sources, (x, y, z), space=self._space, tree=tree, **self._options)

    def _hierarchical(self, tolerance: float) -> FloatArray:
        """Sum of the point sources with an error below `tolerance` of its largest value, by expansions if these pay.

        The error is the largest difference at points drawn at random from the sum without expansions, times a factor
        for points that were not drawn. A sum that is not good enough is repeated with a tenth of the tolerance.
        """
        points = np.ascontiguousarray(self._finder.points.T)
        count = points.shape[1]
        checked = np.random.default_rng(0).choice(count, min(_CHECKED, 1 + count // 16), replace=False)
        exact = self._sum(list(self._sources.values()), points[:, checked])
        out = np.empty((len(exact), count))
        node_tolerance = tolerance
        while True:
            regions = self._relaxed(tolerance)
            tree = Tree.over(points, degree_for(tolerance)) if expansions_pay(regions, count) else None
            order = self._finder.order if tree is None else tree.order
            out[:, order] = self._sum(regions, points[:, order], tree)
            error = _UNSEEN * float(np.abs(out[:, checked] - exact).max())
            if error <= node_tolerance * float(np.abs(out).max()) or tolerance < _LEAST:
                return out
            tolerance *= 0.1

    def _relaxed(self, tolerance: float) -> list[PointSources]:
        """Point sources for a tolerance; equal shapes share one search."""
        distances: dict[Hashable, list[float]] = {}
        regions = []
        for number, far in self._sources.items():
            key = likeness(self._shapes[number])
            if key not in distances:
                distances[key] = distances_for(far, tolerance)
            regions.append(_at_distances(far, distances[key]))
        return regions

    def add_near_fields(self, out: FloatArray) -> None:
        """Add the fields at points too close to a region, or to its image, for the point sources."""
        alike: dict[Hashable, list[int]] = {}
        for number in self._sources:
            alike.setdefault(likeness(self._shapes[number]), []).append(number)
        pairs = _Pairs(out)
        for members in alike.values():
            self._add_pairs(members, ("full",), pairs)
        if self._space == "half":
            level: dict[Hashable, list[int]] = {}  # an image depends on the depth
            for number, far in self._sources.items():
                if far.distance > far.center[2]:
                    level.setdefault((likeness(self._shapes[number]), float(far.center[2])), []).append(number)
            for members in level.values():
                self._add_pairs(members, ("half", "full"), pairs)
        pairs.flush()

    def _add_pairs(self, members: Sequence[int], spaces: tuple[str, ...], pairs: _Pairs) -> None:
        """Fields of equal regions in the first space minus that in the second, at points near them or their images."""
        canonical, far = self._shapes[members[0]], self._sources[members[0]]
        side = (1.0, 1.0, 1.0 if len(spaces) == 1 else -1.0)
        centers = np.array([self._sources[member].center for member in members])
        near_points = [self._finder.within(center * side, far.distance) for center in centers]
        index = np.concatenate(near_points)
        if not index.size:
            return
        counts = [near.size for near in near_points]
        owner = np.repeat(np.asarray(members), counts)
        offsets = self._finder.points[index] - np.repeat(centers, counts, axis=0)
        first, inverse = np.arange(len(offsets)), np.arange(len(offsets))
        if len(members) > 1:  # offsets that agree to round-off are one: regular arrays on a grid share their work
            rounded = np.round(offsets / (1e-12 * far.distance)).astype(np.int64)
            _, first, inverse = np.unique(rounded @ _HASH, return_index=True, return_inverse=True)
            if not np.array_equal(rounded[first][inverse], rounded):  # two of them have one hash
                first, inverse = np.arange(len(offsets)), np.arange(len(offsets))
        at = np.ascontiguousarray((offsets[first] + far.center).T)
        for start in range(0, first.size, _PAIRS):
            points = tuple(at[:, start : start + _PAIRS])
            fields = [unit_fields_at_points(canonical, points, space=space, **self._options) for space in spaces]
            unit = fields[0] - fields[1] if len(fields) == 2 else fields[0]
            chunk: Any = slice(None)
            if first.size > _PAIRS:
                chunk = np.flatnonzero((inverse >= start) & (inverse < start + _PAIRS))
            strains = self._eigenstrains[owner[chunk]]
            pairs.add(index[chunk], np.einsum("ucn,nu->cn", unit[:, :, inverse[chunk] - start], strains))


class _Pairs:
    """Values at points, collected for a joint addition to a field."""

    def __init__(self, out: FloatArray) -> None:
        self._out, self._index, self._values = out, list[IntArray](), list[FloatArray]()

    def add(self, index: IntArray, values: FloatArray) -> None:
        """Add values ``(components, pairs)`` at points, a point maybe several times."""
        self._index.append(index)
        self._values.append(values)
        if sum(pending.size for pending in self._index) > self._out.shape[1]:
            self.flush()

    def flush(self) -> None:
        """Add the collected values."""
        if self._index:
            index = np.concatenate(self._index)
            for component, values in enumerate(np.concatenate(self._values, axis=1)):
                self._out[component] += np.bincount(index, weights=values, minlength=self._out.shape[1])
        self._index.clear()
        self._values.clear()


class _Finder:
    """Search structure for the points close to a position."""

    def __init__(self, x: FloatArray, y: FloatArray, z: FloatArray) -> None:
        from scipy.spatial import cKDTree

        self.points = np.column_stack([x, y, z])
        self._tree = cKDTree(self.points, balanced_tree=False, compact_nodes=False)

    @property
    def order(self) -> NDArray[np.intp]:
        """Indices of the points, with neighbours in space next to each other."""
        return np.asarray(self._tree.indices)

    def within(self, place: FloatArray, distance: float) -> NDArray[np.intp]:
        """Indices of points strictly closer than `distance`."""
        near = np.array(self._tree.query_ball_point(place, distance * (1.0 + 1e-9)), dtype=np.intp)
        if not near.size:
            return near
        dx, dy, dz = (self.points[near] - place).T
        return np.sort(near[dx * dx + dy * dy + dz * dz < distance * distance])  # rounded as the compiled sums do
