"""Subject of the pictures of a case, and their common settings."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from eigencontact_verification.crosscheck.case import Case, Quantity
    from eigencontact_verification.crosscheck.lines import Contains

__all__ = ["MAP", "MAP_ERROR", "OUTLINE_COLOUR", "OUTLINE_SAMPLES", "Field", "Subject", "elements_in_words", "outline"]

FloatArray = NDArray[np.float64]
Field = Callable[[FloatArray, "Quantity"], FloatArray]

#: How much of the body is shown on each side of the source, in its longest extent.
_AROUND = 1.0
#: Samples of an outline across the shown part.
OUTLINE_SAMPLES = 400
MAP, MAP_ERROR = "viridis", "cividis"
#: Vermilion stands out of both maps.
OUTLINE_COLOUR = "#D55E00"


@dataclass(frozen=True, kw_only=True)
class Subject:
    """Data of the pictures of a case.

    Attributes
    ----------
    contains : callable
        The source; of a traction a thin slab at the surface.
    low, high : (3,) arrays
        Its bounds.
    length, displacement, stress : str
        Units.
    field : callable
        Semi-analytical field.
    samples : int
        Samples of the section across the shown part.
    """

    case: Case
    contains: Contains
    low: FloatArray
    high: FloatArray
    length: str
    displacement: str
    stress: str
    field: Field
    samples: int

    @property
    def size(self) -> float:
        """Longest extent of the source."""
        return float(np.max(self.high - self.low))

    @property
    def window(self) -> tuple[FloatArray, FloatArray]:
        """Corners of the part of the body that is shown; it begins at the surface."""
        low, high = self.low - _AROUND * self.size, self.high + _AROUND * self.size
        low[2] = 0.0
        return low, high


def outline(contains: Contains, normal: int, at: float, sides: Sequence[FloatArray]) -> list[FloatArray]:
    """Where the boundary of the source meets a plane, as lines ``(n, 3)``; `sides` are samples along the other axes."""
    from contourpy import contour_generator
    from scipy.ndimage import gaussian_filter

    s, t = np.meshgrid(*sides)
    place: list[FloatArray] = [s, t]
    place.insert(normal, np.full_like(s, at))
    inside = np.asarray(contains(*place), dtype=float)
    if inside.max() == inside.min():
        return []
    smooth = gaussian_filter(inside, 1.5, mode="nearest")  # a line without the steps of the samples
    lines = contour_generator(x=sides[0], y=sides[1], z=smooth).lines(0.5)
    return [np.insert(np.asarray(line), normal, at, axis=1) for line in lines if len(np.asarray(line)) > 1]


def elements_in_words(solution: Any) -> str:
    """The mesh in words."""
    if hasattr(solution, "nodal"):
        return f"coarse mesh of {solution.grid.elements} hexahedra"
    return f"coarse mesh of {solution.basis.mesh.nelements} axisymmetric elements"
