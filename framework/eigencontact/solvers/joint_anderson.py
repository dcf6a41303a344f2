"""Anderson acceleration of several unknowns of different units."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.array_types import FloatArray
from eigencontact.solvers.anderson import Anderson

__all__ = ["JointAnderson"]


class JointAnderson:
    """Anderson combination of several arrays as one vector.

    Each array has a unit of its own and a weight by its number of entries. The unit of an array is its size in the
    first round in which it is not zero. Units stay fixed, because the stored vectors are in these units; with variable
    units the combination stalls. Entries that were always zero, for example of cells without plastic flow, are not
    stored.

    Parameters
    ----------
    depth : int
        Number of stored differences.
    """

    def __init__(self, depth: int) -> None:
        self._depth, self._anderson, self._units = depth, Anderson(depth), list[FloatArray]()
        #: Entries that have been nonzero, in order of their first change: number of the array, and flat indices in it.
        self._moving: list[tuple[int, NDArray[np.intp]]] = []
        self._nonzero: list[NDArray[np.bool_]] = []

    def restart(self) -> None:
        """See `Anderson.restart`."""
        self._anderson.restart()

    @property
    def nbytes(self) -> int:
        """Memory of the stored vectors."""
        return self._anderson.nbytes + sum(entries.nbytes for _, entries in self._moving)

    def next(
        self, guess: Sequence[FloatArray], answers: Sequence[FloatArray], sizes: Sequence[FloatArray]
    ) -> list[FloatArray]:
        """Return the next guess; `sizes` are the scales of the arrays, or of their rows."""
        has_unit = [bool(unit.any()) for unit in self._units] or [False] * len(sizes)
        if any(size.any() and not before for size, before in zip(sizes, has_unit, strict=True)):
            self._anderson = Anderson(self._depth)
            self._units = [
                unit if before else size
                for unit, size, before in zip(self._units or sizes, sizes, has_unit, strict=True)
            ]
        weights = [np.sqrt(array.size) if len(guess) > 1 else 1.0 for array in guess]
        scaled = [np.where(unit > 0.0, unit, 1.0) * weight for unit, weight in zip(self._units, weights, strict=True)]
        self._follow(guess, answers)

        def units(n: int, entries: NDArray[np.intp]) -> FloatArray:
            unit = scaled[n]
            return unit.ravel() if unit.size == 1 else np.broadcast_to(unit, guess[n].shape).ravel()[entries]

        def packed(arrays: Sequence[FloatArray]) -> FloatArray:
            return np.concatenate([arrays[n].ravel()[entries] / units(n, entries) for n, entries in self._moving])

        vector, begin = self._anderson.next(packed(guess), packed(answers)), 0
        out = [np.zeros(array.size) for array in guess]
        for n, entries in self._moving:
            out[n][entries] = vector[begin : begin + entries.size] * units(n, entries)
            begin += entries.size
        return [values.reshape(array.shape) for values, array in zip(out, guess, strict=True)]

    def _follow(self, guess: Sequence[FloatArray], answers: Sequence[FloatArray]) -> None:
        """Append the newly nonzero entries to the stored ones."""
        if not self._nonzero:
            self._nonzero = [np.zeros(array.shape, dtype=bool) for array in guess]
        for number, (before, after) in enumerate(zip(guess, answers, strict=True)):
            fresh = before != 0.0
            fresh |= after != 0.0
            fresh &= ~self._nonzero[number]
            self._nonzero[number] |= fresh
            self._moving.append((number, np.flatnonzero(fresh)))
