"""Sources on the focal ellipse that replace an ellipsoid: for Chi of its mirror image, and outside.

The integral of a harmonic function over a uniform ellipsoid equals that over its focal ellipse, the flat confocal one,
with semi-axes p = √(a² - c²), q = √(b² - c²) and the density of a uniform flat ellipsoid, 3 V √(1 - ξ²/p² - η²/q²) /
(2π p q) (Maclaurin's theorem). Chi of a point is harmonic in its source, so that Chi of the ellipsoid is a cubature
over the ellipse with the kernels of points. It converges like ((√A_1 + √A_3)/p)^(-degree) with A_i = a_i² + λ of the
mirrored field point. Most points need some tens of nodes; only points next to the image of a flat disc near the surface
need too many.

Psi is biharmonic outside. The Fourier transform of an ellipsoid is 3 j1(κ)/κ, κ² = c² k² + p² k_1² + q² k_2²; expanded
to first order in k² about the ellipse it gives the nodes a spread c²/3 (1 - ξ²/p² - η²/q²), c²/5 on average as a
sphere's, and c²/4 (1 - ξ²/p²) on the line of a long spheroid.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from math import comb

import numpy as np
from numpy.typing import NDArray

from eigencontact.plugin import FloatArray, Order, PointKernels
from eigencontact_plugins.shapes.ellipsoid_potentials import ellipsoidal_level

__all__ = ["chi_degrees", "focal_chi", "focal_cubature", "focal_sources"]

IntArray = NDArray[np.intp]

#: Degrees of the cubatures, across and around the ellipse.
DEGREES = np.array([0, 6, 10, 14, 20, 26, 34, 44, 56, 72, 96, 128, 176, 256])
#: Required ratio of the first neglected term to the field; terms of its derivatives decrease less.
DIGITS = 1e-18
#: Number of nodes from which on an integral along a line is cheaper.
MOST = 2500
PAIRS = 1 << 14
#: Distances of points outside, in half lengths of the ellipse, with a cubature for each; and their relative errors. The
#: coarsest cubatures are for sums of lower accuracy, which use them from smaller distances on.
REACHES = (1e4, 1e3, 300.0, 100.0, 20.0, 8.0, 4.0, 2.4, 1.6)
SOURCE_DIGITS = 1e-12


def chi_degrees(semi_axes: FloatArray, points: tuple[FloatArray, ...]) -> tuple[IntArray, IntArray]:
    """Degrees across and around the ellipse for outer points; -1 around if a cubature is too expensive.

    `points` are the mirrored field points in the axes of the ellipsoid. Across the ellipse a term falls like
    ((√A_1 + √A_3)/p)^-degree. Around it, like exp(-τ degree) if the distance from no ring r of it has a zero at angles
    with imaginary parts up to τ; with d the distance from the centre and K = √(x²p² + y²q²) that holds where
    (p² - q²) r² cosh²τ + 2 K r cosh τ < d² + p² r².
    """
    i, j, k = np.argsort(-semi_axes)
    a, b, c = semi_axes[[i, j, k]]
    p2, q2 = max((a - c) * (a + c), 1e-16 * a * a), (b - c) * (b + c)
    level = ellipsoidal_level(semi_axes, points)
    across = (np.sqrt(level + p2) + np.sqrt(level)) / np.sqrt(p2)
    d2 = points[0] ** 2 + points[1] ** 2 + points[2] ** 2
    K = np.sqrt(points[i] ** 2 * p2 + points[j] ** 2 * q2)
    r = np.linspace(0.1, 1.0, 10)[:, None]  # rings; the critical one has the distance of the point
    reach = d2 + p2 * r * r
    # All points of a ring have equal distance from the axis of an oblate spheroid: K = 0, p = q and no zero at all.
    pull = np.maximum(K * r + np.sqrt((K * r) ** 2 + (p2 - q2) * r * r * reach), 1e-8 * reach)
    cosh = np.maximum((reach / pull).min(axis=0), 1.0)
    around = cosh + np.sqrt((cosh - 1.0) * (cosh + 1.0))
    degrees = []
    for ratio in (across, around):
        degree = -np.log(DIGITS) / np.log(np.maximum(ratio, 1.0 + 1e-9))
        place = np.searchsorted(DEGREES, degree)
        degrees.append(np.where(place < DEGREES.size, DEGREES[np.minimum(place, DEGREES.size - 1)], -1))
    first, second = degrees
    if q2 == 0:
        second = np.ones_like(first)
    nodes = (first // 4 + 1) * (second + 1)
    return first, np.where((first < 0) | (second < 0) | (nodes > MOST), -1, second)


def focal_cubature(
    semi_axes: FloatArray, axes: FloatArray, degrees: tuple[int, int]
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Cubature over the focal ellipse of a uniform ellipsoid, of degrees across and around the ellipse.

    Returns
    -------
    nodes, weights, heights : (m, 3), (m,), (m,)
        Positions from the centre; weights, which sum to one; 1 - ξ²/p² - η²/q².
    """
    i, j, k = (int(axis) for axis in np.argsort(-semi_axes))
    a, b, c = semi_axes[[i, j, k]]
    p, q = np.sqrt((a - c) * (a + c)), np.sqrt((b - c) * (b + c))
    u, v, weights = _line(degrees[0]) if q == 0 else _ellipse(*degrees)
    return p * u[:, None] * axes[:, i] + q * v[:, None] * axes[:, j], weights, 1.0 - u * u - v * v


def focal_chi(
    semi_axes: FloatArray,
    axes: FloatArray,
    orders: Sequence[Order],
    points: tuple[FloatArray, ...],
    degrees: tuple[int, int],
) -> FloatArray:
    """Derivatives of Chi, ``(len(orders), n)``.

    Parameters
    ----------
    semi_axes, axes : (3,), (3, 3)
        Semi-axes and, as columns, their directions.
    orders : sequence of (int, int, int)
        Order 2 and higher.
    points : three arrays (n,)
        x - x_c, y - y_c, z + z_c: offsets along Z count downwards from the mirrored centre.
    degrees : (int, int)
        Degrees of the cubature across and around the ellipse.
    """
    nodes, weights, _ = focal_cubature(semi_axes, axes, degrees)
    volume = 4.0 * np.pi / 3.0 * float(semi_axes.prod())
    x, y, z = points
    result = np.empty((len(orders), x.size))
    step = max(1, PAIRS // weights.size)
    for first in range(0, x.size, step):
        chunk = slice(first, first + step)
        # The mirrored source lies at -z', so its depth adds to that of the field point.
        kernels = PointKernels(x[chunk] - nodes[:, :1], y[chunk] - nodes[:, 1:2], z[chunk] + nodes[:, 2:])
        for row, order in enumerate(orders):
            result[row, chunk] = volume * (weights @ kernels.derivative("chi", order))
    return result


def focal_sources(semi_axes: FloatArray, axes: FloatArray) -> list[tuple[float, FloatArray, FloatArray, FloatArray]]:
    """Sources that replace an ellipsoid beyond given distances of its centre, the fewest and farthest first.

    Returns
    -------
    list of (distance, positions (m, 3), weights (m,), spreads (m,))
        Positions from the centre; weights sum to one.
    """
    i, j, k = (int(axis) for axis in np.argsort(-semi_axes))
    a, b, c = (float(axis) for axis in semi_axes[[i, j, k]])
    p, q = np.sqrt((a - c) * (a + c)), np.sqrt((b - c) * (b + c))
    levels = []
    for reach in REACHES:
        distance = max(reach * p, 1.001 * a)
        u, v, weights = _outside(max(reach, distance / max(p, 1e-9 * a)), flat=q > 0)
        positions = p * u[:, None] * axes[:, i] + q * v[:, None] * axes[:, j]
        spread = c * c / (3.0 if q > 0 else 4.0)
        levels.append((distance, positions, weights, spread * (1.0 - u * u - v * v)))
        if distance > reach * p:
            break
    return levels


@cache
def _outside(reach: float, *, flat: bool) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Cubature of the ellipse, or of the line, for points at `reach` times its half length and beyond."""
    across = _terms(reach + np.sqrt((reach - 1.0) * (reach + 1.0)))
    if not flat:
        return _line(across)
    count = -(-(across + 3) // 4)  # exact with the weight t²
    nodes, weights = np.polynomial.legendre.leggauss(2 * count)
    rings: list[tuple[FloatArray, ...]] = []
    for t, w in zip(nodes[count:], weights[count:], strict=True):
        radius = np.sqrt((1.0 - t) * (1.0 + t))
        around = _terms(reach / radius)  # smaller rings need fewer harmonics
        angle = 2.0 * np.pi * (np.arange(around) + 0.5 * (len(rings) % 2)) / around
        rings.append((radius * np.cos(angle), radius * np.sin(angle), np.full(around, 3.0 * w * t * t / around)))
    u, v, weights = (np.concatenate(arrays) for arrays in zip(*rings, strict=True))
    return u, v, weights


def _terms(ratio: float) -> int:
    """Order of negligible terms that fall like ratio^-n, including their derivatives up to order 5."""
    n = 1
    while comb(n + 5, 5) * ratio**-n > SOURCE_DIGITS:
        n += 1
    return n


@cache
def _line(degree: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """For a long spheroid the ellipse is a line with density 3/4 (1 - ξ²)."""
    nodes, weights = np.polynomial.legendre.leggauss(degree // 2 + 2)
    return nodes, np.zeros_like(nodes), 0.75 * weights * (1.0 - nodes) * (1.0 + nodes)


@cache
def _ellipse(across: int, around: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Unit disc with density 3/(2π) √(1 - r²): Gauss in √(1 - r²), half of an even rule, and equal angles."""
    count = across // 4 + 1
    nodes, weights = np.polynomial.legendre.leggauss(2 * count)
    t, w = nodes[count:], weights[count:]
    angle = 2.0 * np.pi * np.arange(around + 1) / (around + 1)
    radius = np.sqrt((1.0 - t) * (1.0 + t))
    u, v = np.multiply.outer(radius, np.cos(angle)), np.multiply.outer(radius, np.sin(angle))
    return u.ravel(), v.ravel(), np.repeat(3.0 * w * t * t, angle.size) / angle.size
