"""Chi of the mirror image of an ellipsoid with polynomial densities: a cubature over its focal ellipse.

The integral of a harmonic function over an ellipsoid with the density (1 - Σ x_i²/a_i²)^n equals that over the focal
ellipse with the weight (1 - ξ²/p² - η²/q²)^(n + 1/2) and the mass 2π a b c Γ(3/2) Γ(n+1)/Γ(n + 5/2). This is the
cubature of the uniform ellipsoid (`eigencontact_plugins.shapes.ellipsoid_mirror`) with other weights. Derivatives of
the densities become derivatives by
the field point along the mirrored axes, and every derivative of Chi of a point of order L is a sum of the irregular
solid harmonics I_(L-2)^m with m up to L (`eigencontact_plugins.shapes.solid_harmonics`).

References
----------
F. W. Dyson 1891, Quart. J. Pure Appl. Math. 25, 259 (focal ellipse).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from math import gamma, pi, prod

import numpy as np
from numpy.typing import NDArray

from eigencontact.plugin import FloatArray, Order, integrated_chi
from eigencontact_plugins.shapes.ellipsoid_ferrers import monomials_to
from eigencontact_plugins.shapes.ellipsoid_mirror import focal_cubature
from eigencontact_plugins.shapes.ellipsoid_moments import density_scales
from eigencontact_plugins.shapes.solid_harmonics import ladder

__all__ = ["focal_chi_sums", "integrated_sums"]

ComplexArray = NDArray[np.complex128]
PAIRS = 1 << 12


@lru_cache(maxsize=16)
def _coefficients(
    semi_axes: tuple[float, ...], axes: tuple[float, ...], degree: int, orders: tuple[Order, ...]
) -> dict[tuple[int, int], tuple[list[int], ComplexArray]]:
    """By n and l: sources (density and order) and their complex coefficients of I_l^m, m = 0 to l + 2.

    The derivative is the real part of their sum, times the mass of f_n.
    """
    functions = ladder("image", degree + 2)
    mirrored = np.array(axes).reshape(3, 3) * np.array([[1.0], [1.0], [-1.0]])
    start = np.zeros(len(functions.indices), dtype=complex)
    start[functions.row[0, -2, 0]] = 1.0
    rows: dict[Order, ComplexArray] = {(0, 0, 0): start}
    for alpha in monomials_to(degree)[1:]:
        axis = next(i for i in range(3) if alpha[i])
        below = (alpha[0] - (axis == 0), alpha[1] - (axis == 1), alpha[2] - (axis == 2))
        steps = [functions.differentiated(rows[below], unit) for unit in ((1, 0, 0), (0, 1, 0), (0, 0, 1))]
        rows[alpha] = np.asarray(mirrored[:, axis] @ steps)
    out: dict[tuple[int, int], tuple[list[int], ComplexArray]] = {}
    terms: dict[tuple[int, int], list[tuple[int, ComplexArray]]] = {}
    source = 0
    for scale, alpha in zip(density_scales(degree), monomials_to(degree), strict=True):
        whole = scale * prod(a**times for a, times in zip(semi_axes, alpha, strict=True))
        for order in orders:
            low = sum(alpha) + sum(order) - 2
            row = np.asarray(functions.differentiated(rows[alpha], order), dtype=complex)
            half: ComplexArray = np.array([row[functions.row[0, low, m]] * (2.0 if m else 1.0) for m in range(low + 3)])
            terms.setdefault((sum(alpha), low), []).append((source, whole * half))
            source += 1
    for key, parts in terms.items():
        out[key] = [source_index for source_index, _ in parts], np.array([half for _, half in parts])
    return out


def focal_chi_sums(
    semi_axes: FloatArray,
    axes: FloatArray,
    degree: int,
    orders: Sequence[Order],
    weights: FloatArray,
    points: tuple[FloatArray, FloatArray, FloatArray],
    degrees: tuple[int, int],
    tests: FloatArray | None = None,
) -> FloatArray:
    """Weighted sums of derivatives of Chi of the densities, ``(k, points)``.

    Parameters
    ----------
    semi_axes, axes : (3,), (3, 3)
        Semi-axes of order one and, as columns, their directions.
    degree : int
        Degree of the densities.
    orders : sequence of (int, int, int)
        Orders 3 and 4.
    weights : (k, m)
        Weights over densities and orders, in this nesting.
    points : three arrays (points,)
        x - x_c, y - y_c, z + z_c: offsets along Z count downwards from the mirrored centre.
    degrees : (int, int)
        Degrees of the cubature across and around the ellipse, for the uniform density.
    tests : (d, points), optional
        Functions that multiply the sums before summation over the points: ``(k, d)``.
    """
    # Derivatives of higher order converge later across the ellipse, and have harmonics of higher order around it.
    across, around = degrees[0] + (degrees[0] * degree) // 12 + 2 * degree, degrees[1] + 2 * degree
    nodes, of_node, height = focal_cubature(semi_axes, axes, (across, around))
    table = _coefficients(tuple(semi_axes.tolist()), tuple(axes.ravel().tolist()), degree, tuple(orders))
    rows = [weights[:, sources] @ half for sources, half in table.values()]
    of_functions = np.concatenate([values for row in rows for values in (row.real, -row.imag)], axis=1)
    of_density = []
    for n in range(degree + 1):
        share = of_node * height**n  # factor √(1 - ξ² - η²)^(2n) relative to the uniform density
        mass = 2.0 * pi * float(semi_axes.prod()) * gamma(1.5) * gamma(n + 1) / gamma(n + 2.5)
        of_density.append(mass * share / share.sum())
    functions = ladder("image", degree + 2)
    half = len(functions.half)
    place = {low: [functions.half.index((0, low, m)) for m in range(low + 3)] for _, low in table}
    x, y, z = points
    out = np.zeros((len(weights), x.size))
    products = np.zeros((of_functions.shape[1], 0 if tests is None else len(tests)))
    step = max(1, PAIRS // len(of_node))
    for first in range(0, x.size, step):
        chunk = slice(first, first + step)
        # The mirrored source lies at -z', so its depth adds to that of the field point.
        at = (x[chunk] - nodes[:, :1], y[chunk] - nodes[:, 1:2], z[chunk] + nodes[:, 2:])
        values = functions.values(*at)
        sums = np.concatenate([
            of_density[n] @ values[[start + m for m in place[low]]] for n, low in table for start in (0, half)
        ])  # fmt: skip
        if tests is None:
            out[:, chunk] = of_functions @ sums
        else:
            products += sums @ tests[:, chunk].T
    return out if tests is None else np.asarray(of_functions @ products)


@dataclass(frozen=True)
class _PlaneSums:
    """Two sums of derivatives of Phi in the plane, as two derivatives of one potential for `integrated_chi`."""

    bounds: tuple[tuple[float, float, float], tuple[float, float, float]]
    sums: Callable[[FloatArray, FloatArray, FloatArray], FloatArray]

    def phi(self, orders: Sequence[Order], x: FloatArray, y: FloatArray, z: FloatArray) -> FloatArray:
        """Both sums, ``(2, k, points)``: of chi without and with a derivative along z."""
        assert list(orders) == [(0, 0, 0), (1, 0, 0)]
        return self.sums(x, y, z)

    def psi(self, orders: Sequence[Order], x: FloatArray, y: FloatArray, z: FloatArray) -> FloatArray:
        """Not used."""
        raise NotImplementedError


def integrated_sums(
    bounds: tuple[tuple[float, float, float], tuple[float, float, float]],
    sums: Callable[[FloatArray, FloatArray, FloatArray], FloatArray],
    points: Sequence[FloatArray],
) -> FloatArray:
    """Sums of derivatives of Chi ``(k, points)`` as integrals along z of sums of Phi; see `integrated_chi`.

    `sums` returns ``(2, k, points)``: those of orders in the plane, and those with one derivative along z.
    """
    zeroth, first = integrated_chi(_PlaneSums(bounds, sums), [(0, 0, 0), (1, 0, 1)], *points)
    return np.asarray(zeroth + first)
