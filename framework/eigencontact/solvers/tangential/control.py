"""What is prescribed of a tangential contact: forces or rigid displacements, each mode by itself."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.grid import Grid
from eigencontact.errors import SceneError, require

__all__ = ["MODES", "TangentialControl", "mode_fields"]

FloatArray = NDArray[np.float64]

#: (displacement, force) of each rigid mode of the surface plane.
MODES = (("shift_x", "tangential_load_x"), ("shift_y", "tangential_load_y"), ("twist", "torsion_moment"))


@dataclass(frozen=True, kw_only=True, slots=True)
class TangentialControl:
    """At most one value of each pair is given; a displacement is 0 where neither it nor its force is.

    All are those of body 2 against body 1: a positive shift drags body 1 along +x, so that the shear traction on it is
    positive there.

    Parameters
    ----------
    tangential_load_x, shift_x, tangential_load_y, shift_y : float, optional
        Q_x, Q_y [N] or δ_x, δ_y [m].
    torsion_moment, twist : float, optional
        M_z [N m] or φ_z [rad] about the z axis, positive from x to y.

    Raises
    ------
    SceneError
        Both of a pair, or a number that is not finite.
    """

    tangential_load_x: float | None = None
    shift_x: float | None = None
    tangential_load_y: float | None = None
    shift_y: float | None = None
    torsion_moment: float | None = None
    twist: float | None = None

    def __post_init__(self) -> None:
        for pair in MODES:
            given = [name for name in pair if getattr(self, name) is not None]
            if len(given) == 2:
                raise SceneError(f"step must give {pair[0]} or {pair[1]} (got both); leave one out")
            for name in given:
                require(np.isfinite(getattr(self, name)), "step", name, getattr(self, name), "finite")

    def forces(self) -> dict[int, float]:
        """Prescribed forces by number of mode."""
        values = {i: getattr(self, force) for i, (_, force) in enumerate(MODES)}
        return {i: float(value) for i, value in values.items() if value is not None}

    def displacements(self) -> dict[int, float]:
        """Prescribed rigid displacements by number of mode, 0 where nothing is said."""
        free = self.forces()
        return {i: float(getattr(self, name) or 0.0) for i, (name, _) in enumerate(MODES) if i not in free}


def mode_fields(grid: Grid, components: str) -> FloatArray:
    """Displacement of each unit rigid mode at the cells, ``(3, len(components), ny, nx)``: x, y, rotation (-y, x)."""
    y, x = grid.axes()
    fields = {"x": (1.0, 0.0, -y), "y": (0.0, 1.0, x)}
    return np.stack(
        [np.stack([np.broadcast_to(fields[c][mode], grid.shape) for c in components]) for mode in range(len(MODES))]
    ).astype(float)
