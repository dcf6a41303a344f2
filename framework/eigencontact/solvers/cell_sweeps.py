"""Sweeps over cells of any law: one application of the volume operator, then an update of each cell by itself.

A sweep computes the eigenstrain of every cell under the present eigenstrain of all other cells. With Anderson
acceleration, for stiffness ratios up to about 20, it takes fewer applications than a Krylov solve in each round with a
contact. Laws that yield or degrade need sweeps. A contact is solved within the same iteration.
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
from eigencontact.solvers.law_cells import LawCells, Variables

__all__ = ["CellSweeps", "Sweep"]

#: Weight of the eigenstrain at the start in the reference size, which also serves for complete unloading.
_START_WEIGHT = 1e-2


@dataclass(frozen=True, slots=True)
class Sweep:
    """Result of one sweep.

    Attributes
    ----------
    image : (6, nz, ny, nx)
        Eigenstrain of each cell under the present eigenstrain of the others; cells without a law have the prestrain
        alone.
    residual : float
        Root mean square of the change over the cells with laws. It is relative to the strain σ / 2G of the load, or to
        a hundredth of the eigenstrain at the start of the increment if that is larger; if both are zero, to the result.
    size : float
        Reference of the residual: root of the sum of squares of a strain over the cells.
    variables : list of mappings
        History variables of the cells of each nonlinear law.
    """

    image: FloatArray
    residual: float
    size: float
    variables: list[Variables]


class CellSweeps:
    """Sweep over one box of cells, with linear laws in `linear` and all others in `laws`; either may have no cells.

    Parameters
    ----------
    linear : InhomogeneousCells
        Linear cells, with the operator and the matrix.
    laws : LawCells
        Cells of other laws, on the same operator.
    """

    def __init__(self, linear: InhomogeneousCells, laws: LawCells) -> None:
        self._linear, self._laws = linear, laws
        # If the cells of the laws fill the whole box in its order, no copies are necessary.
        self._fills_box = np.array_equal(laws.cells, np.arange(int(np.prod(linear.shape))))
        self._at: slice | NDArray[np.intp] = slice(None) if self._fills_box else laws.cells
        self._prestrain_stress: tuple[FloatArray, FloatArray] | None = None
        self._last: tuple[FloatArray, FloatArray] | None = None
        #: Stress of the last sweep; the next sweep uses its memory.
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
        internal_stress: FloatArray | None = None,
    ) -> Sweep:
        """Sweep once.

        Parameters
        ----------
        eigenstrain : (6, nz, ny, nx)
            Present eigenstrain, prestrain included.
        applied_stress : (6, nz, ny, nx)
            Stress [Pa] by the load in the matrix without inhomogeneities.
        prestrain : (6, nz, ny, nx)
            Prestrain of the cells.
        before, steps
            Variables and steps of each nonlinear law; see `LawCells.answer`.
        start : (6, nz, ny, nx), optional
            Eigenstrain at the start of the increment.
        internal_stress : (6, nz, ny, nx), optional
            Stress [Pa] by the eigenstrain of all cells, if there are cells in addition to those of the operator.
        """
        by_cells = self._internal_stress(eigenstrain) if internal_stress is None else internal_stress
        stress = self._total = np.add(applied_stress, by_cells, out=self._total)
        variables: list[Variables] = []
        if self._fills_box:
            e, sigma, prescribed = (values.reshape(6, -1) for values in (eigenstrain, stress, prestrain))
            image, variables = self._laws.answer(e, sigma, prescribed, before, steps)
        else:
            image = prestrain.copy().reshape(6, -1)  # removes the eigenstrain of cells whose material has been worn off
            image[:, self._linear.cells] = self._linear.answer(eigenstrain, stress, prestrain)
            if self._laws.cells.size:
                e, sigma, prescribed = (
                    values.reshape(6, -1)[:, self._at] for values in (eigenstrain, stress, prestrain)
                )
                image[:, self._at], variables = self._laws.answer(e, sigma, prescribed, before, steps)
        change = distance_of(image, eigenstrain)
        size = self._size(applied_stress, prestrain)
        if start is not None:
            size = max(size, _START_WEIGHT * norm_of(start))
        if size == 0.0:  # the history variables are the only load of the cells
            size = max(norm_of(image), norm_of(eigenstrain))
        residual = change / size if change > 0.0 else 0.0
        return Sweep(image.reshape(eigenstrain.shape), residual, size, variables)

    def misfit(
        self,
        eigenstrain: FloatArray,
        applied_stress: FloatArray,
        prestrain: FloatArray,
        before: Sequence[Mapping[str, FloatArray]],
        steps: Sequence[Any],
        start: FloatArray | None = None,
        internal_stress: FloatArray | None = None,
    ) -> float:
        """Largest difference of stress between cells and their laws, relative to the largest stress.

        The reference is a hundredth of the stress 2G ε of the eigenstrain at the start if that is larger, as in the
        residual of a sweep. See `sweep` for the parameters. The residual of a sweep has the same information for linear
        laws.
        """
        if not self._laws.cells.size:
            return 0.0
        stress = applied_stress + (self._internal_stress(eigenstrain) if internal_stress is None else internal_stress)
        e, sigma, prescribed = (values.reshape(6, -1)[:, self._at] for values in (eigenstrain, stress, prestrain))
        largest = float(np.linalg.norm(sigma, axis=0).max())
        if start is not None:
            left = float(np.linalg.norm(start.reshape(6, -1), axis=0).max())
            largest = max(largest, _START_WEIGHT * 2.0 * self._linear.matrix.shear_modulus * left)
        return self._laws.misfit(e, sigma, prescribed, before, steps) / largest if largest > 0.0 else 0.0

    def _size(self, applied_stress: FloatArray, prestrain: FloatArray) -> float:
        """Strain by the load in the cells, the reference of `InclusionReport`."""
        if self._prestrain_stress is None or self._prestrain_stress[0] is not prestrain:
            self._prestrain_stress = prestrain, self._stress_of(prestrain)
        internal_stress = self._prestrain_stress[1]
        load = (applied_stress + internal_stress if internal_stress.any() else applied_stress).reshape(6, -1)
        sizes = [norm_of(load[:, cells]) for cells in (self._linear.cells, self._at)]
        return float(np.hypot(sizes[0], sizes[1])) / (2.0 * self._linear.matrix.shear_modulus)

    def _internal_stress(self, eigenstrain: FloatArray) -> FloatArray:
        """Stress by an eigenstrain, cached for the last one, so that elastic increments need no application."""
        if self._last is None or not np.array_equal(self._last[0], eigenstrain):
            self._last = eigenstrain, self._stress_of(eigenstrain)
        return self._last[1]

    def _stress_of(self, eigenstrain: FloatArray) -> FloatArray:
        if not eigenstrain.any():
            return np.zeros_like(eigenstrain)
        self.applications += 1
        return np.asarray(self._linear.operator.apply(eigenstrain), dtype=float)
