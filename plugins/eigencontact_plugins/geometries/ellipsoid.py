"""Ellipsoid against a plane: a paraboloid with two principal radii of curvature."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from eigencontact.plugin import Angle, FloatArray, Geometry, Length, hook_for
from eigencontact_plugins.geometries.frame import body_axes, check_angle, check_center, check_length

__all__ = ["Ellipsoid", "axis_ratio"]


@dataclass(frozen=True, kw_only=True)
class Ellipsoid(Geometry):
    """Paraboloid h = ξ²/(2 R_x) + η²/(2 R_y) with ξ, η along the axes of the body.

    Parameters
    ----------
    radius_x, radius_y : float
        Principal radii of curvature [m] along ξ and η (of two bodies: the relative ones).
    angle : float
        Rotation of ξ from x towards y [rad].
    center : (float, float)
        Lowest point (x, y) [m].

    Notes
    -----
    Closed form: Hertz, p = p0 √(1 - ξ²/a² - η²/b²), p0 = 3P/(2πab). With k = (minor/major axis), m = 1 - k² and R the
    larger radius: major³ = 3 P R (K(m) - E(m)) / (π E* m) (K. L. Johnson 1985, eqs. 4.28 to 4.32).
    """

    key: ClassVar[str] = "ellipsoid"
    example: ClassVar[dict[str, Any]] = {"radius_x": "1 mm", "radius_y": "2 mm"}
    references: ClassVar[tuple[str, ...]] = ("H. Hertz 1882, doi:10.1515/crll.1882.92.156",)

    radius_x: Length
    radius_y: Length
    angle: Angle = 0.0
    center: tuple[Length, Length] = (0.0, 0.0)

    def __post_init__(self) -> None:
        check_length(self.key, "radius_x", self.radius_x)
        check_length(self.key, "radius_y", self.radius_y)
        check_angle(self.key, self.angle)
        check_center(self.key, self.center)

    def separation(self, x: FloatArray, y: FloatArray) -> FloatArray:
        """Separation h(x, y) [m]; 0 at the centre."""
        xi, eta = body_axes(x, y, self.center, self.angle)
        return np.asarray(xi * (xi / (2.0 * self.radius_x)) + eta * (eta / (2.0 * self.radius_y)))

    def reference_pressure(
        self, x: FloatArray, y: FloatArray, normal_load: float, contact_modulus: float
    ) -> FloatArray:
        """Hertz pressure [Pa] under `normal_load` [N]."""
        from scipy.special import ellipe, ellipkm1

        xi, eta = body_axes(x, y, self.center, self.angle)
        if normal_load <= 0:
            return np.zeros(np.broadcast(xi, eta).shape)
        large, small = max(self.radius_x, self.radius_y), min(self.radius_x, self.radius_y)
        k = axis_ratio(large / small)
        m = (1.0 - k) * (1.0 + k)
        near_circle = 0.25 * np.pi * (1.0 + m * (0.375 + m * 15.0 / 64.0))  # (K - E)/m to 2e-13, without cancellation
        shape = near_circle if m < 1e-4 else (ellipkm1(k * k) - ellipe(m)) / m
        major = (3.0 * normal_load * large * shape / (np.pi * contact_modulus)) ** (1.0 / 3.0)
        a, b = (major, k * major) if self.radius_x >= self.radius_y else (k * major, major)
        peak = 1.5 * normal_load / (np.pi * a * b)
        return np.asarray(peak * np.sqrt(np.maximum(0.0, 1.0 - (xi / a) ** 2 - (eta / b) ** 2)))


def axis_ratio(radius_ratio: float) -> float:
    """Axis ratio k = minor/major of the contact ellipse for a ratio of principal radii >= 1.

    Solves ``radius_ratio = (E/k² - K) / (K - E)``, which is monotonic in k. Its differences lose accuracy for k → 1;
    there ``k = radius_ratio^(-2/3)`` has an error of 3e-3 times the cube of ``radius_ratio - 1``.

    Examples
    --------
    >>> axis_ratio(1.0)
    1.0
    """
    from scipy.optimize import brentq
    from scipy.special import ellipe, ellipkm1

    if radius_ratio - 1.0 < 1e-3:
        return float(radius_ratio ** (-2.0 / 3.0))

    def excess(log_k: float) -> float:
        p = np.exp(2.0 * log_k)
        K, E = ellipkm1(p), ellipe(1.0 - p)
        return float(np.log((E / p - K) / (K - E)) - np.log(radius_ratio))

    # k lies between ratio^(-2/3) (nearly round) and ratio^(-1) (a wide bracket for the slender end)
    return float(np.exp(brentq(excess, -1.01 * np.log(radius_ratio), -0.3 * np.log(radius_ratio), xtol=1e-15)))


eigencontact_register = hook_for(Ellipsoid)
