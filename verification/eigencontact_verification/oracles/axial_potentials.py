r"""Elastic fields of revolution from two harmonic functions, and the harmonic functions of a ball.

Boussinesq's solution in cylindrical coordinates, with 2 mu = 1 and harmonic phi, psi::

    u = grad(phi + z psi) - 4 (1 - nu) psi e_z

z may be counted from any origin; another one adds a multiple of psi to phi. The functions are ``R_l = rho^l P_l / l!``
and ``I_l = (-d/dz)^l (1/R)``, which is singular at the centre, with ``I_-1 = -ln(R + z)``.

Conventions: z into the body, tension positive; no eigenstrain anywhere.

References
----------
A. I. Lurie 1964, Three-Dimensional Problems of the Theory of Elasticity (Papkovich's and Boussinesq's solutions);
E. W. Hobson 1931, The Theory of Spherical and Ellipsoidal Harmonics (recurrences).
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["fields", "regular", "singular", "sphere_values"]

FloatArray = NDArray[np.float64]


def singular(count: int, r: Any, z: Any, *, logarithm: bool = False) -> NDArray[Any]:
    """Derivatives of ``I_l``, l < count, ``(5, count, ...)``, real or complex; with `logarithm` ``I_-1`` comes first.

    The five are the function itself, (d/dr)/r, d/dz, d²/dz² and (d²/dr dz)/r. ``I_-1`` needs ``z > 0``.
    """
    square = r * r + z * z
    R = np.sqrt(square)
    value, slope = [1 / R], [-1 / (square * R)]
    for l in range(count + 1):
        before = (l * l * value[l - 1], l * l * slope[l - 1]) if l else (0.0, 0.0)
        value.append(((2 * l + 1) * z * value[l] - before[0]) / square)
        slope.append(((2 * l + 1) * z * slope[l] - before[1] - 2 * value[l + 1]) / square)
    if logarithm:
        value.insert(0, -np.log(R + z))
        slope.insert(0, -1 / (R * (R + z)))
    values, slopes = np.array(value), np.array(slope)
    n = count + logarithm
    return np.stack([values[:n], slopes[:n], -values[1 : n + 1], values[2 : n + 2], -slopes[1 : n + 1]])


def regular(count: int, r: FloatArray, z: FloatArray) -> FloatArray:
    """Derivatives of R_0 to R_(count-1), the five of `singular`, ``(5, count, ...)``."""
    square, zero = r * r + z * z, np.zeros_like(r)
    value, slope = [zero, zero, zero + 1.0], [zero, zero, zero]  # those of degree -2 and -1 first
    for l in range(count - 1):
        value.append(((2 * l + 1) * z * value[-1] - square * value[-2]) / (l + 1) ** 2)
        slope.append(((2 * l + 1) * z * slope[-1] - square * slope[-2] - 2 * value[-3]) / (l + 1) ** 2)
    values, slopes = np.array(value), np.array(slope)
    return np.stack([values[2:], slopes[2:], values[1:-1], values[:-2], slopes[1:-1]])


def fields(phi: FloatArray, psi: FloatArray, r: FloatArray, z: FloatArray, nu: float) -> FloatArray:
    """Displacement and stress ``(u_r, u_z, s_rr, s_tt, s_zz, s_rz)`` of derivatives as `singular` gives them.

    Parameters
    ----------
    phi, psi : (5, ...)
        Derivatives of both functions.
    r, z : (...)
        Place; z from the origin of the formula, which need not be that of the functions.
    nu : float
        Poisson's ratio.

    Returns
    -------
    (6, ...)
        With 2 mu = 1.
    """
    hoop = phi[1] + z * psi[1]
    bend = phi[3] + z * psi[3]
    return np.stack(
        [
            r * hoop,
            phi[2] + z * psi[2] - (3 - 4 * nu) * psi[0],
            -bend - hoop - 2 * nu * psi[2],
            hoop - 2 * nu * psi[2],
            bend - 2 * (1 - nu) * psi[2],
            r * (phi[4] + z * psi[4] - (1 - 2 * nu) * psi[1]),
        ]
    )


def sphere_values(field: FloatArray, sine: FloatArray, cosine: FloatArray) -> FloatArray:
    """Displacement and traction ``(u_rho, u_theta, t_rho, t_theta)`` on a sphere, of the six of `fields`.

    The polar angle counts from +z; the traction is that on the outward normal.
    """
    u_r, u_z, s_rr, _, s_zz, s_rz = field
    t_r, t_z = s_rr * sine + s_rz * cosine, s_rz * sine + s_zz * cosine
    return np.stack(
        [u_r * sine + u_z * cosine, u_r * cosine - u_z * sine, t_r * sine + t_z * cosine, t_r * cosine - t_z * sine]
    )
