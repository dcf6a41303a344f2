"""Cross-sections of inclusions, the regions of line contacts."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.array_types import FloatArray
from eigencontact.plugin import InclusionShape

__all__ = ["CrossSection"]

Point = tuple[float, float, float]


@dataclass(frozen=True, kw_only=True)
class CrossSection(InclusionShape):
    """A region without end along y, whose cross-section is that of a solid at y = 0.

    Parameters
    ----------
    solid : InclusionShape
    """

    key: ClassVar[str] = "cross-section"

    solid: InclusionShape

    @property
    def bounds(self) -> tuple[Point, Point]:
        """Corners of lowest and highest coordinates [m]; along y of one metre of length."""
        (x0, _, z0), (x1, _, z1) = self.solid.bounds
        return (x0, -0.5, z0), (x1, 0.5, z1)

    def contains(self, x: FloatArray, y: FloatArray, z: FloatArray) -> NDArray[np.bool_]:
        """Whether points lie in the region."""
        return np.asarray(self.solid.contains(x, np.zeros_like(y), z))
