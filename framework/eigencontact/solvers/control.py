"""Prescribed values: for each rigid mode of the approaching body, its force or its displacement.

Modes and signs are those of the gap ``g = h + u - δ - φx y + φy x``: the approach δ with the normal load P, the tilt
φx with the moment Mx = Σ p y dA, the tilt φy with My = -Σ p x dA (thesis eqs 2.71, 2.72).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from eigencontact.core.array_types import FloatArray
from eigencontact.core.grid import Grid
from eigencontact.core.rigid_modes import NORMAL_MODES as MODES
from eigencontact.core.rigid_modes import RigidMode
from eigencontact.errors import SceneError, require

__all__ = ["MODES", "Control", "PrescribedModes", "mode_field"]


class PrescribedModes:
    """Prescribed force or displacement of each rigid mode; without either the displacement is 0."""

    __slots__ = ()
    modes: ClassVar[Sequence[RigidMode]]

    def check_pairs(self) -> None:
        """Refuse two values for one mode, and numbers that are not finite."""
        for displacement, force in self.modes:
            names = [name for name in (displacement, force) if getattr(self, name) is not None]
            if len(names) == 2:
                raise SceneError(f"step must give {displacement} or {force} (got both); leave one out")
            for name in names:
                require(np.isfinite(getattr(self, name)), "step", name, getattr(self, name), "finite")

    @property
    def prescribed_names(self) -> list[str]:
        """Names of the prescribed forces and displacements."""
        return [name for mode in self.modes for name in mode if getattr(self, name) is not None]

    def forces(self) -> dict[int, float]:
        """Prescribed forces by number of mode."""
        values = {i: getattr(self, mode.force) for i, mode in enumerate(self.modes)}
        return {i: float(value) for i, value in values.items() if value is not None}

    def displacements(self) -> dict[int, float]:
        """Prescribed rigid displacements by number of mode, 0 by default."""
        free = self.forces()
        return {i: float(getattr(self, mode.displacement) or 0.0) for i, mode in enumerate(self.modes) if i not in free}


@dataclass(frozen=True, kw_only=True, slots=True)
class Control(PrescribedModes):
    """Normal control with one value of each pair; a tilt is 0 without tilt and moment.

    Parameters
    ----------
    normal_load, approach : float, optional
        P [N] or δ [m]: exactly one of them.
    moment_x, tilt_x, moment_y, tilt_y : float, optional
        Mx, My [N m] or φx, φy [rad], about the middle of the coordinate system.

    Raises
    ------
    SceneError
        Both or neither of two alternative values, a negative load, or a number that is not finite.
    """

    modes: ClassVar[Sequence[RigidMode]] = MODES

    normal_load: float | None = None
    approach: float | None = None
    moment_x: float | None = None
    tilt_x: float | None = None
    moment_y: float | None = None
    tilt_y: float | None = None

    def __post_init__(self) -> None:
        self.check_pairs()
        if self.normal_load is None and self.approach is None:
            raise SceneError("step must give normal_load [N] or approach [m] (got neither)")
        if self.normal_load is not None:
            require(self.normal_load >= 0, "step", "normal_load", self.normal_load, "zero or positive [N]")


def mode_field(mode: int, grid: Grid) -> FloatArray:
    """Displacement field of a unit rigid mode: 1, y or -x, broadcastable to ``(ny, nx)``."""
    y, x = grid.axes()
    return (np.ones((1, 1)), y, -x)[mode]
