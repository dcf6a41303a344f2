"""Wavy surfaces pressed against a half-space: Westergaard's line waves, full contact of crossed waves.

Conventions: periodic, frictionless; pressure positive in compression; the separation is
``Δ (1 - cos(2πx/λ))`` (or with ``cos(kx x) cos(ky y)``), 0 at the crests; the displacement has zero mean over a
period, so the approach δ is the mean of separation plus displacement less the mean gap. E* is the contact modulus.

References
----------
H. M. Westergaard 1939, J. Appl. Mech. 6, A49; K. L. Johnson 1985, Contact Mechanics, section 13.2 (quoted as J.);
K. L. Johnson, J. A. Greenwood, J. G. Higginson 1985, doi:10.1016/0020-7403(85)90105-8 (crossed waves).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["crossed_full_pressure", "line_approach", "line_half_width", "line_pressure", "line_pressure_to_flatten"]

FloatArray = NDArray[np.float64]


def line_pressure_to_flatten(amplitude: float, wavelength: float, contact_modulus: float) -> float:
    """Mean pressure p* = π E* Δ/λ [Pa] at which contact becomes complete (J. eq. 13.7)."""
    return np.pi * contact_modulus * amplitude / wavelength


def line_half_width(mean_pressure: float, amplitude: float, wavelength: float, contact_modulus: float) -> float:
    """Half width [m] of each contact strip, ``(λ/π) asin √(p̄/p*)``; λ/2 where contact is complete (J. eq. 13.8)."""
    share = mean_pressure / line_pressure_to_flatten(amplitude, wavelength, contact_modulus)
    return float(wavelength / np.pi * np.arcsin(np.sqrt(min(1.0, share))))


def line_pressure(
    x: ArrayLike, mean_pressure: float, amplitude: float, wavelength: float, contact_modulus: float
) -> FloatArray:
    """Pressure [Pa] at x [m] from a crest, for any mean pressure >= 0 (J. eqs. 13.6, 13.7)."""
    full = line_pressure_to_flatten(amplitude, wavelength, contact_modulus)
    phase = np.pi * np.asarray(x, dtype=float) / wavelength
    if mean_pressure >= full:
        return np.asarray(mean_pressure + full * np.cos(2.0 * phase))
    share = mean_pressure / full  # sin²(πa/λ)
    height = np.sqrt(np.maximum(0.0, share - np.sin(phase) ** 2))
    return np.asarray(2.0 * full * np.abs(np.cos(phase)) * height)


def line_approach(mean_pressure: float, amplitude: float, wavelength: float, contact_modulus: float) -> float:
    """Approach δ [m] for zero mean displacement: ``Δ s (1 - ln s)`` with s = p̄/p* up to 1, then Δ.

    From the incremental stiffness of a row of flat punches of half width a, dδ/dp̄ = -(2λ/(π E*)) ln sin(πa/λ) (the
    logarithmic capacity of an arc of half angle 2πa/λ on the unit circle is sin(πa/λ)), integrated over the load.
    """
    share = mean_pressure / line_pressure_to_flatten(amplitude, wavelength, contact_modulus)
    if share <= 0.0:
        return 0.0
    return amplitude if share >= 1.0 else float(amplitude * share * (1.0 - np.log(share)))


def crossed_full_pressure(
    x: ArrayLike,
    y: ArrayLike,
    mean_pressure: float,
    amplitude: float,
    wavenumbers: tuple[float, float],
    contact_modulus: float,
) -> FloatArray:
    """Pressure [Pa] in full contact with ``Δ (1 - cos(kx x) cos(ky y))``: ``p̄ + ½ E* k Δ cos(kx x) cos(ky y)``.

    Valid while it is positive everywhere: ``p̄ >= ½ E* k Δ``, with k² = kx² + ky².
    """
    kx, ky = wavenumbers
    amplitude_p = 0.5 * contact_modulus * np.hypot(kx, ky) * amplitude
    return np.asarray(mean_pressure + amplitude_p * np.cos(kx * np.asarray(x)) * np.cos(ky * np.asarray(y)))
