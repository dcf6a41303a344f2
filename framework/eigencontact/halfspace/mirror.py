"""Chi of a mirror image, integrated from Phi for shapes that have no closed form.

Chi,33 = Phi and everything decays, so for derivatives in the plane

    Chi,ab..(x, y, Z) = integral from Z to infinity of (t - Z) Phi,ab..(x, y, t) dt,

one smooth integral along a line that leads away from the image. One derivative along Z takes the factor to -1.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import Protocol

import numpy as np

from eigencontact.core.array_types import FloatArray
from eigencontact.halfspace.potentials import Order

__all__ = ["integrated_chi"]


class HasPhi(Protocol):
    """Interface of a shape for the integral."""

    @property
    def bounds(self) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
        """Lowest and highest coordinates of the region [m]."""

    def phi(self, orders: Sequence[Order], x: FloatArray, y: FloatArray, z: FloatArray) -> FloatArray:
        """Derivatives of one potential, ``(len(orders), n)``, or of several, ``(len(orders), k, n)``."""


_NODES = 20  # of one panel
_RATIO = 2.0
_MOST_PANELS = 16
_BATCH = 65_536


def integrated_chi(shape: HasPhi, orders: Sequence[Order], x: FloatArray, y: FloatArray, z: FloatArray) -> FloatArray:
    """Derivatives of Chi of the mirror image at depths z >= 0, ``(len(orders), n)``; at most one along z.

    Where `shape.phi` gives several potentials, ``(len(orders), k, n)``, those of all, ``(len(orders), k, n)``.
    Gauss-Legendre on panels graded towards the image: one panel if the point is far from it, more where it is close.
    """
    low, high = (np.asarray(corner, dtype=float) for corner in shape.bounds)
    centre = 0.5 * (low + high)
    # Distance to the image's middle sets the scale, distance to its box how finely the first panel is cut.
    reach = np.sqrt((x - centre[0]) ** 2 + (y - centre[1]) ** 2 + (z + centre[2]) ** 2)
    gap = _distance(x, y, -z, low, high)
    panels = 1 + np.ceil(np.log(np.maximum(reach / np.maximum(gap, 1e-30 * reach), 1.0)) / np.log(_RATIO))
    panels = np.minimum(panels, _MOST_PANELS).astype(int)
    out: FloatArray | None = None
    flat = sorted({(nx, ny, 0) for nx, ny, _ in orders})
    rows = [(flat.index((nx, ny, 0)), nz) for nx, ny, nz in orders]
    for count in np.unique(panels):
        nodes, weights = _rule(int(count))
        points = np.flatnonzero(panels == count)
        step = max(1, _BATCH // nodes.size)
        for first in range(0, points.size, step):
            chunk = points[first : first + step]
            along = reach[chunk, None] * nodes
            shape_of = along.shape
            at = [np.broadcast_to(v[chunk, None], shape_of).ravel() for v in (x, y)]
            values = shape.phi(flat, at[0], at[1], (-z[chunk, None] - along).ravel())
            if out is None:
                out = np.empty((len(orders), *values.shape[1:-1], x.size))
            values = values.reshape(*values.shape[:-1], *shape_of)
            zeroth = np.einsum("k...ij,j,i->k...i", values, weights, reach[chunk])
            first_moment = np.einsum("k...ij,j,i->k...i", values, weights * nodes, reach[chunk] ** 2)
            for row, (source, nz) in enumerate(rows):
                out[row][..., chunk] = -zeroth[source] if nz else first_moment[source]
    return np.empty((len(orders), 0)) if out is None else out


def _distance(x: FloatArray, y: FloatArray, z: FloatArray, low: FloatArray, high: FloatArray) -> FloatArray:
    """Distance of points from a box."""
    total = np.zeros_like(x)
    for value, a, b in zip((x, y, z), low, high, strict=True):
        total += np.maximum(np.maximum(a - value, value - b), 0.0) ** 2
    return np.sqrt(total)


@cache
def _rule(panels: int) -> tuple[FloatArray, FloatArray]:
    """Nodes and weights on (0, inf) in units of the reach: graded panels up to 1, then 1 to infinity by t = 1/s."""
    points, weights = np.polynomial.legendre.leggauss(_NODES)
    points, weights = 0.5 * (points + 1.0), 0.5 * weights
    if panels == 1:  # the whole line, mapped by t = s/(1 - s)
        return points / (1.0 - points), weights / (1.0 - points) ** 2
    edges = np.concatenate(([0.0], _RATIO ** np.arange(2.0 - panels, 1.0)))
    width = np.diff(edges)
    nodes = (edges[:-1, None] + width[:, None] * points).ravel()
    inner = (width[:, None] * weights).ravel()
    return np.concatenate((nodes, 1.0 / points)), np.concatenate((inner, weights / points**2))
