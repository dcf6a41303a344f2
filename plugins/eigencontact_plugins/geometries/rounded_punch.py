"""Flat circular punch with a rounded edge."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np
from numpy.typing import NDArray

from eigencontact.plugin import Geometry, Length, hookimpl
from eigencontact_plugins.geometries.frame import body_axes, check_center, check_length
from eigencontact_plugins.geometries.revolution import contact_radius, revolution_pressure

if TYPE_CHECKING:
    from collections.abc import Iterable

__all__ = ["RoundedPunch"]

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class RoundedPunch(Geometry):
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

    def separation(self, x: FloatArray, y: FloatArray) -> FloatArray:
        """Separation h(x, y) [m]; 0 on the flat."""
        r = np.hypot(*body_axes(x, y, self.center))
        return np.asarray(np.maximum(0.0, r - self.flat_radius) ** 2 / (2.0 * self.edge_radius))

    def reference_pressure(
        self, x: FloatArray, y: FloatArray, normal_load: float, contact_modulus: float
    ) -> FloatArray:
        """Closed-form pressure [Pa] under `normal_load` [N]; see the notes of the class."""
        r = np.hypot(*body_axes(x, y, self.center))
        if normal_load <= 0:
            return np.zeros(r.shape)
        b, R = self.flat_radius, self.edge_radius

        def rate(t: FloatArray) -> FloatArray:
            beyond = np.sqrt(np.maximum(0.0, (t - b) * (t + b)))
            return np.asarray((2.0 * beyond - b * np.arctan2(beyond, b)) / R)

        a = contact_radius(rate, normal_load, contact_modulus, junction=b)
        return revolution_pressure(r, rate, a, contact_modulus, junction=b)


@hookimpl
def eigencontact_register() -> Iterable[type[Geometry]]:
    """Register the rounded punch."""
    return [RoundedPunch]
