"""Spheres pressed together and then twisted about their common normal (Lubkin): stick disk, moment, shear.

Notation: K, E complete elliptic integrals of the parameter m(t) = 1 - t²/a²; G = 1/Σ(1/G_i) over the elastic bodies.
The shear on body 1 is ``q = -G d/dr ∫_r^a g(t) (t² - r²)^(-1/2) dt``, the relative displacement inside the contact
``u = (1/r) ∫_0^r t g(t) (r² - t²)^(-1/2) dt`` and the moment ``M = 4πG ∫_0^a t g(t) dt``. Stick (u = φ r) for r < c
needs g = 4φ t/π there, slip (q = μp) for r > c needs g = (2 μ p0/(πG)) t (K - E); g is continuous at c. Then

    G φ a²/(μP) = 3/(4π) (K - E) at c,   M = (16/3) G φ c³ + 8 μ p0 ∫_c^a t² (K - E) dt.

Exact for any elastic constants: torsion neither couples to the pressure nor to other shear. φ grows like the logarithm
of a/c, so that no finite angle makes the whole contact slide.

References
----------
J. L. Lubkin 1951, J. Appl. Mech. 18, 183; K. L. Johnson 1985, Contact Mechanics, section 7.3 (his results in elliptic
integrals); I. N. Sneddon 1966, Mixed Boundary Value Problems (the representation).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["cycle_energy", "initial_stiffness", "moment", "shear", "sliding_moment", "stick_ratio", "twist"]

FloatArray = NDArray[np.float64]


def sliding_moment(friction: float, load: float, radius: float) -> float:
    """Moment of the traction μp, 3π μPa/16 [N m]: the limit for a large angle."""
    return 3.0 * np.pi / 16.0 * friction * load * radius


def initial_stiffness(shear_modulus: float, radius: float) -> float:
    """dM/dφ before slip, 16 G a³/3 [N m]."""
    return 16.0 / 3.0 * shear_modulus * radius**3


def twist(stick: ArrayLike) -> FloatArray:
    """G φ a²/(μP) at a stick radius c/a, above 0 to 1."""
    return np.asarray(0.75 / np.pi * _difference(np.asarray(stick, dtype=float)))


def stick_ratio(angle: float) -> float:
    """c/a at G φ a²/(μP) >= 0; below 1e-30 it is given as that."""
    from scipy.optimize import brentq

    if angle <= 0.0:
        return 1.0
    logarithm = brentq(lambda s: float(twist(np.exp(s))) - angle, -69.0, 0.0, xtol=1e-14) if angle < 16.0 else -69.0
    return float(np.exp(logarithm))


def moment(stick: float) -> float:
    """M/(μPa) at a stick radius c/a, above 0 to 1."""
    from scipy.integrate import quad

    ring = quad(lambda t: t * t * float(_difference(np.asarray(t))), stick, 1.0, epsabs=1e-14, epsrel=1e-12)[0]
    return float(16.0 / 3.0 * twist(stick) * stick**3 + 12.0 / np.pi * ring)


def shear(r: ArrayLike, stick: float) -> FloatArray:
    """Circumferential shear over μ p0 at r/a on first loading: √(1 - r²) for r > c, inside by quadrature.

    Notes
    -----
    Inside, ``q = (2 μ p0 r/π) ∫_c^a E(m(t)) (t² - r²)^(-1/2) dt/t``; with t² = r² + s² the integrand is smooth.
    """
    from scipy.special import ellipe

    r = np.atleast_1d(np.asarray(r, dtype=float))
    nodes, weights = np.polynomial.legendre.leggauss(48)
    low = np.sqrt(np.maximum(0.0, np.maximum(stick, r) ** 2 - r * r))
    high = np.sqrt(np.maximum(0.0, 1.0 - r * r))
    s = 0.5 * (high + low)[:, None] + 0.5 * (high - low)[:, None] * nodes
    square = r[:, None] ** 2 + s * s
    integral = 0.5 * (high - low) * np.sum(weights * ellipe(np.clip(1.0 - square, 0.0, 1.0)) / square, axis=1)
    return np.asarray(np.where(r < stick, 2.0 * r / np.pi * integral, high))


def cycle_energy(stick: float) -> float:
    """Energy of a cycle between ± the angle of c/a, over μ²P²/(G a) (Masing: 8 ∫ M dφ - 4 M φ)."""
    from scipy.integrate import quad

    # dφ = -(3/(4π)) E/t dt along the first loading, in the units of `twist`
    from scipy.special import ellipe

    work = quad(lambda t: moment(t) * 0.75 / np.pi * float(ellipe(1.0 - t * t)) / t, stick, 1.0, epsrel=1e-10)[0]
    return float(8.0 * work - 4.0 * moment(stick) * float(twist(stick)))


def _difference(t: FloatArray) -> FloatArray:
    """K - E of the parameter 1 - t², as (m/3) R_D(0, 1-m, 1): nothing cancels as t -> 1."""
    from scipy.special import elliprd

    square = t * t
    return np.asarray((1.0 - square) / 3.0 * elliprd(0.0, square, 1.0))
