"""Mean stress in regions by their uniform eigenstrains: all pairs at once, without a matrix.

The stress of other regions is biharmonic in a region, for the body bears no forces there. Its mean over a ball is then
a mean over a few points, nearly exact: all that a cubature of degree five leaves of a biharmonic field are derivatives
of the sixth order. The points of all regions see the point sources of all regions in one compiled sum; what is left are
the points within a region, or too close for its point sources, whose share is found once, as small matrices.
"""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigencontact.errors import require
from eigencontact.halfspace.cloud import _Finder, _likeness, _Sources, _sum_of_sources, uses_point_sources
from eigencontact.halfspace.points import field_at_points
from eigencontact.halfspace.potentials import HasFarField, HasPotentials, PointSources

__all__ = ["RegionMeans", "averaging_points"]

FloatArray = NDArray[np.float64]

# Edges of the lattice of points that averages over a shape of which nothing is known but its potentials.
_LATTICE = 6


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
        Points over which the means are taken [m], all regions' one after the other.
    own : (n, 6, 6)
        Mean stress in each region by its own eigenstrain, in units of the shear modulus; with its mirror image.
    """

    def __init__(
        self, shapes: Sequence[HasPotentials], *, poisson_ratio: float, space: str = "half", threads: int | None = None
    ) -> None:
        require(len(shapes) > 0, "regions", "shapes", len(shapes), "at least one")
        self._shapes = list(shapes)
        self._given: dict[str, Any] = {"poisson_ratio": poisson_ratio, "threads": threads}
        self._space = space
        rules = [averaging_points(shape) for shape in shapes]
        self._weights = np.concatenate([weights for _, weights in rules])
        self._starts = np.cumsum([0, *(weights.size for _, weights in rules)])
        self.points: FloatArray = np.ascontiguousarray(np.concatenate([points for points, _ in rules]).T)
        self._far = {
            number: shape.far_field()
            for number, shape in enumerate(shapes)
            if isinstance(shape, HasFarField) and uses_point_sources(shape)
        }
        self._pairs = self._close_pairs()

    def mean(self, values: FloatArray) -> FloatArray:
        """Means ``(k, n)`` of a field given at `points`, ``(k, m)``."""
        return np.asarray(np.add.reduceat(values * self._weights, self._starts[:-1], axis=1))

    def apply(self, eigenstrains: FloatArray) -> FloatArray:
        """Mean stress ``(6, n)``, in units of the shear modulus, by the Mandel eigenstrains ``(6, n)`` [-]."""
        out = np.zeros_like(eigenstrains)
        if self._far:
            regions, chosen = list(self._far.values()), eigenstrains[:, list(self._far)].T
            out += self.mean(self._summed(regions, chosen, slice(None)))
        targets, sources, matrices = self._pairs
        shares = np.einsum("pij,jp->ip", matrices, eigenstrains[:, sources])
        for component, values in enumerate(shares):
            out[component] += np.bincount(targets, weights=values, minlength=out.shape[1])
        return out

    @cached_property
    def own(self) -> FloatArray:
        """See the class."""
        out = np.zeros((len(self._shapes), 6, 6))
        targets, sources, matrices = self._pairs
        same = targets == sources
        np.add.at(out, targets[same], matrices[same])
        for number, far in self._far.items():
            here = slice(self._starts[number], self._starts[number + 1])
            for component, unit in enumerate(np.eye(6)):
                out[number, :, component] += self._summed([far], unit[None], here) @ self._weights[here]
        return out

    def _summed(
        self,
        regions: Sequence[PointSources],
        eigenstrains: FloatArray,
        at: slice | NDArray[np.intp],
        space: str | None = None,
    ) -> FloatArray:
        x, y, z = (np.ascontiguousarray(values) for values in self.points[:, at])
        sources = _Sources(regions, list(eigenstrains))
        given = self._given if len(regions) > 1 else {**self._given, "threads": 1}  # too little to share
        return _sum_of_sources(sources, (x, y, z), space=space or self._space, quantity="stress", **given)

    def _close_pairs(self) -> tuple[NDArray[np.intp], NDArray[np.intp], FloatArray]:
        """Target, source and matrix of all that the sum over point sources leaves out or gets wrong."""
        owner = np.repeat(np.arange(len(self._shapes)), np.diff(self._starts))
        finder = _Finder(*self.points)
        known: dict[Hashable, FloatArray] = {}
        targets, sources, matrices = [], [], []

        def add(source: int, index: NDArray[np.intp], fields: FloatArray) -> None:
            weighted = fields * self._weights[index]
            for target in np.unique(owner[index]):
                targets.append(int(target))
                sources.append(source)
                matrices.append(weighted[:, :, owner[index] == target].sum(axis=2).T)

        for number, shape in enumerate(self._shapes):
            if number not in self._far:
                every = np.arange(owner.size)
                add(number, every, self._fields(shape, None, every, self._space))
                continue
            far = self._far[number]
            near = finder.within(far.center, far.distance)
            # In full space stress does not depend on the size: all balls share one matrix, and so do equal shapes.
            offsets = np.round((self.points[:, near].T - far.center) / (1e-12 * far.distance))
            key = ("ball" if _is_ball(far) else _likeness(shape), offsets.tobytes())
            if key not in known:
                known[key] = self._fields(shape, far, near, "full")
            add(number, near, known[key])
            near = finder.within(far.center * (1.0, 1.0, -1.0), far.distance)
            if self._space == "half" and near.size:  # a region that touches the surface: its image is as close
                add(number, near, self._fields(shape, far, near, "half") - self._fields(shape, far, near, "full"))
        return np.array(targets), np.array(sources), np.array(matrices)

    def _fields(self, shape: HasPotentials, far: PointSources | None, at: NDArray[np.intp], space: str) -> FloatArray:
        """Stress ``(6 eigenstrains, 6, points)`` of a region less that of its point sources, if it has any."""
        x, y, z = (np.ascontiguousarray(values) for values in self.points[:, at])
        out = np.empty((6, 6, at.size))
        finest = None if far is None else [replace(far, coarser=None)]
        for component, unit in enumerate(np.eye(6)):
            out[component] = field_at_points(
                shape,
                unit,
                (x, y, z),
                space=space,
                quantity="stress",
                poisson_ratio=self._given["poisson_ratio"],
                threads=1,
            )
            if finest is not None:
                out[component] -= self._summed(finest, unit[None], at, space)
        return out


def averaging_points(shape: HasPotentials) -> tuple[FloatArray, FloatArray]:
    """Points ``(m, 3)`` [m] and weights ``(m,)`` of the mean over a region.

    Ellipsoids, known by their volume and second moments, take 13 points and polynomials of degree 5 exactly (for a ball
    whose field is biharmonic the error is of the sixth order); other shapes with point sources 8 points and degree 3
    about their centroid's axes if they are symmetric; the rest a lattice in their bounds.
    """
    if not isinstance(shape, HasFarField):
        return _lattice(shape)
    far = shape.far_field()
    volume = float(far.volumes.sum())
    center = far.volumes @ far.positions / volume
    offsets = far.positions - center
    moments = (far.volumes[:, None] * offsets).T @ offsets + float(far.volumes @ far.spreads) * np.eye(3)
    squares, axes = np.linalg.eigh(moments / volume)
    deviations = np.sqrt(squares)
    ellipsoid = 4.0 / 3.0 * np.pi * float(np.prod(np.sqrt(5.0) * deviations))
    if abs(ellipsoid - volume) < 1e-6 * volume:
        points, weights = _ball()
        points = np.sqrt(5.0) * points
    else:
        points = np.array(np.meshgrid(*[(-1.0, 1.0)] * 3)).reshape(3, -1).T
        weights = np.full(8, 0.125)
    return center + (points * deviations) @ axes.T, weights


def _ball() -> tuple[FloatArray, FloatArray]:
    """Centre and twelve corners of an icosahedron: degree 5 in the unit ball."""
    golden = 0.5 * (1.0 + np.sqrt(5.0))
    corners = [
        np.roll((0.0, first, second * golden), turn) for turn in range(3) for first in (-1, 1) for second in (-1, 1)
    ]
    directions = np.array(corners) / np.hypot(1.0, golden)
    # <r²> = 3/5 and <r⁴> = 3/7 of a ball.
    return np.vstack([np.zeros(3), np.sqrt(5.0 / 7.0) * directions]), np.array([4.0 / 25.0] + [7.0 / 100.0] * 12)


def _lattice(shape: HasPotentials) -> tuple[FloatArray, FloatArray]:
    low, high = (np.array(corner, dtype=float) for corner in shape.bounds)
    parts = (np.arange(_LATTICE) + 0.5) / _LATTICE
    grid = np.array(np.meshgrid(parts, parts, parts)).reshape(3, -1)
    x, y, z = low[:, None] + grid * (high - low)[:, None]
    inside = shape.phi([(2, 0, 0), (0, 2, 0), (0, 0, 2)], x, y, z).sum(axis=0) < -2.0 * np.pi
    rule = f"thick enough to hold one of {_LATTICE} x {_LATTICE} x {_LATTICE} points in its bounds"
    require(inside.any(), "regions", "shape", shape, rule)
    return np.column_stack([x, y, z])[inside], np.full(int(inside.sum()), 1.0 / inside.sum())


def _is_ball(far: PointSources) -> bool:
    """One point source, of the spread that belongs to its volume."""
    radius = float(np.sqrt(5.0 * far.spreads[0]))
    return far.spreads.size == 1 and abs(far.volumes[0] - 4.0 / 3.0 * np.pi * radius**3) < 1e-9 * far.volumes[0]
