"""Increment of a load step: prescribed values at its end, and its halves."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TypeVar

from eigencontact.core.bulk import NO_BULK
from eigencontact.execution.blocks.step import Step
from eigencontact.execution.blocks.surface import Surface
from eigencontact.solvers.control import MODES as NORMAL_MODES
from eigencontact.solvers.control import Control
from eigencontact.solvers.report import Progress
from eigencontact.solvers.tangential.control import MODES, TangentialControl

__all__ = ["Increment"]

_Control = TypeVar("_Control", Control, TangentialControl)


@dataclass(frozen=True, kw_only=True, slots=True)
class Increment:
    """Path from one accepted state to the next, linear in all prescribed values.

    Attributes
    ----------
    times : (float, float)
        Start and end, in load steps.
    begin : mapping of str to float
        Loads and motions at the start.
    control, tangential : Control, TangentialControl or None
        Prescribed values at the end; None without contact, or without friction.
    surface : Surface
        Surfaces of the contact in this increment.
    progress : callable or None
        Receives the residual of each iteration.
    bulk : two mappings of str to float
        Bulk stress of the bodies at the start and at the end [Pa], by name.
    """

    times: tuple[float, float]
    begin: Mapping[str, float]
    control: Control | None
    tangential: TangentialControl | None
    surface: Surface
    progress: Progress | None
    bulk: tuple[Mapping[str, float], Mapping[str, float]] = (NO_BULK, NO_BULK)

    @classmethod
    def of(cls, step: Step) -> Increment:
        """A whole load step."""
        last = step.previous
        return cls(
            times=(0.0 if last is None else last.time, step.time),
            begin={} if last is None else last.scalars,
            control=step.control,
            tangential=step.tangential,
            surface=step.surface,
            progress=step.progress,
            bulk=step.bulk,
        )

    def at_start(self) -> Increment:
        """Increment without change: its end is its start."""
        return replace(self, times=(self.times[0], self.times[0]), bulk=(self.bulk[0], self.bulk[0]))

    def halves(self) -> tuple[Increment, Increment]:
        """Split the increment at its middle into two increments."""
        start, end = self.times
        middle = 0.5 * (start + end)
        control, normal_values = _middle(self.control, NORMAL_MODES, self.begin)
        tangential, tangential_values = _middle(self.tangential, MODES, self.begin)
        early, late = self.surface.halves()
        before, after = self.bulk
        between = {name: 0.5 * (before[name] + value) for name, value in after.items()}
        first = replace(
            self, times=(start, middle), control=control, tangential=tangential, surface=early, bulk=(before, between)
        )
        return first, replace(
            self, times=(middle, end), begin={**self.begin, **normal_values, **tangential_values}, surface=late,
            bulk=(between, after),
        )  # fmt: skip


def _middle(
    end: _Control | None, modes: tuple[tuple[str, str], ...], begin: Mapping[str, float]
) -> tuple[_Control | None, dict[str, float]]:
    """Control at half of the increment, and its values by name."""
    if end is None:
        return None, {}
    names = [name for pair in modes for name in pair if getattr(end, name) is not None]
    values = {name: 0.5 * (begin.get(name, 0.0) + getattr(end, name)) for name in names}
    return type(end)(**values), values
