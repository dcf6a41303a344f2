"""Cylinder on a plane, of finite or infinite length."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from eigencontact.plugin import Angle, FloatArray, Geometry, Length, hook_for, require
from eigencontact_plugins.geometries.frame import body_axes, check_angle, check_center, check_length

__all__ = ["Cylinder"]


@dataclass(frozen=True, kw_only=True)
class Cylinder(Geometry):
    """Roller h = ξ²/(2R) with its axis along y, straight over ``length``.

    Parameters
    ----------
    radius : float
        R [m], in the plane across the axis.
    length : float
        L [m], of the straight part, centred; ``"infinite"`` by default.
    end_radius : float
        Radius [m] of the rounding beyond the straight part, as a parabola: h grows by (|η| - L/2)² / (2 end_radius)
        with continuous slope. 0 means sharp ends: there is no surface beyond them, and the separation increases by R +
        L, more than any approach, so that there is no contact. Points on the ends (to 1e-9 L) belong to the surface.
    angle : float
        Rotation of the axis from y towards -x [rad] (the whole body rotates from x towards y).
    center : (float, float)
        Middle of the lowest line (x, y) [m].

    Notes
    -----
    No closed form exists for a finite length: the pressure rises near the ends, without bound if they are sharp.
    """

    key: ClassVar[str] = "cylinder"
    example: ClassVar[dict[str, Any]] = {"radius": "1 mm", "length": "2 mm"}
    references: ClassVar[tuple[str, ...]] = (
        "K. L. Johnson 1985, Contact Mechanics, sec. 4.2, doi:10.1017/CBO9781139171731",
    )

    radius: Length
    length: Length = np.inf
    end_radius: Length = 0.0
    angle: Angle = 0.0
    center: tuple[Length, Length] = (0.0, 0.0)

    def __post_init__(self) -> None:
        check_length(self.key, "radius", self.radius)
        if self.length != np.inf:
            check_length(self.key, "length", self.length)
        rule = "finite and not negative [m] (0: sharp ends)"
        require(0 <= self.end_radius < np.inf, self.key, "end_radius", self.end_radius, rule)
        check_angle(self.key, self.angle)
        check_center(self.key, self.center)

    def separation(self, x: FloatArray, y: FloatArray) -> FloatArray:
        """Separation h(x, y) [m]; 0 on the lowest line."""
        xi, eta = body_axes(x, y, self.center, self.angle)
        overhang = np.maximum(0.0, np.abs(eta) - 0.5 * self.length)
        if self.end_radius > 0:
            end = overhang * (overhang / (2.0 * self.end_radius))
        else:
            end = np.where(overhang > 1e-9 * self.length, self.radius + self.length, 0.0)
        return np.asarray(xi * (xi / (2.0 * self.radius)) + end)


eigencontact_register = hook_for(Cylinder)
