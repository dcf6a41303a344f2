"""Potentials of an ellipsoid in its own axes, inside and outside, all derivatives.

============  =========================================================================================
symbol        meaning
============  =========================================================================================
a_i           semi-axes; c the shortest
λ             ellipsoidal coordinate of an outer point, the largest root of Σ x_i²/(a_i² + λ) = 1; 0 inside
A_i           a_i² + λ
Δ(s)          √((a_1² + s)(a_2² + s)(a_3² + s)) with s counted from 0
I, I_i        2π a_1 a_2 a_3 ∫_λ^∞ {1, 1/(a_i² + s)} ds/Δ
K_i, J_ij     2π a_1 a_2 a_3 ∫_λ^∞ s {1/(a_i² + s), 1/((a_i² + s)(a_j² + s))} ds/Δ
y_i, h, g     x_i/A_i, Σ y_i², 2π a_1 a_2 a_3/Δ(λ)
============  =========================================================================================

From Φ = ½ (I - Σ x_k² I_k) and Ψ,i = x_i P_i with P_i = ½ (K_i - Σ x_k² J_ik) (Ferrers and Dyson), and because the
integrands vanish at λ,

    Φ,i  = -x_i I_i            Φ,ij  = -δ_ij I_i + 2 g y_i y_j / h
    Ψ,ij = δ_ij P_i - x_i x_j J_ij
    Ψ,ijk = -(δ_ij x_k J_ik + δ_ik x_j J_ij + δ_jk x_i J_ij) + 2 g λ y_i y_j y_k / h

The remaining derivatives are elementary, with λ,i = 2 y_i / h, and computed by jets. All integrals have positive
integrands. They are computed by Gauss-Legendre quadrature after a change of variable, without cancellation and without
division by a_i² - a_j². Spheres, spheroids and similar ellipsoids need no special case.

References
----------
T. Mura, Micromechanics of Defects in Solids, 2nd ed. 1987, eqs. 11.36 to 11.39. J. D. Eshelby 1959,
doi:10.1098/rspa.1959.0173.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cache

import numpy as np
from numpy.typing import NDArray

from eigencontact.plugin import FloatArray, Jet, Order, implicit, variables

__all__ = ["ellipsoidal_level", "level_rules", "potential_derivatives"]


#: Largest ratio of the largest to the smallest A_i for a single change of variable.
_ROUND = 4.0
_NODES = 20


class Region:
    """Points all inside or all outside, with the terms of their derivatives, each computed once.

    Parameters
    ----------
    semi_axes : (3,)
        Semi-axes, of order one.
    points : three arrays of shape (n,)
        Field points in the axes of the ellipsoid.
    order : int
        Order of the jets: the number of remaining derivatives.
    outside : bool
        Whether the points are outside; boundary points belong to either side.
    """

    def __init__(
        self, semi_axes: FloatArray, points: tuple[FloatArray, FloatArray, FloatArray], order: int, *, outside: bool
    ) -> None:
        self.a = semi_axes
        self.order = order
        self.x = variables(*points, order)
        self.outside = outside
        self._derivatives: dict[tuple[str, tuple[int, ...]], Jet] = {}
        short = float(semi_axes.min())
        self.excess = (semi_axes - short) * (semi_axes + short)  # a_i² - c², exact for nearly equal axes
        if outside:
            level = ellipsoidal_level(semi_axes, points)
            self.level_value = level - short**2
        else:
            level = np.full(1, short**2)
            self.level_value = np.zeros(1)
        self.integrals = _integrals(semi_axes, self.excess, level, self.level_value)
        if outside:
            self._prepare(level, short)

    def _prepare(self, level: FloatArray, short: float) -> None:
        """Jets of λ + c², A_i, y_i, g and 2/h."""
        squares = [x * x for x in self.x]
        e1, e2, e3 = (float(e) for e in self.excess)
        start = [x.value / (e + level) for x, e in zip(self.x, self.excess, strict=True)]
        slope = -(start[0] ** 2 + start[1] ** 2 + start[2] ** 2)

        def equation(t: Jet) -> Jet:
            return squares[0] / (t + e1) + squares[1] / (t + e2) + squares[2] / (t + e3) - 1.0

        t = implicit(equation, level, slope, self.order)
        inverse = [(t + e) ** -1 for e in self.excess]
        self.y = [x * inverse_square for x, inverse_square in zip(self.x, inverse, strict=True)]
        p, q, r = (y * y for y in self.y)
        self.scale = (inverse[0] * inverse[1] * inverse[2]) ** 0.5 * float(2.0 * np.pi * self.a.prod())  # g
        self.twice_over_h = 2.0 / (p + q + r)
        self.inverse = inverse
        self.level = t - short**2

    def layer(self, *axes: int) -> Jet:
        """2 g y_i y_j / h or 2 g λ y_i y_j y_k / h: the additional terms outside."""
        key = ("layer", axes)
        if key not in self._derivatives:
            if axes == ():
                self._derivatives[key] = self.scale * self.twice_over_h
            elif len(axes) < 3:
                self._derivatives[key] = self.layer(*axes[:-1]) * self.y[axes[-1]]
            else:
                self._derivatives[key] = self.layer(*axes[:2]) * (self.level * self.y[axes[2]])
        return self._derivatives[key]

    def integral(self, *axes: int) -> Jet:
        """I_i or J_ij as a jet: its gradient is elementary."""
        axes = tuple(sorted(axes))
        key = ("integral", axes)
        if key not in self._derivatives:
            self._derivatives[key] = self._integral(axes)
        return self._derivatives[key]

    def _integral(self, axes: tuple[int, ...]) -> Jet:
        value = self.integrals[axes]
        if not self.outside or self.order == 0:
            return Jet(value[None], self.order)
        slope = -self.layer() * self.inverse[axes[0]]
        if len(axes) == 2:
            slope = slope * self.inverse[axes[1]] * self.level
        slope = slope.truncated(self.order - 1)
        return Jet.from_gradient(value, (slope * self.y[0], slope * self.y[1], slope * self.y[2]))

    def phi(self, axes: tuple[int, ...]) -> Jet:
        """Derivative of Φ along none, one or two axes."""
        if len(axes) == 0:
            weighted = (x.value**2 * self.integrals[(k,)] for k, x in enumerate(self.x))
            return Jet(0.5 * (self.integrals[()] - sum(weighted))[None], 0)
        if len(axes) == 1:
            return Jet(-self.x[axes[0]].value * self.integrals[axes][None], 0)
        i, j = axes
        terms = [-self.integral(i)] if i == j else []
        if self.outside:
            terms.append(self.layer(i, j))
        return self._total(terms)

    def psi(self, axes: tuple[int, ...]) -> Jet:
        """Derivative of Ψ along one, two or three axes, in ascending order."""
        if len(axes) < 3:
            i, j = axes[0], axes[-1]
            weighted = (x.value**2 * self._j(i, k) for k, x in enumerate(self.x))
            twice = self.integrals["K", i] - sum(weighted)  # 2 P_i
            if len(axes) == 1:
                return Jet((0.5 * self.x[i].value * twice)[None], 0)
            diagonal = 0.5 * twice if i == j else 0.0
            return Jet((diagonal - self.x[i].value * self.x[j].value * self._j(i, j))[None], 0)
        i, j, k = axes
        terms = [-self.x[k] * self.integral(i, k)] if i == j else []
        terms += [-self.x[i] * self.integral(i, j)] if j == k else []
        terms += [-self.x[j] * self.integral(i, j)] if i == k else []
        if self.outside:
            terms.append(self.layer(i, j, k))
        return self._total(terms)

    def _j(self, i: int, k: int) -> FloatArray:
        return self.integrals[min(i, k), max(i, k)]

    def _total(self, terms: list[Jet]) -> Jet:
        total = Jet(np.zeros((1, *self.x[0].value.shape)), self.order)
        for term in terms:
            total = total + term
        return total


def potential_derivatives(
    potential: str, semi_axes: FloatArray, orders: Sequence[Order], points: tuple[FloatArray, ...], *, outside: bool
) -> FloatArray:
    """Derivatives of ``"phi"``, or of ``"psi"`` from order 1 on, ``(len(orders), n)``; lengths of order one."""
    terms: list[tuple[tuple[str, Order, float], ...]] = [((potential, order, 1.0),) for order in orders]
    if outside:
        terms = [_without_short(potential, order, int(np.argmin(semi_axes))) for order in orders]
    derivatives = {(name, order) for row in terms for name, order, _ in row}
    closed = {"phi": 2, "psi": 3}
    most_orders = max((sum(order) - closed[name] for name, order in derivatives), default=0)
    x, y, z = points
    region = Region(semi_axes, (x, y, z), max(0, most_orders), outside=outside)
    jets: dict[tuple[str, tuple[int, ...]], Jet] = {}
    values: dict[tuple[str, Order], FloatArray] = {}
    for name, order in derivatives:
        axes, remaining = _split(order, closed[name])
        if (name, axes) not in jets:
            jets[name, axes] = region.phi(axes) if name == "phi" else region.psi(axes)
        values[name, order] = jets[name, axes].derivative(remaining)
    result = np.zeros((len(orders), x.size))
    for place, row in enumerate(terms):
        for name, order, factor in row:
            result[place] += factor * values[name, order]
    return result


@cache
def _without_short(potential: str, order: Order, short: int) -> tuple[tuple[str, Order, float], ...]:
    """An outer derivative by others with at most one along the short axis, by the Laplacians of Φ (0) and Ψ (2Φ).

    Above the face of a disc λ varies over the thickness, and the field over the width. Direct derivatives along the
    short axis would cancel, by a further factor a/c for each.
    """
    if order[short] < 2 or sum(order) < (2 if potential == "phi" else 3):
        return ((potential, order, 1.0),)
    lower = tuple(n - 2 * (axis == short) for axis, n in enumerate(order))
    total: dict[tuple[str, Order], float] = {}
    sources = [("phi", lower, 2.0)] if potential == "psi" else []
    for axis in {0, 1, 2} - {short}:
        raised = tuple(n + 2 * (a == axis) for a, n in enumerate(lower))
        sources.append((potential, raised, -1.0))
    for name, (i, j, k), factor in sources:
        for base, at, inner in _without_short(name, (i, j, k), short):
            total[base, at] = total.get((base, at), 0.0) + factor * inner
    return tuple((base, at, factor) for (base, at), factor in total.items())


@cache
def _split(order: Order, closed: int) -> tuple[tuple[int, ...], Order]:
    """Axes of the closed derivatives, different ones first (they have fewest terms), and the remaining axes."""
    remaining: list[int] = list(order)
    axes: list[int] = []
    while len(axes) < min(closed, sum(order)):
        axis = min((a for a in range(3) if remaining[a]), key=lambda a: (axes.count(a), a))
        remaining[axis] -= 1
        axes.append(axis)
    return tuple(sorted(axes)), (remaining[0], remaining[1], remaining[2])


def ellipsoidal_level(semi_axes: FloatArray, points: tuple[FloatArray, ...]) -> FloatArray:
    """λ + c² of outer points, to a relative accuracy: c² (never less) on the boundary.

    The reciprocal of Σ x_i²/(a_i² + λ) is a concave, nearly linear function of λ. Newton's method on it approaches the
    root from below without overshooting.
    """
    short = float(semi_axes.min())
    excess = (semi_axes - short) * (semi_axes + short)
    squares = [x * x for x in points]
    level = np.full(points[0].shape, short**2)
    for square, e in zip(squares, excess, strict=True):
        np.maximum(level, square - e, out=level)
    for _ in range(60):
        inverse = [1.0 / (level + e) for e in excess]
        quotients = [square * inverse_square for square, inverse_square in zip(squares, inverse, strict=True)]
        total = quotients[0] + quotients[1] + quotients[2]
        slope = quotients[0] * inverse[0] + quotients[1] * inverse[1] + quotients[2] * inverse[2]
        step = np.maximum(total * (total - 1.0) / np.where(slope > 0, slope, 1.0), 0.0)
        level += step
        if np.all(step <= 1e-15 * level):
            break
    return level


@cache
def _gauss(count: int, upper: float) -> tuple[FloatArray, FloatArray]:
    nodes, weights = np.polynomial.legendre.leggauss(count)
    return 0.5 * upper * (nodes + 1.0), 0.5 * upper * weights


@cache
def _round_rule() -> tuple[FloatArray, FloatArray, FloatArray]:
    """u², 1 - u² and weights on 0 < u < 1: half of a rule on (-1, 1), because the integrands are even."""
    nodes, weights = np.polynomial.legendre.leggauss(2 * _NODES)
    u, w = nodes[_NODES:, None], weights[_NODES:, None]
    return u * u, (1.0 - u) * (1.0 + u), w


def _slender_rule(smallest: FloatArray, largest: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Rule for very different A_i: the integral over s < max A_i is nearly linear in ln(s + min A_i)."""
    length = np.log1p(largest / smallest)
    reach = 2.6 / (0.5 * float(length.max()))  # half width of the strip without singularities, in half lengths
    count = int(np.ceil(18.5 / np.log(reach + np.hypot(1.0, reach)))) + 4
    nodes, weights = _gauss(count, 1.0)
    w = nodes[:, None] * length
    s = smallest * np.expm1(w)
    u2 = largest / (s + largest)
    weight = weights[:, None] * length * (s + smallest) * u2**1.5 / (2.0 * largest)
    tail, tail_weights = _gauss(_NODES, float(np.sqrt(0.5)))
    tail2 = np.broadcast_to((tail * tail)[:, None], (tail.size, length.size))
    return (
        np.concatenate([u2, tail2]),
        np.concatenate([s / (s + largest), 1.0 - tail2]),
        np.concatenate([weight, np.broadcast_to(tail_weights[:, None], tail2.shape)]),
    )


def _rules(
    excess: FloatArray, level: FloatArray
) -> Iterator[tuple[NDArray[np.bool_], FloatArray, tuple[FloatArray, FloatArray, FloatArray], list[FloatArray]]]:
    """Points with a common rule; their M, the rule (u², 1 - u², weights) and the inverted B_i of `_integrals`."""
    slender = level + excess.max() > _ROUND * level
    for points in (slender, ~slender):
        if points.any():
            A = [level[points] + e for e in excess]
            largest = A[int(np.argmax(excess))]
            u2, v2, weight = _slender_rule(level[points], largest) if points is slender else _round_rule()
            yield points, largest, (u2, v2, weight), [1.0 / (largest * v2 + term * u2) for term in A]


def level_rules(
    excess: FloatArray, level: FloatArray
) -> Iterator[tuple[NDArray[np.bool_], FloatArray, list[FloatArray], FloatArray]]:
    """Rules of integrals ds/Δ from λ to infinity; `excess` is a_i² - c², `level` λ + c².

    Yields
    ------
    points : (n,) bool
        Points that share a rule, m of them.
    step, inverse, weight : (nodes, m), three of (nodes, m), (nodes, m)
        s - λ, 1/(a_i² + s) and weights, which contain 1/Δ.
    """
    for points, largest, (u2, v2, weight), B in _rules(excess, level):
        of_delta = 2.0 * largest * weight * np.sqrt(B[0] * B[1] * B[2])
        yield points, largest * v2 / u2, [inverse * u2 for inverse in B], of_delta


def _integrals(
    semi_axes: FloatArray, excess: FloatArray, level: FloatArray, value: FloatArray
) -> dict[tuple[object, ...], FloatArray]:
    """I ``()``, I_i ``(i,)``, J_ij ``(i, j)`` with i <= j and K_i ``("K", i)``; `level` is λ + c², `value` λ.

    With max A_i = M and s + M = M/u² (s counted from λ), s + A_i = B_i/u² and s + λ = N/u², every integral is one of
    ``2 M ∫ u^2m N^n / (B_i B_j √(B_1 B_2 B_3)) du`` over 0 < u < 1.
    """
    names: list[tuple[object, ...]] = [(), *((i,) for i in range(3)), *(("K", i) for i in range(3))]
    names += [(i, j) for i in range(3) for j in range(i, 3)]
    result = {name: np.empty(level.shape) for name in names}
    for points, largest, (u2, v2, weight), B in _rules(excess, level):
        N = largest * v2 + value[points] * u2
        base = weight * np.sqrt(B[0] * B[1] * B[2])
        factor = 4.0 * np.pi * float(semi_axes.prod()) * largest
        result[()][points] = factor * base.sum(axis=0)
        for i in range(3):
            once = base * B[i]
            weighted = once * N
            result[(i,)][points] = factor * np.sum(once * u2, axis=0)
            result["K", i][points] = factor * weighted.sum(axis=0)
            weighted *= u2
            for j in range(i, 3):
                result[i, j][points] = factor * np.einsum("qn,qn->n", weighted, B[j])
    return result
