"""Increments of a load step: halved where they do not converge, or as the error of the plastic strain requires."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from eigencontact.errors import NotConverged
from eigencontact.execution.blocks.increment import Increment
from eigencontact.execution.interiors.interior import Interior
from eigencontact.execution.mechanics.coupled import Coupled, Solution

__all__ = ["Halving"]

#: Largest number of halvings of a load step.
_HALVINGS = 5


class Halving:
    """Solution of one load step by one or more increments.

    An increment that does not converge is halved; the second half starts from the state after the first. With a
    limit, increments with plastic flow are halved as well. The difference between the whole increment and its halves
    estimates the remaining error of the halves (implicit steps are of first order). If the error is too large, each
    half is halved again.

    Parameters
    ----------
    coupled : Coupled
    interiors : sequence of Interior
    limit : float or None
        Allowed error of the plastic strain, `numerics.plastic-error`.

    Attributes
    ----------
    rejected : list of Solution
        Solutions that others replaced; their work counts.
    error : float
        Estimated error of the plastic strain; 0 without a limit.
    """

    def __init__(self, coupled: Coupled, interiors: Sequence[Interior], limit: float | None) -> None:
        self._coupled, self._interiors, self._limit = coupled, interiors, limit
        self.rejected: list[Solution] = []
        self.error = 0.0

    def solve(self, increment: Increment, memory: Any, before: Solution) -> list[Solution]:
        """Solved increments of a step, in order of time."""
        if self._limit is None:
            return self._converged(increment, memory, before, 0)
        return self._accurate(increment, memory, before, None, self._limit, 0)

    def _converged(self, increment: Increment, memory: Any, before: Solution, depth: int) -> list[Solution]:
        """Solved increments: the increment itself, or its halves if it does not converge."""
        try:
            return [self._coupled.solve(increment, memory, before)]
        except NotConverged:
            if depth == _HALVINGS:
                raise
        first, second = increment.halves()
        increments = self._converged(first, memory, before, depth + 1)
        return increments + self._converged(second, _memory(increments), increments[-1], depth + 1)

    def _accurate(
        self, increment: Increment, memory: Any, before: Solution, whole: list[Solution] | None, limit: float,
        depth: int,
    ) -> list[Solution]:  # fmt: skip
        """Solve an increment, halved as often as the allowed error of the plastic strain requires.

        `whole` is the undivided increment, if already solved.
        """
        whole = whole or self._converged(increment, memory, before, depth)
        flowed = any(interior.flowed(before.records, whole[-1].records) for interior in self._interiors)
        if depth == _HALVINGS or not flowed:
            return whole
        first, second = increment.halves()
        first_half = self._converged(first, memory, before, depth + 1)
        second_half = self._converged(second, _memory(first_half), first_half[-1], depth + 1)
        error = max(interior.distance(whole[-1].records, second_half[-1].records) for interior in self._interiors)
        self.rejected += whole
        if error <= limit or depth + 1 == _HALVINGS:
            self.error = max(self.error, error)
            return first_half + second_half
        self.rejected += second_half
        increments = self._accurate(first, memory, before, first_half, limit, depth + 1)
        return increments + self._accurate(second, _memory(increments), increments[-1], None, limit, depth + 1)


def _memory(increments: Sequence[Solution]) -> Any:
    """Record of solved increments for the contact."""
    last = increments[-1].contact
    return None if last is None else last.memory
