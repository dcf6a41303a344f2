"""Blocks of a computation: required and provided quantities, cost, and the running object."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Protocol, TypeVar, cast

from eigencontact.core.numbers import Number
from eigencontact.execution.blocks.step import Step
from eigencontact.model.kernels import KernelUse
from eigencontact.results.records import StepRecord

if TYPE_CHECKING:
    from eigencontact.core.cautions import Caution, LeftOut
    from eigencontact.execution.blocks.precision import Precision
    from eigencontact.model.model import Model

__all__ = ["Block", "Cost", "PlanItem", "Run", "Running", "Stateless"]

Started = TypeVar("Started")
#: Scalars of every step, in order.
History = Sequence[Mapping[str, float]]


@dataclass(frozen=True, slots=True)
class Cost:
    """Predicted memory and time of a piece of work.

    Attributes
    ----------
    memory : float
        Memory held until the end of the run [bytes].
    seconds_once, seconds_per_step : float
        Wall time per run and per step [s].
    transient : float
        Memory held only during the work [bytes]. For several pieces of work the largest value counts.
    """

    memory: float = 0.0
    seconds_once: float = 0.0
    seconds_per_step: float = 0.0
    transient: float = 0.0

    @property
    def peak(self) -> float:
        """Memory at its peak [bytes]."""
        return self.memory + self.transient

    def __add__(self, other: Cost) -> Cost:
        return Cost(
            self.memory + other.memory,
            self.seconds_once + other.seconds_once,
            self.seconds_per_step + other.seconds_per_step,
            max(self.transient, other.transient),
        )

    def times(self, count: float) -> Cost:
        """Cost of the same work, repeated `count` times."""
        return Cost(count * self.memory, count * self.seconds_once, count * self.seconds_per_step, self.transient)

    @property
    def once(self) -> Cost:
        """Cost of work that is done once for all steps; its memory is released afterwards."""
        return Cost(seconds_once=self.seconds_once + self.seconds_per_step, transient=self.peak)

    @property
    def every_step(self) -> Cost:
        """Cost of work that is repeated in each step; its memory is released afterwards."""
        return Cost(seconds_per_step=self.seconds_once + self.seconds_per_step, transient=self.peak)


class PlanItem:
    """Text of `explain` about a block, or about one of several parts of a block.

    Attributes
    ----------
    name : str
        Unique in the plan.
    reason : str
        Reason why the plan contains it.
    kernels : sequence of KernelUse
        Influence coefficients that the block builds.
    cost : Cost
        Predicted cost.
    precisions : sequence of Precision
        Precision of each operator for which the scene leaves the choice to the plan.
    numbers : sequence of Number
        Scalars that the block adds to a step. The class attribute lists all possible scalars for the reference page.
    """

    name: str
    reason: str
    kernels: Sequence[KernelUse] = ()
    cost: Cost = Cost()
    precisions: Sequence[Precision] = ()
    numbers: Sequence[Number] = ()


class Running(Protocol):
    """Running block: it holds the operators and solvers of one run."""

    def advance(self, step: Step) -> None:
        """Read the required quantities from the step and add the provided ones."""
        ...


class Run:
    """The started blocks of one run.

    A plan declares blocks and holds no operators; a run starts each block once. Coupled blocks reach each other through
    this object. Solver memory ends with it, so a plan can be run any number of times.
    """

    def __init__(self) -> None:
        self._started: dict[Callable[[Run], Any], Any] = {}

    def started(self, start: Callable[[Run], Started]) -> Started:
        """Running object of a block, made by `Block.start` at the first call."""
        if start not in self._started:
            self._started[start] = start(self)
        return cast("Started", self._started[start])


class Block(PlanItem, ABC):
    """Unit of work of a run: the planner declares it, the run starts it once, and it advances step by step.

    Attributes
    ----------
    requires, provides : frozenset of str
        Quantities, by name.
    requesters : mapping of str to str
        Provided quantities that are results of the run, with the requester of each. Other provided quantities are
        computed only if another block requires them.
    settles : bool
        Whether the block keeps state from step to step, so that it also takes part in steps that are not results.
    accumulated : frozenset of str
        Surface fields that accumulate over the solved steps. Steps that are not results do not add to them.
    """

    requires: frozenset[str] = frozenset()
    provides: frozenset[str] = frozenset()
    requesters: Mapping[str, str] = MappingProxyType({})
    settles: bool = False
    accumulated: frozenset[str] = frozenset()

    @property
    def parts(self) -> Sequence[PlanItem]:
        """Parts that the block solves together."""
        return (self,)

    def cycles_of(self, last: StepRecord) -> int:  # noqa: ARG002
        """Number of cycles that an accepted step represents, including itself."""
        return 1

    def facts(self, model: Model) -> list[str]:  # noqa: ARG002
        """Lines for `explain` about the physics of the block; see `eigencontact.planning.explain.PlanWords.facts`."""
        return []

    def left_out(self, model: Model) -> list[LeftOut]:  # noqa: ARG002
        """Effects that the physics of the block leaves out."""
        return []

    def foreseen(self, model: Model) -> Iterable[Caution]:  # noqa: ARG002
        """Warnings of the plan."""
        return ()

    def noticed(self, model: Model, last: StepRecord, history: History) -> Iterable[Caution]:  # noqa: ARG002
        """Warnings of the results, from the last step and the scalars of all steps."""
        return ()

    @abstractmethod
    def start(self, run: Run) -> Running:
        """Build the operators and solvers of a run; no operator is built, and no solver imported, before."""


class Stateless(Block):
    """Block without state and without set-up: the running object is the block."""

    def start(self, run: Run) -> Running:  # noqa: ARG002
        """See `Block.start`."""
        return self

    @abstractmethod
    def advance(self, step: Step) -> None:
        """See `Running.advance`."""
