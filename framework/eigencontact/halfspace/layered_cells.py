"""Values and integrals over rectangles of a smooth function of the plane, known on nodes that spread like sinh.

A field that comes from depths of s and more is, in each of x and y, analytic in a strip of the stretched coordinate
``ξ = asinh(x/s)``: its nearest singularities, x = ± i s, lie at ±iπ/2. Nodes at ξ = jΔ therefore resolve the scale s at
the origin and ever wider ones far from it. The interpolant (local Lagrange polynomials in ξ) is integrated over any
interval of x exactly, so the integral over a rectangle is a product of two vectors with the matrix of nodal values, for
rectangles far smaller than s and far larger alike.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from eigencontact.halfspace.layered_hankel import STENCIL, interpolation_weights

__all__ = ["StretchedNodes"]

FloatArray = NDArray[np.float64]

# Exact for the polynomial of degree STENCIL - 1 times dx/dξ, to rounding at the steps that are used.
POINTS, GAUSS = np.polynomial.legendre.leggauss(10)
MARGIN = STENCIL // 2


@dataclass(frozen=True)
class StretchedNodes:
    """Nodes x = s sinh(jΔ), j = 0, 1, ..., past `reach`; functions are even or odd in x.

    Parameters
    ----------
    scale : float
        Length s [m].
    reach : float
        Largest coordinate that will be asked for [m].
    step : float
        Spacing Δ of ξ [-].
    """

    scale: float
    reach: float
    step: float

    @cached_property
    def intervals(self) -> int:
        """Intervals between nodes up to `reach`."""
        return int(np.arcsinh(self.reach / self.scale) / self.step) + 1

    @cached_property
    def x(self) -> FloatArray:
        """Coordinates of the nodes, ``(n,)`` [m]."""
        x: FloatArray = self.scale * np.sinh(self.step * np.arange(self.intervals + MARGIN + 1))
        return x

    def integrals(self, low: FloatArray, high: FloatArray) -> dict[int, FloatArray]:
        """Weights ``(m, n)`` of integrals from `low` to `high` ``(m,)`` [m], for even (1) and odd (-1) functions."""
        upper, lower = self._primitives(high), self._primitives(low)
        return {parity: upper[parity] - lower[parity] for parity in (1, -1)}

    def values(self, x: FloatArray) -> dict[int, FloatArray]:
        """Weights ``(m, n)`` of the values at `x` ``(m,)`` [m], for even (1) and odd (-1) functions."""
        first, weights = interpolation_weights(np.arcsinh(np.abs(x) / self.scale) / self.step)
        number = np.arange(x.size)
        found = {parity: np.zeros((x.size, self.x.size)) for parity in (1, -1)}
        for j in range(STENCIL):
            node = first + j
            for parity, rows in found.items():
                rows[number, np.abs(node)] += np.where(node < 0, parity, 1) * weights[j]
        found[-1] *= np.sign(x)[:, None]
        return found

    @cached_property
    def _prefixes(self) -> dict[int, FloatArray]:
        """Weights of the integrals from 0 to each node, ``(intervals + 1, n)``."""
        whole = {parity: np.zeros((self.intervals + 1, self.x.size)) for parity in (1, -1)}
        inner = {parity: rows[1:] for parity, rows in whole.items()}
        self._add_parts(inner, np.arange(self.intervals), np.ones(self.intervals))
        return {parity: np.cumsum(rows, axis=0) for parity, rows in whole.items()}

    def _primitives(self, edges: FloatArray) -> dict[int, FloatArray]:
        """Weights of the integrals from 0 to each edge."""
        t = np.arcsinh(np.abs(edges) / self.scale) / self.step
        interval = np.minimum(t.astype(np.intp), self.intervals - 1)
        found = {parity: rows[interval] for parity, rows in self._prefixes.items()}
        self._add_parts(found, interval, t - interval)
        found[1] *= np.sign(edges)[:, None]  # the primitive of an even function is odd
        return found

    def _add_parts(self, rows: dict[int, FloatArray], interval: NDArray[np.intp], part: FloatArray) -> None:
        """Add to each row the integral over the leading `part` of one interval."""
        inside = 0.5 * part * (POINTS[:, None] + 1.0)
        _, weights = interpolation_weights(inside)
        slope = np.cosh((interval + inside) * self.step)
        slope *= GAUSS[:, None] * (0.5 * self.scale * self.step * part)
        number = np.arange(interval.size)
        for j in range(STENCIL):
            node = interval - (MARGIN - 1) + j
            share = np.sum(weights[j] * slope, axis=0)
            for parity, target in rows.items():
                target[number, np.abs(node)] += np.where(node < 0, parity, 1) * share
