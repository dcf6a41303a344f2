"""Polynomial densities of a shape: that they span all polynomials of a degree, and that its rule integrates them."""

from __future__ import annotations

from math import comb
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigencontact_verification.conformance.orders import of_total
from eigencontact_verification.conformance.quadrature import quadrature_rules
from eigencontact_verification.conformance.report import agree, check, ensure, ensure_array, ensure_pure
from eigencontact_verification.conformance.sampling import principal_axes, region, sample, within

FloatArray = NDArray[np.float64]

#: Degree of the densities that checks ask for.
DEGREE = 3
#: Condition of the densities up to which they count as independent, with values of order one in a round region.
_INDEPENDENT = 1e6
#: Share of the volume that the kit's quadratures may miss: see `integrals`.
_MISSED = 3e-5


def count_of(degree: int) -> int:
    """Number of monomials in three coordinates up to a degree."""
    return comb(degree + 3, 3)


def values_of(shape: Any, degree: int, places: FloatArray) -> FloatArray:
    """Densities at points ``(..., 3)``."""
    return np.asarray(shape.densities(degree, *(np.array(coordinate) for coordinate in np.moveaxis(places, -1, 0))))


def density_sizes(shape: Any, degree: int) -> FloatArray:
    """Root mean square of the densities inside, ``(n,)``."""
    return np.asarray(np.sqrt(np.mean(values_of(shape, degree, within(shape)) ** 2, axis=1)))


def _monomials(shape: Any, degree: int, places: FloatArray) -> FloatArray:
    """Monomials of coordinates along the principal axes of the region, of order one inside, ``(n, m)``."""
    middle, axes, spread = principal_axes(shape)
    scaled = (places - middle) @ axes / spread
    exponents = np.array([order for total in range(degree + 1) for order in of_total(total)])
    return np.asarray(np.prod(scaled[None] ** exponents[:, None, :], axis=-1))


@check
def check_densities(shape: Any) -> None:
    """Densities up to each degree are independent polynomials of that degree, those of lower degrees first.

    They are the same polynomials inside and outside.
    """
    points = within(shape)
    _, without = sample(shape)
    whole = values_of(shape, DEGREE, points)
    for degree in range(DEGREE + 1):
        count = count_of(degree)
        values = values_of(shape, degree, points)
        ensure_array(
            values,
            (count, len(points)),
            f"densities up to degree {degree} at {len(points)} points",
            "return one row for each density",
            rule="float64 of shape {shape}: (N+1)(N+2)(N+3)/6 densities",
        )
        names = [f"density {row} of degree up to {degree}" for row in range(count)]
        size = np.max(np.abs(values), axis=1, keepdims=True)
        advice = "order the densities by degree, whatever degree is asked for"
        first = "that of the same row where a higher degree is asked for"
        agree(names, values, whole[:count], scale=size, tolerance=1e-12, points=points, rule=first, advice=advice)
        basis = _monomials(shape, degree, points)
        coefficients = np.linalg.lstsq(basis.T, values.T, rcond=None)[0].T
        for places in (points, without.places):
            monomials = _monomials(shape, degree, places)
            expected, scale = coefficients @ monomials, size * np.max(np.abs(monomials), axis=0)
            rule = f"a polynomial of degree {degree}, the same inside and outside"
            advice = "list densities of lower degrees first, and do not cut them off at the boundary"
            agree(names, values_of(shape, degree, places), expected, scale=scale, tolerance=1e-9, points=places,
                  rule=rule, advice=advice)  # fmt: skip
        condition = float(np.linalg.cond(values / np.linalg.norm(values, axis=1, keepdims=True)))
        ensure(
            condition < _INDEPENDENT,
            f"the condition of the densities up to degree {degree} inside",
            f"below {_INDEPENDENT:.0e}: independent, as many as monomials of that degree",
            f"{condition:.1e}",
            "use products that are orthogonal or nearly so, scaled by the lengths of the shape",
        )


@check
def check_densities_arrays(shape: Any) -> None:
    """Answers have shape (n, ...) for 0-d, (1,), (n,), (nz, ny, nx) and no points; the same twice, inputs untouched."""
    points = within(shape)[:12]
    count = count_of(DEGREE)
    expected = values_of(shape, DEGREE, points)
    for form in ((), (1,), (12,), (3, 2, 2), (0,)):
        size = int(np.prod(form))
        answer = values_of(shape, DEGREE, np.resize(points, (12, 3))[:size].reshape((*form, 3)))
        in_a_row = np.resize(expected, (count, 12))[:, :size].reshape((count, *form))
        ensure(
            answer.shape == (count, *form) and np.allclose(answer, in_a_row, rtol=1e-9, atol=1e-12),
            f"densities at points of shape {form}",
            f"of shape {(count, *form)}, the values of the same points in a row",
            f"of shape {answer.shape}",
            "treat every point alike, whatever the shape of the arrays",
        )
    arrays = list(np.ascontiguousarray(points.T))
    ensure_pure(
        "densities", lambda: shape.densities(DEGREE, *arrays), arrays, arguments="the arrays given to densities"
    )


@check
def check_density_rule(shape: Any) -> None:
    """The rule integrates 1, x and x² as lines through contains do, and products of densities as a finer rule does."""
    counts = (DEGREE + 3, DEGREE + 3, 2 * DEGREE + 5)
    grams, moments = [], []
    box = region(shape)
    for times in (1, 2):
        points, weights = (np.asarray(array) for array in shape.density_rule((*(times * count for count in counts),)))
        ensure(
            points.ndim == 2 and points.shape[1:] == (3,) and weights.shape == points.shape[:1],
            "points and weights of density_rule",
            "of shapes (m, 3) and (m,)",
            f"{points.shape} and {weights.shape}",
            "return both as arrays",
        )
        values = values_of(shape, DEGREE, points)
        grams.append((values * weights) @ values.T)
        offset = (points - box.center) / box.half
        moments.append(_second_moments(offset, weights))
    names = [f"the integral of density {row} times another" for row in range(len(grams[0]))]
    agree(
        names,
        grams[0],
        grams[1],
        scale=np.sqrt(np.outer(np.diag(grams[1]), np.diag(grams[1]))),
        tolerance=1e-10,
        points=np.repeat(box.center[None], len(names), axis=0),
        rule=f"that of {2} times as many points",
        advice="use Gauss's rule along the coordinates of the shape, exact for polynomials",
    )
    coarse, fine = (
        _second_moments((rule.nodes - box.center) / box.half, rule.weights) for rule in quadrature_rules(shape)
    )
    doubt = float(np.max(np.abs(coarse - fine))) / fine[0]
    agree(
        ["the volume", *(f"the integral of {'xyz'[axis]}" for axis in range(3)),
         *(f"the integral of {'xyz'[i]} {'xyz'[j]}" for i in range(3) for j in range(i, 3))],
        moments[1][:, None],
        fine[:, None],
        scale=fine[0],
        tolerance=4 * doubt + _MISSED,
        points=box.center[None],
        rule="that over the points that contains accepts, in half edges of bounds from their middle",
        advice="weights must add up to the volume, points must be those of contains",
    )  # fmt: skip


def _second_moments(offset: FloatArray, weights: FloatArray) -> FloatArray:
    """Integrals of 1, x_i and x_i x_j."""
    products = [offset[:, i] * offset[:, j] for i in range(3) for j in range(i, 3)]
    return np.array([weights.sum(), *(weights @ offset), *(weights @ product for product in products)])
