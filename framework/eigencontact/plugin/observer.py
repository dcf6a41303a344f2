"""The kind *observer*: sees every accepted step."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.grid import Grid
from eigencontact.plugin.component import Component

__all__ = ["Observer", "StepView"]

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True, slots=True)
class StepView:
    """What an observer sees of an accepted load step. Arrays are read-only.

    Attributes
    ----------
    index : int
        Number of the step, from 1.
    grid : Grid
        Grid of the surface fields.
    fields : mapping of str to (ny, nx) array
        ``pressure`` [Pa], ``gap`` [m], ``displacement_z`` [m] and whatever else the plan provides.
    scalars : mapping of str to float
        ``normal_load`` [N], ``approach`` [m], ``tilt_x``, ``tilt_y`` [rad], ``contact_area`` [m^2] and others.
    """

    index: int
    grid: Grid
    fields: Mapping[str, FloatArray]
    scalars: Mapping[str, float]


class Observer(Component, ABC):
    """Sees every accepted step and returns numbers that are stored with it."""

    kind: ClassVar[str] = "observer"

    @abstractmethod
    def observe(self, step: StepView) -> Mapping[str, float]:
        """Return named numbers (SI units) of this step; the names must not change from step to step."""
