"""Finite circular cylinder of any orientation."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from eigencontact.plugin import FloatArray, InclusionShape, Length, Place, Row, as_tuple, hook_for, real_points, require

__all__ = ["Cylinder"]

Point = tuple[float, float, float]
AXES: dict[str, Row] = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}

#: Relative distance from the boundary, within which a point lies on it.
SNAP = 1e-13


@dataclass(frozen=True, kw_only=True)
class Cylinder(InclusionShape):
    """Circular cylinder with flat ends.

    Parameters
    ----------
    center : (float, float, float)
        Middle of the axis (x, y, z) [m].
    radius : float
        Radius [m].
    length : float
        Distance between the ends [m].
    axis : "x", "y", "z" or (float, float, float)
        Direction of the axis, of any nonzero length.

    Notes
    -----
    The shape has no potentials: the framework divides it into cuboids with volume fractions.
    """

    key: ClassVar[str] = "cylinder"
    references: ClassVar[tuple[str, ...]] = ("S. Liu & Q. Wang 2005, J. Appl. Mech. 72, 871 (sum over cuboids)",)

    center: Place
    radius: Length
    length: Length
    axis: Literal["x", "y", "z"] | Row = "z"

    def __post_init__(self) -> None:
        for name in ("center", "axis"):
            object.__setattr__(self, name, as_tuple(getattr(self, name)))
        good = np.shape(self.center) == (3,) and bool(np.isfinite(self.center).all())
        require(good, self.key, "center", self.center, "three finite lengths (x, y, z) [m]")
        require(0 < self.radius < np.inf, self.key, "radius", self.radius, "positive and finite [m]")
        require(0 < self.length < np.inf, self.key, "length", self.length, "positive and finite [m]")
        good = self.axis in AXES or (
            not isinstance(self.axis, str)
            and np.shape(self.axis) == (3,)
            and bool(np.isfinite(self.axis).all())
            and bool(np.any(self.axis))
        )
        require(good, self.key, "axis", self.axis, "'x', 'y', 'z' or a direction of three numbers, not all zero")

    @cached_property
    def direction(self) -> FloatArray:
        """Unit vector along the axis."""
        vector = np.array(AXES[self.axis] if isinstance(self.axis, str) else self.axis, dtype=float)
        vector = vector / np.abs(vector).max()
        return np.asarray(vector / np.linalg.norm(vector))

    @property
    def volume(self) -> float:
        """Volume π r² l [m³]."""
        return float(np.pi * self.radius**2 * self.length)

    @property
    def bounds(self) -> tuple[Point, Point]:
        """Corners of lowest and of highest coordinates [m]."""
        u = np.abs(self.direction)
        reach = 0.5 * self.length * u + self.radius * np.sqrt(np.maximum(0.0, (1.0 - u) * (1.0 + u)))
        (x, y, z), (a, b, c) = self.center, (float(v) for v in reach)
        return (x - a, y - b, z - c), (x + a, y + b, z + c)

    def contains(self, x: FloatArray, y: FloatArray, z: FloatArray) -> NDArray[np.bool_]:
        """Whether points lie in the cylinder or on its boundary."""
        x, y, z = real_points(self.key, x, y, z)
        offset = [np.asarray(t, dtype=float) - c for t, c in zip((x, y, z), self.center, strict=True)]
        u, v, w = (float(cosine) for cosine in self.direction)
        along = u * offset[0] + v * offset[1] + w * offset[2]
        p, q, r = (t - along * cosine for t, cosine in zip(offset, (u, v, w), strict=True))
        within = p * p + q * q + r * r <= (self.radius * (1 + SNAP)) ** 2
        return np.asarray(within & (np.abs(along) <= 0.5 * self.length * (1 + SNAP)))


eigencontact_register = hook_for(Cylinder)
