"""Flat-ended circular punch, pressed and tilted, on a half-space: closed forms.

Conventions: rigid punch of radius a about the origin, frictionless, in contact over the whole disk; the surface is
pushed in by ``u = δ + φx y - φy x``; the moments are Mx = Σ p y dA and My = -Σ p x dA; E* is the contact modulus.
Valid while the pressure is positive: ``2 a hypot(φx, φy) <= δ``, i.e. centre of pressure within a/3 of the middle.

References
----------
J. Boussinesq 1885; K. L. Johnson 1985, Contact Mechanics, sections 3.4 and 5.1 (pressed);
I. N. Sneddon 1951, Fourier Transforms, section 10.4 (tilted).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["flat_punch_forces", "flat_punch_pressure"]

FloatArray = NDArray[np.float64]


def flat_punch_forces(
    approach: float, tilt_x: float, tilt_y: float, radius: float, contact_modulus: float
) -> tuple[float, float, float]:
    """Return P [N], Mx, My [N m]: ``2 E* a δ``, ``(4/3) E* a³ φx``, ``(4/3) E* a³ φy``."""
    rocking = 4.0 / 3.0 * contact_modulus * radius**3
    return 2.0 * contact_modulus * radius * approach, rocking * tilt_x, rocking * tilt_y


def flat_punch_pressure(
    x: ArrayLike, y: ArrayLike, approach: float, tilt_x: float, tilt_y: float, radius: float, contact_modulus: float
) -> FloatArray:
    """Pressure [Pa] ``E* (δ + 2 φx y - 2 φy x) / (π √(a² - r²))`` inside the disk, zero outside.

    Infinite on the rim r = a.
    """
    x, y = np.broadcast_arrays(np.asarray(x, dtype=float), np.asarray(y, dtype=float))
    inside = radius**2 - x * x - y * y
    root = np.sqrt(np.where(inside > 0, inside, np.inf))
    return np.asarray(contact_modulus * (approach + 2.0 * tilt_x * y - 2.0 * tilt_y * x) / (np.pi * root))
