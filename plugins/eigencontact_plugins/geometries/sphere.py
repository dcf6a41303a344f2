"""Sphere against a plane: parabola of the half-space theory, or the exact circle."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Literal

import numpy as np

from eigencontact.plugin import FloatArray, Length, Revolution, hook_for, require
from eigencontact_plugins.geometries.frame import body_axes, check_center, check_length

__all__ = ["Sphere"]


@dataclass(frozen=True, kw_only=True)
class Sphere(Revolution):
    """Sphere, or two spheres by their relative radius 1/R = 1/R1 + 1/R2.

    Parameters
    ----------
    radius : float
        R [m].
    profile : "parabola" or "circle"
        ``parabola``: h = r²/(2R), as in Hertz's theory; it differs from the circle by r⁴/(8R³). ``circle``: h = R -
        √(R² - r²), for contacts that are not small compared with R (the half-space remains an approximation for small
        slopes). Beyond r = R the sphere has no surface; the separation continues as h = r, which is at least R and out
        of reach of the contact.
    center : (float, float)
        Lowest point (x, y) [m].

    Notes
    -----
    Closed form: Hertz for the parabola, p = p0 √(1 - r²/a²); for the circle Sneddon's g'(t) = artanh(t/R)
    + tR/(R² - t²), which tends to Hertz for a/R → 0 (load at equal a: 1 + 2a²/(5R²) + ... times Hertz's). It is NaN for
    loads above about 20 E* R², which require a > R.

    Examples
    --------
    >>> Sphere(radius=2.0).separation(np.array([0.0, 1.0]), np.array([0.0, 0.0])).tolist()
    [0.0, 0.25]
    """

    key: ClassVar[str] = "sphere"
    example: ClassVar[dict[str, Any]] = {"radius": "1 mm"}
    references: ClassVar[tuple[str, ...]] = (
        "H. Hertz 1882, doi:10.1515/crll.1882.92.156",
        "I. N. Sneddon 1965, doi:10.1016/0020-7225(65)90019-4",
    )

    radius: Length
    profile: Literal["parabola", "circle"] = "parabola"
    center: tuple[Length, Length] = (0.0, 0.0)

    def __post_init__(self) -> None:
        check_length(self.key, "radius", self.radius)
        require(self.profile in ("parabola", "circle"), self.key, "profile", self.profile, "'parabola' or 'circle'")
        check_center(self.key, self.center)

    def height(self, r: FloatArray) -> FloatArray:
        """Separation h(r) [m]; 0 at the centre."""
        R = self.radius
        if self.profile == "parabola":
            return np.asarray(r * (r / (2.0 * R)))
        inside = np.minimum(r, R)  # the next line is R - √(R² - r²) without cancellation
        return np.asarray(np.where(r < R, inside**2 / (R + np.sqrt((R - inside) * (R + inside))), r))

    def rate(self, t: FloatArray) -> FloatArray:
        """Derivative of the approach; see `Revolution`."""
        R = self.radius
        if self.profile == "parabola":
            return np.asarray(2.0 * t / R)
        return np.asarray(np.arctanh(t / R) + t * R / ((R - t) * (R + t)))

    @property
    def limit(self) -> float:
        """Radius [m] at which the surface of a sphere is vertical."""
        return np.inf if self.profile == "parabola" else self.radius

    def reference_pressure(
        self, x: FloatArray, y: FloatArray, normal_load: float, contact_modulus: float
    ) -> FloatArray:
        """Closed-form pressure [Pa] under `normal_load` [N]; see the notes of the class."""
        if self.profile == "circle" or normal_load <= 0:
            return super().reference_pressure(x, y, normal_load, contact_modulus)
        r, R = np.hypot(*body_axes(x, y, self.center)), self.radius
        a = (0.75 * normal_load * R / contact_modulus) ** (1.0 / 3.0)
        peak = 2.0 * contact_modulus * a / (np.pi * R)
        return np.asarray(peak * np.sqrt(np.maximum(0.0, 1.0 - (r / a) ** 2)))


eigencontact_register = hook_for(Sphere)
