"""Rigid modes of two bodies in contact: displacement and work-conjugate force of each."""

from __future__ import annotations

from typing import NamedTuple

__all__ = ["NORMAL_MODES", "TANGENTIAL_MODES", "RigidMode"]


class RigidMode(NamedTuple):
    """Names of a displacement and of its force, in controls, steps of scenes and scalars of results."""

    displacement: str
    force: str


#: Of the approaching body: gap ``h + u - approach - tilt_x y + tilt_y x``.
NORMAL_MODES = (
    RigidMode("approach", "normal_load"), RigidMode("tilt_x", "moment_x"), RigidMode("tilt_y", "moment_y"),
)  # fmt: skip
#: Of body 2 against body 1 along the surface: x, y and the turn (-y, x).
TANGENTIAL_MODES = (
    RigidMode("shift_x", "tangential_load_x"),
    RigidMode("shift_y", "tangential_load_y"),
    RigidMode("twist", "torsion_moment"),
)
