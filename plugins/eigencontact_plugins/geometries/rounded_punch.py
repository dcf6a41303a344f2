"""Flat circular punch with a rounded edge."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from eigencontact.plugin import FloatArray, Length, Revolution, hook_for
from eigencontact_plugins.geometries.frame import check_center, check_length

__all__ = ["RoundedPunch"]


@dataclass(frozen=True, kw_only=True)
class RoundedPunch(Revolution):
    """Flat of radius b, then h = (r - b)² / (2 R) with continuous slope.

    Parameters
    ----------
    flat_radius : float
        b [m].
    edge_radius : float
        R [m] of the rounding, as a parabola.
    center : (float, float)
        Middle of the flat (x, y) [m].

    Notes
    -----
    Closed form: Sneddon's integral with g'(t) = (2 √(t² - b²) - b arccos(b/t)) / R for t > b, else 0. The pressure is
    finite everywhere and largest near the edge of the flat.
    """

    key: ClassVar[str] = "rounded-punch"
    example: ClassVar[dict[str, Any]] = {"flat_radius": "100 um", "edge_radius": "10 um"}
    references: ClassVar[tuple[str, ...]] = (
        "M. Ciavarella 1999, Int. J. Solids Struct. 36, 4149-4181",
        "I. N. Sneddon 1965, doi:10.1016/0020-7225(65)90019-4",
    )

    flat_radius: Length
    edge_radius: Length
    center: tuple[Length, Length] = (0.0, 0.0)

    def __post_init__(self) -> None:
        check_length(self.key, "flat_radius", self.flat_radius)
        check_length(self.key, "edge_radius", self.edge_radius)
        check_center(self.key, self.center)

    @property
    def junction(self) -> float:
        """Radius b [m] at which the rounding begins."""
        return self.flat_radius

    def height(self, r: FloatArray) -> FloatArray:
        """Separation h(r) [m]; 0 on the flat."""
        return np.asarray(np.maximum(0.0, r - self.flat_radius) ** 2 / (2.0 * self.edge_radius))

    def rate(self, t: FloatArray) -> FloatArray:
        """Derivative of the approach; see `Revolution`."""
        b = self.flat_radius
        outer = np.sqrt(np.maximum(0.0, (t - b) * (t + b)))
        return np.asarray((2.0 * outer - b * np.arctan2(outer, b)) / self.edge_radius)


eigencontact_register = hook_for(RoundedPunch)
