"""The code behind each kind of block; a runner is built once per run and called once per load step."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, field
from importlib import import_module
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from eigencontact.errors import EigencontactError, PluginError
from eigencontact.planning.blocks import Block
from eigencontact.planning.plan import Plan
from eigencontact.plugin import StepView
from eigencontact.results.records import RegionRecord, StepRecord
from eigencontact.solvers.control import Control
from eigencontact.solvers.report import Progress
from eigencontact.solvers.tangential.control import TangentialControl

__all__ = ["Runner", "State", "build_runner"]

FloatArray = NDArray[np.float64]


@dataclass(slots=True)
class State:
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
    previous : StepRecord or None
        The last accepted step; None in the first.
    fields, scalars, regions, observed
        Results, by name.
    inner : mapping
        Fields of eigenstrain by region and quantity, for the blocks that put a region's results together.
    initial : mapping
        Surface fields of eigenstrain before the first step, in the first step of a contact with friction.
    equivalent : mapping
        Equivalent eigenstrain of inhomogeneities by body: of their cells ``(6, nz, ny, nx)``, or of each ``(6, n)``.
    lifted : mapping
        Displacement of the surface by it ``(3, ny, nx)``, where its solver gives that along the tractions.
    """

    index: int
    time: float
    control: Control | None
    tangential: TangentialControl | None = None
    travel: tuple[float, float] = (0.0, 0.0)
    previous: StepRecord | None = None
    fields: dict[str, FloatArray] = field(default_factory=dict)
    scalars: dict[str, float] = field(default_factory=dict)
    regions: dict[str, RegionRecord] = field(default_factory=dict)
    observed: dict[str, float] = field(default_factory=dict)
    inner: dict[str, dict[str, FloatArray]] = field(default_factory=dict)
    initial: dict[str, FloatArray] = field(default_factory=dict)
    equivalent: dict[int, FloatArray] = field(default_factory=dict)
    lifted: dict[int, FloatArray] = field(default_factory=dict)
    progress: Progress | None = None


class Runner(Protocol):
    """Advances the state of one load step."""

    def __call__(self, state: State) -> None:
        """Read what its block requires from the state and add what it provides."""
        ...


def build_runner(plan: Plan, block: Block) -> Runner:
    """Runner of a declared block; nothing of a block is built, or imported, before this."""
    module, name = _HOMES[block.runner]
    builder: Callable[[Plan, Block], Runner] = getattr(import_module(f"eigencontact.execution.{module}"), name)
    return builder(plan, block)


class Observe:
    def __init__(self, plan: Plan, block: Block) -> None:
        number = block.settings["number"]
        assert isinstance(number, int)
        self._name, self._observer = plan.observers[number]
        prefixes = [re.sub(r"\W", "_", observer.key) for _, observer in plan.observers]
        self._prefix = prefixes[number]
        if prefixes.count(self._prefix) > 1:
            self._prefix += f"_{number + 1}"
        self._grid = plan.grid

    def __call__(self, state: State) -> None:
        fields = {}
        for name, values in state.fields.items():
            view = values.view()
            view.flags.writeable = False
            fields[name] = view
        step = StepView(index=state.index, grid=self._grid, fields=fields, scalars=dict(state.scalars))
        try:
            numbers = self._observer.observe(step)
            state.observed |= {f"{self._prefix}_{name}": float(value) for name, value in numbers.items()}
        except EigencontactError:
            raise
        except Exception as problem:
            raise PluginError(
                f"observer {self._name!r} must return named numbers (got {type(problem).__name__}: {problem})"
            ) from problem


#: Module and class of each kind of runner.
_HOMES = {
    "separation": ("contact", "Separation"),
    "normal-contact": ("contact", "NormalContact"),
    "frictional-contact": ("friction", "FrictionalContactRunner"),
    "tangential-displacement": ("contact", "TangentialDisplacement"),
    "reference-pressure": ("contact", "ReferencePressure"),
    "shear-bound": ("friction_reference", "ShearBound"),
    "reference-shear": ("friction_reference", "ReferenceShear"),
    "stress": ("stress", "Stress"),
    "residual-displacement": ("eigenstrain", "ResidualDisplacement"),
    "eigenstrain-region": ("eigenstrain", "EigenstrainRegion"),
    "inhomogeneities": ("inhomogeneities", "Inhomogeneities"),
    "solved-residual-displacement": ("inhomogeneities", "SolvedResidualDisplacement"),
    "solved-eigenstrain-region": ("inhomogeneities", "SolvedEigenstrainRegion"),
    "region": ("regions", "Region"),
    "observer": ("runners", "Observe"),
}
