"""Surfaces of both bodies for the contact of a step, as one value."""

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
    """Sliding of the whole contact.

    Attributes
    ----------
    distance : float
        Sliding path of body 2 on body 1 [m].
    direction : (float, float)
        Unit vector (x, y) of the sliding of body 2 at the end of the path.
    """

    distance: float
    direction: tuple[float, float]


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Surface:
    """Surfaces of both bodies before contact.

    Blocks change a surface with `dataclasses.replace`. A step, its increments and the contact share one value.

    Attributes
    ----------
    separation : (ny, nx) or None
        Initial gap, worn depth included [m]; None without a contact.
    worn_depths : mapping of int to (ny, nx)
        Worn depth of each body in coordinates of the window [m].
    exposed : (ny, nx) int or None
        Number of the topmost material; None if no law needs it.
    slide : Slide or None
        Sliding of the whole contact; None if the solver computes the slip.
    moved : bool
        Whether the surfaces have changed since the solver computed the last pressure.
    solids : Solids or None
        Solids with the present thickness of worn layers; None if the bodies of the model are unchanged.
    """

    separation: FloatArray | None = None
    worn_depths: Mapping[int, FloatArray] = field(default_factory=dict)
    exposed: NDArray[np.intp] | None = None
    slide: Slide | None = None
    moved: bool = False
    solids: Solids | None = None

    def halves(self) -> tuple[Surface, Surface]:
        """Surfaces of the first and second half of an increment, each with half of the sliding path."""
        slide = None if self.slide is None else replace(self.slide, distance=0.5 * self.slide.distance)
        return replace(self, slide=slide), replace(self, slide=slide, moved=False)
