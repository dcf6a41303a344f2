"""Cells of any law, swept: one application of the volume operator, then each cell by itself.

A sweep computes the eigenstrain of every cell under the present eigenstrain of the others. With Anderson's combination
it converges for ratios of stiffness up to about 20 in fewer applications than a Krylov solve in every round with a
contact, also for laws that yield or degrade. A contact is solved inside the iteration.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.array_types import FloatArray
from eigencontact.core.products import distance_of, norm_of
from eigencontact.solvers.equivalent_inclusions import InhomogeneousCells
from eigencontact.solvers.law_cells import LawCells, Remembered

__all__ = ["CellSweeps", "Sweep"]

#: Part of the eigenstrain of the last increment that counts beside the strain of the load: all is unloaded at times.
_LEFT = 1e-2


@dataclass(frozen=True, slots=True)
class Sweep:
    """Result of one sweep.

    Attributes
    ----------
    image : (6, nz, ny, nx)
        Eigenstrain of each cell under the present eigenstrain of the others; without a law the prestrain alone.
    residual : float
        Root mean square of the change, over the cells of laws, relative to the load's strain σ / 2G, or if that is less
        to a hundredth of the eigenstrain at the start of the increment; without either to the result.
    size : float
        Reference of the residual: root of the sum over the cells of the squares of a strain.
    remembered : list of mappings
        History variables of the cells of each law that is not linear.
    """

    image: FloatArray
    residual: float
    size: float
    remembered: list[Remembered]


class CellSweeps:
    """Sweep over one box of cells: linear laws in `linear`, all others in `laws`; either may have no cells.

    Parameters
    ----------
    linear : InhomogeneousCells
        With the operator, and the matrix.
    laws : LawCells
        On the same operator.
    """

    def __init__(self, linear: InhomogeneousCells, laws: LawCells) -> None:
        self._linear, self._laws = linear, laws
        # Where the cells of the laws are the whole box in its order, nothing is copied.
        self._fills_box = np.array_equal(laws.cells, np.arange(int(np.prod(linear.shape))))
        self._at: slice | NDArray[np.intp] = slice(None) if self._fills_box else laws.cells
        self._prestrain_stress: tuple[FloatArray, FloatArray] | None = None
        self._last: tuple[FloatArray, FloatArray] | None = None
        #: Stress of the last sweep, whose memory the next one uses.
        self._total: FloatArray | None = None
        self.applications = 0

    def sweep(
        self,
        eigenstrain: FloatArray,
        applied_stress: FloatArray,
        prestrain: FloatArray,
        before: Sequence[Mapping[str, FloatArray]] = (),
        steps: Sequence[Any] = (),
        start: FloatArray | None = None,
        caused: FloatArray | None = None,
    ) -> Sweep:
        """Sweep once.

        Parameters
        ----------
        eigenstrain : (6, nz, ny, nx)
            As it is, prestrain included.
        applied_stress : (6, nz, ny, nx)
            Stress [Pa] that the load would cause in the matrix alone.
        prestrain : (6, nz, ny, nx)
            Eigenstrain of the cells' own.
        before, steps
            For each law that is not linear; see `LawCells.answer`.
        start : (6, nz, ny, nx), optional
            Eigenstrain that the increment begins with.
        caused : (6, nz, ny, nx), optional
            Stress [Pa] by the eigenstrain; by default that of the operator, for cells that are all there is.
        """
        by_cells = self._caused(eigenstrain) if caused is None else caused
        stress = self._total = np.add(applied_stress, by_cells, out=self._total)
        remembered: list[Remembered] = []
        if self._fills_box:
            e, sigma, prescribed = (values.reshape(6, -1) for values in (eigenstrain, stress, prestrain))
            image, remembered = self._laws.answer(e, sigma, prescribed, before, steps)
        else:
            image = prestrain.copy().reshape(6, -1)  # what a cell had that nothing fills any more, as wear took it off
            image[:, self._linear.cells] = self._linear.answer(eigenstrain, stress, prestrain)
            if self._laws.cells.size:
                e, sigma, prescribed = (
                    values.reshape(6, -1)[:, self._at] for values in (eigenstrain, stress, prestrain)
                )
                image[:, self._at], remembered = self._laws.answer(e, sigma, prescribed, before, steps)
        change = distance_of(image, eigenstrain)
        size = self._size(applied_stress, prestrain)
        if start is not None:
            size = max(size, _LEFT * norm_of(start))
        if size == 0.0:  # nothing loads the cells but what they remember
            size = max(norm_of(image), norm_of(eigenstrain))
        residual = change / size if change > 0.0 else 0.0
        return Sweep(image.reshape(eigenstrain.shape), residual, size, remembered)

    def misfit(
        self,
        eigenstrain: FloatArray,
        applied_stress: FloatArray,
        prestrain: FloatArray,
        before: Sequence[Mapping[str, FloatArray]],
        steps: Sequence[Any],
        start: FloatArray | None = None,
        caused: FloatArray | None = None,
    ) -> float:
        """Largest difference of the stress of cells from the response of their laws, relative to the largest stress.

        Where all is unloaded a hundredth of the stress 2G ε of the eigenstrain at the start counts instead if it is
        more, as in the residual of a sweep. See `sweep` for the parameters; of laws that are linear its residual says
        the same.
        """
        if not self._laws.cells.size:
            return 0.0
        stress = applied_stress + (self._caused(eigenstrain) if caused is None else caused)
        e, sigma, prescribed = (values.reshape(6, -1)[:, self._at] for values in (eigenstrain, stress, prestrain))
        largest = float(np.linalg.norm(sigma, axis=0).max())
        if start is not None:
            left = float(np.linalg.norm(start.reshape(6, -1), axis=0).max())
            largest = max(largest, _LEFT * 2.0 * self._linear.matrix.shear_modulus * left)
        return self._laws.misfit(e, sigma, prescribed, before, steps) / largest if largest > 0.0 else 0.0

    def _size(self, applied_stress: FloatArray, prestrain: FloatArray) -> float:
        """Strain of the load in the cells, the scale of `InclusionReport`."""
        if self._prestrain_stress is None or self._prestrain_stress[0] is not prestrain:
            self._prestrain_stress = prestrain, self._stress_of(prestrain)
        caused = self._prestrain_stress[1]
        load = (applied_stress + caused if caused.any() else applied_stress).reshape(6, -1)
        sizes = [norm_of(load[:, cells]) for cells in (self._linear.cells, self._at)]
        return float(np.hypot(sizes[0], sizes[1])) / (2.0 * self._linear.matrix.shear_modulus)

    def _caused(self, eigenstrain: FloatArray) -> FloatArray:
        """Stress by an eigenstrain, stored for the last eigenstrain so that elastic increments apply nothing."""
        if self._last is None or not np.array_equal(self._last[0], eigenstrain):
            self._last = eigenstrain, self._stress_of(eigenstrain)
        return self._last[1]

    def _stress_of(self, eigenstrain: FloatArray) -> FloatArray:
        if not eigenstrain.any():
            return np.zeros_like(eigenstrain)
        self.applications += 1
        return np.asarray(self._linear.operator.apply(eigenstrain), dtype=float)
