"""A load step while it is computed: what is prescribed, the step before, and what the blocks have found so far."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from eigencontact.model.kernels import Bodies
from eigencontact.results.records import HistoryRecord, RegionRecord, StepRecord
from eigencontact.solvers.control import Control
from eigencontact.solvers.report import Progress
from eigencontact.solvers.tangential.control import TangentialControl

__all__ = ["CyclePlace", "Slide", "Step"]

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True, slots=True)
class CyclePlace:
    """Place of an increment in a cycle that is repeated.

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


@dataclass(slots=True)
class Step:
    """What one load step has produced so far.

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
    cycle : CyclePlace or None
        Where in a cycle it lies; None outside of cycles.
    slide : Slide or None
        How the surfaces slide all over the contact; None where what slips is to be found.
    moved : bool
        Whether the surfaces have moved since the last step found its pressure.
    worn : dict of int to (ny, nx)
        Depth that each body that wears has lost where the contact of the step meets it [m].
    bodies : Bodies or None
        Bodies whose layers have worn; None where they are those of the model.
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
    cycle: CyclePlace | None = None
    slide: Slide | None = None
    moved: bool = False
    worn: dict[int, FloatArray] = field(default_factory=dict)
    bodies: Bodies | None = None
    previous: StepRecord | None = None
    fields: dict[str, FloatArray] = field(default_factory=dict)
    scalars: dict[str, float] = field(default_factory=dict)
    regions: dict[str, RegionRecord] = field(default_factory=dict)
    looks: dict[str, RegionRecord] = field(default_factory=dict)
    observed: dict[str, float] = field(default_factory=dict)
    history: dict[str, HistoryRecord] = field(default_factory=dict)
    progress: Progress | None = None

    @property
    def exposed(self) -> NDArray[np.intp] | None:
        """Material ``(ny, nx)`` that the contact of the step meets, by number; None where no law asks."""
        found = self.fields.get("exposed_material")
        return None if found is None else found.astype(np.intp)

    def record(self) -> StepRecord:
        """The step as it is handed on and stored."""
        return StepRecord(
            index=self.index,
            time=self.time,
            scalars=self.scalars,
            fields={name: values for name, values in self.fields.items() if name != "separation"},
            regions=self.regions,
            observed=self.observed,
            history=self.history,
        )
