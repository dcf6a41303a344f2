"""Evaluation of all steps of a run after the last step."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from eigencontact.execution.blocks.block import PlanItem

if TYPE_CHECKING:
    from eigencontact.core.cautions import Caution
    from eigencontact.results.borders import Variable
    from eigencontact.results.stored import Results

__all__ = ["Conclusion", "Findings"]


@dataclass(frozen=True, kw_only=True, slots=True)
class Findings:
    """Results of a conclusion.

    Attributes
    ----------
    numbers : mapping of str to float
        Numbers of the run, declared by `Conclusion.numbers`; undefined numbers are left out.
    variables : sequence of Variable
        Fields for the results. Their dimensions exist in the results already, without ``step``.
    cautions : sequence of Caution
        Warnings about the numbers and fields.
    """

    numbers: Mapping[str, float]
    variables: Sequence[Variable] = field(default=())
    cautions: Sequence[Caution] = field(default=())


class Conclusion(PlanItem, ABC):
    """Evaluation of the stored results of all steps, done once; a plan declares it like a block."""

    @abstractmethod
    def conclude(self, results: Results) -> Findings:
        """Evaluate the results of a finished run."""
