"""Mean stress in regions by their uniform eigenstrains: all pairs at once, without a matrix.

Pairs far apart share one compiled sum of point sources over a few points of each region. Pairs close to each other, or
to each other's mirror image, and each region with itself, are averaged once over many points, as small matrices. The
stress of other regions is biharmonic in a region, for the body bears no forces there; over a ball its mean is therefore
that over a sphere of sqrt(3/5) of the radius, and the accuracy of the points on that sphere limits the mean.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np

from eigencontact.core.array_types import FloatArray, IntArray
from eigencontact.errors import require
from eigencontact.halfspace.cloud import _Sources, _sum_of_sources, cloud_sources
from eigencontact.halfspace.points import unit_fields_at_points
from eigencontact.halfspace.potentials import HasFarField, HasPotentials, PointSources

__all__ = ["RegionMeans", "averaging_points", "is_ball"]

Rule = tuple[FloatArray, FloatArray]

# Edges of the lattice of points that averages over a shape of which nothing is known but its potentials.
_LATTICE = 6
# Distance in radii of the target from which its few points do: what they miss is then below 0.4 % of a point source.
_FAR = 4.0
# Order of the rule on a sphere (2 n² points) for a load that comes from near: an error of 2 % where the gap between two
# balls is 0.15 radii.
_OF_LOAD = 5
# Order of the rule for a close neighbour: an error of 0.03 % at the same gap.
_OF_NEIGHBOUR = 8


class RegionMeans:
    """Mean stress in each region by the uniform eigenstrains of all.

    Parameters
    ----------
    shapes : sequence of HasPotentials
        Regions that do not overlap.
    poisson_ratio : float
        In (-1, 0.5].
    space : {"half", "full"}
        With or without the free surface z = 0.
    threads : int, optional
        Cores to use; by default all.

    Attributes
    ----------
    points : (3, m)
        Points [m] over which `mean` averages a load, all regions' one after the other.
    self_stress : (n, 6, 6)
        Mean stress in each region by its own eigenstrain, in units of the shear modulus; of its image too.
    """

    def __init__(
        self, shapes: Sequence[HasPotentials], *, poisson_ratio: float, space: str = "half", threads: int | None = None
    ) -> None:
        require(len(shapes) > 0, "regions", "shapes", len(shapes), "at least one")
        self._shapes, self._space = list(shapes), space
        self._options: dict[str, Any] = {"poisson_ratio": poisson_ratio, "quantity": "stress"}
        self._threads = threads
        sources = {number: cloud_sources(shape) for number, shape in enumerate(shapes)}
        self._far = {number: far for number, far in sources.items() if far is not None}
        self._few = _Rules([averaging_points(shape) for shape in shapes])
        bounds = np.array([shape.bounds for shape in shapes], dtype=float)
        self._radii = 0.5 * (bounds[:, 1] - bounds[:, 0]).max(axis=1)
        self._centers = bounds.mean(axis=1)
        shallow = (self._centers[:, 2] < _FAR * self._radii) & (space == "half")
        load = [averaging_points(shape, _OF_LOAD if near else 0) for shape, near in zip(shapes, shallow, strict=True)]
        self._load = _Rules(load)
        self.points = self._load.points
        self._pairs = self._close_pairs([averaging_points(shape, _OF_NEIGHBOUR) for shape in shapes])

    def mean(self, values: FloatArray) -> FloatArray:
        """Means ``(k, n)`` of a field given at `points`, ``(k, m)``."""
        return self._load.mean(values)

    def apply(self, eigenstrains: FloatArray) -> FloatArray:
        """Mean stress ``(6, n)``, in units of the shear modulus, by the Mandel eigenstrains ``(6, n)`` [-]."""
        out = np.zeros_like(eigenstrains)
        if self._far and len(self._shapes) > 1:
            regions, strains = list(self._far.values()), eigenstrains[:, list(self._far)].T
            out += self._few.mean(self._summed(regions, strains, self._few.points, threads=self._threads))
        targets, sources, matrices = self._pairs
        shares = np.einsum("pij,jp->ip", matrices, eigenstrains[:, sources])
        for component, values in enumerate(shares):
            out[component] += np.bincount(targets, weights=values, minlength=out.shape[1])
        return out

    def _summed(
        self,
        regions: Sequence[PointSources],
        eigenstrains: FloatArray,
        points: FloatArray,
        *,
        space: str | None = None,
        threads: int | None = 1,
    ) -> FloatArray:
        x, y, z = (np.ascontiguousarray(values) for values in points)
        sources = _Sources(regions, eigenstrains)
        return _sum_of_sources(sources, (x, y, z), space=space or self._space, threads=threads, **self._options)

    def _close_pairs(self, rules: list[Rule]) -> tuple[IntArray, IntArray, FloatArray]:
        """Target, source and matrix of all that the sum over point sources leaves out or gets wrong."""
        count = len(self._shapes)
        self.self_stress = np.zeros((count, 6, 6))
        corrections: dict[bytes, FloatArray] = {}
        targets, sources, matrices = [], [], []
        for source in range(count):
            near = self._near(source) if source in self._far else np.arange(count)
            points = np.concatenate([rules[target][0] for target in near]).T
            weights = [rules[target][1] for target in near]
            fine = _means(self._fields(source, points, corrections), weights)
            self.self_stress[source] = fine[list(near).index(source)]
            if source in self._far and count > 1:
                few = [slice(self._few.starts[target], self._few.starts[target + 1]) for target in near]
                at = np.concatenate([self._few.points[:, region] for region in few], axis=1)
                counted = np.array([self._summed([self._far[source]], unit[None], at) for unit in np.eye(6)])
                fine -= _means(counted, [self._few.weights[region] for region in few])
            targets.append(near)
            sources.append(np.full(near.size, source))
            matrices.append(fine)
        return np.concatenate(targets), np.concatenate(sources), np.concatenate(matrices)

    def _near(self, source: int) -> IntArray:
        """Regions that are close to one, or to its mirror image; itself too."""
        is_near = np.zeros(len(self._shapes), dtype=bool)
        reach = np.maximum(_FAR * self._radii, self._far[source].distance + self._radii)
        for mirror in (1.0, -1.0)[: 2 if self._space == "half" else 1]:
            offsets = self._centers - self._centers[source] * (1.0, 1.0, mirror)
            is_near |= np.einsum("ni,ni->n", offsets, offsets) < reach**2
        is_near[source] = True
        return np.flatnonzero(is_near)

    def _sums(self, source: int, points: FloatArray, space: str) -> FloatArray:
        """Stress ``(6 eigenstrains, 6, points)`` of the point sources of a region."""
        finest = [replace(self._far[source], coarser=None)]
        return np.array([self._summed(finest, unit[None], points, space=space) for unit in np.eye(6)])

    def _exact(self, source: int, points: FloatArray, space: str) -> FloatArray:
        """The same by the region's own potentials, evaluated once for all six eigenstrains."""
        x, y, z = points
        return unit_fields_at_points(self._shapes[source], (x, y, z), space=space, threads=1, **self._options)

    def _fields(self, source: int, points: FloatArray, corrections: dict[bytes, FloatArray]) -> FloatArray:
        """Stress ``(6 eigenstrains, 6, points)`` of a region."""
        if source not in self._far:
            return self._exact(source, points, self._space)
        far = self._far[source]
        if not _is_one_ball(far):
            return self._fields_by_levels(source, points)
        out = self._sums(source, points, self._space)
        offsets = points.T - far.center
        close = np.flatnonzero(np.einsum("ni,ni->n", offsets, offsets) < far.distance**2)
        # In full space stress does not depend on the size: all balls share one matrix.
        key = np.round(offsets[close] / (1e-12 * far.distance)).tobytes()
        if key not in corrections:
            corrections[key] = self._exact(source, points[:, close], "full") - self._sums(
                source, points[:, close], "full"
            )
        out[:, :, close] += corrections[key]
        if self._space == "half":
            offsets = points.T - far.center * (1.0, 1.0, -1.0)
            close = np.flatnonzero(np.einsum("ni,ni->n", offsets, offsets) < far.distance**2)
            if close.size:  # a region that touches the surface, or nearly: its image is as close
                at = points[:, close]
                out[:, :, close] += self._exact(source, at, "half") - self._exact(source, at, "full")
                out[:, :, close] -= self._sums(source, at, "half") - self._sums(source, at, "full")
        return out

    def _fields_by_levels(self, source: int, points: FloatArray) -> FloatArray:
        """The same for a region of many point sources: none of them near by, few of them far away."""
        far = self._far[source]
        close = np.zeros(points.shape[1], dtype=bool)
        for mirror in (1.0, -1.0)[: 2 if self._space == "half" else 1]:
            offsets = points.T - far.center * (1.0, 1.0, mirror)
            close |= np.einsum("ni,ni->n", offsets, offsets) < far.distance**2
        out = np.empty((6, 6, points.shape[1]))
        out[:, :, close] = self._exact(source, points[:, close], self._space)
        away = points[:, ~close]
        out[:, :, ~close] = [self._summed([far], unit[None], away) for unit in np.eye(6)]
        return out


class _Rules:
    """Points and weights of all regions, one after the other."""

    def __init__(self, rules: Sequence[Rule]) -> None:
        self.points: FloatArray = np.ascontiguousarray(np.concatenate([points for points, _ in rules]).T)
        self.weights = np.concatenate([weights for _, weights in rules])
        self.starts = np.cumsum([0, *(weights.size for _, weights in rules)])

    def mean(self, values: FloatArray) -> FloatArray:
        """Means ``(k, n)`` of values ``(k, points)``."""
        return np.asarray(np.add.reduceat(values * self.weights, self.starts[:-1], axis=1))


def _means(fields: FloatArray, weights: Sequence[FloatArray]) -> FloatArray:
    """Matrices ``(targets, 6, 6)`` from stress ``(6 eigenstrains, 6, points)``."""
    starts = np.cumsum([0, *(weights_of_region.size for weights_of_region in weights[:-1])])
    means = np.add.reduceat(fields * np.concatenate(weights), starts, axis=2)
    return np.asarray(means.transpose(2, 1, 0))


def averaging_points(shape: HasPotentials, order: int = 0) -> Rule:
    """Points ``(m, 3)`` [m] and weights ``(m,)`` of the mean over a region.

    Ellipsoids, known by their volume and second moments, take 13 points and polynomials of degree 5 exactly. Order
    n > 0 asks for more: a ball then takes 2 n² points on one sphere, exact for biharmonic polynomials of degree
    2 n - 1, and an ellipsoid somewhat fewer at each of three radii. Other shapes with point sources take 8 points and
    degree 3 (if they are symmetric about their centroid's axes), the rest a lattice in their bounds, good to 0.3 %.
    """
    if not isinstance(shape, HasFarField):
        return _lattice(shape)
    far = shape.far_field()
    volume = float(far.volumes.sum())
    center = far.volumes @ far.positions / volume
    offsets = far.positions - center
    moments = (far.volumes[:, None] * offsets).T @ offsets + float(far.volumes @ far.spreads) * np.eye(3)
    squares, axes = (np.full(3, far.spreads[0]), np.eye(3)) if _is_one_ball(far) else np.linalg.eigh(moments / volume)
    deviations = np.sqrt(squares)
    ellipsoid = 4.0 / 3.0 * np.pi * float(np.prod(np.sqrt(5.0) * deviations))
    if abs(ellipsoid - volume) < 1e-6 * volume:
        points, weights = (
            _ball() if order == 0 else _shells(*((order, 1) if _is_one_ball(far) else (max(4, order - 2), 3)))
        )
        points = np.sqrt(5.0) * points
    else:
        points = np.array(np.meshgrid(*[(-1.0, 1.0)] * 3)).reshape(3, -1).T
        weights = np.full(8, 0.125)
    return center + (points * deviations) @ axes.T, weights


def _ball() -> Rule:
    """Centre and twelve corners of an icosahedron: degree 5 in the unit ball."""
    golden = 0.5 * (1.0 + np.sqrt(5.0))
    signs = [(first, second) for first in (-1, 1) for second in (-1, 1)]
    corners = [np.roll((0.0, first, second * golden), turn) for turn in range(3) for first, second in signs]
    directions = np.array(corners) / np.hypot(1.0, golden)
    # <r²> = 3/5 and <r⁴> = 3/7 of a ball.
    return np.vstack([np.zeros(3), np.sqrt(5.0 / 7.0) * directions]), np.array([4.0 / 25.0] + [7.0 / 100.0] * 12)


@cache
def _shells(order: int, count: int) -> Rule:
    """Spheres in the unit ball; a single one has the radius that does for biharmonic functions."""
    heights, of_height = np.polynomial.legendre.leggauss(order)
    turns = (np.arange(2 * order) + 0.5) * np.pi / order
    t, v = (values.ravel() for values in np.meshgrid(heights, turns, indexing="ij"))
    directions = np.column_stack([np.sqrt(1.0 - t * t) * np.cos(v), np.sqrt(1.0 - t * t) * np.sin(v), t])
    weights = np.repeat(of_height / (4.0 * order), 2 * order)
    if count == 1:
        return np.sqrt(0.6) * directions, weights
    radii, of_radius = np.polynomial.legendre.leggauss(count)
    radii = 0.5 * (1.0 + radii)
    of_radius = 1.5 * radii**2 * of_radius
    return (radii[:, None, None] * directions).reshape(-1, 3), np.outer(of_radius, weights).ravel()


def _lattice(shape: HasPotentials) -> Rule:
    low, high = (np.array(corner, dtype=float) for corner in shape.bounds)
    fractions = (np.arange(_LATTICE) + 0.5) / _LATTICE
    grid = np.array(np.meshgrid(fractions, fractions, fractions)).reshape(3, -1)
    x, y, z = low[:, None] + grid * (high - low)[:, None]
    inside = shape.phi([(2, 0, 0), (0, 2, 0), (0, 0, 2)], x, y, z).sum(axis=0) < -2.0 * np.pi
    rule = f"thick enough to hold one of {_LATTICE} x {_LATTICE} x {_LATTICE} points in its bounds"
    require(inside.any(), "regions", "shape", shape, rule)
    return np.column_stack([x, y, z])[inside], np.full(int(inside.sum()), 1.0 / inside.sum())


def is_ball(shape: object) -> bool:
    """Whether a shape is a ball, by its far field."""
    return isinstance(shape, HasFarField) and _is_one_ball(shape.far_field())


def _is_one_ball(far: PointSources) -> bool:
    """One point source, of the spread that belongs to its volume."""
    radius = float(np.sqrt(5.0 * far.spreads[0]))
    return far.spreads.size == 1 and abs(far.volumes[0] - 4.0 / 3.0 * np.pi * radius**3) < 1e-9 * far.volumes[0]
