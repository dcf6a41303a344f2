"""Sharp wedge with its edge along y."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from eigencontact.plugin import Angle, FloatArray, Geometry, Length, hook_for, require
from eigencontact_plugins.geometries.frame import body_axes, check_angle, check_center

__all__ = ["Wedge"]


@dataclass(frozen=True, kw_only=True)
class Wedge(Geometry):
    """Wedge h = |ξ| cot α, with two flat flanks that meet in an infinite edge along y.

    Parameters
    ----------
    half_angle : float
        α [rad], between the middle plane and a flank. The half-space assumes small slopes, α near π/2.
    angle : float
        Rotation of the edge from y towards -x [rad] (the whole body rotates from x towards y).
    center : (float, float)
        Point of the edge (x, y) [m].

    Notes
    -----
    As a line contact of half width a: p = (E* cot α / π) arcosh(a / |x|) and P = E* a cot α per length. The pressure
    has a logarithmic singularity at the edge, so the largest pressure of a run grows with the number of cells.
    """

    key: ClassVar[str] = "wedge"
    example: ClassVar[dict[str, Any]] = {"half_angle": 1.4}
    references: ClassVar[tuple[str, ...]] = (
        "K. L. Johnson 1985, Contact Mechanics, sec. 5.2, doi:10.1017/CBO9781139171731",
    )

    half_angle: Angle
    angle: Angle = 0.0
    center: tuple[Length, Length] = (0.0, 0.0)

    def __post_init__(self) -> None:
        rule = "between 0 and π/2 [rad], from the middle plane to a flank"
        require(0 < self.half_angle < 0.5 * np.pi, self.key, "half_angle", self.half_angle, rule)
        check_angle(self.key, self.angle)
        check_center(self.key, self.center)

    def separation(self, x: FloatArray, y: FloatArray) -> FloatArray:
        """Separation h(x, y) [m]; 0 on the edge."""
        xi, eta = body_axes(x, y, self.center, self.angle)
        return np.asarray(np.abs(xi) / np.tan(self.half_angle) + 0.0 * eta)


eigencontact_register = hook_for(Wedge)
