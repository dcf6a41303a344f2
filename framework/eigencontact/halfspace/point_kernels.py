"""Derivatives of R, 1/R and Z ln(R + Z) - R: the potentials of a point source, of any order.

Each derivative is a short sum of ``coefficient * x^i y^j z^k R^-m (R + Z)^-n``, found once by the product rule and
evaluated with the direction cosines, so that it neither overflows nor loses digits at any distance.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

import numpy as np
from numpy.typing import NDArray

from eigencontact.halfspace.potentials import Order, PointSources

__all__ = ["point_derivatives", "source_derivatives"]

FloatArray = NDArray[np.float64]

# Pairs of a source and a field point taken at a time.
_PAIRS = 16_384

# Exponents (i, j, k, m, n) of x^i y^j z^k R^-m (R + Z)^-n, and the coefficient.
Monomials = dict[tuple[int, int, int, int, int], float]


def _differentiated(terms: Monomials, axis: int) -> Monomials:
    out: Monomials = {}

    def add(exponents: tuple[int, int, int, int, int], value: float) -> None:
        out[exponents] = out.get(exponents, 0.0) + value

    for (i, j, k, m, n), value in terms.items():
        powers = [i, j, k]
        if powers[axis]:
            lower = powers.copy()
            lower[axis] -= 1
            add((lower[0], lower[1], lower[2], m, n), value * powers[axis])
        higher = powers.copy()
        higher[axis] += 1
        if m:
            add((higher[0], higher[1], higher[2], m + 2, n), -m * value)
        if n and axis < 2:
            add((higher[0], higher[1], higher[2], m + 1, n + 1), -n * value)
        elif n:  # d(R + Z)/dZ = (R + Z)/R
            add((i, j, k, m + 1, n), -n * value)
    return {exponents: value for exponents, value in out.items() if value}


@cache
def _monomials(potential: str, order: Order) -> Monomials:
    steps = [axis for axis, times in enumerate(order) for _ in range(times)]
    if potential == "psi":
        terms: Monomials = {(0, 0, 0, -1, 0): 1.0}
    elif potential == "phi":
        terms = {(0, 0, 0, 1, 0): 1.0}
    else:  # Chi,x = -x/(R + Z), Chi,y = -y/(R + Z); the logarithm is gone from there on
        first = steps.pop(0)
        terms = {(1, 0, 0, 0, 1): -1.0} if first == 0 else {(0, 1, 0, 0, 1): -1.0}
    for axis in steps:
        terms = _differentiated(terms, axis)
    return terms


def point_derivatives(
    potential: str, orders: Sequence[Order], x: FloatArray, y: FloatArray, z: FloatArray
) -> FloatArray:
    """Derivatives of the potential of a unit point source at offsets x, y, z of one shape, ``(len(orders), ...)``.

    Parameters
    ----------
    potential : {"psi", "phi", "chi"}
        R, 1/R, or Z ln(R + Z) - R (z >= 0, at least one derivative along x or y).
    """
    R = np.sqrt(x * x + y * y + z * z)
    cosines = [_powers(value / R, 5) for value in (x, y, z)]
    inverse_w = _powers(R / (R + z), 4) if potential == "chi" else []
    out = np.empty((len(orders), *R.shape))
    degree = {"psi": 1, "phi": -1, "chi": 1}[potential]
    scale: dict[int, FloatArray] = {}
    for row, order in enumerate(orders):
        total = np.zeros_like(R)
        for (i, j, k, _, n), value in _monomials(potential, order).items():
            term = value * cosines[0][i]
            if j:
                term *= cosines[1][j]
            if k:
                term *= cosines[2][k]
            if n:
                term *= inverse_w[n]
            total += term
        power = degree - sum(order)
        if power not in scale:
            scale[power] = R**power
        np.multiply(total, scale[power], out=out[row])
    return out


def _powers(value: FloatArray, highest: int) -> list[FloatArray]:
    powers = [np.ones_like(value)]
    for _ in range(highest):
        powers.append(powers[-1] * value)
    return powers


def source_derivatives(
    sources: PointSources, potential: str, orders: Sequence[Order], x: FloatArray, y: FloatArray, z: FloatArray
) -> FloatArray:
    """Sum over point sources at field points of one shape; ``chi`` takes them as mirrored, z + z'."""
    out = np.zeros((len(orders), *x.shape))
    mirror = 1.0 if potential == "chi" else -1.0
    step = max(1, _PAIRS // max(1, x.size))
    for first in range(0, len(sources.volumes), step):
        part = slice(first, first + step)
        px, py, pz = (values.reshape(-1, *[1] * x.ndim) for values in sources.positions[part].T)
        offsets = x - px, y - py, z + mirror * pz
        out += np.einsum("s,ks...->k...", sources.volumes[part], point_derivatives(potential, orders, *offsets))
        if potential == "psi" and np.any(sources.spreads[part]):
            weights = sources.volumes[part] * sources.spreads[part]
            out += np.einsum("s,ks...->k...", weights, point_derivatives("phi", orders, *offsets))
    return out
