"""The surfaces that the contact of a step meets, as one value."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.array_types import FloatArray
from eigencontact.model.kernels import Solids

__all__ = ["Slide", "Surface"]


@dataclass(frozen=True, kw_only=True, slots=True)
class Slide:
    """Sliding all over the contact.

    Attributes
    ----------
    distance : float
        Path of body 2 on body 1 [m].
    direction : (float, float)
        Of its end, along x and y, of length 1.
    """

    distance: float
    direction: tuple[float, float]


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Surface:
    """Surfaces of both bodies before contact.

    Blocks change a surface with `dataclasses.replace`: a step, its increments and the contact share one value.

    Attributes
    ----------
    separation : (ny, nx) or None
        Initial gap, lost depth included [m]; None without a contact.
    lost : mapping of int to (ny, nx)
        Depth that bodies have lost, in coordinates of the window [m].
    exposed : (ny, nx) int or None
        Number of the topmost material; None where no law asks for it.
    slide : Slide or None
        Sliding all over the contact; None where the solver computes the slip.
    moved : bool
        Whether the surfaces have changed since the solver computed the last pressure.
    solids : Solids or None
        Solids with layers that have become thinner; None where the bodies are those of the model.
    """

    separation: FloatArray | None = None
    lost: Mapping[int, FloatArray] = field(default_factory=dict)
    exposed: NDArray[np.intp] | None = None
    slide: Slide | None = None
    moved: bool = False
    solids: Solids | None = None

    def halves(self) -> tuple[Surface, Surface]:
        """Surfaces of the first and second half of an increment, each with half of the sliding path."""
        slide = None if self.slide is None else replace(self.slide, distance=0.5 * self.slide.distance)
        return replace(self, slide=slide), replace(self, slide=slide, moved=False)
