"""Potentials of a cuboid far away, where corner sums lose accuracy: exact along its longest edge, Gauss sums across.

At the distance d from a cuboid with edges a <= b <= c the sum over the corners loses a relative 5e-16 d (d + c)²/(abc):
measured against quadrature within a factor of 5 for cubes, plates of 1:100 and bars of 1:1000, d from a to 7c. The
short edges dominate: a bar of 1:1000 has nine digits left at a distance of c, and six at 7c.

The method here has a relative loss of at most d/c times rounding errors. The integral along the longest edge, over
which the integrand may vary quickly, has a closed form. Across it the integrand is smooth, and a Gauss rule of n points
has an error of about q^(-2n), q = e + sqrt(e² + 1), e = 2d/edge, below round-off.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

import numpy as np

from eigencontact.plugin import FloatArray, Order, PointKernels

__all__ = ["distant_derivatives", "distant_from", "gauss_rule"]


#: Largest d (d + c)² / (abc) for the corner sum: a relative loss of about 1.5e-11.
LARGEST_LOSS = 3e4


def distant_from(edges: Sequence[float]) -> float:
    """Distance from a cuboid, in the unit of its edges, beyond which `distant_derivatives` is more accurate."""
    longest, volume = max(edges), float(np.prod(edges))
    low, high = 0.0, float(np.cbrt(LARGEST_LOSS * volume))
    for _ in range(60):
        d = 0.5 * (low + high)
        low, high = (low, d) if d * (d + longest) ** 2 > LARGEST_LOSS * volume else (d, high)
    return max(high, 2.0 * sorted(edges)[1])


def gauss_rule(half: float, distance: float) -> tuple[FloatArray, FloatArray]:
    """Gauss-Legendre nodes and weights on [-half, half] for fields at `distance` from it, beside or in line."""
    e = distance / half
    n = int(np.ceil(15.0 / (2 * np.log10(e + np.sqrt(e * e + 1)))))
    nodes, weights = _unit_rule(n)
    return half * nodes, half * weights


@cache
def _unit_rule(n: int) -> tuple[FloatArray, FloatArray]:
    nodes, weights = np.polynomial.legendre.leggauss(n)
    return nodes, weights


def distant_derivatives(
    potential: str,
    orders: Sequence[Order],
    offsets: Sequence[FloatArray],
    half: Sequence[float],
) -> FloatArray:
    """Derivatives of a potential of a cuboid, ``(len(orders), n)``.

    Parameters
    ----------
    offsets : three arrays of shape (n,)
        Points relative to the centre, at a distance of at least `distant_from`, with nonnegative x, y and z; for Chi of
        the mirror image z is greater than half an edge instead.
    half : (hx, hy, hz)
        Half edges.
    """
    along = int(np.argmax(half))
    distance = distant_from([2 * h for h in half])
    first, second = (axis for axis in range(3) if axis != along)
    out = np.zeros((len(orders), offsets[0].size))
    (nodes_1, weights_1), (nodes_2, weights_2) = gauss_rule(half[first], distance), gauss_rule(half[second], distance)
    at = list(offsets)
    for node_1, weight_1 in zip(nodes_1, weights_1, strict=True):
        for node_2, weight_2 in zip(nodes_2, weights_2, strict=True):
            at[first], at[second] = offsets[first] - node_1, offsets[second] - node_2
            for end in (-half[along], half[along]):
                at[along] = offsets[along] + end
                kernels = PointKernels(at[0], at[1], at[2])
                weight = np.copysign(weight_1 * weight_2, end)
                for row, order in enumerate(orders):
                    out[row] += weight * kernels.integral(potential, order, along)
    return out
