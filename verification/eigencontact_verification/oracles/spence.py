"""Sphere pressed onto an elastic body with friction: the stick disk and the radial shear (Spence, uncoupled).

Goodman's approximation: the pressure is that of Hertz, undisturbed by the shear. While the load grows, stick disk and
contact keep their ratio k = c/a. Every increment of load is that of a flat punch of the present radius, with slip where
r > c. In units of the increment dP, ``dq = -d/dr ∫_r^a χ(t) (t² - r²)^(-1/2) dt`` with

    χ = β/(2π² a) ln((a+t)/(a-t))   (stick, t < c),     χ = μ/(π² a) (t/a) K'(t/a)   (slip, t > c),

and χ is continuous at c: ``ln((1+k)/(1-k))/(2k) = (μ/β) K'(k)``. K' is the complete elliptic integral of the
complementary modulus: parameter 1 - k². The shear on body 1 points outward where β > 0.

β is Dundurs' second constant; (1-2ν)/(2(1-ν)) for a rigid sphere.

References
----------
D. A. Spence 1975, J. Elasticity 5, 297 (with the right side inverted where the formula is quoted as β/μ: c must shrink
to nothing with μ); L. E. Goodman 1962, J. Appl. Mech. 29, 515; K. L. Johnson 1985, Contact Mechanics, section 5.4.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["radial_shear", "stick_ratio"]

FloatArray = NDArray[np.float64]


def stick_ratio(friction_over_beta: float) -> float:
    """c/a at μ/β > 0.

    Below μ/β of 0.05 the disk is smaller than 1e-12 of the contact.
    """
    from scipy.optimize import brentq
    from scipy.special import ellipkm1

    def balance(x: float) -> float:  # k = 1/(1 + e^-x): even resolution at both ends
        k, complement = 1.0 / (1.0 + np.exp(-x)), 1.0 / (1.0 + np.exp(x))
        return float(np.log((1.0 + k) / complement) / (2.0 * k) - friction_over_beta * ellipkm1(k * k))

    x = brentq(balance, -300.0, 300.0, xtol=1e-13)
    return float(1.0 / (1.0 + np.exp(-x)))


def radial_shear(r: ArrayLike, friction_over_beta: float) -> FloatArray:
    """Radial shear traction over β p0 at r/a, outward positive; (μ/β) √(1 - r²) for r > c.

    Notes
    -----
    The increments are added up over the radius b of the growing contact, dP = 3P b² db/a³. A ring at r slips while
    b < r/k, under μ dp; from then on it sticks, ``dq = r χ(b)/b (b²-r²)^(-1/2) - r ∫_r^b (χ/t)' (t²-r²)^(-1/2) dt``,
    by quadrature. Zero at r = 0 and r >= 1; error 1e-12 up to μ/β = 1.5, 1e-5 at 2.
    """
    k = stick_ratio(friction_over_beta)
    r = np.atleast_1d(np.asarray(r, dtype=float))
    # P = 1 and a = 1: p0 = 3/(2π). The slipping part of the history carries μ dp.
    p0 = 1.5 / np.pi
    slipped_until = np.minimum(1.0, r / k)
    total = friction_over_beta * p0 * np.sqrt(np.maximum(0.0, slipped_until**2 - r * r))
    nodes, weights = np.polynomial.legendre.leggauss(40)
    inside = (r < k) & (r > 0)
    low, high = np.log(r[inside]), np.log(k)
    # in s = ln(r/b): dP = 3 b² db = -3 b³ ds, and the increment is dq = rate(r/b)/b² dP
    # the rate has a logarithm at x = k: nodes gather there
    share = 0.5 * (nodes + 1.0)
    s = high - (high - low)[:, None] * share**4
    rate = _stick_rate(np.exp(s), k, friction_over_beta)
    history = 3.0 * r[inside, None] * np.exp(-s) * rate
    total[inside] += 0.5 * (high - low) * (history @ (4.0 * share**3 * weights))
    return np.asarray(np.where(r < 1.0, total / p0, 0.0))


def _stick_rate(x: FloatArray, k: float, ratio: float) -> FloatArray:
    """dq/dP over β at r = x b inside the stick disk, for b = 1."""
    from scipy.special import ellipe, ellipk

    nodes, weights = np.polynomial.legendre.leggauss(48)
    x = x[..., None]
    total = ratio / (2.0 * np.pi) * x / np.sqrt(1.0 - x * x)
    for start, stop in ((x, k), (np.full_like(x, k), 1.0)):
        low, high = np.sqrt(np.maximum(0.0, start**2 - x * x)), np.sqrt(np.maximum(0.0, stop**2 - x * x))
        s = 0.5 * (high + low) + 0.5 * (high - low) * nodes
        t = np.sqrt(x * x + s * s)
        if stop == k:  # (χ/t)' of stick
            logarithm = np.log((1.0 + t) / (1.0 - t))
            slope = (2.0 / (t * (1.0 - t * t)) - logarithm / t**2) / (2.0 * np.pi**2)
        else:  # (χ/t)' of slip: d/dt K(1-t²) = (t² K - E)/(t (1-t²))
            m = 1.0 - t * t
            slope = ratio / np.pi**2 * (t * t * ellipk(m) - ellipe(m)) / (t * m)
        total -= x * 0.5 * (high - low) * np.sum(weights * slope / t, axis=-1, keepdims=True)
    return np.asarray(total[..., 0])
