"""Harmonic potentials of polynomial densities: integrals of ρ/R, Laplacian, derivatives, boundary."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigencontact_verification.conformance.boundary import smooth_points
from eigencontact_verification.conformance.densities import DEGREE, count_of, density_sizes, values_of
from eigencontact_verification.conformance.integrals import directions
from eigencontact_verification.conformance.orders import AXES, Order, add, name, of_total, point_derivatives
from eigencontact_verification.conformance.quadrature import Rule, quadrature_rules, ray_rules
from eigencontact_verification.conformance.report import agree, check, ensure, ensure_pure
from eigencontact_verification.conformance.sampling import derivative_along, inside, on_boundary, region, sample

FloatArray = NDArray[np.float64]

#: Share of a volume that both quadratures may miss.
_MISSED = 3e-5
_HIGHEST = 5


def phi_of(shape: Any, degree: int, orders: list[Order], places: FloatArray) -> FloatArray:
    """Derivatives of the potentials of the densities at points ``(..., 3)``, per root mean square of each density."""
    points = (np.array(coordinate) for coordinate in np.moveaxis(places, -1, 0))
    values = np.asarray(shape.phi_moments(degree, orders, *points))
    sizes = density_sizes(shape, degree)
    return values / sizes.reshape(-1, *[1] * (values.ndim - 1))


def _names(orders: list[Order], count: int) -> list[str]:
    return [f"{name('phi', order).rstrip(',')} of density {row}" for row in range(count) for order in orders]


def _compare(
    got: FloatArray, expected: FloatArray, orders: list[Order], places: FloatArray, *, scale: FloatArray | None = None,
    tolerance: FloatArray | float, rule: str, advice: str,
) -> None:  # fmt: skip
    """Compare derivatives ``(n, orders, points)``, relative to the largest of all at the point or of `scale` there."""
    largest = np.max(np.abs(expected), axis=(0, 1)) if scale is None else scale
    count, points = len(got), got.shape[2]
    agree(
        _names(orders, count), got.reshape(-1, points), expected.reshape(-1, points),
        scale=largest, tolerance=tolerance, points=places, rule=rule, advice=advice,
    )  # fmt: skip


@check
def check_moment_arrays(shape: Any) -> None:
    """Answers have shape (n, len(orders), ...); a lower degree gives the leading densities; inputs stay untouched."""
    within, without = sample(shape)
    places = np.resize(np.concatenate([within.places, without.places]), (12, 3))
    orders = [order for total in range(_HIGHEST + 1) for order in of_total(total)][::4]
    flat = phi_of(shape, DEGREE, orders, places)
    scale = np.abs(flat).max(axis=(0, 2), keepdims=True)[0]
    for form in ((), (1,), (12,), (3, 2, 2), (0,)):
        size = int(np.prod(form))
        answer = phi_of(shape, DEGREE, orders, places[:size].reshape((*form, 3)))
        expected = (count_of(DEGREE), len(orders), *form)
        equal = answer.shape == expected and np.all(
            np.abs(answer.reshape(*expected[:2], -1) - flat[..., :size]) <= 1e-9 * scale
        )
        ensure(
            equal,
            f"phi_moments of {len(orders)} orders at points of shape {form}",
            f"of shape {expected}, the values of the same points in a row",
            f"of shape {answer.shape}",
            "allocate np.empty((n, len(orders), *x.shape)) and treat every point alike",
        )
    backwards = phi_of(shape, DEGREE, orders[::-1], places)[:, ::-1]
    lower = phi_of(shape, DEGREE - 1, orders, places)
    for got, expected_values, subject in (
        (backwards, flat, "phi_moments of orders in reverse"),
        (lower, flat[: count_of(DEGREE - 1)], "phi_moments of one degree less"),
    ):
        ensure(
            np.all(np.abs(got - expected_values) <= 1e-9 * scale),
            subject,
            "the same rows",
            "different rows",
            "answer in the order of `orders`, densities of lower degrees first",
        )
    arrays = list(np.ascontiguousarray(places.T))
    ask = partial(shape.phi_moments, DEGREE, orders, *arrays)
    ensure_pure("phi_moments", ask, arrays, arguments="the arrays given to phi_moments")


@check
def check_moment_quadrature(shape: Any) -> None:
    """Three half diagonals away all orders, and inside orders 0 and 1, equal integrals of ρ/R over contains.

    The allowed error is four times the difference of two quadratures; inside these follow rays from the point.
    """
    box = region(shape)
    away = box.center + 3 * box.radius * directions(4)
    within = sample(shape)[0].places[:3]
    sizes = density_sizes(shape, DEGREE)[:, None]

    def integrate(rules: Rule | list[Rule], orders: list[Order], places: FloatArray) -> FloatArray:
        rules = rules if isinstance(rules, list) else [rules] * len(places)
        out = np.empty((len(sizes), len(orders), len(places)))
        for column, (place, rule) in enumerate(zip(places, rules, strict=True)):
            kernels = point_derivatives(-1, orders, (place - rule.nodes).T)
            out[..., column] = (values_of(shape, DEGREE, rule.nodes) / sizes * rule.weights) @ kernels.T
        return out

    region_words = "over the points that contains accepts"
    cases: list[tuple[FloatArray, tuple[int, ...], tuple[Any, Any], str]] = [
        (away, tuple(range(_HIGHEST + 1)), quadrature_rules(shape), region_words),
        (within, (0, 1), ray_rules(shape, within), f"along rays, {region_words}"),
    ]
    for places, totals, (coarse, fine), words in cases:
        for total in totals:
            orders = of_total(total)
            expected = integrate(fine, orders, places)
            doubt = float(np.max(np.abs(expected - integrate(coarse, orders, places))) / np.max(np.abs(expected)))
            ensure(
                doubt < 2e-2,
                f"the kit's quadrature {words}",
                "settled: two rules must differ by less than 2 %",
                f"{doubt:.1e}",
                "make bounds tight; a shape of thin parts may waive this check and say why",
            )
            _compare(
                phi_of(shape, DEGREE, orders, places), expected, orders, places,
                scale=np.max(np.abs(expected)) * np.ones(len(places)), tolerance=4 * doubt + _MISSED,
                rule=f"the integral of ρ/R {words}",
                advice="compare the density that belongs to this row with densities(), its sign and its scale",
            )  # fmt: skip


@check
def check_moment_laplacian(shape: Any) -> None:
    """The Laplacian of the potential is -4 pi ρ inside and 0 outside."""
    within, without = sample(shape)
    places = np.concatenate([within.places, without.places])
    orders = [add((0, 0, 0), axis, 2) for axis in AXES]
    second = phi_of(shape, DEGREE, of_total(2), places)
    laplacian = phi_of(shape, DEGREE, orders, places).sum(axis=1, keepdims=True)
    density = values_of(shape, DEGREE, places) / density_sizes(shape, DEGREE)[:, None] * inside(shape, places)
    expected = -4 * np.pi * density[:, None, :]
    scale = np.maximum(np.max(np.abs(second), axis=(0, 1)), np.max(np.abs(expected), axis=(0, 1)))
    agree(
        [f"the Laplacian of phi of density {row}" for row in range(len(expected))],
        laplacian[:, 0], expected[:, 0], scale=scale, tolerance=1e-9, points=places,
        rule="-4 pi times the density inside and 0 outside",
        advice="compare the density that belongs to this row with densities(), its sign and its scale",
    )  # fmt: skip


@check
def check_moment_derivatives(shape: Any) -> None:
    """Every derivative of order 1 to 5 is the derivative of each of order one less that leads to it."""
    groups = sample(shape)
    places = np.concatenate([group.places for group in groups])
    reach = np.concatenate([group.clearance for group in groups]) / 4
    for total in range(_HIGHEST):
        orders = of_total(total)
        below = np.max(np.abs(phi_of(shape, DEGREE, orders, places)), axis=(0, 1))
        above = np.max(np.abs(phi_of(shape, DEGREE, of_total(total + 1), places)), axis=(0, 1))
        for axis in AXES:
            slopes = derivative_along(axis, places, reach, partial(phi_of, shape, DEGREE, orders))
            raised = [add(order, axis) for order in orders]
            _compare(
                phi_of(shape, DEGREE, raised, places), slopes, raised, places,
                scale=np.maximum(above, 1e-6 * below / reach), tolerance=1e-7,
                rule="the derivative of the order below it",
                advice="differentiate that row again; a wrong row disagrees with itself along another axis too",
            )  # fmt: skip


@check
def check_moment_boundary(shape: Any) -> None:
    """Potential and gradient are continuous; second derivatives on the boundary are the mean of both sides (z > 0).

    The boundary is met where contains changes; points on it are those of flat faces in the planes of bounds, and those
    where an axis through the middle of bounds leaves the shape at bounds.
    """
    crossing, outward = on_boundary(shape)
    step = region(shape).step
    for total in (0, 1):
        orders = of_total(total)
        within, without = (phi_of(shape, DEGREE, orders, crossing + side * step * outward) for side in (-1, 1))
        _compare(
            within, without, orders, crossing, scale=np.max(np.abs(without)) * np.ones(len(crossing)), tolerance=1e-5,
            rule="the same just inside and just outside",
            advice="the formulas inside and outside differ on the boundary: compare their constants",
        )  # fmt: skip
    places, normals = smooth_points(shape)
    if not len(places):
        return
    orders = of_total(2)
    within, without = (phi_of(shape, DEGREE, orders, places + side * step * normals) for side in (-1, 1))
    _compare(
        phi_of(shape, DEGREE, orders, places), (within + without) / 2, orders, places,
        scale=np.max(np.abs(within), axis=(0, 1)), tolerance=1e-5,
        rule="the mean of its values just inside and just outside",
        advice="average both formulas on the boundary",
    )  # fmt: skip
