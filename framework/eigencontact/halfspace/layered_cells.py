"""Values and cell integrals of a smooth function of the plane, known at nodes with sinh spacing.

A field that comes from depths of s and more is, in each of x and y, analytic in a strip of the stretched coordinate
``ξ = asinh(x/s)``: its nearest singularities, x = ± i s, lie at ±iπ/2. Chebyshev polynomials of ξ up to the largest
coordinate X that counts, even ones or odd ones, resolve it: n nodes leave an error of about exp(-2 n asinh(π/2Ξ)),
Ξ = asinh(X/s), whether cells are far smaller than s or far larger. The interpolant is integrated over cells by Gauss's
rule in ξ, so the integral over a rectangle is a product of two vectors with the matrix of nodal values.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, cached_property, lru_cache

import numpy as np

from eigencontact.core.array_types import FloatArray
from eigencontact.core.products import product

__all__ = ["StretchedNodes", "Weights"]

#: Weights ``(m, n)`` for even (1) and odd (-1) functions.
Weights = dict[int, FloatArray]

# Panels of Gauss's rule are no longer than this in ξ.
PANEL = 1.0
# Exponent of the accuracy of Gauss's rule: exp(-36) is double precision.
GAUSS = 36.0


@dataclass(frozen=True)
class StretchedNodes:
    """Nodes x = s sinh(Ξ sin φ), φ = π (2j + 1) / 4n, j = 0, 1, ..., n - 1; functions are even or odd in x.

    Parameters
    ----------
    scale : float
        Length s [m].
    extent : float
        Largest stretched coordinate Ξ that will be asked for [-].
    count : int
        Number of nodes n.
    """

    scale: float
    extent: float
    count: int

    @staticmethod
    def enough(scale: float, extent: float, digits: float) -> StretchedNodes:
        """Nodes for an error of about exp(-digits)."""
        return StretchedNodes(scale, extent, int(np.ceil(digits / (2 * np.arcsinh(0.5 * np.pi / extent)))) + 2)

    @cached_property
    def _angles(self) -> FloatArray:
        return np.pi * (2 * np.arange(self.count) + 1.0) / (4 * self.count)

    @cached_property
    def x(self) -> FloatArray:
        """Coordinates of the nodes, ``(n,)`` [m], ascending and positive."""
        x: FloatArray = self.scale * np.sinh(self.extent * np.sin(self._angles))
        return x

    def values(self, x: FloatArray) -> Weights:
        """Weights of the values at x ``(m,)`` [m]."""
        return self._on_nodes(self._polynomials(np.arcsinh(x / self.scale)))

    def integrals(self, centres: FloatArray, half_width: float) -> Weights:
        """Weights of the integrals over cells about `centres` ``(m,)``, of this half width [m]."""
        return _integrals(self, np.asarray(centres, dtype=float).tobytes(), half_width)

    def strips(self, count: int) -> Weights:
        """Weights of the integrals over all x, `count` times, for functions that decay like 1/x².

        What is beyond a length is a series in its inverse: the integrals up to the last coordinate, a half and a
        quarter of it extrapolate two terms.
        """
        far = float(self.scale * np.sinh(self.extent)) * (1.0 - 1e-9)
        whole, half, quarter = (self.integrals(np.zeros(1), share * far) for share in (1.0, 0.5, 0.25))
        rows = {parity: (8.0 * whole[parity] - 6.0 * half[parity] + quarter[parity]) / 3.0 for parity in whole}
        return {parity: np.repeat(row, count, axis=0) for parity, row in rows.items()}

    def _polynomials(self, xi: FloatArray) -> Weights:
        """Chebyshev polynomials of even and of odd degree, up to sign, ``(m, n)``."""
        angle = np.arcsin(np.clip(xi / self.extent, -1.0, 1.0))[:, None]
        degree = 2 * np.arange(self.count)
        return {1: np.cos(degree * angle), -1: np.sin((degree + 1) * angle)}

    def _on_nodes(self, polynomials: Weights) -> Weights:
        """Weights of nodal values from those of polynomials."""
        return {parity: product(rows, self._coefficients[parity]) for parity, rows in polynomials.items()}

    @cached_property
    def _coefficients(self) -> Weights:
        """Coefficients of polynomials from nodal values: interpolation on Chebyshev's points, ``(n, n)``."""
        degree = 2 * np.arange(self.count)[:, None]
        even, odd = np.cos(degree * self._angles), np.sin((degree + 1) * self._angles)
        even[0] *= 0.5
        return {1: 2.0 / self.count * even, -1: 2.0 / self.count * odd}


@cache
def _gauss(count: int) -> tuple[FloatArray, FloatArray]:
    return np.polynomial.legendre.leggauss(count)


@lru_cache(maxsize=64)
def _integrals(nodes: StretchedNodes, centres: bytes, half_width: float) -> Weights:
    """Cached weights of integrals over cells, see `StretchedNodes.integrals`."""
    middle, half = np.frombuffer(centres) / nodes.scale, half_width / nodes.scale
    low, high = middle - half, middle + half
    # Differences of asinh, written so that a narrow cell keeps its digits.
    low_root, high_root = np.sqrt(1 + low * low), np.sqrt(1 + high * high)
    apart = high * low_root - low * high_root
    same_side = low * high > 0
    np.divide(4 * half * middle, high * low_root + low * high_root, out=apart, where=same_side)
    length = np.arcsinh(apart)
    panels = np.ceil(length / PANEL).astype(np.intp)
    first = np.cumsum(panels) - panels
    step = np.repeat(length / panels, panels)
    begin = np.repeat(np.arcsinh(low), panels) + step * (np.arange(step.size) - np.repeat(first, panels))
    count = int(np.ceil(GAUSS / (2 * np.arcsinh(np.pi / step.max())))) + 1
    points, shares = _gauss(count)
    xi = begin + 0.5 * step * (points[:, None] + 1.0)
    weights = np.cosh(xi) * (0.5 * nodes.scale * step) * shares[:, None]
    sums = {}
    for parity, rows in nodes._polynomials(xi.ravel()).items():  # noqa: SLF001
        summed = np.einsum("qp,qpn->pn", weights, rows.reshape(*xi.shape, -1))
        sums[parity] = np.add.reduceat(summed, first, axis=0)
    return nodes._on_nodes(sums)  # noqa: SLF001
