"""Base class of the causes of a field: tractions and eigenstrain."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.array_types import FloatArray
from eigencontact.execution.blocks.block import Cost
from eigencontact.execution.blocks.precision import Precision
from eigencontact.execution.blocks.step import Step
from eigencontact.model.kernels import KernelUse

__all__ = ["Cause", "StressAtDepths"]

#: Function that returns the stress of several steps at some depths of a lattice, by their indices ``(n,)``: Mandel
#: vectors ``(steps, 6, n, points of a depth)``; the first and the last dimension may have length 1.
StressAtDepths = Callable[[NDArray[np.intp]], FloatArray]


class Cause(ABC):
    """Cause of a field at the points of a region.

    Attributes
    ----------
    requires : frozenset of str
        Quantities that the cause needs from a step.
    kernels, cost, precisions
        See `PlanItem`.
    note : str
        Remark on the values, for `explain` and results; may be empty.
    mean_above : float
        Depth [m] above which the stress is a mean over each cell; 0 if no means are taken.
    by_depths : bool
        Whether `of_steps` returns the stress, from surface fields and bulk stress alone.
    """

    requires: frozenset[str]
    kernels: Sequence[KernelUse]
    cost: Cost
    precisions: Sequence[Precision]
    note: str = ""
    mean_above: float = 0.0
    by_depths: bool = False

    @abstractmethod
    def fields(self, step: Step) -> dict[str, FloatArray]:
        """Fields of this cause by quantity, ``(3 or 6, *lattice.shape)``."""

    def of_steps(self, steps: Sequence[Step]) -> StressAtDepths:
        """Stress of several steps, computed at the depths where it is needed; see `by_depths`."""
        raise NotImplementedError

    def amend(self, fields: dict[str, FloatArray], step: Step) -> None:  # noqa: B027
        """Correct the sum of all causes."""
