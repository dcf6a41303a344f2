"""Where below a point of the surface the material is sheared most, in every step."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from eigencontact.plugin import Length, Observer, hookimpl, require


@dataclass(frozen=True, kw_only=True)
class DeepestShear(Observer):
    """Largest shear stress on a line into a body, and its depth.

    Parameters
    ----------
    depth : float
        Length of the line [m].
    x, y : float
        Where it begins [m].
    points : int
        On the line.
    """

    key: ClassVar[str] = "deepest-shear"
    references: ClassVar[tuple[str, ...]] = ("elementary: half the difference of principal stresses",)
    units: ClassVar[dict[str, str]] = {"shear": "Pa", "depth": "m"}

    depth: Length
    x: Length = 0.0
    y: Length = 0.0
    points: int = 65

    def __post_init__(self):
        require(0 < self.depth < np.inf, self.key, "depth", self.depth, "positive and finite [m]")
        require(np.isfinite(self.x), self.key, "x", self.x, "finite [m]")
        require(np.isfinite(self.y), self.key, "y", self.y, "finite [m]")
        require(self.points > 1, self.key, "points", self.points, "2 or more")

    @property
    def regions(self):
        """The line; its stress is found in every step, and not stored."""
        start, end = (self.x, self.y, self.depth / self.points), (self.x, self.y, self.depth)
        line = {"shape": "line", "start": start, "end": end, "count": self.points, "quantities": ["tresca"]}
        return {"line": line}

    def observe(self, step):
        """Largest shear stress on the line, and the depth where it is."""
        line = step.regions["line"]
        shear = 0.5 * line.fields["tresca"]
        return {"shear": shear.max(), "depth": line.coords["z"][shear.argmax()]}


@hookimpl
def eigencontact_register():
    """Register the observer."""
    return [DeepestShear]
