"""Ranges of stress intensity factors over a cycle, thresholds of short cracks, and the length of arrest."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from eigencontact.core.array_types import FloatArray

__all__ = ["FactorRanges", "arrest_length", "el_haddad", "factor_ranges", "kitagawa_takahashi", "short_crack_length"]


class FactorRanges(NamedTuple):
    """Ranges over one cycle, ``(lengths,)`` each.

    Attributes
    ----------
    mode_1, mode_2 : array
        Ranges of K_I and K_II [Pa sqrt(m)].
    effective : array
        Both together [Pa sqrt(m)].
    ratio : array
        Smallest over largest K_I [-], NaN where K_I is never positive.
    """

    mode_1: FloatArray
    mode_2: FloatArray
    effective: FloatArray
    ratio: FloatArray


def factor_ranges(factors: FloatArray) -> FactorRanges:
    """Ranges of factors of a cycle.

    Parameters
    ----------
    factors : (2, steps, lengths) float64
        K_I and K_II of faces that do not touch [Pa sqrt(m)].

    Notes
    -----
    A negative K_I closes the tip and counts as zero: ``dK_I`` is the range of ``max(K_I, 0)``, as in ASTM E 647 for
    ratios below zero. K_II counts with its whole range, also while the faces touch: their friction is left out, so
    the range of closed faces is an upper bound. ``dK_eff = sqrt(dK_I^2 + dK_II^2)`` is that of the same energy release
    in plane strain.

    Examples
    --------
    >>> factor_ranges(np.array([[[3.0], [-3.0]], [[2.0], [-2.0]]])).effective.tolist()
    [5.0]
    """
    opening, sliding = factors
    mode_1 = np.ptp(np.maximum(opening, 0.0), axis=0)
    mode_2 = np.ptp(sliding, axis=0)
    largest = opening.max(axis=0)
    ratio = np.divide(opening.min(axis=0), largest, out=np.full(largest.shape, np.nan), where=largest > 0)
    return FactorRanges(mode_1, mode_2, np.hypot(mode_1, mode_2), ratio)


def short_crack_length(long_crack_threshold: float, limit_amplitude: float, shape: float) -> float:
    """Length ``a_0 = (dK_th / (F sigma_0))^2 / pi`` [m] of short cracks, for which the fatigue limit governs.

    Parameters
    ----------
    long_crack_threshold : float
        Threshold range of long cracks [Pa sqrt(m)].
    limit_amplitude : float
        Stress amplitude [Pa] that a smooth specimen endures, fully reversed. It is the tensile part of the range, as
        the range of K_I is.
    shape : float
        Factor F of the crack, ``K = F sigma sqrt(pi a)`` [-].

    References
    ----------
    M. H. El Haddad, T. H. Topper, K. N. Smith, Prediction of non propagating cracks, Eng. Fract. Mech. 11 (1979) 573.

    Examples
    --------
    >>> f"{1e6 * short_crack_length(5e6, 250e6, 1.1215):.1f} um"
    '101.2 um'
    """
    return float((long_crack_threshold / (shape * limit_amplitude)) ** 2 / np.pi)


def el_haddad(lengths: FloatArray, long_crack_threshold: float, short_length: float) -> FloatArray:
    """Threshold range [Pa sqrt(m)] of cracks of all lengths, ``dK_th sqrt(a / (a + a_0))``.

    Examples
    --------
    >>> el_haddad(np.array([1e-4]), 5e6, 3e-4).tolist()
    [2500000.0]
    """
    return np.asarray(long_crack_threshold * np.sqrt(lengths / (lengths + short_length)))


def kitagawa_takahashi(lengths: FloatArray, long_crack_threshold: float, short_length: float) -> FloatArray:
    """Threshold range [Pa sqrt(m)]: the fatigue limit below a_0, ``dK_th sqrt(a / a_0)``, the long crack's above.

    References
    ----------
    H. Kitagawa, S. Takahashi, Applicability of fracture mechanics to very small cracks, Proc. 2nd Int. Conf. on
    Mechanical Behaviour of Materials, Boston (1976) 627.

    Examples
    --------
    >>> kitagawa_takahashi(np.array([1e-4, 4e-4, 9e-4]), 5e6, 4e-4).tolist()
    [2500000.0, 5000000.0, 5000000.0]
    """
    return np.asarray(long_crack_threshold * np.minimum(1.0, np.sqrt(lengths / short_length)))


def arrest_length(lengths: FloatArray, effective: FloatArray, threshold: FloatArray) -> float:
    """Length at which a growing crack stops [m]: 0 if the shortest crack does not grow, infinity if no crack stops.

    Between two lengths the logarithm of range over threshold is linear in the logarithm of the length.

    Examples
    --------
    >>> arrest_length(np.array([1.0, 4.0]), np.array([2.0, 0.5]), np.ones(2))
    2.0
    """
    with np.errstate(divide="ignore"):
        excess = np.log(effective / threshold)
    below = np.flatnonzero(~(excess >= 0))
    if below.size == 0:
        return float("inf")
    after = int(below[0])
    if after == 0:
        return 0.0
    before = excess[after - 1]
    fraction = before / (before - excess[after]) if np.isfinite(excess[after]) else 0.0
    return float(np.exp(np.interp(fraction, [0.0, 1.0], np.log(lengths[after - 1 : after + 1]))))
