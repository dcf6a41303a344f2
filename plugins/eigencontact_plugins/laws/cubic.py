"""Cubic crystals."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from eigencontact.plugin import (
    Direction,
    FloatArray,
    LinearLaw,
    Stress,
    frame_of,
    hook_for,
    mandel_rotation,
    require,
)

__all__ = ["Cubic"]


_ROUNDING = 1e-9


@dataclass(frozen=True, kw_only=True)
class Cubic(LinearLaw):
    """Cubic crystal.

    Parameters
    ----------
    c11, c12, c44 : float
        Stiffnesses [Pa] in the usual (Voigt) notation: ``c44`` relates shear stress to twice the tensor strain.
        Not negative: c11 - c12, c11 + 2 c12, c44.
    x_axis, y_axis : (float, float, float)
        Directions [100] and [010] of the crystal in scene axes, of any length, at right angles.
    """

    key: ClassVar[str] = "cubic"
    example: ClassVar[dict[str, Any]] = {"c11": "246.5 GPa", "c12": "147.3 GPa", "c44": "124.7 GPa"}
    references: ClassVar[tuple[str, ...]] = ("J. F. Nye 1957, Physical Properties of Crystals, chapter 8",)

    c11: Stress
    c12: Stress
    c44: Stress
    x_axis: Direction = (1.0, 0.0, 0.0)
    y_axis: Direction = (0.0, 1.0, 0.0)

    def __post_init__(self) -> None:
        for name in ("c11", "c12", "c44"):
            require(np.isfinite(getattr(self, name)), self.key, name, getattr(self, name), "finite [Pa]")
        require(self.c44 >= 0, self.key, "c44", self.c44, "zero or positive [Pa]")
        size = abs(self.c11) + abs(self.c12)
        stable = min(self.c11 - self.c12, self.c11 + 2 * self.c12) >= -_ROUNDING * size
        require(stable, self.key, "c12", self.c12, f"between -c11 / 2 and c11 = {self.c11!r} [Pa]")
        frame_of(self.key, self.x_axis, self.y_axis)

    def stiffness_matrix(self) -> FloatArray:
        """See `LinearLaw.stiffness_matrix`."""
        turn = mandel_rotation(frame_of(self.key, self.x_axis, self.y_axis))
        crystal = np.diag([self.c11 - self.c12] * 3 + [2.0 * self.c44] * 3)
        crystal[:3, :3] += self.c12
        return turn @ crystal @ turn.T


eigencontact_register = hook_for(Cubic)
