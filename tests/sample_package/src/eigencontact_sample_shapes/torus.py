"""Torus with its axis along z, by its indicator alone."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from eigencontact.plugin import InclusionShape, Length, Place, hookimpl, require


@dataclass(frozen=True, kw_only=True)
class Torus(InclusionShape):
    """Ring of circular section, its axis along z.

    Parameters
    ----------
    center : (float, float, float)
        Middle (x, y, z) [m].
    ring_radius : float
        From the middle to the middle of the section [m].
    tube_radius : float
        Of the section [m], smaller than the ring's.
    """

    key: ClassVar[str] = "torus"
    references: ClassVar[tuple[str, ...]] = ("elementary: (rho - R)^2 + z^2 <= r^2",)

    center: Place
    ring_radius: Length
    tube_radius: Length

    def __post_init__(self):
        require(np.all(np.isfinite(self.center)), self.key, "center", self.center, "three finite lengths [m]")
        require(0 < self.ring_radius < np.inf, self.key, "ring_radius", self.ring_radius, "positive and finite [m]")
        rule = f"positive and below ring_radius, {self.ring_radius} [m]"
        require(0 < self.tube_radius < self.ring_radius, self.key, "tube_radius", self.tube_radius, rule)

    @property
    def bounds(self):
        """Corners of lowest and of highest coordinates [m]."""
        x, y, z = self.center
        wide, high = self.ring_radius + self.tube_radius, self.tube_radius
        return (x - wide, y - wide, z - high), (x + wide, y + wide, z + high)

    def contains(self, x, y, z):
        """Whether points lie in the ring."""
        from_axis = np.hypot(x - self.center[0], y - self.center[1])
        return np.hypot(from_axis - self.ring_radius, z - self.center[2]) <= self.tube_radius


@hookimpl
def eigencontact_register():
    """Register the torus."""
    return [Torus]
