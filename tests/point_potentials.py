"""Derivatives of R, 1/R and Z ln(R + Z) - R by recursion, for tests: Leibniz' rule on the equations that they satisfy.

Works on numpy arrays and on mpmath numbers. Shares no code and no formula with the package.
"""

from itertools import product
from math import comb, prod

import numpy as np


def orders(total):
    """All (nx, ny, nz) of one sum."""
    return [(a, b, total - a - b) for a in range(total, -1, -1) for b in range(total - a, -1, -1)]


def _less(order, axis, by):
    return tuple(n - by * (i == axis) for i, n in enumerate(order))


def power(p, order, x, known=None):
    """Derivative of R^p from R² f,i = p x_i f."""
    known = {} if known is None else known
    if min(order) < 0:
        return 0.0
    if order not in known:
        square = sum(t * t for t in x)
        if sum(order) == 0:
            known[order] = square**0.5 if p == 1 else 1 / square**0.5
        else:
            i = max(range(3), key=lambda axis: order[axis])
            m = _less(order, i, 1)
            value = p * x[i] * power(p, m, x, known) + p * m[i] * power(p, _less(m, i, 1), x, known)
            for j in range(3):
                value -= 2 * m[j] * x[j] * power(p, _less(order, j, 1), x, known)
                value -= m[j] * (m[j] - 1) * power(p, _less(order, j, 2), x, known)
            known[order] = value / square
    return known[order]


def _inverse(order, x, known):
    """Derivative of v from (R + Z) v = 1."""
    if ("v", order) not in known:
        total = 1.0 if sum(order) == 0 else 0.0
        for part in product(*(range(n + 1) for n in order)):
            if sum(part) > 0:
                rest = tuple(n - m for n, m in zip(order, part, strict=True))
                derivative = power(1, part, x, known) + (part == (0, 0, 1))
                total -= prod(map(comb, order, part)) * derivative * _inverse(rest, x, known)
        known["v", order] = total / (power(1, (0, 0, 0), x, known) + x[2])
    return known["v", order]


def kernel(potential, order, x, known=None):
    """Derivative of the potential of a unit point at offset x; "chi" from order (1, 0, 0) on.

    A dictionary `known` keeps what derivatives of one potential at one x have in common.
    """
    known = {} if known is None else known
    if potential != "chi":
        return power(1 if potential == "psi" else -1, order, x, known)
    if order[2] >= 2:
        return power(-1, _less(order, 2, 2), x)
    i = 0 if order[0] else 1
    m = _less(order, i, 1)  # Chi,x = -x/(R + Z)
    value = -x[i] * _inverse(m, x, known)
    return value - m[i] * _inverse(_less(m, i, 1), x, known) if m[i] else value


def integrated(potential, chosen, center, edges, point, counts=(24, 24, 24), pieces=(1, 1, 1)):
    """Integrals of derivatives over a cuboid (mirrored for "chi") by composite Gauss-Legendre sums."""
    rules = []
    for edge, count, number in zip(edges, counts, pieces, strict=True):
        nodes, weights = np.polynomial.legendre.leggauss(count)
        half = 0.5 * edge / number
        middles = half * (2 * np.arange(number) + 1 - number)
        rules.append(((middles[:, None] + half * nodes).ravel(), np.tile(half * weights, number)))
    a, b, c = np.meshgrid(*(rule[0] for rule in rules), indexing="ij")
    volume = np.einsum("i,j,k->ijk", *(rule[1] for rule in rules))
    x, y, z = point
    depth = z + center[2] + c if potential == "chi" else z - center[2] - c
    offsets, known = (x - center[0] - a, y - center[1] - b, depth), {}
    return np.array([np.sum(volume * kernel(potential, order, offsets, known)) for order in chosen])
