"""Prescribed values of a tangential contact: a force or a rigid displacement for each mode."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from eigencontact.core.array_types import FloatArray
from eigencontact.core.grid import Grid
from eigencontact.core.rigid_modes import TANGENTIAL_MODES as MODES
from eigencontact.core.rigid_modes import RigidMode
from eigencontact.solvers.control import PrescribedModes

__all__ = ["MODES", "TangentialControl", "mode_fields"]


@dataclass(frozen=True, kw_only=True, slots=True)
class TangentialControl(PrescribedModes):
    """Tangential control with at most one value of each pair; a displacement is 0 without displacement and force.

    All values are those of body 2 relative to body 1: a positive shift moves body 1 along +x, so that the shear
    traction on body 1 is positive.

    Parameters
    ----------
    tangential_load_x, shift_x, tangential_load_y, shift_y : float, optional
        Q_x, Q_y [N] or δ_x, δ_y [m].
    torsion_moment, twist : float, optional
        M_z [N m] or φ_z [rad] about the z axis, positive from x to y.

    Raises
    ------
    SceneError
        Both values of one mode, or a number that is not finite.
    """

    modes: ClassVar[Sequence[RigidMode]] = MODES

    tangential_load_x: float | None = None
    shift_x: float | None = None
    tangential_load_y: float | None = None
    shift_y: float | None = None
    torsion_moment: float | None = None
    twist: float | None = None

    def __post_init__(self) -> None:
        self.check_pairs()


def mode_fields(grid: Grid, components: str) -> FloatArray:
    """Displacement of each unit rigid mode at the cells, ``(3, len(components), ny, nx)``: x, y, rotation (-y, x)."""
    y, x = grid.axes()
    fields = {"x": (1.0, 0.0, -y), "y": (0.0, 1.0, x)}
    return np.stack(
        [np.stack([np.broadcast_to(fields[c][mode], grid.shape) for c in components]) for mode in range(len(MODES))]
    ).astype(float)
