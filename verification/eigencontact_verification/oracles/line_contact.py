"""Closed forms of line contacts in plane strain: cylinder, punch with rounded edges, partial slip, line forces.

Conventions: z into the body; pressure positive in compression, stress positive in tension; loads per length. E* is the
contact modulus, 1/E* = Σ (1 - ν²)/E over the bodies. Valid for small strains and contacts narrow beside the bodies.

References
----------
K. L. Johnson 1985, Contact Mechanics, sections 2.3, 4.2 and 7.2 (quoted below as J.), doi:10.1017/CBO9781139171731;
M. Ciavarella, D. A. Hills, G. Monno 1998, Proc. Inst. Mech. Eng. C 212, 319-328.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = [
    "cattaneo_shear",
    "cattaneo_stick",
    "flamant",
    "hertz_cylinder",
    "hertz_pressure",
    "hertz_stress",
    "rounded_punch_load",
    "rounded_punch_pressure",
    "stress_under",
    "trailing_edge_tension",
    "wedge_half_width",
    "wedge_pressure",
]

FloatArray = NDArray[np.float64]


def hertz_cylinder(load: float, radius: float, contact_modulus: float) -> tuple[float, float]:
    """Half width [m] and largest pressure [Pa] of a cylinder on a plane, under a load per length (J. 4.43, 4.45)."""
    a = float(np.sqrt(4.0 * load * radius / (np.pi * contact_modulus)))
    return a, 2.0 * load / (np.pi * a)


def hertz_pressure(x: ArrayLike, a: float, p0: float) -> FloatArray:
    """Pressure p0 √(1 - x²/a²)."""
    return np.asarray(p0 * np.sqrt(np.maximum(0.0, 1.0 - (np.asarray(x, dtype=float) / a) ** 2)))


def hertz_stress(x: ArrayLike, z: ArrayLike) -> FloatArray:
    """Stress xx, zz, xz under a frictionless cylinder, for a = p0 = 1 and z > 0: McEwen's form (J. 4.49)."""
    x, z = np.broadcast_arrays(np.asarray(x, dtype=float), np.asarray(z, dtype=float))
    inner = 1.0 - x * x + z * z
    root = np.sqrt(inner * inner + 4.0 * x * x * z * z)
    m = np.sqrt(0.5 * (root + inner))
    n = np.sign(x) * np.sqrt(np.maximum(0.0, 0.5 * (root - inner)))
    share = (z * z + n * n) / (m * m + n * n)
    # Johnson's shear has the sign of his z axis; here xz is negative below the right half.
    return np.array([-(m * (1.0 + share) - 2.0 * z), -m * (1.0 - share), -n * (m * m - z * z) / (m * m + n * n)])


def cattaneo_stick(load: float, shear: float, coefficient: float) -> float:
    """Half width of the stick zone by that of the contact: √(1 - Q/(μP))."""
    return float(np.sqrt(1.0 - shear / (coefficient * load)))


def cattaneo_shear(x: ArrayLike, a: float, p0: float, coefficient: float, stick: float) -> FloatArray:
    """Shear of a cylinder in partial slip, monotonic, elastically similar bodies; `stick` as of `cattaneo_stick`."""
    inner = hertz_pressure(x, stick * a, stick * p0)
    return np.asarray(coefficient * (hertz_pressure(x, a, p0) - inner))


def trailing_edge_tension(p0: float, coefficient: float, share: float) -> float:
    """Stress xx at the trailing edge in partial slip, Q = `share` μP: 2 μ p0 √(Q/μP)."""
    return 2.0 * coefficient * p0 * float(np.sqrt(share))


def rounded_punch_load(angle: float) -> float:
    """Load per length P R/(b² E*) of a flat of half width b with parabolic edges of radius R; b = a sin(`angle`)."""
    return float((np.pi - 2.0 * angle - np.sin(2.0 * angle)) / (4.0 * np.sin(angle) ** 2))


def rounded_punch_pressure(x: ArrayLike, angle: float) -> FloatArray:
    """Pressure p b/P of that punch at places x/b within the contact; at x = b it is the limit."""
    inner = np.sin(angle)
    phi = np.arcsin(np.asarray(x, dtype=float) * inner)
    difference = np.where(np.abs(np.abs(phi) - angle) < 1e-12, 1e-12, phi - angle)
    first = np.log(np.abs(np.sin(phi + angle) / np.sin(difference)))
    second = np.log(np.abs(np.tan(0.5 * (phi + angle)) * np.tan(0.5 * difference)))
    free = np.pi - 2.0 * angle
    curve = free * np.cos(phi) + np.sin(phi) * first + np.sin(angle) * second
    return np.asarray(2.0 * inner / (np.pi * (free - np.sin(2.0 * angle))) * curve)


def wedge_half_width(load: float, slope: float, contact_modulus: float) -> float:
    """Half width P / (E* s) [m] of a sharp wedge |x| s on a plane, under a load P per length (J. 5.2)."""
    return load / (contact_modulus * slope)


def wedge_pressure(x0: ArrayLike, x1: ArrayLike, a: float, slope: float, contact_modulus: float) -> FloatArray:
    """Mean pressure [Pa] from x0 to x1 under a wedge of half width a: that of (E* s / π) arcosh(a / |x|) (J. 5.2).

    Its integral from 0 to x is (E* s / π) (x arcosh(a / |x|) + a arcsin(x / a)): the pressure at the edge is infinite,
    and its mean is not.
    """
    low, high = (np.asarray(x, dtype=float) for x in (x0, x1))

    def carried(x: FloatArray) -> FloatArray:
        inside = np.clip(x / a, -1.0, 1.0)
        safe = np.maximum(np.abs(inside), np.finfo(float).tiny)
        return np.asarray(inside * np.arccosh(1.0 / safe) + np.arcsin(inside))

    return np.asarray(contact_modulus * slope * a / np.pi * (carried(high) - carried(low)) / (high - low))


def flamant(x: ArrayLike, z: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Stress xx, zz, xz by a unit line force along z, and along x, at points z > 0 (J. 2.20 and 2.23) [1/m]."""
    x, z = np.broadcast_arrays(np.asarray(x, dtype=float), np.asarray(z, dtype=float))
    products = np.array([x * x, z * z, x * z])
    common = -2.0 / (np.pi * (x * x + z * z) ** 2)
    return common * z * products, common * x * products


def stress_under(
    pressure: Callable[[FloatArray], ArrayLike], shear: Callable[[FloatArray], ArrayLike], x: float, z: float,
    ends: tuple[float, ...], order: int = 400,
) -> FloatArray:  # fmt: skip
    """Stress xx, zz, xz at one point z > 0 by Gauss sums of line forces over the intervals between `ends`.

    The substitution s = middle + half sin θ takes care of root-like ends.
    """
    nodes, weights = np.polynomial.legendre.leggauss(order)
    angles, weights = 0.5 * np.pi * nodes, 0.5 * np.pi * weights
    total = np.zeros(3)
    for low, high in pairwise(ends):
        s = 0.5 * (low + high) + 0.5 * (high - low) * np.sin(angles)
        w = weights * 0.5 * (high - low) * np.cos(angles)
        normal, tangential = flamant(x - s, np.full_like(s, z))
        total += normal @ (w * np.asarray(pressure(s))) + tangential @ (w * np.asarray(shear(s)))
    return total
