"""Base class of the causes of a field: tractions and eigenstrain."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence

from eigencontact.core.array_types import FloatArray
from eigencontact.execution.blocks.block import Cost
from eigencontact.execution.blocks.precision import Precision
from eigencontact.execution.blocks.step import Step
from eigencontact.model.kernels import KernelUse

__all__ = ["Cause"]


class Cause(ABC):
    """Cause of a field at the points of a region.

    Attributes
    ----------
    requires : frozenset of str
        Quantities that the cause needs from a step.
    kernels, cost, precisions
        See `Part`.
    note : str
        Remark on the values, for `explain` and results; may be empty.
    mean_above : float
        Depth [m] above which the stress is a mean over each cell; 0 if no means are taken.
    """

    requires: frozenset[str]
    kernels: Sequence[KernelUse]
    cost: Cost
    precisions: Sequence[Precision]
    note: str = ""
    mean_above: float = 0.0

    @abstractmethod
    def fields(self, step: Step) -> dict[str, FloatArray]:
        """Fields of this cause by quantity, ``(3 or 6, *lattice.shape)``."""

    def amend(self, fields: dict[str, FloatArray], step: Step) -> None:  # noqa: B027
        """Correct the sum of all causes."""
