"""Cone with a rounded tip."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from eigencontact.plugin import Angle, FloatArray, Length, Revolution, hook_for, require
from eigencontact_plugins.geometries.frame import check_center, check_length

__all__ = ["RoundedCone"]


@dataclass(frozen=True, kw_only=True)
class RoundedCone(Revolution):
    """Parabolic tip h = r²/(2R) up to r = b = R cot α, then the tangent cone of slope cot α.

    Parameters
    ----------
    half_angle : float
        α [rad], between the axis and the flank, as indenters are specified (70.3° for the equivalent of Berkovich's).
        The half-space assumes small slopes, α near π/2.
    tip_radius : float
        R [m] of the tip.
    center : (float, float)
        Tip (x, y) [m].

    Notes
    -----
    Closed form: Sneddon's integral with g'(t) = 2t/R for t <= b, then (2 (t - √(t² - b²)) + b arccos(b/t)) / R. Far
    beyond the tip it tends to the sharp cone, P = (π/2) E* a² cot α.
    """

    key: ClassVar[str] = "rounded-cone"
    example: ClassVar[dict[str, Any]] = {"half_angle": 1.4, "tip_radius": "10 um"}
    references: ClassVar[tuple[str, ...]] = (
        "M. Ciavarella 1999, Int. J. Solids Struct. 36, 4149-4181",
        "I. N. Sneddon 1965, doi:10.1016/0020-7225(65)90019-4",
    )

    half_angle: Angle
    tip_radius: Length
    center: tuple[Length, Length] = (0.0, 0.0)

    def __post_init__(self) -> None:
        require(
            0 < self.half_angle < 0.5 * np.pi,
            self.key,
            "half_angle",
            self.half_angle,
            "between 0 and π/2 [rad], from the axis to the flank",
        )
        check_length(self.key, "tip_radius", self.tip_radius)
        check_center(self.key, self.center)

    @property
    def junction(self) -> float:
        """Radius b [m] of the transition from the tip to the cone."""
        return float(self.tip_radius / np.tan(self.half_angle))

    def height(self, r: FloatArray) -> FloatArray:
        """Separation h(r) [m]; 0 at the tip."""
        tip = np.minimum(r, self.junction)
        return np.asarray((tip * (0.5 * tip) + (r - tip) * self.junction) / self.tip_radius)

    def rate(self, t: FloatArray) -> FloatArray:
        """Derivative of the approach; see `Revolution`."""
        b = self.junction
        outer = np.sqrt(np.maximum(0.0, (t - b) * (t + b)))
        return np.asarray((2.0 * (t - outer) + b * np.arctan2(outer, b)) / self.tip_radius)


eigencontact_register = hook_for(RoundedCone)
