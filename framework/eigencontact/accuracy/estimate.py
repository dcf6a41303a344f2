"""Error of one number from its values on coarser discretisations."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite
from typing import NamedTuple

__all__ = ["Estimate", "estimate"]

#: Factor on an extrapolated error, whose order is observed on three discretisations (Roache 1998: 1.25).
_SAFETY = 1.25
#: The same where the observed order is above the known ones, and the highest of these is assumed (Roache 1998: 3 for an
#: assumed order): differences of one number may be small by chance.
_ASSUMED = 3.0
#: Orders beyond those known by so much still count as observed: three nearby discretisations tell the order poorly.
_SLACK = 0.5
#: Factor on the standard error where no order was observed: two differences of a number that scatters with the place of
#: the cells (contact area, largest value over cells) may both be small. Measured on random scenes, see the page on
#: error bars.
_SCATTER = 3.0
_HIGHEST_ORDER = 8.0


class Estimate(NamedTuple):
    """Error of a number, and the observed order of its decrease; None without an observed order."""

    error: float
    order: float | None


def estimate(
    value: float,
    coarser_values: Sequence[tuple[float, float]],
    lowest: float,
    highest: float,
    *,
    scatters: bool = False,
    mean: bool = False,
    size: float = 1.0,
) -> Estimate:
    """Estimate the error of a value with step size 1.

    Parameters
    ----------
    value : float
        Value of the discretisation in use.
    coarser_values : sequence of (float, float)
        One or two other discretisations, the finer first: step size in units of that of `value`, and the value there.
        The first of two may be finer than `value`.
    lowest, highest : float
        Orders between which the error is known to fall.
    scatters : bool
        Whether no order can be read off two differences, as of an area of cells.
    mean : bool
        Whether the differences are means over many points, and so not small by chance.
    size : float
        Step size of `value`, relative to the run whose error is estimated.

    Returns
    -------
    Estimate
        With an observed order within the known ones (Richardson): the extrapolated error, times a factor of safety.
        With a higher order: the error by the highest known order and the coarsest value, times a larger factor (the
        same factor for a mean).
        Without an order: the largest difference over the sum of both step sizes (to the lowest order), times a factor
        for scatter, or the error by the lowest order, if that is larger.

    Notes
    -----
    Let ``v(h) = v(0) + c h^p``. Then ``v(1) - v(0) = (v(h) - v(1)) / (h^p - 1)``. Two step sizes give the order:
    ``(v(h2) - v(1)) / (v(h1) - v(1)) = (h2^p - 1) / (h1^p - 1)``, which rises with `p`. Errors that scatter on both
    step sizes, ``e(1)`` and ``e(h)`` of about ``s`` and ``s h^p``, differ by up to ``s (1 + h^p)``.

    References
    ----------
    P. J. Roache, Verification and Validation in Computational Science and Engineering, Hermosa, 1998, section 5.6.

    Examples
    --------
    >>> error, order = estimate(1.01, [(1.5, 1.0225), (2.0, 1.04)], 1.0, 2.0)  # of second order, true error 0.01
    >>> f"{error:.4f}, order {order:.2f}"
    '0.0125, order 2.00'
    >>> estimate(1.0, [(1.5, 1.1), (2.0, 0.9)], 1.0, 2.0).order is None
    True
    """
    base_estimate = _of_value(value, coarser_values, lowest, highest, scatters=scatters, mean=mean)
    return base_estimate if size == 1.0 else base_estimate._replace(error=base_estimate.error / size**lowest)


def _of_value(
    value: float,
    coarser_values: Sequence[tuple[float, float]],
    lowest: float,
    highest: float,
    *,
    scatters: bool,
    mean: bool,
) -> Estimate:
    """Error of the value itself; see `estimate`."""
    differences = [(size, abs(coarser_value - value)) for size, coarser_value in coarser_values]
    extrapolated = max(difference / abs(size**lowest - 1.0) for size, difference in differences)
    if len(coarser_values) < 2:
        return Estimate(extrapolated, None)
    (near_size, near_value), (far_size, far_value) = coarser_values
    order = None if scatters else _observed_order(near_size, near_value - value, far_size, far_value - value)
    if order is None or order < lowest - _SLACK:
        scatter = max(difference / (size**lowest + 1.0) for size, difference in differences)
        return Estimate(max(_SCATTER * scatter, extrapolated), None)
    exponent = min(order, highest)
    if order > highest + _SLACK:  # the coarsest is too coarse for its order, and its difference large
        safety = _SAFETY if mean else _ASSUMED
        return Estimate(safety * abs(far_value - value) / (far_size**highest - 1.0), None)
    return Estimate(_SAFETY * abs((near_value - value) / (near_size**exponent - 1.0)), order)


def _observed_order(near_size: float, near_difference: float, far_size: float, far_difference: float) -> float | None:
    """Order from two differences; None if the differences have different signs or do not decrease."""
    if near_difference == 0.0 or not isfinite(far_difference / near_difference):
        return None
    if near_size < 1.0:  # relative to the finest of the three
        near_size, far_size = 1.0 / near_size, far_size / near_size
        near_difference, far_difference = -near_difference, far_difference - near_difference
    quotient = far_difference / near_difference

    def excess(order: float) -> float:
        return float((far_size**order - 1.0) / (near_size**order - 1.0) - quotient)

    low, high = 1e-3, _HIGHEST_ORDER
    if excess(low) > 0.0 or excess(high) < 0.0:
        return None
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if excess(middle) < 0.0 else (low, middle)
    return 0.5 * (low + high)
