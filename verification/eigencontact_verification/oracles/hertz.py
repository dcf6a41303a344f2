"""Closed forms of Hertz contact, of its sliding extension, and of Love's uniformly loaded rectangle.

Conventions: z into the body; pressure positive in compression; stress positive in tension; stresses are those of an
elastic half-space under the pressure p = p0 √(1 - r²/a²). Lengths in stress functions are in units of a, stresses in
units of p0. E* is the contact modulus, 1/E* = Σ (1 - ν²)/E over the bodies. Valid for small strains, smooth
frictionless surfaces and contact sizes small beside the radii of curvature.

References
----------
K. L. Johnson 1985, Contact Mechanics, sections 3.4, 4.2 and 7.1 (quoted below as J.);
G. M. Hamilton and L. E. Goodman 1966, doi:10.1115/1.3625051; G. M. Hamilton 1983;
B. C. Carlson's symmetric elliptic integrals R_F, R_D: https://dlmf.nist.gov/19.16.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = [
    "axis_shear_sliding",
    "axis_stress",
    "hertz_ellipse",
    "hertz_sphere",
    "love_centre_displacement",
    "max_von_mises",
    "pressure",
    "surface_stress",
    "surface_von_mises_sliding",
    "trailing_edge_tension",
]

FloatArray = NDArray[np.float64]


def hertz_sphere(load: float, radius: float, contact_modulus: float) -> tuple[float, float, float]:
    """Contact of a sphere of (relative) radius R with a plane under a load P > 0.

    Returns
    -------
    a, p0, approach : float
        Contact radius [m], largest pressure [Pa], approach of distant points [m] (J. eqs. 4.22 to 4.24).
    """
    a = (0.75 * load * radius / contact_modulus) ** (1.0 / 3.0)
    return a, 1.5 * load / (np.pi * a * a), a * a / radius


def hertz_ellipse(
    load: float, radius_x: float, radius_y: float, contact_modulus: float
) -> tuple[float, float, float, float]:
    """Contact of the paraboloid x²/(2 R_x) + y²/(2 R_y) with a plane under a load P > 0.

    Returns
    -------
    a, b, p0, approach : float
        Semi-axes along x and y [m], largest pressure [Pa], approach [m].

    Notes
    -----
    The displacement under the semi-ellipsoidal pressure is a quadratic of x and y (J. section 3.5): with
    R_F = R_F(0, a², b²),

        approach = p0 a b R_F / E*,  1/(2 R_x) = p0 a b R_D(0, b², a²) / (3 E*),  and x <-> y, a <-> b.

    The ratio of the last two gives b/a by bisection; nothing cancels at R_x = R_y. Any ratio from 1e-12 to 1e12.
    """
    from scipy.special import elliprd, elliprf

    def ratio(log_k: float) -> float:  # log(R_x / R_y) of an ellipse with log(b/a) = log_k
        k2 = np.exp(2.0 * log_k)
        return float(np.log(elliprd(0.0, 1.0, k2) / elliprd(0.0, k2, 1.0)))

    goal = np.log(radius_x / radius_y)
    low, high = -30.0, 30.0  # the ratio falls as b/a grows
    for _ in range(200):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if ratio(middle) > goal else (low, middle)
    k = np.exp(0.5 * (low + high))
    # p0 = 3P/(2π a b) turns 1/(2 R_x) = ... into a³ = P R_x R_D(0, k², 1)/(π E*)
    a = float((load * radius_x * elliprd(0.0, k * k, 1.0) / (np.pi * contact_modulus)) ** (1.0 / 3.0))
    b = float(k * a)
    p0 = 1.5 * load / (np.pi * a * b)
    return a, b, p0, float(p0 * a * b * elliprf(0.0, a * a, b * b) / contact_modulus)


def pressure(x: ArrayLike, y: ArrayLike, a: float, b: float, p0: float) -> FloatArray:
    """Semi-ellipsoidal pressure p0 √(1 - x²/a² - y²/b²) [Pa], zero outside the ellipse."""
    inside = 1.0 - np.square(np.asarray(x) / a) - np.square(np.asarray(y) / b)
    return np.asarray(p0 * np.sqrt(np.maximum(0.0, inside)))


def axis_stress(z: ArrayLike, poisson_ratio: float) -> tuple[FloatArray, FloatArray]:
    """Stresses (σ_z, σ_r)/p0 on the axis r = 0 at depth z/a >= 0; σ_θ = σ_r (J. eq. 3.45)."""
    z = np.asarray(z, dtype=float)
    sigma_z = -1.0 / (1.0 + z * z)
    sigma_r = -(1.0 + poisson_ratio) * (1.0 - z * np.arctan2(1.0, z)) - 0.5 * sigma_z
    return sigma_z, sigma_r


def surface_stress(r: ArrayLike, poisson_ratio: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Stresses (σ_r, σ_θ, σ_z)/p0 on the surface at r/a >= 0 (J. eqs. 3.42 and 3.43)."""
    r = np.asarray(r, dtype=float)
    root = np.sqrt(np.maximum(0.0, 1.0 - r * r))
    # (1 - root³)/r² inside without cancellation at r -> 0; 1/r² outside
    share = np.where(r < 1.0, (1.0 + root + root**2) / (1.0 + root), 1.0 / np.maximum(r, 1.0) ** 2)
    radial = (1.0 - 2.0 * poisson_ratio) / 3.0 * share
    return radial - root, -radial - 2.0 * poisson_ratio * root, -root


def max_von_mises(poisson_ratio: float) -> tuple[float, float]:
    """Largest von Mises stress /p0 on the axis below the surface, and its depth z/a; ν from 0 to 0.5.

    Frictionless. On the axis it equals twice the largest shear stress, |σ_z - σ_r|. For small ν it is also the largest
    of the whole body.
    """
    from scipy.optimize import minimize_scalar

    def minus(z: float) -> float:
        sigma_z, sigma_r = axis_stress(z, poisson_ratio)
        return -float(abs(sigma_z - sigma_r))

    minimum = minimize_scalar(minus, bounds=(0.2, 1.0), method="bounded", options={"xatol": 1e-10})
    return -float(minimum.fun), float(minimum.x)


def axis_shear_sliding(z: ArrayLike) -> FloatArray:
    """Shear τ_xz/(μ p0) on the axis at depth z/a >= 0 under the traction q_x = μ p that acts on the body along +x.

    The integral of Cerruti's point solution, -3/2 z ∫_0^1 √(1-r²) r³ (r²+z²)^(-5/2) dr, in closed form; independent
    of ν. On the axis q_x adds no other component: they are odd in x. Rounding error: 1e-16 max(1, z), absolute.
    """
    z = np.asarray(z, dtype=float)
    return np.asarray(-1.5 + 0.5 / (1.0 + z * z) + 1.5 * z * np.arctan2(1.0, z))


def surface_von_mises_sliding(friction: float, poisson_ratio: float) -> float:
    """Von Mises stress /p0 at the centre of the surface under sliding: √((1-2ν)²/4 + 3μ²)."""
    return float(np.hypot(0.5 - poisson_ratio, np.sqrt(3.0) * friction))


def trailing_edge_tension(friction: float, poisson_ratio: float) -> float:
    """Largest tension σ_xx/p0 under sliding, at x = -a for q_x = μp along +x: (1-2ν)/3 + (4+ν)πμ/8 (Hamilton)."""
    return (1.0 - 2.0 * poisson_ratio) / 3.0 + (4.0 + poisson_ratio) * np.pi * friction / 8.0


def love_centre_displacement(
    pressure: float, half_x: float, half_y: float, young_modulus: float, poisson_ratio: float
) -> float:
    """Displacement u_z [m] at the centre of a rectangle |x| <= half_x, |y| <= half_y under uniform pressure [Pa].

    ``4 p (1-ν²)/(π E) (a asinh(b/a) + b asinh(a/b))`` (A. E. H. Love 1929; J. eq. 3.25). Any ratio of the sides.
    """
    lengths = half_x * np.arcsinh(half_y / half_x) + half_y * np.arcsinh(half_x / half_y)
    return float(4.0 * pressure * (1.0 - poisson_ratio**2) / (np.pi * young_modulus) * lengths)
