"""A tree of points, and biharmonic expansions of the fields of distant regions at the points of a node.

Fields without body forces are biharmonic, and so are their half-space images. In a ball of radius b whose center no
source comes closer to than b/θ they are polynomials of degree p up to some θ^(p+1): a few hundred values on two spheres
determine them for any number of points in it. Every node expands the regions that are far from it and were not far from
the nodes above, and passes its expansion down.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, cached_property, partial
from math import comb

import numpy as np

from eigencontact.core.array_types import FloatArray, IntArray
from eigencontact.core.parallel import in_parallel, parts
from eigencontact.halfspace.potentials import PointSources

__all__ = ["APART", "Tree", "degree_for", "distances_for", "error_of", "expansion_size"]

#: Radius of a node in units of the gap between its center and a region that it takes by its expansion.
APART = 0.3
# Error of expansions relative to the largest value of the field: this times comb(p + 4, 4) θ^(p + 1). In clouds of
# spheres and ellipsoids displacement had at most 1.7 times that with p = 6 and a twentieth of it with p = 11, stress a
# third of these.
_CONSTANT = 3e-3
# Radius of the inner sphere of an expansion, in units of the outer one.
_INNER = 0.55
# Points on the spheres per unknown.
_POINTS = 1.06
# Degree up to which moments of point sources are compared.
_COMPARED = 36
# Points that are summed together: a small block is close to few regions.
_BLOCK = 32


def error_of(degree: int) -> float:
    """Error to be expected of expansions, relative to the largest value of the field."""
    return _CONSTANT * comb(degree + 4, 4) * APART ** (degree + 1)


def degree_for(tolerance: float) -> int:
    """Lowest degree whose expected error is below a tolerance."""
    degree = 3
    while error_of(degree) > tolerance:
        degree += 1
    return degree


def expansion_size(tolerance: float) -> int:
    """Number of interpolation points of an expansion for a tolerance."""
    return int(_unit(degree_for(tolerance))[0].shape[1])


def distances_for(finest: PointSources, tolerance: float) -> list[float]:
    """Distances [m] from which levels of point sources, the coarsest first, are as accurate as the finest.

    What a level gets wrong is the difference of its multipole moments from those of the finest, relative to the field
    of all the volume in the center; moments above those compared are taken to be all wrong.
    """
    from eigencontact.halfspace.expansion_kernels import moments

    levels, unit = finest.levels, max(level.reach for level in finest.levels)
    if len(levels) == 1:
        return [level.distance for level in levels]
    volume = float(finest.volumes.sum())

    def of(level: PointSources) -> FloatArray:
        x, y, z = np.ascontiguousarray((level.positions - level.center).T / unit)
        return np.asarray(moments(x, y, z, level.volumes / volume, level.spreads / unit**2, _COMPARED))

    exact, k = of(finest), np.arange(_COMPARED + 30)
    of_first = (k + 1) * (k + 2) * (0.5 * k + 2.0) / 4.0
    of_second = (k + 1) * (k + 2) * (k + 3) * (k + 4) / 4.0
    trial = np.geomspace(1.02, finest.levels[0].distance / unit, 400)
    powers = trial[:, None] ** -k
    out = []
    for level in levels:
        wrong = np.sqrt(np.add.reduceat((of(level) - exact) ** 2, np.arange(_COMPARED + 1) ** 2, axis=1))
        errors = np.full((2, k.size), 2.0)
        errors[1] /= 2.0 * k + 3.0
        errors[:, : _COMPARED + 1] = wrong
        error = powers @ (of_first * errors[0]) + (powers @ (of_second * errors[1])) / trial**2
        good = trial[error <= tolerance] * unit
        out.append(min(level.distance, float(good[0])) if good.size else level.distance)
    out[-1] = finest.distance  # nothing finer tells how well it does
    return [float(distance) for distance in np.maximum.accumulate(out[::-1])[::-1]]


@cache
def _unit(degree: int) -> tuple[FloatArray, FloatArray]:
    """Points ``(3, m)`` of an expansion in the unit ball, and coefficients of values there, ``(count, m)``."""
    from eigencontact.halfspace.expansion_kernels import polynomials

    outer, inner = (int(np.ceil(_POINTS * n * n)) for n in (degree + 1, degree - 1))
    points = np.ascontiguousarray(np.concatenate([_spiral(outer), _INNER * _spiral(inner)]).T)
    return points, np.linalg.pinv(polynomials(*points, degree).T)


def _spiral(count: int) -> FloatArray:
    """Points spread evenly on the unit sphere, ``(count, 3)``."""
    height = 1.0 - (2.0 * np.arange(count) + 1.0) / count
    turn, across = np.pi * (1.0 + np.sqrt(5.0)) * np.arange(count), np.sqrt(1.0 - height * height)
    return np.column_stack([across * np.cos(turn), across * np.sin(turn), height])


@dataclass(frozen=True)
class Tree:
    """Nodes of a binary tree over points.

    Attributes
    ----------
    order : (n,)
        Points, those of a node next to each other.
    nodes : (k, 5)
        Center, radius of a ball that holds the points, 1 if the node has an expansion; in the order of their depth.
    ranges : (k, 2)
        First of the points of a node and the end of them.
    parents, children : (k,), (k, 2)
        Nodes above and below; -1 for none.
    depths : (d + 1,)
        First node of each depth.
    degree : int
        Of the expansions.
    """

    order: IntArray
    nodes: FloatArray
    ranges: IntArray
    parents: IntArray
    children: IntArray
    depths: IntArray
    degree: int

    @classmethod
    def over(cls, points: FloatArray, degree: int) -> Tree:
        """Tree over points ``(3, n)``; a node has an expansion if it holds more points than the expansion."""
        from eigencontact.halfspace.expansion_kernels import grow

        order, nodes, ranges, parents, children, depths = grow(points, 3 * _unit(degree)[0].shape[1] // 2, _BLOCK)
        return cls(order, nodes, ranges, parents, children, depths, degree)

    @property
    def expansion_points(self) -> FloatArray:
        """Interpolation points of the expansions, ``(3, expansions, m)``."""
        unit, _ = _unit(self.degree)
        large = self.nodes[self.nodes[:, 4] > 0]
        return np.asarray(large[:, :3].T[:, :, None] + large[:, 3, None] * unit[:, None, :])

    @cached_property
    def blocks(self) -> IntArray:
        """Blocks for the compiled sums: of points (role 0) and, after all of them, of expansions (role 1)."""
        leaves, large = np.flatnonzero(self.children[:, 0] < 0), np.flatnonzero(self.nodes[:, 4])
        size = _unit(self.degree)[0].shape[1]
        starts = self.order.size + size * np.arange(large.size)
        point_and_node_blocks = [
            np.column_stack([self.ranges[leaves], leaves, np.zeros_like(leaves)]),
            np.column_stack([starts, starts + size, large, np.ones_like(large)]),
        ]
        # Shuffled, so that every thread gets some of the dear ones.
        return np.random.default_rng(0).permutation(np.concatenate(point_and_node_blocks))

    def add(self, points: FloatArray, values: FloatArray, out: FloatArray, threads: int) -> None:
        """Add the values of the expansions at points ``(3, n)``, in their order, to ``out (c, n)``.

        `values` of the expansions at their points, ``(expansions, c, m)``, are overwritten.
        """
        from eigencontact.halfspace.expansion_kernels import pass_down

        unit, fit = _unit(self.degree)
        place = np.cumsum(self.nodes[:, 4] > 0) - 1  # of each expansion among them
        for first, stop in zip(self.depths[:-1], self.depths[1:], strict=True):
            large = first + np.flatnonzero(self.nodes[first:stop, 4])
            if not large.size:
                continue
            depth = values[place[large]]
            coefficients = (depth.reshape(-1, depth.shape[2]) @ fit.T).reshape(*depth.shape[:2], -1)
            shared = (*points, self.ranges, self.children)
            tables = (place, self.nodes, unit, self.degree)
            in_parallel(
                threads,
                [
                    partial(pass_down, *shared, large[node_range], *tables, coefficients[node_range], values, out)
                    for node_range in parts(np.arange(large.size), threads)
                ],
            )
