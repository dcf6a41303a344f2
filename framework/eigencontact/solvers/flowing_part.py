"""Sweeps of a body that yields over the part of its box in which cells flow.

Cells outside the part have no eigenstrain as long as their law stays elastic there, and only a sweep over the whole box
can check this. One such sweep begins an increment, and another one must confirm its end; a cell outside that has begun
to flow extends the part. The sweeps between them cost time in proportion to the size of the part.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.array_types import BoolArray, FloatArray
from eigencontact.core.products import distance_of
from eigencontact.solvers.cell_sweeps import Sweep
from eigencontact.solvers.equivalent_inclusions import StressOperator
from eigencontact.solvers.law_cells import LawCells

__all__ = ["LARGEST_PART", "FlowingPart", "Window"]

Window = tuple[slice, slice, slice]

#: Largest share of the cells of a box that a part may have.
LARGEST_PART = 0.5
#: Cells of a box from which a part pays.
_FEWEST = 8192
#: Cells on every side of those that flow, as a share of their extent: a part that grows is built anew.
_MARGIN = 0.1


@dataclass(frozen=True, slots=True, eq=False)
class _Start:
    """State of the cells of a part at the start of an increment, evaluation points of the law, and prestrain."""

    before: Sequence[Mapping[str, FloatArray]]
    steps: Sequence[Any]
    prestrain: FloatArray


class FlowingPart:
    """Box around all cells of a larger box that flow.

    Parameters
    ----------
    shape : (nz, ny, nx)
        Of the larger box; one law fills it in its order.
    operator : callable
        Operator from eigenstrain to stress in a window of the larger box.
    laws : callable
        Law of some cells, by flat index.
    """

    def __init__(
        self,
        shape: tuple[int, int, int],
        operator: Callable[[Window], StressOperator],
        laws: Callable[[NDArray[np.intp]], LawCells],
    ) -> None:
        self._shape, self._operator_of, self._laws_of = shape, operator, laws
        self._numbers = np.arange(int(np.prod(shape))).reshape(shape)
        self._window: Window | None = None
        self._is_too_large = self._numbers.size < _FEWEST
        self._start: _Start | None = None
        #: Whether the last sweep let cells flow that have neighbours outside the window.
        self.reaches_rim = False
        self.applications = 0

    @property
    def window(self) -> Window | None:
        """Present window; None where the whole box must be swept."""
        return self._window

    def begin(self) -> None:
        """Begin an increment."""
        self._start, self.reaches_rim = None, False

    def follow(self, active: BoolArray) -> None:
        """Extend the window so that it contains the active cells ``(nz, ny, nx)`` of a sweep over the whole box."""
        self.reaches_rim = False
        if self._is_too_large or not active.any():
            return
        spans = [(int(cells[0]), int(cells[-1]) + 1) for cells in _along_axes(active)]
        window = self._window
        if (
            window is not None
            and all(low >= side.start and high <= side.stop for (low, high), side in zip(spans, window, strict=True))
            and not self._reaches_rim(active[window])
        ):
            return
        margins = [1 + int(_MARGIN * (high - low)) for low, high in spans]
        k, j, i = (
            slice(max(low - margin, 0), min(high + margin, size))
            for (low, high), margin, size in zip(spans, margins, self._shape, strict=True)
        )
        cells = self._numbers[k, j, i]
        self._is_too_large = cells.size > LARGEST_PART * self._numbers.size
        self._window, self._start = (None if self._is_too_large else (k, j, i)), None
        if self._window is not None:
            self._cells = cells.ravel()
            self._operator, self._laws = self._operator_of(self._window), self._laws_of(self._cells)

    def sweep(
        self,
        eigenstrain: FloatArray,
        applied_stress: FloatArray,
        start: tuple[FloatArray, Sequence[Mapping[str, FloatArray]], Sequence[Any]],
        size: float,
    ) -> Sweep:
        """Sweep the window once.

        Parameters
        ----------
        eigenstrain : (6, nz, ny, nx)
            Of the larger box.
        applied_stress : (6, ...)
            Stress [Pa] by the load in the window.
        start : (prestrain, before, steps)
            See `CellSweeps.sweep`; in the larger box.
        size : float
            Reference of the residual, from the last sweep over the whole box.

        Returns
        -------
        Sweep
            Image in the larger box, without history variables.
        """
        assert self._window is not None
        if self._start is None:
            prestrain, before, (step,) = start
            variables = [{name: values[:, self._cells] for name, values in records.items()} for records in before]
            self._start = _Start(variables, [step.of(self._cells)], self._of_window(prestrain))
        inside = (slice(None), *self._window)
        strain = np.ascontiguousarray(eigenstrain[inside])
        self.applications += 1
        stress = applied_stress + self._operator.apply(strain)
        image, _ = self._laws.answer(
            strain.reshape(6, -1), stress.reshape(6, -1), self._start.prestrain, self._start.before, self._start.steps
        )
        out = np.zeros_like(eigenstrain)
        out[inside] = image.reshape(strain.shape)
        change = distance_of(image, strain.reshape(6, -1))
        self.reaches_rim = self._reaches_rim((image != 0.0).any(axis=0).reshape(strain.shape[1:]))
        return Sweep(out, change / size if change > 0.0 else 0.0, size, [])

    def _reaches_rim(self, active: BoolArray) -> bool:
        """Whether outermost cells of the window are active that have neighbours outside."""
        assert self._window is not None
        for cells, side, size in zip(_along_axes(active), self._window, self._shape, strict=True):
            if cells.size and (
                (side.start > 0 and cells[0] == 0) or (side.stop < size and cells[-1] == side.stop - side.start - 1)
            ):
                return True
        return False

    def _of_window(self, values: FloatArray) -> FloatArray:
        return np.ascontiguousarray(values.reshape(6, -1)[:, self._cells])


def _along_axes(active: BoolArray) -> list[NDArray[np.intp]]:
    """Indices along each axis at which there are active cells."""
    return [np.flatnonzero(active.any(axis=across)) for across in ((1, 2), (0, 2), (0, 1))]
