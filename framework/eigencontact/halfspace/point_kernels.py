"""Derivatives of R, 1/R and Z ln(R + Z) - R, the potentials of a point, and of their integrals along an axis.

All of them depend on the coordinates across some axis only through s = (sum of their squares)/2, so that one rule
serves everywhere: with f_m the m-th derivative of f by s,

    d^a/dx^a d^b/dy^b f = sum over i, j of c(a, i) c(b, j) x^(a-2i) y^(b-2j) f_(a+b-i-j)
    c(a, i) = a! / (2^i i! (a-2i)!)

R and 1/R are such functions of all three coordinates, with dR/ds = 1/R. Along one axis, say z, and with u = 1/R and
v = 1/(R + z), the derivatives by s of what is left over are sums of u^a v^b, for

    d(u^a v^b)/ds = -a u^(a+2) v^b - b u^(a+1) v^(b+1)

    ln(R + z):                  first derivative   u v   (the integral of 1/R; also the integral of R, differentiated)
    z ln(R + z) - R:            first derivative   -v
    its integral along z:       second derivative  -v²/2

Nothing is singular but the source and, for the last three, the ray behind it: negative z with x = y = 0.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache
from itertools import product
from math import factorial, prod

import numpy as np

from eigencontact.core.array_types import FloatArray
from eigencontact.halfspace.potentials import Order, PointSources

__all__ = ["PointKernels", "source_derivatives"]

#: Exponents (a, b) of u^a v^b with their coefficient.
Terms = tuple[tuple[tuple[int, int], float], ...]

#: Number of a first known derivative by s, and that derivative.
LOGARITHM: tuple[int, Terms] = (1, (((1, 1), 1.0),))
INTEGRAL_OF_R: tuple[int, Terms] = (2, (((1, 1), 1.0),))
PLANE: tuple[int, Terms] = (1, (((0, 1), -1.0),))
INTEGRAL_OF_PLANE: tuple[int, Terms] = (2, (((0, 2), -0.5),))

#: Smallest square of a distance from the axis in a quotient.
TINY = 1e-60
#: Pairs of a source and a field point taken at a time.
PAIRS = 16_384


class PointKernels:
    """Derivatives of the potentials of a unit point source, and of their integrals along an axis.

    Parameters
    ----------
    x, y, z : arrays of one shape
        Field point minus source, not zero; for ``"chi"`` z is Z, the depth of the field point plus that of the source.

    Notes
    -----
    Powers that several derivatives share are computed once. A shape whose potentials are integrals over points, of a
    volume or a line, sums them with weights: its order, sign and scale are those of `HasPotentials`.

    Examples
    --------
    Psi,xx = (y² + z²) / R³ and Phi,x = -x / R³ at a distance of 1:

    >>> at = PointKernels(np.array([0.6]), np.array([0.0]), np.array([0.8]))
    >>> at.derivative("psi", (2, 0, 0)).round(12), at.derivative("phi", (1, 0, 0)).round(12)
    (array([0.64]), array([-0.6]))
    """

    def __init__(self, x: FloatArray, y: FloatArray, z: FloatArray) -> None:
        self.x = (x, y, z)
        self.R: FloatArray = np.sqrt(x * x + y * y + z * z)
        self._x = [_Powers(t) for t in self.x]
        self._u = _Powers(1.0 / self.R)
        self._v: dict[int, _Powers] = {}
        self._sums: dict[tuple[int, Terms], FloatArray] = {}

    def derivative(self, potential: str, order: Order) -> FloatArray:
        """Derivative of R (``"psi"``), 1/R (``"phi"``) or Z ln(R + Z) - R (``"chi"``: z >= 0, order 2 and more)."""
        if potential == "chi":
            if order[2] >= 2:
                return self.derivative("phi", _add(order, 2, -2))
            return self._across(2, order, PLANE if order[2] == 0 else LOGARITHM)
        power = 1 if potential == "psi" else -1
        return self._combine((0, 1, 2), order, lambda m: prod(range(power, power - 2 * m, -2)) * self._u[2 * m - power])

    def integral(self, potential: str, order: Order, axis: int) -> FloatArray:
        """Derivative of an antiderivative of the potential along an axis: order 3 and more, for ``"phi"`` 1 and more.

        Up to terms that do not depend on the coordinate along the axis: take the difference of two ends.
        """
        if order[axis] > 0:
            return self.derivative(potential, _add(order, axis, -1))
        if potential == "phi":
            return self._across(axis, order, LOGARITHM)
        if potential == "psi":
            return self._across(axis, order, INTEGRAL_OF_R)
        if axis == 2:
            return self._across(axis, order, INTEGRAL_OF_PLANE)
        if order[2] >= 2:
            return self.integral("phi", _add(order, 2, -2), axis)
        lower = _add(order, 1 - axis, -2)  # Chi,xx + Chi,yy = -Phi
        return -self.integral("phi", lower, axis) - self.derivative("chi", _add(lower, axis, 1))

    def _across(self, axis: int, order: Order, differentiated: tuple[int, Terms]) -> FloatArray:
        """Derivative across `axis` of a function of s whose derivatives are sums of u^a v^b."""
        other_axes = [index for index in range(3) if index != axis]
        first, terms = differentiated
        return self._combine(other_axes, order, lambda m: self._sum(axis, _differentiated(terms, m - first)))

    def _combine(self, axes: Sequence[int], order: Order, derivative: Callable[[int], FloatArray]) -> FloatArray:
        """Rule of the module docstring for coordinates `axes` and the derivatives by s."""
        total = np.zeros_like(self.R)
        for paired in product(*(range(order[axis] // 2 + 1) for axis in axes)):
            term = derivative(sum(order[axis] for axis in axes) - sum(paired))
            coefficient = 1
            for axis, i in zip(axes, paired, strict=True):
                a = order[axis]
                coefficient *= factorial(a) // (2**i * factorial(i) * factorial(a - 2 * i))
                if a > 2 * i:
                    term = term * self._x[axis][a - 2 * i]
            total += coefficient * term
        return total

    def _sum(self, axis: int, terms: Terms) -> FloatArray:
        """Sum of u^a v^b."""
        value = self._sums.get((axis, terms))
        if value is None:
            if axis not in self._v:
                self._v[axis] = _Powers(self._inverse(axis))
            v = self._v[axis]
            value = np.zeros_like(self.R)
            for (a, b), coefficient in terms:
                value += coefficient * (self._u[a] * v[b])
            self._sums[axis, terms] = value
        return value

    def _inverse(self, axis: int) -> FloatArray:
        """Quotient v = 1 / (R + x_axis), without cancellation for negative x_axis."""
        t, w = self.x[axis], self.R + np.abs(self.x[axis])
        if np.any(t < 0):
            across = self.x[axis - 1] ** 2 + self.x[axis - 2] ** 2
            return np.where(t < 0, w / np.maximum(across, TINY), 1.0 / w)
        return np.asarray(1.0 / w)


def source_derivatives(
    sources: PointSources, potential: str, orders: Sequence[Order], x: FloatArray, y: FloatArray, z: FloatArray
) -> FloatArray:
    """Sum over point sources at field points of one shape; ``chi`` mirrors the sources, z + z'."""
    out = np.zeros((len(orders), *x.shape))
    mirror = 1.0 if potential == "chi" else -1.0
    step = max(1, PAIRS // max(1, x.size))
    for first in range(0, len(sources.volumes), step):
        chunk = slice(first, first + step)
        px, py, pz = (values.reshape(-1, *[1] * x.ndim) for values in sources.positions[chunk].T)
        kernels = PointKernels(x - px, y - py, z + mirror * pz)
        spread = sources.volumes[chunk] * sources.spreads[chunk] if potential == "psi" else np.zeros(1)
        for row, order in enumerate(orders):
            out[row] += np.tensordot(sources.volumes[chunk], kernels.derivative(potential, order), 1)
            if spread.any():
                out[row] += np.tensordot(spread, kernels.derivative("phi", order), 1)
    return out


class _Powers:
    """Powers 0, 1, 2, ... of an array, each computed when first used."""

    def __init__(self, base: FloatArray) -> None:
        self._powers = [np.ones_like(base), base]

    def __getitem__(self, exponent: int) -> FloatArray:
        if exponent < 0:
            return np.asarray(1.0 / self[-exponent])
        while len(self._powers) <= exponent:
            self._powers.append(self._powers[-1] * self._powers[1])
        return self._powers[exponent]


def _add(order: Order, axis: int, times: int) -> Order:
    x, y, z = (n + times * (i == axis) for i, n in enumerate(order))
    return x, y, z


@cache
def _differentiated(terms: Terms, times: int) -> Terms:
    """Derivative by s of a sum of u^a v^b, so many times."""
    for _ in range(times):
        out: dict[tuple[int, int], float] = {}
        for (a, b), value in terms:
            out[a + 2, b] = out.get((a + 2, b), 0.0) - a * value
            out[a + 1, b + 1] = out.get((a + 1, b + 1), 0.0) - b * value
        terms = tuple((exponents, value) for exponents, value in out.items() if value)
    return terms
