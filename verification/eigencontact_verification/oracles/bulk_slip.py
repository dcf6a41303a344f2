"""Stick and slip of a contact whose bodies are stretched, by dense matrices and Gauss-Seidel sweeps cell by cell.

The pressure is given, and neither pressure nor shear moves the surfaces along the other's direction: like bodies. The
shear q acts on body 1. A cell whose increment of slip s = K (q - q') + o - o' - (d - d') is not zero has the shear
μ p against s; q', o' and d' are those before the increment, o is the displacement of body 1 less body 2 by bulk stress
and d the shift of body 2.

References
----------
V. Cerruti 1882 (point force along the surface); D. Nowell and D. A. Hills 1987, Int. J. Mech. Sci. 29, 355 (line
contact with bulk stress: the stick zone moves by a σ/(4 μ p0)).
"""

from __future__ import annotations

from itertools import product

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["cerruti", "moved_stick_zone", "stretched", "swept"]

FloatArray = NDArray[np.float64]


def moved_stick_zone(strain: float, radius: float, friction: float, pressure: float, modulus: float) -> float:
    """Offset [m] of the stick zone of a line contact of like bodies under a load along x on body 1.

    Parameters
    ----------
    strain : float
        Strain xx of body 1 less that of body 2, small beside that which slips everywhere.
    radius : float
        Half width a [m].
    friction, pressure : float
        μ, and the largest pressure p0 [Pa].
    modulus : float
        E/(1 - ν²) of either body [Pa].
    """
    return strain * modulus * radius / (4.0 * friction * pressure)


def cerruti(x: FloatArray, y: FloatArray, half_widths: tuple[float, float], young: float, nu: float) -> FloatArray:
    """Displacement (2, 2, n) [m/Pa] along x and y by unit shear along x and y on a rectangle, at offsets x, y (n,)."""
    total = np.zeros((2, 2, *np.shape(x)))
    for sign_x, sign_y in product((1.0, -1.0), repeat=2):
        u, v = x + sign_x * half_widths[0], y + sign_y * half_widths[1]
        r, sign = np.hypot(u, v), sign_x * sign_y
        over_x, over_y = v * np.arcsinh(u / np.abs(v)), u * np.arcsinh(v / np.abs(u))
        inverse = over_x + over_y  # integral of 1/r; those of x²/r³ and y²/r³ are its two parts, that of xy/r³ is -r
        total[0, 0] += sign * ((1.0 - nu) * inverse + nu * over_x)
        total[1, 1] += sign * ((1.0 - nu) * inverse + nu * over_y)
        total[0, 1] -= sign * nu * r
    total[1, 0] = total[0, 1]
    return total * (1.0 + nu) / (np.pi * young)


def stretched(x: FloatArray, y: FloatArray, stress: ArrayLike, young: float, nu: float) -> FloatArray:
    """Displacement (2, n) [m] of a half-space at x, y (n,) by bulk stress (xx, yy, xy) [Pa], about the origin."""
    xx, yy, xy = np.asarray(stress, dtype=float)
    shear = (1.0 + nu) * xy / young
    return np.stack([(xx - nu * yy) / young * x + shear * y, shear * x + (yy - nu * xx) / young * y])


def swept(
    compliance: FloatArray, bound: FloatArray, moved: FloatArray, before: FloatArray, *, tolerance: float = 1e-10
) -> FloatArray:
    """Shear (2, n) [Pa] at the end of an increment.

    Parameters
    ----------
    compliance : (2, 2, n, n)
        Displacement by shear, both bodies together [m/Pa].
    bound : (n,)
        μ p [Pa].
    moved : (2, n)
        Change of the bulk displacement less that of the shift [m].
    before : (2, n)
        Shear at the start [Pa].
    tolerance : float
        Largest change of a sweep, in parts of the largest bound.

    Raises
    ------
    RuntimeError
        The sweeps do not converge.
    """
    q = before.copy()
    slip = moved.copy()
    stiffness = 1.0 / np.trace(compliance[:, :, 0, 0])
    for _ in range(20_000):
        largest = 0.0
        for cell, limit in enumerate(bound):
            tried = q[:, cell] - stiffness * slip[:, cell]
            size = np.hypot(*tried)
            change = tried * min(1.0, limit / size if size > 0.0 else 1.0) - q[:, cell]
            q[:, cell] += change
            slip += np.einsum("ijn,j->in", compliance[:, :, :, cell], change)
            largest = max(largest, float(np.abs(change).max()))
        if largest <= tolerance * bound.max():
            return q
    raise RuntimeError(f"no stick and slip found for {bound.size} cells: last change {largest:.1e} Pa")
