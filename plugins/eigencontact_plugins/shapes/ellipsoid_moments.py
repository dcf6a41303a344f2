"""Polynomial densities of an ellipsoid, and sums over their harmonic and biharmonic potentials.

With ξ_i = x_i/a_i and n = |α| the densities are ρ_α = s ∂^α (1 - |ξ|²)^n, with derivatives by ξ and s for a mean square
of one over the ellipsoid. They are polynomials of degree n, orthogonal to all of lower degree. Derivatives of (1 -
|ξ|²)^n up to the (n-1)-th are continuous at the boundary; the potentials are therefore derivatives of those of (1 -
|ξ|²)^n, V_n:

    Φ[ρ_α] = s a^α ∂^α V_n,    Ψ,i[ρ_α] = s a^α ∂^α {x_i V_n + a_i²/(2(n + 1)) V_(n+1),i}

the second from Ψ[ρ],i = x_i Φ[ρ] - Φ[x_i ρ].

References
----------
N. M. Ferrers 1877, Quart. J. Pure Appl. Math. 14, 1; F. W. Dyson 1891, ibid. 25, 259. The densities are Appell's: P.
Appell and J. Kampé de Fériet 1926, Fonctions hypergéométriques et hypersphériques, part 2.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache, lru_cache
from math import factorial, gamma, pi, prod, sqrt
from typing import Any

import numpy as np

from eigencontact.plugin import FloatArray, Order
from eigencontact_plugins.shapes.ellipsoid_ferrers import (
    Column,
    inner_polynomials,
    monomial_values,
    monomials_to,
    outer_derivatives,
    without_short,
)

__all__ = ["density_scales", "density_values", "weighted_sums"]

#: Potentials with the orders of their derivatives.
Requests = tuple[tuple[str, tuple[Order, ...]], ...]
Points = tuple[FloatArray, FloatArray, FloatArray]

CHUNK = 1024


@cache
def _densities(degree: int) -> tuple[FloatArray, tuple[float, ...]]:
    """Coefficients ``(n, monomials)`` in the monomials of ξ, and the factors s, of the densities up to a degree."""
    orders = monomials_to(degree)
    place = {order: row for row, order in enumerate(orders)}
    rows = np.zeros((len(orders), len(orders)))
    for row, alpha in zip(rows, orders, strict=True):
        n = sum(alpha)
        for ijk in monomials_to(n):
            powers = tuple(2 * half - times for half, times in zip(ijk, alpha, strict=True))
            if min(powers) >= 0:
                multiplicity = factorial(n) // (factorial(n - sum(ijk)) * prod(map(factorial, ijk)))
                factor = prod(factorial(2 * half) // factorial(power) for half, power in zip(ijk, powers, strict=True))
                row[place[powers[0], powers[1], powers[2]]] = (-1) ** sum(ijk) * multiplicity * factor
    gram = np.array([[_mean(first, second) for second in orders] for first in orders])
    scales = [(-1.0) ** sum(alpha) / sqrt(row @ gram @ row) for row, alpha in zip(rows, orders, strict=True)]
    return np.array(scales)[:, None] * rows, tuple(scales)


def _mean(first: Order, second: Order) -> float:
    """Mean of a product of two monomials over the unit ball."""
    powers = [i + j for i, j in zip(first, second, strict=True)]
    if any(power % 2 for power in powers):
        return 0.0
    return 0.75 / pi * prod(gamma((power + 1) / 2) for power in powers) / gamma((sum(powers) + 5) / 2)


def density_values(degree: int, points: Sequence[FloatArray]) -> FloatArray:
    """Values of the densities up to a degree at ξ, ``(n, points)``, in the order of `monomials_to`."""
    return np.asarray(_densities(degree)[0] @ monomial_values(degree, points))


def density_scales(degree: int) -> tuple[float, ...]:
    """Factors s of the densities."""
    return _densities(degree)[1]


@dataclass(frozen=True, eq=False)
class _Terms:
    """Terms of the potentials of all densities: derivatives of V_n, some multiplied by a coordinate.

    Attributes
    ----------
    columns : list of (n, γ)
        Derivatives of V_n.
    table : (4 columns, sources)
        Sparse factors for x, y, z or no coordinate, by derivative; sources are potentials, densities and orders.
    blocks : tuple of int
        Coordinates in the terms, 0 to 2, and 3 for none.
    inner : (columns, monomials), optional
        Polynomials of the derivatives inside, up to `degree`.
    """

    columns: list[Column]
    table: Any
    blocks: tuple[int, ...]
    degree: int
    inner: FloatArray | None

    def contracted(self, weights: FloatArray | None) -> FloatArray:
        """Coefficients of the derivatives, ``(4, k, columns)``, for weights ``(k, sources)`` or each source."""
        rows = self.table.toarray() if weights is None else self.table @ weights.T
        return np.asarray(rows).reshape(4, len(self.columns), -1).transpose(0, 2, 1)


@lru_cache(maxsize=16)
def _terms(semi_axes: tuple[float, float, float], degree: int, requests: Requests, *, outside: bool) -> _Terms:
    from scipy.sparse import coo_array  # late: most runs need no moments

    short = int(np.argmin(semi_axes))
    scales = density_scales(degree)
    numbers: dict[Column, int] = {}
    rows: list[tuple[int, int, int, float]] = []
    source = 0
    for name, orders in requests:
        for scale, alpha in zip(scales, monomials_to(degree), strict=True):
            whole = scale * prod(a**times for a, times in zip(semi_axes, alpha, strict=True))
            for order in orders:
                for block, (n, gamma_), factor in _of_potential(name, alpha, order, semi_axes):
                    reduced = without_short(gamma_, short) if outside else ((gamma_, 1),)
                    for target, times in reduced:
                        column = numbers.setdefault((n, target), len(numbers))
                        rows.append((source, block, column, whole * factor * times))
                source += 1
    columns = list(numbers)
    # A derivative of V_n, of degree 2n + 2, has at least the n of its density.
    most = max(2 * n + 2 - sum(order) for n, order in columns)
    inner = None if outside else inner_polynomials(np.array(semi_axes), columns, max(most, 0))
    targets = [block * len(columns) + column for _, block, column, _ in rows]
    factors, sources = [row[3] for row in rows], [row[0] for row in rows]
    table = coo_array((factors, (targets, sources)), shape=(4 * len(columns), source)).tocsr()
    blocks = tuple(sorted({row[1] for row in rows}))
    return _Terms(columns, table, blocks, max(most, 0), inner)


def _of_potential(
    name: str, alpha: Order, order: Order, semi_axes: tuple[float, float, float]
) -> list[tuple[int, Column, float]]:
    """Terms of a derivative of Φ or Ψ of ∂^α f_n: coordinate that multiplies (3: none), derivative of V_n, factor."""
    n = sum(alpha)
    if name == "phi":
        return [(3, (n, _sum(alpha, order)), 1.0)]
    axis = int(np.argmax(order))
    step: Order = (int(axis == 0), int(axis == 1), int(axis == 2))
    raised = _sum(alpha, order)
    base = _sum(raised, step, -1)
    terms = [(axis, (n, base), 1.0), (3, (n + 1, raised), semi_axes[axis] ** 2 / (2.0 * (n + 1)))]
    if base[axis]:
        terms.append((3, (n, _sum(base, step, -1)), float(base[axis])))
    return terms


def _sum(first: Order, second: Order, sign: int = 1) -> Order:
    return first[0] + sign * second[0], first[1] + sign * second[1], first[2] + sign * second[2]


def weighted_sums(
    semi_axes: FloatArray,
    degree: int,
    requests: Requests,
    weights: FloatArray | None,
    points: Points,
    tests: FloatArray | None = None,
    *,
    outside: bool,
) -> FloatArray:
    """Weighted sums of derivatives of Φ and Ψ of the densities, in the axes of the ellipsoid.

    Parameters
    ----------
    semi_axes : (3,)
        Semi-axes of order one.
    degree : int
        Degree of the densities.
    requests : ((potential, orders), ...)
        ``"phi"`` with any orders, ``"psi"`` with orders from 1 on.
    weights : (k, m), optional
        Weights over potentials, densities and orders, in this nesting; by default all m values one by one.
    points : three arrays (points,)
        All outside or all inside; on the boundary the limit from that side.
    tests : (d, points), optional
        Functions that multiply the sums before summation over the points; they require weights.

    Returns
    -------
    (k or m, points), or (k, d) with tests
    """
    a, b, c = (float(axis) for axis in semi_axes)
    terms = _terms((a, b, c), degree, requests, outside=outside)

    def chunks() -> Iterator[tuple[slice, list[FloatArray | float], FloatArray]]:
        """Points, their coordinates and 1, and the derivatives of V_n there, or the monomials inside."""
        for first in range(0, points[0].size, CHUNK):
            span = slice(first, first + CHUNK)
            coordinates = points[0][span], points[1][span], points[2][span]
            values = (
                outer_derivatives(semi_axes, terms.columns, coordinates)
                if outside
                else monomial_values(terms.degree, coordinates)
            )
            yield span, [*coordinates, 1.0], values

    if tests is not None and weights is not None:
        count = len(terms.columns) if terms.inner is None else terms.inner.shape[1]
        products = np.zeros((4, count, len(tests)))
        for span, factors, values in chunks():
            for block in terms.blocks:
                products[block] += values @ (factors[block] * tests[:, span]).T
        if terms.inner is not None:
            products = terms.inner @ products
        return np.asarray(weights @ (terms.table.T @ products.reshape(-1, len(tests))))
    blocks = terms.contracted(weights)
    if terms.inner is not None:
        blocks = blocks @ terms.inner
    rows = blocks[list(terms.blocks)].reshape(-1, blocks.shape[2])
    out = np.zeros((blocks.shape[1], points[0].size))
    for span, factors, values in chunks():
        sums = (rows @ values).reshape(len(terms.blocks), len(out), values.shape[-1])
        for block, of_block in zip(terms.blocks, sums, strict=True):
            out[:, span] += factors[block] * of_block
    return out
