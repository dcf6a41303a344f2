"""Conclusions: what follows from all steps of a run together, after the last."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from eigencontact.execution.blocks.block import Part

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
        Numbers of the run, which `Conclusion.numbers` declares; one that does not exist is left out.
    variables : sequence of Variable
        Fields for the results, on dimensions that these have already, without ``step``.
    cautions : sequence of Caution
        Warnings about them.
    """

    numbers: Mapping[str, float]
    variables: Sequence[Variable] = field(default=())
    cautions: Sequence[Caution] = field(default=())


class Conclusion(Part, ABC):
    """Work that is done once, on the stored results of all steps; a plan declares it, as it declares blocks."""

    @abstractmethod
    def conclude(self, results: Results) -> Findings:
        """Evaluate the results of a run that is finished."""
