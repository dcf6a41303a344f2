"""Inhomogeneities as cells of other elastic constants: the equivalent eigenstrain of all cells from one linear system.

A cell with stiffness C_i and prestrain ε_p carries, with an eigenstrain ε*, the stress of the matrix (stiffness C_m,
compliance M_m),

    σ = σ_0 + A ε*,    C_i (M_m σ + ε* - ε_p) = σ,

where A ε* is the stress by all eigenstrains, and M_m σ + ε* is the total strain. The unknown is the part x by the
difference of the constants, ε* = ε_p + x. The condition of each cell is multiplied by (C_i + 2 μ_m)^-1, so that its
coefficients stay bounded for a void (the condition is then σ = 0), for a rigid cell (total strain = ε_p) and for an
incompressible matrix with infinite C_m. It is then multiplied by the inverse of the response of a single cell. The
result is a strain per strain, and its residual is the error of the eigenstrain of each cell under the present
eigenstrain of the others.

References
----------
J. D. Eshelby 1957, Proc. R. Soc. Lond. A 241, 376 (the method, one ellipsoid); T. Mura 1987, Micromechanics of Defects
in Solids, section 22; K. Zhou, W. W. Hoh, X. Wang, L. M. Keer, J. H. L. Pang, B. Song and Q. J. Wang 2013, Mech. Mater.
60, 144 (review, cells with FFT).
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eigencontact.core.array_types import FloatArray
from eigencontact.core.elasticity import Elasticity, ElasticityOfCells
from eigencontact.core.material import Material
from eigencontact.errors import require
from eigencontact.solvers.cell_conditions import Conditions, Shares
from eigencontact.solvers.cells import Cells
from eigencontact.solvers.inclusion_system import InclusionSystem

__all__ = [
    "InhomogeneousCells",
    "StressOperator",
]


class StressOperator(Protocol):
    """Stress in the cells by their eigenstrain (for example ``MeanVolumeField``)."""

    source: Cells
    target: Cells
    quantity: str
    poisson_ratio: float
    shear_modulus: float

    def apply(self, eigenstrain: ArrayLike) -> NDArray[np.floating]:
        """Stress [Pa] of an eigenstrain, both ``(6, nz, ny, nx)``."""


class InhomogeneousCells(InclusionSystem):
    """Linear system of one arrangement of materials; `solve` accepts fields ``(6, nz, ny, nx)``.

    Parameters
    ----------
    operator : StressOperator
        Stress by eigenstrain in the same cells, for the constants of the matrix, as the mean over each cell
        (`eigencontact.solvers.mean_stress.MeanVolumeField`). With values at the cell centres, cells of less than a
        fifth of the matrix's stiffness may need a thousand iterations, and voids have no solution.
    matrix : Material
        Surrounding material; ν up to 0.5.
    materials : sequence of Elasticity, ElasticityOfCells or (6, 6)
        Materials 1, 2, ...: elastic constants (`eigencontact.core.elasticity`) or a Mandel stiffness [Pa].
    material_index : (nz, ny, nx) of int
        Material of each cell, 0 is the matrix.
    fraction : (nz, ny, nx), optional
        Fraction of each cell filled by its material, above 0 and up to 1; ignored for index 0. By default 1.
    beside : (nz, ny, nx) of int, optional
        Material of the rest of cells with a fraction below 1; by default 0, the matrix.
    normal : (3, nz, ny, nx), optional
        Normal of the boundary in cells with a fraction below 1, of any length and sign; zero if unknown.

    Notes
    -----
    Six applications of the operator to the middle cell determine the response of a single cell. In cells more than
    about a hundred times stiffer than the matrix, the mean stress of the region is as accurate as elsewhere, but its
    distribution among the cells is not: it causes very small strains, and the steps of the cell boundary disturb it.
    """

    tolerance, max_iterations, restart = 1e-6, 500, 60

    def __init__(
        self,
        operator: StressOperator,
        matrix: Material,
        materials: Sequence[Elasticity | ElasticityOfCells | ArrayLike],
        material_index: ArrayLike,
        *,
        fraction: ArrayLike | None = None,
        beside: ArrayLike | None = None,
        normal: ArrayLike | None = None,
    ) -> None:
        index = np.asarray(material_index)
        _check(operator, matrix, len(materials), index)
        self.operator, self.matrix, self.shape = operator, matrix, operator.source.shape
        shares = Shares.of(index, fraction, beside, normal, len(materials))
        flat = index.ravel()
        # Whole cells first, by material, then cut cells.
        order = np.lexsort((flat, shares.mixed))
        self._cells = order[flat[order] > 0]
        self._parts: list[tuple[slice, FloatArray]] = []
        self._offset: FloatArray | None = None
        if self._cells.size == 0:
            return
        for cells, (stress, strain, prestrain) in Conditions(matrix, materials).of(self._cells, flat, shares):
            condition = stress @ self.self_stress + strain
            self._parts.append((cells, _by_component(np.linalg.solve(condition, stress))))
            if prestrain is not strain:  # cut cells, one run at the end
                self._offset = _by_component(np.linalg.solve(condition, prestrain - strain))

    @cached_property
    def self_stress(self) -> FloatArray:
        """Stress in a cell by its own eigenstrain, ``(6, 6)`` [Pa]."""
        k, j, i = (n // 2 for n in self.shape)
        out = np.empty((6, 6))
        for component in range(6):
            strain = np.zeros((6, *self.shape))
            strain[component, k, j, i] = 1.0
            out[:, component] = self.operator.apply(strain)[:, k, j, i]
        return out

    @property
    def cells(self) -> NDArray[np.intp]:
        """Flat indices of the cells with other constants."""
        return self._cells

    def answer(self, eigenstrain: FloatArray, stress: FloatArray, prestrain: FloatArray) -> FloatArray:
        """Eigenstrain of each cell under the present eigenstrain of the others: ``(6, n)`` of the `cells`.

        Parameters
        ----------
        eigenstrain, stress, prestrain : (6, nz, ny, nx)
            Present eigenstrain, the total stress [Pa] under it, and the prestrain of the cells.
        """
        flat = [self._unknowns(values) for values in (eigenstrain, stress, prestrain)]
        equivalent = flat[0] - flat[2]
        return flat[0] + self._residual(equivalent, flat[1]) + self._shift(prestrain)

    def _residual(self, x: FloatArray, stress: FloatArray) -> FloatArray:
        """Residual of each cell's condition, as the eigenstrain that removes it in this cell."""
        foreign = stress - self.self_stress @ x
        out = np.empty_like(x)
        for cells, matrix in self._parts:
            out[:, cells] = _product(matrix, foreign[:, cells])
        out += x
        return np.negative(out, out=out)

    def _shift(self, prestrain: FloatArray) -> FloatArray | float:
        """Contribution of a prestrain to the conditions of cut cells, in which only one material has it."""
        if self._offset is None or not prestrain.any():
            return 0.0
        out = np.zeros((6, self._cells.size))
        last = self._parts[-1][0]
        out[:, last] = _product(self._offset, prestrain.reshape(6, -1)[:, self._cells[last]])
        return out

    def _unknowns(self, values: FloatArray) -> FloatArray:
        return values.reshape(6, -1)[:, self._cells]

    def _spread(self, x: FloatArray) -> FloatArray:
        out = np.zeros((6, int(np.prod(self.shape))))
        out[:, self._cells] = x
        return out.reshape(6, *self.shape)

    def _stress_of(self, eigenstrain: FloatArray) -> FloatArray:
        return np.asarray(self.operator.apply(eigenstrain), dtype=float)


def _by_component(matrices: NDArray[np.floating]) -> FloatArray:
    """Matrices of cells, ``(n, 6, 6)``, as ``(6, 6, n)``; a single matrix ``(6, 6)`` unchanged."""
    return np.ascontiguousarray(matrices if matrices.ndim == 2 else np.moveaxis(matrices, 0, 2), dtype=float)


def _product(matrices: FloatArray, vectors: FloatArray) -> FloatArray:
    """Matrices ``(6, 6)`` or ``(6, 6, n)`` times vectors ``(6, n)``."""
    if matrices.ndim == 2:
        return np.asarray(matrices @ vectors)
    return np.asarray(np.einsum("ijn,jn->in", matrices, vectors))


def _check(operator: StressOperator, matrix: Material, materials: int, index: NDArray[np.int_]) -> None:
    where = "inclusions"
    require(operator.quantity == "stress", where, "operator", operator.quantity, "one that gives stress")
    require(operator.source == operator.target, where, "operator", operator.target, "one from cells to the same cells")
    constants = (operator.poisson_ratio, operator.shear_modulus)
    equal_constants = np.allclose(constants, (matrix.poisson_ratio, matrix.shear_modulus), rtol=1e-9, atol=0.0)
    require(equal_constants, where, "matrix", matrix, f"of the operator's constants (ν, G) = {constants}")
    shape = operator.source.shape
    require(index.dtype.kind in "iu", where, "material_index", index.dtype, "of integers")
    require(index.shape == shape, where, "material_index", index.shape, f"of shape {shape}")
    rule = f"from 0 (the matrix) to {materials}, the number of materials given"
    require(index.min() >= 0 and index.max() <= materials, where, "material_index", int(index.max()), rule)
