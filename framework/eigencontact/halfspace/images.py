"""Field of a rectangle of the surface that repeats along y.

The rectangle |x| <= a, |y| <= b repeats with the period L, so that it covers the share β = 2b/L of a strip without end.
With K(y) the field of one rectangle, S that of the strip and R that of a long rectangle |y| <= (N + 1/2) L:

    Σ_n K(y + nL)  =  Σ_{|n| <= N} K(y + nL)  +  β (S - R(y))  +  C

C is the end correction: beyond each end of the long rectangle the sum of rectangles differs from the even load by
the sum over k of -L^(2k-1) B_2k(1/2)/(2k)! (1 - β^2k) times the odd derivative of order 2k - 1 of K there, along the
outward direction, with Bernoulli's polynomials (the formula of Euler and Maclaurin, DLMF 2.10.1, at midpoints).
Differences of K at neighbouring images stand for the derivatives, so that C only changes weights of the last images.
The displacement has the free constant of the strip: its mean along y is β times that of the strip.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from math import factorial

import numpy as np

from eigencontact.core.array_types import FloatArray

__all__ = ["image_weights", "repeated"]

#: Images on each side before the end correction, and derivatives that it holds: 10 and 6 leave 2e-11, more than these
#: change nothing any more.
_IMAGES, _ORDER = 14, 8


@cache
def _correction(share: float, order: int) -> FloatArray:
    """Weights c_j of K(N + 1 + j) - K(N - j), ``(order,)``, by which the odd derivatives are met."""
    from scipy.special import bernoulli

    numbers = bernoulli(2 * order)
    powers = 2 * np.arange(1, order + 1)
    # B_n(1/2) = (2^(1-n) - 1) B_n
    terms = [-(2.0 ** (1 - n) - 1.0) * numbers[n] / factorial(n) * (1.0 - share**n) for n in powers]
    places = np.arange(order) + 0.5
    moments = np.array([2.0 * places ** (n - 1) / factorial(n - 1) for n in powers])
    return np.linalg.solve(moments, np.array(terms))


def image_weights(share: float, images: int = _IMAGES, order: int = _ORDER) -> FloatArray:
    """Weights of the images n = 0, 1, ... on each side, ``(images + order + 1,)``.

    Parameters
    ----------
    share : float
        β, the width of the rectangle along y over the period.
    images : int
        N, at least `order` - 1.
    order : int
        Odd derivatives in the end correction.

    Examples
    --------
    >>> image_weights(1.0)[:3].tolist(), image_weights(1.0)[-2:].tolist()  # rectangles that fill the strip
    ([1.0, 1.0, 1.0], [0.0, 0.0])
    """
    weights = np.zeros(images + order + 1)
    weights[: images + 1] = 1.0
    correction = _correction(share, order)
    weights[images + 1 :] += correction
    weights[images + 1 - order : images + 1] -= correction[::-1]
    return weights


def repeated(
    field: Callable[[FloatArray, float], FloatArray],
    y: FloatArray,
    half_width: float,
    period: float,
    strip: FloatArray,
) -> FloatArray:
    """Field of a rectangle that repeats along y.

    Parameters
    ----------
    field : callable
        Field of a rectangle at places y (ny,) [m] from its middle, by its half width along y [m]: ``(..., ny, nx)``.
    y : (ny,)
        Places along y [m].
    half_width : float
        b, half width of the rectangle along y [m].
    period : float
        L, at least 2 b [m].
    strip : (..., 1 or ny, nx)
        Field of the strip of the same width along x.

    Returns
    -------
    (..., ny, nx)
        Per unit traction on the rectangle and its images, in the unit of `field`. Rows of such rectangles that fill
        the strip give its field with an error of 4e-13 of the largest value; sums of 1200 images one by one agree to
        1e-9, the error of those sums.
    """
    share = 2.0 * half_width / period
    if share > 1.0 - 1e-12:  # rectangles that touch are the strip
        return np.asarray(strip + 0.0 * y[:, None])
    total = share * (strip - field(y, (_IMAGES + 0.5) * period))
    for number, weight in enumerate(image_weights(share)):
        for shift in {number * period, -number * period}:
            total = total + weight * field(y + shift, half_width)
    return np.asarray(total)
