"""Observer that reads a surface field at chosen points in every step."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from eigencontact.plugin import Length, Observer, SceneError, StepView, hook_for, require, unit_of

__all__ = ["Probe"]


@dataclass(frozen=True, kw_only=True)
class Probe(Observer):
    """Value of a surface field at points of z = 0.

    Parameters
    ----------
    points : tuple of (float, float)
        Points (x, y) [m] inside the window.
    field : str
        Name of a surface field of the run: ``pressure``, ``gap``, ``displacement_z`` and others.

    Notes
    -----
    Bilinear between cell centres and exact at them; constant in the outer half cell of the window. The numbers are
    ``<field>_1``, ``<field>_2`` ... in the order of the points, in the unit of the field.
    """

    key: ClassVar[str] = "probe"
    example: ClassVar[dict[str, Any]] = {"points": [[0.0, 0.0]]}

    points: tuple[tuple[Length, Length], ...]
    field: str = "pressure"

    def __post_init__(self) -> None:
        pairs = len(self.points) > 0 and all(len(p) == 2 and np.isfinite(p).all() for p in self.points)
        require(pairs, self.key, "points", self.points, "at least one point of two finite lengths (x, y)")
        require(self.field, self.key, "field", self.field, "the name of a surface field")

    @property
    def units(self) -> Mapping[str, str]:
        """See `Observer.units`."""
        return {f"{self.field}_{number}": unit_of(self.field) for number in range(1, len(self.points) + 1)}

    def observe(self, step: StepView) -> Mapping[str, float]:
        """Values at the points, ``{"pressure_1": ...}``.

        Raises
        ------
        SceneError
            The step has no such field, or a point lies outside the window.
        """
        from scipy.ndimage import map_coordinates

        if self.field not in step.fields:
            names = ", ".join(repr(name) for name in sorted(step.fields))
            raise SceneError(f"{self.key}.field must be one of {names} (got {self.field!r})")
        grid = step.grid
        x, y = np.transpose(self.points)
        column = (x - grid.center[0]) / grid.dx + 0.5 * (grid.nx - 1)
        row = (y - grid.center[1]) / grid.dy + 0.5 * (grid.ny - 1)
        position = np.round([row, column], 9)  # in cells; the rounding makes cell centres and window edges exact
        outside = ((position < -0.5) | (position > np.array([[grid.ny], [grid.nx]]) - 0.5)).any(axis=0)
        if outside.any():
            first, (width, depth), (cx, cy) = int(np.argmax(outside)), grid.size, grid.center
            raise SceneError(
                f"{self.key}.points must be inside the window, {width:.6g} m x {depth:.6g} m about ({cx:.6g}, {cy:.6g})"
                f" (got {self.points[first]!r} as point {first + 1}); move the point or enlarge the window"
            )
        values = map_coordinates(step.fields[self.field], position, order=1, mode="nearest")
        return {f"{self.field}_{number}": float(value) for number, value in enumerate(values, start=1)}


eigencontact_register = hook_for(Probe)
