"""Wear of a sphere in closed form: what fretting and sliding tend to, by the method of dimensionality reduction.

A rigid sphere r²/(2R) is pressed onto an elastic half-space by the approach d and moved to and fro by ±u0 along the
surface. A row of independent springs gives the same loads and contact radii: those at |x| < c stick, those beyond slip
and wear. What sticks never wears; what slips wears until it bears nothing. With like constants of friction everywhere
the springs slip first where ``μ E* (d - x²/R) = G* u0``. All follows from c and d, so

    e = u0 G*/(μ E*) = d - c²/R,     G* = 4 G/(2 - ν),     E*/G* = (2 - ν)/(2 (1 - ν)) on a rigid partner,

the *slipping approach*, stands for friction, amplitude and shear modulus. The shift is uncoupled from the pressure,
and slips across the load are neglected, as in `cattaneo`.

References
----------
V. L. Popov, M. Heß 2015, Method of Dimensionality Reduction in Contact Mechanics and Friction, chapters 3 and 5;
M. Popov, V. L. Popov and others 2014, Limiting shape due to fretting wear in an oscillating tangential contact.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["FrettingLimit", "first_energy", "limit_of_approach", "limits_of_load", "sliding_limit", "slipping_approach"]

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class FrettingLimit:
    """The worn sphere that wears no more.

    Attributes
    ----------
    approach : float
        d [m].
    sphere_radius : float
        R [m].
    stick_radius : float
        c [m], at most √(R d): the radius that touches and bears the load.
    """

    approach: float
    sphere_radius: float
    stick_radius: float

    def profile(self, r: ArrayLike) -> FloatArray:
        """Height [m] of the worn sphere above its tip, ``(2/π) ∫ g(x)/√(r² - x²) dx`` with g = d for x > c."""
        r, c, R, d = np.asarray(r, dtype=float), self.stick_radius, self.sphere_radius, self.approach
        s = np.maximum(r, c)
        asin, root = np.arcsin(c / s), np.sqrt((s - c) * (s + c))
        worn = d - 2.0 / np.pi * ((d - s * s / (2.0 * R)) * asin + c / (2.0 * R) * root)
        return np.asarray(np.where((r > c) & (r < self.outer_radius), worn, r * r / (2.0 * R)))

    def depth(self, r: ArrayLike) -> FloatArray:
        """Worn depth [m]; zero inside c and outside b."""
        return self.profile(r) - np.asarray(r, dtype=float) ** 2 / (2.0 * self.sphere_radius)

    @cached_property
    def outer_radius(self) -> float:
        """Radius b [m] where the worn ring ends: the free surface beside the stick disk meets the sphere."""
        from scipy.optimize import brentq

        c, R, d = self.stick_radius, self.sphere_radius, self.approach

        def over(r: float) -> float:
            asin, root = np.arcsin(c / r), np.sqrt((r - c) * (r + c))
            lift = d - r * r / (2.0 * R)
            return float(lift - 2.0 / np.pi * (lift * asin + c / (2.0 * R) * root))

        # at the Hertz radius the worn surface lies above the sphere; at √(2dR) the sphere lies above the flat
        return float(brentq(over, np.sqrt(R * d), np.sqrt(2.0 * R * d), xtol=1e-15 * c))

    def pressure(self, r: ArrayLike, contact_modulus: float) -> FloatArray:
        """Pressure [Pa] for the contact modulus E* [Pa]; infinite at c, zero beyond."""
        r, c, R = np.asarray(r, dtype=float), self.stick_radius, self.sphere_radius
        root = np.sqrt(np.maximum(0.0, (c - r) * (c + r)))
        with np.errstate(divide="ignore"):
            inside = (self.approach - c * c / R) / root + 2.0 * root / R
        return np.asarray(np.where(r <= c, contact_modulus / np.pi * inside, 0.0))

    def load(self, contact_modulus: float) -> float:
        """Load [N] for the contact modulus E* [Pa]: 2 E* (d c - c³/(3R))."""
        c = self.stick_radius
        return 2.0 * contact_modulus * (self.approach * c - c**3 / (3.0 * self.sphere_radius))

    @cached_property
    def volume(self) -> float:
        """Worn volume [m³], by quadrature."""
        from scipy.integrate import quad

        limits = self.stick_radius, self.outer_radius
        return float(quad(lambda r: 2.0 * np.pi * r * float(self.depth(r)), *limits, epsrel=1e-10, epsabs=0.0)[0])

    @cached_property
    def deepest(self) -> tuple[float, float]:
        """Largest worn depth [m] and its radius [m]."""
        from scipy.optimize import minimize_scalar

        limits = self.stick_radius, self.outer_radius
        minimum = minimize_scalar(lambda r: -float(self.depth(r)), bounds=limits, options={"xatol": 1e-9 * limits[1]})
        return -float(minimum.fun), float(minimum.x)


def slipping_approach(amplitude: float, friction: float, modulus_ratio: float) -> float:
    """Slipping approach e = u0 G*/(μ E*) [m] of the amplitude u0 [m], with the modulus ratio E*/G*."""
    return amplitude / (friction * modulus_ratio)


def limit_of_approach(approach: float, sphere_radius: float, slipping: float) -> FrettingLimit:
    """Limit with the approach d [m] kept.

    Parameters
    ----------
    approach, sphere_radius : float
        d and R [m].
    slipping : float
        e [m] of `slipping_approach`, below d: else all slips, and nothing is left that bears the load.
    """
    stick = float(np.sqrt(sphere_radius * (approach - slipping)))
    return FrettingLimit(approach=approach, sphere_radius=sphere_radius, stick_radius=stick)


def limits_of_load(contact_radius: float, sphere_radius: float, slipping: float) -> tuple[FrettingLimit, FrettingLimit]:
    """Brackets of the limit with the load kept, which has no limit free of history.

    Parameters
    ----------
    contact_radius : float
        a [m] at first, of Hertz: stands for the load.
    sphere_radius, slipping : float
        R and e [m], e below a²/R.

    Returns
    -------
    lower, upper : FrettingLimit
        Lower depth: the stick radius follows d, ``e c + 2 c³/(3R) = 2 a³/(3R)``. Upper depth: it stays at its first
        value, and the sphere sinks until it bears the load alone, ``d c - c³/(3R) = 2 a³/(3R)``.
    """
    from scipy.optimize import brentq

    a, R = contact_radius, sphere_radius
    moved = float(brentq(lambda c: slipping * c + 2.0 / (3.0 * R) * (c**3 - a**3), 0.0, a, xtol=1e-15 * a))
    stayed = float(np.sqrt(a * a - R * slipping))
    sunk = (2.0 * a**3 + stayed**3) / (3.0 * R * stayed)
    return (
        FrettingLimit(approach=slipping + moved**2 / R, sphere_radius=R, stick_radius=moved),
        FrettingLimit(approach=sunk, sphere_radius=R, stick_radius=stayed),
    )


def first_energy(
    contact_radius: float, sphere_radius: float, slipping: float, amplitude: float, friction: float, modulus: float
) -> float:
    """Energy of the first cycle of partial slip [J], 8 μ E* u0 ∫_c^a (d - g)(1 - (d - g)/e) dx with g = x²/R.

    Parameters
    ----------
    contact_radius, sphere_radius, slipping, amplitude : float
        a, R, e, u0 [m].
    friction : float
        μ.
    modulus : float
        E* [Pa].
    """
    a, R = contact_radius, sphere_radius
    c = np.sqrt(a * a - R * slipping)
    # with d = a²/R, ∫ (a² - x²)/R dx and ∫ (a² - x²)²/R² dx from c to a
    first = (a * a * (a - c) - (a**3 - c**3) / 3.0) / R
    second = (a**4 * (a - c) - 2.0 * a * a * (a**3 - c**3) / 3.0 + (a**5 - c**5) / 5.0) / R**2
    return float(8.0 * friction * modulus * amplitude * (first - second / slipping))


def sliding_limit(volume: float, load: float, sphere_radius: float) -> tuple[float, float, float]:
    """Limit of gross sliding where the worn volume V [m³] far exceeds the elastic one.

    Returns
    -------
    radius, pressure, depth : float
        a = (4 R V/π)^(1/4) [m], p = P/(π a²) [Pa], a²/(2R) [m]: a flat cap of the sphere, evenly pressed.
    """
    a = float((4.0 * sphere_radius * volume / np.pi) ** 0.25)
    return a, load / (np.pi * a * a), a * a / (2.0 * sphere_radius)
