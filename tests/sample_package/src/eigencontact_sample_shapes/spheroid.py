"""Spheroid with its axis along z: potentials in closed form, written as formulas and differentiated by jets.

In units of the equatorial radius, with c the polar radius, e2 = 1 - c², s² = c² + λ and λ the confocal coordinate of
a point outside (s = c inside)::

    J(m, n) = ∫ du / ((1 + u)^m (c² + u)^(n + 1/2))  from λ on
    Phi     = π c [J(1,0) - r² J(2,0) - z² J(1,1)]
    Psi,x   = π c x [J(1,0) - J(2,0) - r² (J(2,0) - J(3,0)) - z² (J(1,1) - J(2,1))],  y alike
    Psi,z   = π c z [J(1,0) - c² J(1,1) - r² (J(2,0) - c² J(2,1)) - z² (J(1,1) - c² J(1,2))]

Psi,i = x_i Phi - ∫ x'_i / R, and the integral is the gradient of Ferrers's potential of the density 1 - r² - z²/c².
"""

from dataclasses import dataclass
from functools import partial
from math import factorial
from typing import ClassVar

import numpy as np
from numpy.polynomial import Polynomial
from scipy.special import binom

from eigencontact.plugin import InclusionShape, Jet, Length, Place, derivatives_of, hookimpl, require


@dataclass(frozen=True, kw_only=True)
class Spheroid(InclusionShape):
    """Ellipsoid of revolution about z, oblate or prolate.

    Parameters
    ----------
    center : (float, float, float)
        Middle (x, y, z) [m].
    equatorial_radius, polar_radius : float
        Half its extent across and along z [m]; their ratio is between 1/20 and 20, where the closed form keeps 1e-10.
    """

    key: ClassVar[str] = "spheroid"
    references: ClassVar[tuple[str, ...]] = (
        "N. M. Ferrers 1877, Q. J. Pure Appl. Math. 14, 1-22",
        "J. D. Eshelby 1959, doi:10.1098/rspa.1959.0173",
    )

    center: Place
    equatorial_radius: Length
    polar_radius: Length

    def __post_init__(self):
        require(np.all(np.isfinite(self.center)), self.key, "center", self.center, "three finite lengths [m]")
        for name in ("equatorial_radius", "polar_radius"):
            value = getattr(self, name)
            require(0 < value < np.inf, self.key, name, value, "positive and finite [m]")
        rule = f"between 1/20 and 20 times equatorial_radius, {self.equatorial_radius} [m]"
        ratio = self.polar_radius / self.equatorial_radius
        require(0.05 <= ratio <= 20, self.key, "polar_radius", self.polar_radius, rule)

    @property
    def bounds(self):
        """Corners of lowest and of highest coordinates [m]."""
        (x, y, z), a, c = self.center, self.equatorial_radius, self.polar_radius
        return (x - a, y - a, z - c), (x + a, y + a, z + c)

    def contains(self, x, y, z):
        """Whether points lie in the spheroid."""
        x, y, z = self._scaled(x, y, z)
        return x**2 + y**2 + (z * self.equatorial_radius / self.polar_radius) ** 2 <= 1

    def phi(self, orders, x, y, z):
        """Derivatives of Phi, ``(len(orders), ...)``."""
        return self._differentiate(_phi, 2, orders, x, y, z)

    def psi(self, orders, x, y, z):
        """Derivatives of Psi, ``(len(orders), ...)``."""
        return self._differentiate(_psi, 4, orders, x, y, z)

    def _scaled(self, x, y, z):
        return ((np.asarray(t) - c) / self.equatorial_radius for t, c in zip((x, y, z), self.center, strict=True))

    def _differentiate(self, formula, power, orders, x, y, z):
        """Differentiate one formula inside, one outside, and one far outside where the first would cancel."""
        inside = self.contains(x, y, z)
        x, y, z = self._scaled(x, y, z)
        c = self.polar_radius / self.equatorial_radius
        far = ~inside & (_confocal(x, y, z, c) > 2 * np.sqrt(abs(1 - c * c)))
        out = np.empty((len(orders), *x.shape))
        for where, within in ((inside, True), (~inside & ~far, False), (far, False)):
            out[:, where] = derivatives_of(partial(formula, c, within), orders, x[where], y[where], z[where])
        scale = [self.equatorial_radius ** (power - sum(order)) for order in orders]
        return out * np.array(scale).reshape(-1, *[1] * x.ndim)


def _confocal(x, y, z, c):
    """Polar radius s of the confocal spheroid through a point: r² / (s² + e2) + z² / s² = 1."""
    e2 = 1 - c * c
    b = x * x + y * y + z * z - e2
    return np.sqrt((b + np.sqrt(b * b + 4 * e2 * (z * z))) / 2)


def _integrals(s, e2):
    """J(1,0), J(2,0), J(3,0), J(1,1), J(2,1), J(1,2) for s, a number or a jet."""
    if abs(e2) <= 0.26 * np.min(s.value if isinstance(s, Jet) else s) ** 2:
        return _series(s, e2)
    e, across = np.sqrt(abs(e2)), s * s + e2
    j10 = 2 / e * np.arctan(e / s) if e2 > 0 else np.log((s + e) / (s - e)) / e
    j20 = (j10 / 2 - s / across) / e2
    j30 = (1.5 * j20 - s / (across * across)) / (2 * e2)
    j11 = (2 / s - j10) / e2
    return [j10, j20, j30, j11, (j11 - j20) / e2, (2 / (3 * s * s * s) - j11) / e2]


def _series(s, e2):
    """Give the same in powers of q = e2 / s², which do not cancel where s is large."""
    inverse = 1 / s
    square = inverse * inverse
    fronts = {1: inverse, 3: inverse * square, 5: inverse * square * square}
    q = e2 * square
    powers, k = [1.0], np.arange(36)
    value = q.value if isinstance(q, Jet) else q
    for _ in range(q.order if isinstance(q, Jet) else 0):
        powers.append(powers[-1] * (q - value))
    integrals = []
    for m, n in ((1, 0), (2, 0), (3, 0), (1, 1), (2, 1), (1, 2)):
        series = Polynomial(2 * (-1.0) ** k * binom(m + k - 1, k) / (2 * m + 2 * n + 2 * k - 1))
        taylor = [series.deriv(degree)(value) / factorial(degree) for degree in range(len(powers))]
        total = sum(term * power for term, power in zip(taylor, powers, strict=True))
        integrals.append(fronts[2 * m + 2 * n - 1] * total)
    return integrals


def _phi(c, within, x, y, z):
    j10, j20, _, j11, _, _ = _integrals(c if within else _confocal(x, y, z, c), 1 - c * c)
    return np.pi * c * (j10 - (x * x + y * y) * j20 - z * z * j11)


def _psi(c, within, x, y, z):
    j10, j20, j30, j11, j21, j12 = _integrals(c if within else _confocal(x, y, z, c), 1 - c * c)
    r2, z2, c2 = x * x + y * y, z * z, c * c
    across = np.pi * c * (j10 - j20 - r2 * (j20 - j30) - z2 * (j11 - j21))
    along = np.pi * c * (j10 - c2 * j11 - r2 * (j20 - c2 * j21) - z2 * (j11 - c2 * j12))
    return Jet.from_gradient(0.0, (x * across, y * across, z * along))


@hookimpl
def eigencontact_register():
    """Register the spheroid."""
    return [Spheroid]
