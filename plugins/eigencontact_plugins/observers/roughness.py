"""Observer of the residual shape of a surface, mostly by plastic strain."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from eigencontact.plugin import Length, Observer, SceneError, StepView, hook_for, require

__all__ = ["Roughness"]


@dataclass(frozen=True, kw_only=True)
class Roughness(Observer):
    """Heights of the surface in a rectangle, by the displacement of eigenstrain.

    Parameters
    ----------
    start, end : (float, float), optional
        Corners (x, y) of the rectangle [m]; the whole window by default.

    Notes
    -----
    The numbers are those of the heights of the cells, positive out of the body: ``mean``; relative to it ``sa``, the
    mean of the magnitudes, and ``sq``, the root mean square; ``sz``, from the lowest to the highest. They exclude the
    elastic displacement by the load.
    """

    key: ClassVar[str] = "roughness"
    units: ClassVar[Mapping[str, str]] = {"mean": "m", "sa": "m", "sq": "m", "sz": "m"}
    references: ClassVar[tuple[str, ...]] = ("ISO 25178-2:2021, sections 4.3.1, 4.3.2 and 4.3.7",)

    start: tuple[Length, Length] | None = None
    end: tuple[Length, Length] | None = None

    def __post_init__(self) -> None:
        corners = [corner for corner in (self.start, self.end) if corner is not None]
        require(len(corners) != 1, self.key, "start", self.start, "given together with end, or neither")
        if self.start is not None and self.end is not None:
            good = all(low < high for low, high in zip(self.start, self.end, strict=True))
            require(good, self.key, "end", self.end, "beyond start along x and y [m]")

    def observe(self, step: StepView) -> Mapping[str, float]:
        """Numbers of the heights; see the notes of the class.

        Raises
        ------
        SceneError
            No eigenstrain displaces the surface, or the rectangle contains no cell.
        """
        if "residual_displacement_z" not in step.fields:
            raise SceneError(f"{self.key} must observe a body with eigenstrain or one that yields (got none)")
        y, x = step.grid.axes()
        heights = -step.fields["residual_displacement_z"]
        if self.start is not None and self.end is not None:
            inside = (x >= self.start[0]) & (x <= self.end[0]) & (y >= self.start[1]) & (y <= self.end[1])
            heights = heights[np.broadcast_to(inside, heights.shape)]
            if not heights.size:
                raise SceneError(
                    f"{self.key}.start and end must contain cells of the window (got {self.start}, {self.end})"
                )
        mean = float(heights.mean())
        return {
            "mean": mean,
            "sa": float(np.abs(heights - mean).mean()),
            "sq": float(np.sqrt(np.mean((heights - mean) ** 2))),
            "sz": float(np.ptp(heights)),
        }


eigencontact_register = hook_for(Roughness)
