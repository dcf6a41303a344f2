"""Elasticity by a stiffness matrix."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from eigencontact.plugin import (
    Direction,
    FloatArray,
    LinearLaw,
    Stress,
    checked_stiffness,
    frame_of,
    hook_for,
    mandel_rotation,
)

__all__ = ["GivenStiffness"]


@dataclass(frozen=True, kw_only=True)
class GivenStiffness(LinearLaw):
    """Anisotropic elasticity with a given stiffness matrix.

    Parameters
    ----------
    stiffness : (6, 6)
        Mandel stiffness [Pa] (rows and columns xx, yy, zz, √2 yz, √2 xz, √2 xy: the shear entries of a Voigt matrix
        times 2, its mixed ones times √2): symmetric, without negative eigenvalues; zero is a void.
    x_axis, y_axis : (float, float, float)
        Directions of the axes of the matrix, in scene axes, of any length, at right angles.
    """

    key: ClassVar[str] = "stiffness"
    example: ClassVar[dict[str, Any]] = {"stiffness": [[1e9 * ((i == j) + 0.1) for j in range(6)] for i in range(6)]}
    references: ClassVar[tuple[str, ...]] = ("M. M. Mehrabadi, S. C. Cowin 1990, Q. J. Mech. Appl. Math. 43, 15",)

    stiffness: tuple[tuple[Stress, ...], ...]
    x_axis: Direction = (1.0, 0.0, 0.0)
    y_axis: Direction = (0.0, 1.0, 0.0)

    def __post_init__(self) -> None:
        ragged = len({len(row) for row in self.stiffness}) > 1
        matrix = checked_stiffness(self.key, "stiffness", [[0.0]] if ragged else self.stiffness)
        object.__setattr__(self, "stiffness", tuple(map(tuple, matrix.tolist())))
        frame_of(self.key, self.x_axis, self.y_axis)

    def stiffness_matrix(self) -> FloatArray:
        """See `LinearLaw.stiffness_matrix`."""
        turn = mandel_rotation(frame_of(self.key, self.x_axis, self.y_axis))
        return np.asarray(turn @ np.array(self.stiffness) @ turn.T)


eigencontact_register = hook_for(GivenStiffness)
