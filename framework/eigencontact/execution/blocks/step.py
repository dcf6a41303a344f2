"""Load step during its computation: prescribed values, previous step, and results of the blocks."""

from __future__ import annotations

from collections.abc import Mapping
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
        Which repeat, from 1.
    skipped : int
        Repeats before it that are not solved.
    left : int
        Repeats after it.
    begins, ends : bool
        Whether it is the first, or the last, increment of the cycle.
    settling : bool
        Whether it is of a cycle that is only gone through, after others have been skipped.
    """

    number: int
    skipped: int
    left: int
    begins: bool
    ends: bool
    settling: bool = False


@dataclass(slots=True)
class Step:
    """Results of one load step during its computation.

    Attributes
    ----------
    index, time : int, float
        Number of the step from 1, and its place in the load history: 1 ends the first table of steps.
    control : Control or None
        What is prescribed of the contact; None without one.
    tangential : TangentialControl or None
        What is prescribed along the surface; None without friction.
    travel : (float, float)
        Place (x, y) of the geometry [m].
    bulk : two mappings of str to float
        Bulk stress of the bodies before the step and at its end [Pa], by name.
    cycle : CyclePlace or None
        Where in a cycle it lies; None outside of cycles.
    surface : Surface
        The surfaces that the contact of the step meets.
    previous : StepRecord or None
        The last accepted step, as it is stored; None in the first.
    fields, scalars, regions, observed, history
        Results, by name.
    looks
        Regions that observers asked for; they are not stored.
    progress : callable or None
        Told the residual of each iteration.
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
    looks: dict[str, RegionRecord] = field(default_factory=dict)
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
