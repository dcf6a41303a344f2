"""Load step during its computation: prescribed values, previous step, and results of the blocks."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from eigencontact.core.array_types import FloatArray
from eigencontact.core.bulk import NO_BULK
from eigencontact.execution.blocks.surface import Surface
from eigencontact.results.records import HistoryRecord, RegionRecord, StepRecord
from eigencontact.solvers.control import Control
from eigencontact.solvers.report import Progress
from eigencontact.solvers.tangential.control import TangentialControl

__all__ = ["CyclePlace", "Step"]


@dataclass(frozen=True, kw_only=True, slots=True)
class CyclePlace:
    """Position of an increment in a repeated cycle.

    Attributes
    ----------
    number : int
        Number of the repetition, from 1.
    skipped : int
        Skipped repetitions before it.
    repeats_after : int
        Remaining repetitions after it.
    begins, ends : bool
        Whether it is the first or the last increment of the cycle.
    settling : bool
        Whether its cycle follows skipped cycles and only restores the contact state; such a cycle is not a result.
    """

    number: int
    skipped: int
    repeats_after: int
    begins: bool
    ends: bool
    settling: bool = False


@dataclass(slots=True)
class Step:
    """Results of one load step during its computation.

    Attributes
    ----------
    index, time : int, float
        Number of the step from 1, and its position in the load history: time 1 is the end of the first table of steps.
    control : Control or None
        Prescribed values of the contact; None without a contact.
    tangential : TangentialControl or None
        Prescribed values along the surface; None without friction.
    travel : (float, float)
        Position (x, y) of the geometry [m].
    bulk : two mappings of str to float
        Bulk stress of the bodies before the step and at its end [Pa], by name.
    cycle : CyclePlace or None
        Position in a cycle; None outside of cycles.
    surface : Surface
        Surfaces of the contact in this step.
    previous : StepRecord or None
        Stored record of the last accepted step; None in the first step.
    fields, scalars, regions, observed, history
        Results, by name.
    looks
        Regions for observers, or functions that compute them; they are not stored.
    progress : callable or None
        Receives the residual of each iteration.
    """

    index: int
    time: float
    control: Control | None = None
    tangential: TangentialControl | None = None
    travel: tuple[float, float] = (0.0, 0.0)
    bulk: tuple[Mapping[str, float], Mapping[str, float]] = (NO_BULK, NO_BULK)
    cycle: CyclePlace | None = None
    surface: Surface = field(default_factory=Surface)
    previous: StepRecord | None = None
    fields: dict[str, FloatArray] = field(default_factory=dict)
    scalars: dict[str, float] = field(default_factory=dict)
    regions: dict[str, RegionRecord] = field(default_factory=dict)
    looks: dict[str, RegionRecord | Callable[[], RegionRecord]] = field(default_factory=dict)
    observed: dict[str, float] = field(default_factory=dict)
    history: dict[str, HistoryRecord] = field(default_factory=dict)
    progress: Progress | None = None

    def record(self) -> StepRecord:
        """Record of the step for storage and for other blocks."""
        return StepRecord(
            index=self.index,
            time=self.time,
            scalars=self.scalars,
            fields=self.fields,
            regions=self.regions,
            observed=self.observed,
            history=self.history,
        )
