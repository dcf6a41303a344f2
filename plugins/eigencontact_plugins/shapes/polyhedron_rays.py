"""Winding number of a closed surface around points, from the triangles on a ray from each point.

All rays have the same direction, which is not along any lattice. The triangles can therefore be sorted once into bins
of the plane across this direction, and each point is compared with a few triangles only. A ray through an edge or a
corner within round-off gives no result: such points are reported, and their solid angle is used instead.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eigencontact.plugin import FloatArray

__all__ = ["Bins", "sorted_into_bins"]

IntArray = NDArray[np.intp]

#: Distances, relative to the size of the surface, below which a ray passes through an edge.
ROUNDING = 1e-12
PAIRS = 1 << 18

_c, _s = np.cos(0.7361), np.sin(0.7361)
_d, _t = np.cos(1.0917), np.sin(1.0917)
#: Rotation whose third column is the direction of the rays.
TURN: FloatArray = np.array([[_c, -_s, 0.0], [_s, _c, 0.0], [0.0, 0.0, 1.0]]) @ np.array(
    [[_d, 0.0, _t], [0.0, 1.0, 0.0], [-_t, 0.0, _d]]
)


@dataclass(frozen=True, eq=False)
class Bins:
    """Triangles ``(m, 3, 3)`` in rotated coordinates from 0 to about 1, and the triangles of each bin."""

    origin: FloatArray
    extent: float
    count: int
    corners: FloatArray
    first: IntArray
    members: IntArray

    def winding(self, points: FloatArray) -> tuple[IntArray, NDArray[np.bool_]]:
        """Winding number of points ``(n, 3)``, and the uncertain points."""
        turned = ((points - self.origin) @ TURN) / self.extent
        cell = np.clip((turned[:, :2] * self.count).astype(np.intp), 0, self.count - 1)
        place = cell[:, 0] * self.count + cell[:, 1]
        number = self.first[place + 1] - self.first[place]
        winding, doubt = np.zeros(len(points), dtype=np.intp), np.zeros(len(points), dtype=bool)
        ends = np.cumsum(number)
        start = 0
        while start < len(points):
            stop = max(start + 1, int(np.searchsorted(ends, (ends[start - 1] if start else 0) + PAIRS)))
            chunk = slice(start, stop)
            self._meet(turned[chunk], self.first[place[chunk]], number[chunk], winding[chunk], doubt[chunk])
            start = stop
        return winding, doubt

    def _meet(
        self, points: FloatArray, first: IntArray, number: IntArray, winding: IntArray, doubt: NDArray[np.bool_]
    ) -> None:
        """All pairs of a point and a triangle of its bin; adds to `winding`, marks `doubt`."""
        point = np.repeat(np.arange(len(points)), number)
        within = np.arange(point.size) - np.repeat(np.cumsum(number) - number, number)
        corners = self.corners[self.members[np.repeat(first, number) + within]]
        offset = corners - points[point, None, :]
        x, y, z = offset[..., 0], offset[..., 1], offset[..., 2]
        sides = np.stack([x[:, i - 2] * y[:, i - 1] - x[:, i - 1] * y[:, i - 2] for i in range(3)], axis=1)
        low, high = sides.min(axis=1), sides.max(axis=1)
        up, down = low > ROUNDING, high < -ROUNDING
        doubt[point[~up & ~down & ((low > -ROUNDING) | (high < ROUNDING))]] = True
        crossing = np.flatnonzero(up | down)
        height = np.einsum("ni,ni->n", sides[crossing], z[crossing]) / sides[crossing].sum(axis=1)
        ahead = crossing[height > 0]
        np.add.at(winding, point[ahead], np.where(up[ahead], 1, -1))


def sorted_into_bins(corners: FloatArray) -> Bins:
    """Sort triangles ``(m, 3, 3)`` into square bins across the rays, about as many as triangles."""
    origin = corners.reshape(-1, 3).mean(axis=0)
    turned = (corners - origin) @ TURN
    low = turned.reshape(-1, 3).min(axis=0)
    extent = float(np.ptp(turned.reshape(-1, 3), axis=0).max())
    origin = origin + TURN @ low
    turned = (turned - low) / extent
    count = int(np.clip(np.sqrt(len(corners)), 1, 256))
    lowest, highest = (
        np.clip((v[:, :2] * count).astype(np.intp), 0, count - 1) for v in (turned.min(axis=1), turned.max(axis=1))
    )
    spans = highest - lowest + 1
    number = spans[:, 0] * spans[:, 1]
    triangle = np.repeat(np.arange(len(corners)), number)
    within = np.arange(triangle.size) - np.repeat(np.cumsum(number) - number, number)
    column = lowest[triangle, 0] + within // spans[triangle, 1]
    row = lowest[triangle, 1] + within % spans[triangle, 1]
    place = column * count + row
    order = np.argsort(place, kind="stable")
    first = np.concatenate([[0], np.cumsum(np.bincount(place, minlength=count * count))])
    return Bins(origin, extent, count, turned, first, triangle[order])
