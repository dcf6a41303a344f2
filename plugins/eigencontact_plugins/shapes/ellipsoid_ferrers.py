"""Derivatives of the potentials V_n of the densities f_n = (1 - Σ x_i²/a_i²)^n over an ellipsoid, in its own axes.

With U(s) = 1 - Σ x_i²/(a_i² + s), Δ(s) = √((a_1² + s)(a_2² + s)(a_3² + s)) and λ the largest root of U (0 inside)

    V_n = π a_1 a_2 a_3/(n + 1) ∫_λ^∞ U^(n+1)/Δ ds                              (Ferrers and Dyson)

The integral equals that of U^(n+1) log(-U)/(2π i Δ) along a fixed path around the cut from λ to infinity, so that
derivatives can be taken inside it. Terms with the logarithm become an integral along the cut; the other terms have a
pole at λ:

    ∂^γ V_n = π a_1 a_2 a_3/(n + 1) { ∫_λ^∞ ∂^γ U^(n+1)/Δ ds + Res_λ r_γ/Δ }

with r_γ the part of ∂^γ [U^(n+1) log U] without a logarithm. The residue, absent up to |γ| = n + 1, is a coefficient of
a short Taylor series about λ.

References
----------
N. M. Ferrers 1877, Quart. J. Pure Appl. Math. 14, 1; F. W. Dyson 1891, ibid. 25, 259: V_n. T. Mura 1987, Micromechanics
of Defects in Solids, section 11. The residue was derived for this project.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from math import comb, factorial, prod

import numpy as np

from eigencontact.plugin import FloatArray, Order
from eigencontact_plugins.shapes.ellipsoid_potentials import ellipsoidal_level, level_rules

__all__ = ["Column", "inner_polynomials", "monomial_values", "monomials_to", "outer_derivatives", "without_short"]

#: n and γ of ∂^γ V_n.
Column = tuple[int, Order]
Table = dict[tuple[int, Order], FloatArray]


@cache
def monomials_to(degree: int) -> tuple[Order, ...]:
    """Exponents of all monomials in three coordinates up to a degree, lower degrees first."""
    return tuple(
        (i, j, total - i - j)
        for total in range(degree + 1)
        for i in range(total, -1, -1)
        for j in range(total - i, -1, -1)
    )


def monomial_values(degree: int, points: Sequence[FloatArray]) -> FloatArray:
    """Values of the monomials up to a degree, ``(monomials, points)``."""
    powers = [_powers(values, degree) for values in points]
    return np.stack([powers[0][i] * powers[1][j] * powers[2][k] for i, j, k in monomials_to(degree)])


def _powers(base: FloatArray, highest: int) -> list[FloatArray]:
    """Powers 0 to `highest`."""
    out = [np.ones_like(base)]
    for _ in range(highest):
        out.append(out[-1] * base)
    return out


@cache
def without_short(order: Order, short: int) -> tuple[tuple[Order, int], ...]:
    """An outer derivative by others with at most one along one axis, by Laplace's equation: (order, factor)."""
    left, odd = divmod(order[short], 2)
    first, second = (axis for axis in range(3) if axis != short)
    terms = []
    for times in range(left + 1):
        moved = list(order)
        moved[short] = odd
        moved[first] += 2 * times
        moved[second] += 2 * (left - times)
        terms.append(((moved[0], moved[1], moved[2]), (-1) ** left * comb(left, times)))
    return tuple(terms)


@cache
def _terms(order: Order) -> tuple[tuple[Order, Order, float], ...]:
    """Terms of ∂^γ g(U): exponents of x_i and of 1/(a_i² + s), whose sum is the derivative of g, and a factor."""
    terms = []
    for j in np.ndindex(*(times // 2 + 1 for times in order)):
        powers = tuple(times - 2 * pairs for times, pairs in zip(order, j, strict=True))
        inverse = tuple(times - pairs for times, pairs in zip(order, j, strict=True))
        factor = prod(
            factorial(times) / (factorial(pairs) * factorial(power)) * (-2.0) ** power * (-1.0) ** pairs
            for times, pairs, power in zip(order, j, powers, strict=True)
        )
        terms.append(((powers[0], powers[1], powers[2]), (inverse[0], inverse[1], inverse[2]), factor))
    return tuple(terms)


def inner_polynomials(semi_axes: FloatArray, columns: Sequence[Column], degree: int) -> FloatArray:
    """Coefficients of ∂^γ V_n inside in the monomials of x up to a degree, ``(columns, monomials)``."""
    highest = max(n for n, _ in columns) + 1
    short = float(semi_axes.min())
    excess = (semi_axes - short) * (semi_axes + short)
    _, _, inverse, weight = next(level_rules(excess, np.full(1, short * short)))
    powers = [_powers(values[:, 0], highest) for values in inverse]
    whole = np.pi * float(semi_axes.prod())
    place = {order: row for row, order in enumerate(monomials_to(degree))}
    out = np.zeros((len(columns), len(place)))
    integrals = {
        ijk: whole * float(weight[:, 0] @ (powers[0][ijk[0]] * powers[1][ijk[1]] * powers[2][ijk[2]]))
        for ijk in monomials_to(highest)
    }
    for row, (n, order) in enumerate(columns):
        for ijk in monomials_to(n + 1):
            rest_powers = tuple(2 * half - times for half, times in zip(ijk, order, strict=True))
            if min(rest_powers) < 0:
                continue
            factor = factorial(n) * (-1.0) ** sum(ijk) / factorial(n + 1 - sum(ijk))
            factor *= prod(
                factorial(2 * half) / (factorial(half) * factorial(power))
                for half, power in zip(ijk, rest_powers, strict=True)
            )
            out[row, place[rest_powers[0], rest_powers[1], rest_powers[2]]] += factor * integrals[ijk]
    return out


def outer_derivatives(
    semi_axes: FloatArray, columns: Sequence[Column], points: tuple[FloatArray, FloatArray, FloatArray]
) -> FloatArray:
    """∂^γ V_n at points outside or on the boundary, ``(len(columns), points)``.

    Parameters
    ----------
    semi_axes : (3,)
        Semi-axes of order one.
    columns : sequence of (n, γ)
        At most one derivative along the shortest axis; see `without_short`.
    points : three arrays (points,)
        Coordinates along the axes of the ellipsoid.
    """
    exponents: dict[Order, set[int]] = {}
    for n, order in columns:
        for _, inverse, _ in _terms(order):
            exponents.setdefault(inverse, set()).add(n)
    moments = _moments(semi_axes, exponents, points)
    powers = [_powers(values, max(order[axis] for _, order in columns)) for axis, values in enumerate(points)]
    whole = np.pi * float(semi_axes.prod())
    out = np.zeros((len(columns), points[0].size))
    monomials: dict[Order, FloatArray] = {}
    for row, (n, order) in enumerate(columns):
        for power, inverse, factor in _terms(order):
            if power not in monomials:
                monomials[power] = powers[0][power[0]] * powers[1][power[1]] * powers[2][power[2]]
            out[row] += (factor * whole / (n + 1)) * monomials[power] * moments[n, inverse]
    return out


def _moments(
    semi_axes: FloatArray, exponents: dict[Order, set[int]], points: tuple[FloatArray, FloatArray, FloatArray]
) -> Table:
    """Integral along the cut or residue of the Σk-th derivative of U^(n+1) [log U] by U, times Π (a_i² + s)^-k_i/Δ."""
    short = float(semi_axes.min())
    excess = (semi_axes - short) * (semi_axes + short)
    level = ellipsoidal_level(semi_axes, points)
    # U(λ) = 0: U = (s - λ) Σ x_i²/((a_i² + λ)(a_i² + s)) avoids a difference of nearly equal numbers.
    slopes = [values * values / (level + e) for values, e in zip(points, excess, strict=True)]
    out: Table = {(n, order): np.empty(level.shape) for order, of_order in exponents.items() for n in of_order}
    along = {order: {n for n in of_order if sum(order) <= n + 1} for order, of_order in exponents.items()}
    for place, step, inverse, weight in level_rules(excess, level):
        U = step * sum(slope[place] * values for slope, values in zip(slopes, inverse, strict=True))
        for (n, order), values in _sums(along, inverse, weight, U).items():
            out[n, order][place] = factorial(n + 1) / factorial(n + 1 - sum(order)) * values
    at_pole = {order: exponents[order] - along[order] for order in exponents}
    for (n, order), values in _residues(at_pole, excess, level, slopes).items():
        above = sum(order) - n - 1
        out[n, order][:] = (-1.0) ** (above - 1) * factorial(n + 1) * factorial(above - 1) * values
    return out


def _residues(
    exponents: dict[Order, set[int]], excess: FloatArray, level: FloatArray, slopes: Sequence[FloatArray]
) -> Table:
    """Residue at λ of U^-p Π (a_i² + s)^-k_i/Δ, p = Σ k - n - 1, by Taylor series in (s - λ)/(λ + c²)."""
    orders = [order for order, of_order in exponents.items() if of_order]
    if not orders:
        return {}
    length = max(sum(order) - n - 1 for order in orders for n in exponents[order])
    inverse = [1.0 / (level + e) for e in excess]
    ratios = [level * values for values in inverse]
    factors = [
        [_binomial(values, ratio, k + 0.5, length) for k in range(max(order[axis] for order in orders) + 1)]
        for axis, (values, ratio) in enumerate(zip(inverse, ratios, strict=True))
    ]
    U = [
        sum(
            slope * values * level * (-ratio) ** m for slope, values, ratio in zip(slopes, inverse, ratios, strict=True)
        )
        for m in range(length)
    ]
    first = [1.0 / U[0]]
    for m in range(1, length):
        first.append(-first[0] * sum(U[k] * first[m - k] for k in range(1, m + 1)))
    poles = [np.stack(first)]
    while len(poles) < length:
        poles.append(_product(poles[-1], poles[0]))
    pairs: dict[tuple[int, int], FloatArray] = {}
    out: Table = {}
    for order in orders:
        if order[1:] not in pairs:
            pairs[order[1], order[2]] = _product(factors[1][order[1]], factors[2][order[2]])
        series = _product(factors[0][order[0]], pairs[order[1], order[2]])
        for n in exponents[order]:
            p = sum(order) - n - 1
            out[n, order] = level * np.einsum("mp,mp->p", series[:p], poles[p - 1][p - 1 :: -1])
    return out


def _binomial(inverse: FloatArray, ratio: FloatArray, power: float, length: int) -> FloatArray:
    """Series ``(length, points)`` of (a² + s)^-power."""
    terms = [inverse**power]
    for m in range(1, length):
        terms.append(terms[-1] * ratio * (-(power + m - 1) / m))
    return np.stack(terms)


def _product(first: FloatArray, second: FloatArray) -> FloatArray:
    """Product of two series of equal length, truncated."""
    out: FloatArray = first * second[0]
    for m in range(1, len(first)):
        out[m:] += first[:-m] * second[m]
    return out


def _sums(exponents: dict[Order, set[int]], inverse: Sequence[FloatArray], weight: FloatArray, U: FloatArray) -> Table:
    """Sums over the first axis of weight Π inverse_i^k_i U^(n + 1 - Σ k)."""
    orders = [order for order, of_order in exponents.items() if of_order]
    if not orders:
        return {}
    powers = [_powers(values, max(order[axis] for order in orders)) for axis, values in enumerate(inverse)]
    most = max(n + 1 - sum(order) for order in orders for n in exponents[order])
    weights = [weight * values for values in _powers(U, most)]
    out: Table = {}
    for order in orders:
        product = powers[0][order[0]] * powers[1][order[1]] * powers[2][order[2]]
        for n in exponents[order]:
            out[n, order] = np.einsum("qp,qp->p", product, weights[n + 1 - sum(order)])
    return out
