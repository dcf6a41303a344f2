"""Shapes that offer only ``contains`` as sums over the corners of their cells.

Cells that adjoin share corners. With f the fraction of each cell (0 outside the lattice), D the difference along an
axis and C the corner function of a derivative, the derivative of the region's potential is the sum over nodes of::

    (Dx Dy Dz f) C(point - node)

Nodes within the region and outside of it have no weight: the work grows with the region's surface. C is singular on the
rays that lead from a node along -x, -y and -z, where poles of several nodes would have to cancel. So it is only asked
for positive offsets: along an axis in which its derivative is of odd order it is even, along the others odd but for
twice its value at offset 0, which does not depend on that offset. Summed over the nodes beyond the point, the latter is
the sum over the section of the region through the point, for the axis x::

    -2 (Dy Dz f) C(0, point - node)

What is singular then are true edges, where the fractions of neighbours differ.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property, partial
from math import comb

import numpy as np

from eigencontact.core.array_types import FloatArray
from eigencontact.core.parallel import available_threads, in_parallel
from eigencontact.errors import require
from eigencontact.halfspace.potentials import HasCornerPotentials, Order, Point, PointSources
from eigencontact.halfspace.voxels import Region, volume_fractions, voxels_across

__all__ = ["VoxelisedShape"]

CellShape = Callable[[Point, Point], HasCornerPotentials]  # centre and edges -> the shape of one cell

# Pairs of a node and a field point taken at a time, so that their kernels stay in cache.
_PAIRS = 16_384
# Distance from a face, in cells, below which a point lies on it; depth of the top below which that is the surface.
_SNAP = 1e-12
# Offset, in cells, that stands for the limit from one side.
_BESIDE = 1e-30
# What point sources may leave out, relative to the field.
_FAR_DIGITS = 1e-11


class VoxelisedShape:
    """A region as a sum of cells weighted by volume fraction, with potentials like any other shape.

    Parameters
    ----------
    region : Region
        The shape.
    cell : callable
        ``cell(centre, edges)`` makes the shape of one cell, with corner potentials.
    cells : int
        Cells across the longest extent. Outside, the error falls with the square of their size: at half a radius from a
        sphere 16 cells across leave 0.05 to 0.6 % (measured).

    Notes
    -----
    The cost of a point grows with the number of cells that the boundary cuts, the square of `cells`.
    """

    def __init__(self, region: Region, cell: CellShape, cells: int) -> None:
        self.region, self.voxels = region, voxels_across(region.bounds, cells)
        self.fractions = volume_fractions(region, self.voxels)
        require(self.fractions.any(), "voxels", "cells", cells, "enough to find a part of the region")
        dx, dy, dz = self.voxels.edges.tolist()
        self._corner = cell((0.0, 0.0, 0.5 * dz), (dx, dy, dz)).corner
        self._unit = max(dx, dy, dz)
        self._low, self._pitch = self.voxels.low / self._unit, self.voxels.edges / self._unit
        self._flush = bool(abs(self._low[2]) <= _SNAP)
        if self._flush:
            self._low[2] = 0.0
        self._along = self.fractions.transpose(2, 1, 0)
        self._nodes, self._weights = self._weighted_nodes(self._along, (0, 1, 2))
        self._sections: dict[tuple[int, int, int], tuple[FloatArray, FloatArray]] = {}

    @property
    def bounds(self) -> tuple[Point, Point]:
        """Bounds of the region."""
        return self.region.bounds

    @property
    def volume(self) -> float:
        """Volume of the cells [m^3]."""
        return float(self.fractions.sum() * np.prod(self.voxels.edges))

    def phi(self, orders: Sequence[Order], x: FloatArray, y: FloatArray, z: FloatArray) -> FloatArray:
        """Derivatives of Phi, summed over the cells."""
        return self._sum("phi", orders, x, y, z)

    def psi(self, orders: Sequence[Order], x: FloatArray, y: FloatArray, z: FloatArray) -> FloatArray:
        """Derivatives of Psi, summed over the cells."""
        return self._sum("psi", orders, x, y, z)

    def chi(self, orders: Sequence[Order], x: FloatArray, y: FloatArray, z: FloatArray) -> FloatArray:
        """Derivatives of Chi, summed over the cells."""
        return self._sum("chi", orders, x, y, z)

    def far_field(self) -> PointSources:
        """Points and weights with the integrals of polynomials over the cells; the error is below 1e-10."""
        return self._far

    @cached_property
    def _far(self) -> PointSources:
        low, high = (np.asarray(corner) for corner in self.bounds)
        distance = 8.0 * float(np.linalg.norm(high - low))
        (x, of_x), (y, of_y), (z, of_z) = (
            _interpolation(self.voxels.low[axis], self.voxels.edges[axis], count, distance)
            for axis, count in enumerate(self._along.shape)
        )
        volumes = np.einsum("ijk,ai,bj,ck->abc", self._along, of_x, of_y, of_z, optimize=True).ravel()
        return PointSources(
            center=0.5 * (low + high),
            distance=distance,
            positions=np.stack(np.meshgrid(x, y, z, indexing="ij"), axis=-1).reshape(-1, 3),
            volumes=volumes,
            spreads=np.zeros(volumes.size),
        )

    def _sum(self, name: str, orders: Sequence[Order], x: FloatArray, y: FloatArray, z: FloatArray) -> FloatArray:
        points = np.stack([np.ravel(t) for t in (x, y, z)])
        out = np.empty((len(orders), points.shape[1]))
        step = max(1, _PAIRS // self._weights.size)

        def fill(first: int) -> None:
            out[:, first : first + step] = self._derivatives(name, orders, points[:, first : first + step])

        in_parallel(available_threads(), [partial(fill, first) for first in range(0, points.shape[1], step)])
        powers = [(2 if name == "phi" else 4) - sum(order) for order in orders]
        out *= self._unit ** np.array(powers, dtype=float)[:, None]
        return out.reshape(len(orders), *np.shape(x))

    def _derivatives(self, name: str, orders: Sequence[Order], points: FloatArray) -> FloatArray:
        """Derivatives at some points, in units of the cells."""
        pairs = [self._pairs(point, image=name == "chi") for point in points.T]
        starts = np.cumsum([0, *(weights.size for *_, weights in pairs[:-1])])
        offsets, even, odd, weights = (np.concatenate(arrays, axis=-1) for arrays in zip(*pairs, strict=True))
        values = self._corner(name, orders, *np.abs(offsets))
        weights_of: dict[tuple[int, ...], FloatArray] = {}
        for row, order in enumerate(orders):
            parity = tuple(n % 2 for n in order)
            if parity not in weights_of:
                weights_of[parity] = weights * np.prod([(even, odd)[n][axis] for axis, n in enumerate(parity)], axis=0)
            values[row] *= weights_of[parity]
        return np.asarray(np.add.reduceat(values, starts, axis=1))

    def _pairs(self, point: FloatArray, *, image: bool) -> tuple[FloatArray, ...]:
        """Offsets ``(3, n)`` of a point from nodes, factors ``(3, n)`` by even and odd order along each axis, weights.

        Offsets from the mirror image count downwards: its nodes lie above the surface, their order is turned over.
        """
        mirror = np.array([1.0, 1.0, -1.0 if image else 1.0])[:, None]
        side = 0.0
        if self._flush and not image and point[2] == 0:  # the side from which a point of the surface sees it
            side = -1.0 if np.signbit(point[2]) else 1.0
        at = point / self._unit
        nodes, weights = [self._nodes], [self._weights]
        for axis in (0, 1) if image else (0, 1, 2):
            section = self._section(axis, float(at[axis]), side if axis == 2 else 0.0)
            nodes.append(section[0])
            weights.append(section[1])
        offset = at[:, None] - mirror * np.concatenate(nodes, axis=1)
        offset[np.abs(offset) <= _SNAP] = 0.0
        offset[2][offset[2] == 0] = side * _BESIDE
        even, odd = np.sign(offset), np.ones_like(offset)
        if image:  # all of it lies above the point
            even[2] = 1.0
        stop = self._weights.size
        for axis, section_nodes in enumerate(nodes[1:]):
            nodes_of_section = slice(stop, stop := stop + section_nodes.shape[1])
            offset[axis, nodes_of_section], even[axis, nodes_of_section], odd[axis, nodes_of_section] = 0.0, 1.0, 0.0
        total = np.concatenate(weights)
        return offset, even, odd, -total if image else total

    def _section(self, axis: int, place: float, side: float) -> tuple[FloatArray, FloatArray]:
        """Nodes and weights of the section at a coordinate; on a face the mean of both sides, or that of a side."""
        count, depth = self._along.shape[axis], (place - self._low[axis]) / self._pitch[axis]
        nearest = round(depth)
        on_face = abs(depth - nearest) * self._pitch[axis] <= _SNAP
        layers = (nearest - 1, nearest) if on_face else (int(np.floor(depth)),) * 2
        if side:
            layers = (0 if side > 0 else -1,) * 2
        above, below = (layer if 0 <= layer < count else -1 for layer in layers)
        key = axis, above, below
        if key not in self._sections:
            padded = np.concatenate([self._along, np.zeros_like(self._along.take([0], axis))], axis)
            across = tuple(across_axis for across_axis in range(3) if across_axis != axis)
            fractions = -(padded.take([above], axis) + padded.take([below], axis))
            self._sections[key] = self._weighted_nodes(fractions, across)
        return self._sections[key]

    def _weighted_nodes(self, fractions: FloatArray, axes: tuple[int, ...]) -> tuple[FloatArray, FloatArray]:
        """Coordinates ``(3, n)`` and weights of the nodes with nonzero differences along some axes."""
        for axis in axes:
            edge = np.zeros_like(fractions.take([0], axis))
            fractions = np.diff(fractions, axis=axis, prepend=edge, append=edge)
        nodes = np.argwhere(fractions)
        return self._low[:, None] + nodes.T * self._pitch[:, None], fractions[tuple(nodes.T)]


def _interpolation(low: float, edge: float, count: int, distance: float) -> tuple[FloatArray, FloatArray]:
    """Nodes ``(n,)`` along an axis, and the cell integrals of the nodal polynomials, ``(n, count)``.

    What interpolation leaves out of a function with a pole at `distance` falls like (2 distance / half length)^-n; the
    derivatives of the fifth order fall by comb(n + 5, 5) less.
    """
    half = 0.5 * count * edge
    n = 1
    while comb(n + 5, 5) * (2.0 * distance / half) ** -n > _FAR_DIGITS:
        n += 1
    nodes, weights = np.polynomial.legendre.leggauss(n)
    inside = ((np.arange(count)[:, None] + 0.5 * (nodes + 1.0)) * 2.0 / count - 1.0).ravel()
    legendre = np.polynomial.legendre.legvander(inside, n - 1).T * (np.arange(n) + 0.5)[:, None]
    values = (weights[:, None] * np.polynomial.legendre.legvander(nodes, n - 1)) @ legendre
    return low + half * (nodes + 1.0), edge * 0.5 * values.reshape(n, count, n) @ weights
