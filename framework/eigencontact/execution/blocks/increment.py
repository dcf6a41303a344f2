"""One increment of the load: what is prescribed at its end, and how it is halved."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from eigencontact.execution.blocks.step import Slide, Step
from eigencontact.solvers.control import MODES as NORMAL_MODES
from eigencontact.solvers.control import Control
from eigencontact.solvers.report import Progress
from eigencontact.solvers.tangential.control import MODES, TangentialControl

__all__ = ["Increment"]

FloatArray = NDArray[np.float64]
_Control = TypeVar("_Control", Control, TangentialControl)


@dataclass(frozen=True, kw_only=True, slots=True)
class Increment:
    """From one accepted state to the next, along straight lines.

    Attributes
    ----------
    times : (float, float)
        Start and end, in load steps.
    begin : mapping of str to float
        Loads and motions at the start.
    control, tangential : Control, TangentialControl or None
        What is prescribed at the end; None without contact, or without friction.
    separation : (ny, nx) or None
        Initial separation, worn depth included [m].
    material : (ny, nx) int or None
        What is exposed; None where no law asks.
    worn : mapping of int to (ny, nx)
        Depth that bodies have lost [m].
    slide : Slide or None
        How the surfaces slide all over the contact.
    moved : bool
        Whether the surfaces are others than those that the pressure at the start was found on.
    progress : callable or None
        Told the residual of each iteration.
    """

    times: tuple[float, float]
    begin: Mapping[str, float]
    control: Control | None
    tangential: TangentialControl | None
    separation: FloatArray | None
    material: NDArray[np.intp] | None
    worn: Mapping[int, FloatArray]
    slide: Slide | None
    moved: bool
    progress: Progress | None

    @classmethod
    def of(cls, step: Step) -> Increment:
        """A whole load step."""
        last = step.previous
        return cls(
            times=(0.0 if last is None else last.time, step.time),
            begin={} if last is None else last.scalars,
            control=step.control,
            tangential=step.tangential,
            separation=step.fields.get("separation"),
            material=step.exposed,
            worn=step.worn,
            slide=step.slide,
            moved=step.moved,
            progress=step.progress,
        )

    def at_start(self) -> Increment:
        """Nothing but the start."""
        return replace(self, times=(self.times[0], self.times[0]))

    def halves(self) -> tuple[Increment, Increment]:
        """The first half, and the rest."""
        start, end = self.times
        middle = 0.5 * (start + end)
        control, told = _middle(self.control, NORMAL_MODES, self.begin)
        tangential, along = _middle(self.tangential, MODES, self.begin)
        slide = None if self.slide is None else replace(self.slide, distance=0.5 * self.slide.distance)
        first = replace(self, times=(start, middle), control=control, tangential=tangential, slide=slide)
        return first, replace(
            self, times=(middle, end), begin={**self.begin, **told, **along}, slide=slide, moved=False
        )


def _middle(
    end: _Control | None, modes: tuple[tuple[str, str], ...], begin: Mapping[str, float]
) -> tuple[_Control | None, dict[str, float]]:
    """Control half-way, and its values by name."""
    if end is None:
        return None, {}
    names = [name for pair in modes for name in pair if getattr(end, name) is not None]
    values = {name: 0.5 * (begin.get(name, 0.0) + getattr(end, name)) for name in names}
    return type(end)(**values), values
