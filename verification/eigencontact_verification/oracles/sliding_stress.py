"""Stress under a sphere that slides: Hertz pressure p and the shear traction q_x = μp on the same disk.

Conventions: z into the body, lengths in units of a, stresses in units of p0, tension positive, plain tensor components
in the order xx, yy, zz, yz, xz, xy. q_x acts on the body along +x; the trailing edge, in tension, is x = -a.

Closed forms on the surface inside the contact and on the axis; anywhere in z > 0 by quadrature of the point forces of
Boussinesq and Cerruti, which the closed forms are checked against.

The surface follows from the displacement by ``q_x = q0 √(1 - r²)``, which is quadratic (Johnson eq. 3.91 without the
rigid part): ``32 G u_x/(π q0) = 4(2-ν) - (4-3ν) x² - (4-ν) y²``, ``32 G u_y/(π q0) = 2ν x y``, and plane stress there.

References
----------
G. M. Hamilton 1983, Proc. Inst. Mech. Eng. C 197, 53; G. M. Hamilton, L. E. Goodman 1966, doi:10.1115/1.3625051;
K. L. Johnson 1985, Contact Mechanics, sections 3.6 and 7.1.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eigencontact_verification.oracles.boussinesq import point_force

__all__ = ["axis", "by_quadrature", "surface_inside", "von_mises"]

FloatArray = NDArray[np.float64]


def surface_inside(x: ArrayLike, y: ArrayLike, friction: float, poisson_ratio: float) -> FloatArray:
    """Stress ``(6, ...)`` on the surface z = 0+ for x² + y² <= 1."""
    x, y = np.broadcast_arrays(np.asarray(x, dtype=float), np.asarray(y, dtype=float))
    nu, square = poisson_ratio, x * x + y * y
    root = np.sqrt(np.maximum(0.0, 1.0 - square))
    # σ_r, σ_θ of the pressure, J. eq. 3.42: mean -(1+2ν)/2 p and deviator; (1 - root³)/r² kept finite at r = 0
    share = (1.0 - 2.0 * nu) / 3.0 * (1.0 + root + root**2) / (1.0 + root)
    radial, hoop = share - root, -share - 2.0 * nu * root
    safe = np.where(square > 0.0, square, 1.0)
    cosine2, product = np.where(square > 0.0, x * x / safe, 0.5), x * y / safe
    xx = radial * cosine2 + hoop * (1.0 - cosine2)
    yy = radial * (1.0 - cosine2) + hoop * cosine2
    xy = (radial - hoop) * product
    shear = friction * np.pi / 8.0
    zero = np.zeros(x.shape)
    return np.array(
        [
            xx - shear * (4.0 + nu) * x,
            yy - shear * 3.0 * nu * x,
            -root,
            zero,
            -friction * root,
            xy - shear * (2.0 - nu) * y,
        ]
    )


def axis(z: ArrayLike, friction: float, poisson_ratio: float) -> FloatArray:
    """Stress ``(6, ...)`` at the depth z >= 0 below the centre; the shear adds xz alone."""
    z = np.asarray(z, dtype=float)
    angle = np.arctan2(1.0, z)
    zz = -1.0 / (1.0 + z * z)
    rr = -(1.0 + poisson_ratio) * (1.0 - z * angle) - 0.5 * zz
    xz = friction * (-1.5 - 0.5 * zz + 1.5 * z * angle)
    zero = np.zeros(z.shape)
    return np.array([rr, rr, zz, zero, xz, zero])


def by_quadrature(
    point: tuple[float, float, float], friction: float, poisson_ratio: float, order: int = 64
) -> FloatArray:
    """Stress ``(6,)`` at a point with z > 0 (from about 1e-3 on to 1e-9 and better), in the disk's shadow or not.

    Polar coordinates about the foot of the point. Inside the disk: ``distance = z sinh t`` for the near half of each
    ray, and the root of the pressure at the rim taken off by a square in the far half. Outside: chords, with the sine
    substitution along the chord and across the chords.
    """
    x, y, z = point
    nodes, weights = np.polynomial.legendre.leggauss(order)
    unit, half = 0.5 * (nodes + 1.0), 0.5 * weights
    rho = float(np.hypot(x, y))
    if rho < 1.0:
        # trapezoidal in the angle, which is periodic; more of them where the foot is near the rim
        count = int(6 * order / max(0.05, 1.0 - rho) ** 0.5)
        angles, angle_weight = 2.0 * np.pi * np.arange(count) / count, np.full(count, 2.0 * np.pi / count)
        reach = _exit(x, y, angles)
        middle = 0.5 * reach
        top = np.arcsinh(middle / z)
        near = z * np.sinh(top[:, None] * unit)
        near_weight = top[:, None] * half * z * np.cosh(top[:, None] * unit)
        far = reach[:, None] - middle[:, None] * unit**2
        far_weight = middle[:, None] * 2.0 * unit * half
        distance = np.concatenate([near, far], axis=1)
        weight = np.concatenate([near_weight, far_weight], axis=1)
    else:
        swing = 0.5 * np.pi * nodes  # angle = asin(sin(swing)/rho): the ends of the chords close like a root
        angles = np.arctan2(-y, -x) + np.arcsin(np.sin(swing) / rho)
        angle_weight = 0.5 * np.pi * weights * np.cos(swing) / np.sqrt(rho**2 - np.sin(swing) ** 2)
        centre = rho * np.sqrt(1.0 - (np.sin(swing) / rho) ** 2)
        chord = np.cos(swing)
        distance = centre[:, None] + chord[:, None] * np.sin(0.5 * np.pi * nodes)
        weight = chord[:, None] * 0.5 * np.pi * weights * np.cos(0.5 * np.pi * nodes)
    dx, dy = distance * np.cos(angles)[:, None], distance * np.sin(angles)[:, None]
    pressure = np.sqrt(np.maximum(0.0, 1.0 - (x + dx) ** 2 - (y + dy) ** 2))
    depth = np.full(dx.shape, z)
    # the source lies at the foot + (dx, dy), so that field point less source is (-dx, -dy)
    total = point_force("p", -dx, -dy, depth, poisson_ratio)[3:]
    if friction:
        total = total + friction * point_force("q_x", -dx, -dy, depth, poisson_ratio)[3:]
    return np.asarray(np.einsum("cij,ij,i->c", total, pressure * weight * distance, angle_weight))


def von_mises(stress: ArrayLike) -> FloatArray:
    """Von Mises stress of plain components ``(6, ...)``."""
    xx, yy, zz, yz, xz, xy = np.asarray(stress, dtype=float)
    normal = (xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2
    return np.asarray(np.sqrt(0.5 * normal + 3.0 * (yz**2 + xz**2 + xy**2)))


def _exit(x: float, y: float, angles: FloatArray) -> FloatArray:
    """Distance from a point inside the unit disk to its rim along rays."""
    along = x * np.cos(angles) + y * np.sin(angles)
    return np.asarray(-along + np.sqrt(1.0 - (x * x + y * y) + along**2))
