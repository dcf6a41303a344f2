r"""Conditions on stress and eigenstrain in the cells of an inhomogeneous body, including cells cut by a boundary.

A cell of stiffness C_i in a matrix of stiffness C_m, compliance M_m, with mean stress σ and eigenstrain ε*, satisfies

    P σ + Q ε* = R ε_p,    P = stiff M_m - soft,  Q = R = stiff,    stiff = C_i (C_i + 2G)^-1,  soft = (C_i + 2G)^-1,

with the shear modulus G of the matrix. P, Q and R are bounded for a void, a rigid cell and an incompressible matrix. In
a cut cell material 1 fills a fraction f, and material 2 the rest. The stresses of both parts depend on the mean stress
and, through a tensor T, on the difference of their eigenstrains ε_1 - ε_2,

    σ_1 = σ - (1-f) T (ε_1 - ε_2),    σ_2 = σ + f T (ε_1 - ε_2),    ε* = f ε_1 + (1-f) ε_2,

and elimination of ε_1 and ε_2 gives P, Q and R of the cell. T = 0 is Reuss' mixture (equal stress), and T = C_m is
Voigt's (equal strain). T of a ball, C_m (I - S), is that of Hashin and Shtrikman. T of a layer with the normal of the
boundary is exact for flat boundaries much larger than a cell. The program uses T of a ball without a known normal,
otherwise mostly T of a layer.

References
----------
G. W. Milton 2002, The Theory of Composites, chapter 9 (laminates); J. D. Eshelby 1957, Proc. R. Soc. Lond. A 241, 376;
Z. Hashin and S. Shtrikman 1963, J. Mech. Phys. Solids 11, 127.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eigencontact.core.array_types import FloatArray
from eigencontact.core.elasticity import (
    Elasticity,
    ElasticityOfCells,
    checked_stiffness,
    factors_of_stiffness,
    isotropic,
    isotropic_factors,
    mandel_rotation,
)
from eigencontact.core.material import Material
from eigencontact.core.tensors import INDICES, SQRT2
from eigencontact.errors import require

__all__ = [
    "Condition",
    "Conditions",
    "Shares",
    "compliance",
    "condition_of",
    "constraint_of_ball",
    "constraint_of_cut",
    "constraint_of_layer",
    "mixed",
]

IntArray = NDArray[np.int_]

# Weight of a ball's T in cut cells with a known normal. With a layer's T alone, a void or a rigid inclusion seems
# larger, by the extent of its cut cells beyond it, because cells are not infinite layers. Measured on Eshelby's sphere
# with 5 to 10 cells per radius: 0.1 to 0.3 are best from void to rigid, 0.1 for the stress inside.
_ROUND = 0.1


class Condition(NamedTuple):
    """Factors P [1/Pa], Q [-], R [-] of ``P σ + Q ε* = R ε_p``, ``(6, 6)`` or one for each cell, ``(n, 6, 6)``."""

    stress: FloatArray
    strain: FloatArray
    prestrain: FloatArray


@dataclass(frozen=True)
class Shares:
    """Fractions of materials in cut cells, by flat index.

    Attributes
    ----------
    mixed : (n,) of bool
        Cells with two materials.
    fraction : (n,)
        Fraction of the first material.
    beside : (n,) of int
        Index of the second material.
    normal : (3, n) or None
        Normal of the boundary.
    """

    mixed: NDArray[np.bool_]
    fraction: FloatArray
    beside: IntArray
    normal: FloatArray | None

    @classmethod
    def of(
        cls,
        index: IntArray,
        fraction: ArrayLike | None,
        beside: ArrayLike | None,
        normal: ArrayLike | None,
        materials: int,
    ) -> Shares:
        """Check and flatten the input."""
        where, shape = "inclusions", index.shape
        share = np.ones(shape) if fraction is None else np.asarray(fraction, dtype=float)
        require(share.shape == shape, where, "fraction", share.shape, f"of shape {shape}")
        read = share[index > 0]
        good = not read.size or bool(read.min() > 0.0 and read.max() <= 1.0)
        require(good, where, "fraction", "values outside" if read.size else 0, "above 0 and up to 1 in every cell")
        second = np.zeros(shape, dtype=int) if beside is None else np.asarray(beside)
        require(second.dtype.kind in "iu", where, "beside", second.dtype, "of integers")
        require(second.shape == shape, where, "beside", second.shape, f"of shape {shape}")
        rule = f"from 0 (the matrix) to {materials}, the number of materials given"
        require(second.min() >= 0 and second.max() <= materials, where, "beside", int(second.max()), rule)
        across = None if normal is None else np.asarray(normal, dtype=float)
        if across is not None:
            require(across.shape == (3, *shape), where, "normal", across.shape, f"of shape {(3, *shape)}")
            require(bool(np.isfinite(across).all()), where, "normal", "NaN or infinity", "finite")
            across = across.reshape(3, -1)
        cut = (index > 0) & (share < 1.0) & (index != second)
        return cls(cut.ravel(), share.ravel(), second.ravel(), across)


class Conditions:
    """Conditions of the cells of one box."""

    def __init__(self, matrix: Material, materials: Sequence[Elasticity | ElasticityOfCells | ArrayLike]) -> None:
        self.matrix, self._materials = matrix, materials

    def of(self, cells: NDArray[np.intp], index: IntArray, shares: Shares) -> Iterator[tuple[slice, Condition]]:
        """Runs of cells and their conditions: whole cells by material, then all cut cells.

        `cells` are flat indices, whole ones first and by material.
        """
        cut = int(np.count_nonzero(~shares.mixed[cells]))
        names, starts = np.unique(index[cells[:cut]], return_index=True)
        for name, start, stop in zip(names, starts, [*starts[1:], cut][: names.size], strict=True):
            yield slice(int(start), int(stop)), self._of_material(int(name), cells[start:stop])
        if cut < cells.size:
            yield slice(cut, cells.size), self._cut(cells[cut:], index, shares)

    def _of_material(self, name: int, cells: NDArray[np.intp]) -> Condition:
        """Condition of one material; material 0 is the matrix with P = 0."""
        if name == 0:
            matrix = self.matrix
            stiff = isotropic_factors(matrix.young_modulus, matrix.poisson_ratio, matrix.shear_modulus)[1]
            return Condition(np.zeros((6, 6)), stiff, stiff)
        item = self._materials[name - 1]
        return condition_of(item.of_cells(cells) if isinstance(item, ElasticityOfCells) else item, self.matrix)

    def _by_cell(self, names: IntArray, cells: NDArray[np.intp]) -> Condition:
        stress, strain = np.empty((2, cells.size, 6, 6))
        for name in np.unique(names):
            of_name = names == name
            stress[of_name], strain[of_name], _ = self._of_material(int(name), cells[of_name])
        return Condition(stress, strain, strain)

    def _cut(self, cells: NDArray[np.intp], index: IntArray, shares: Shares) -> Condition:
        first, second = self._by_cell(index[cells], cells), self._by_cell(shares.beside[cells], cells)
        normals = np.zeros((cells.size, 3))
        if shares.normal is not None:
            normals[shares.beside[cells] == 0] = shares.normal[:, cells[shares.beside[cells] == 0]].T
        return mixed(first, second, shares.fraction[cells], constraint_of_cut(self.matrix, normals))


def condition_of(material: Elasticity | ArrayLike, matrix: Material) -> Condition:
    """Condition of a material in a matrix."""
    if isinstance(material, Elasticity):
        soft, stiff = material.factors(matrix.shear_modulus)
    else:
        soft, stiff = factors_of_stiffness(checked_stiffness("inclusions", "material", material), matrix.shear_modulus)
    return Condition(stiff @ compliance(matrix) - soft, stiff, stiff)


def mixed(first: Condition, second: Condition, fraction: FloatArray, constraint: FloatArray) -> Condition:
    """Conditions of cut cells, all ``(n, 6, 6)``; `fraction` ``(n,)`` is that of the first material."""
    f = fraction[:, None, None]
    (P1, Q1, _), (P2, Q2, _) = first, second
    difference1, difference2 = Q1 - P1 @ constraint, Q2 - P2 @ constraint
    # Contribution of the difference of the two eigenstrains to the mean condition, from the condition of the
    # difference.
    mean = (1.0 - f) * difference1 + f * difference2
    weight = np.linalg.solve(mean.swapaxes(1, 2), (difference1 - difference2).swapaxes(1, 2)).swapaxes(1, 2)
    stress = f * P1 + (1.0 - f) * P2 - f * (1.0 - f) * weight @ (P1 - P2)
    strain = f * Q1 + (1.0 - f) * Q2 - f * (1.0 - f) * weight @ (Q1 - Q2)
    return Condition(stress, strain, Q1 - (1.0 - f) * weight @ Q1)


def constraint_of_ball(matrix: Material) -> FloatArray:
    """T = C_m (I - S) [Pa] of a ball in the matrix, ``(6, 6)``; finite for ν = 0.5."""
    nu, G = matrix.poisson_ratio, matrix.shear_modulus
    of_volume = 4.0 * G * (1.0 + nu) / (3.0 * (1.0 - nu))
    return isotropic(np.array(of_volume), np.array(2.0 * G * (7.0 - 5.0 * nu) / (15.0 * (1.0 - nu))))


def constraint_of_cut(matrix: Material, normals: FloatArray) -> FloatArray:
    """T [Pa] of cut cells, ``(n, 6, 6)``, by the normals of the boundaries in them ``(n, 3)``; zero if unknown."""
    constraint = np.broadcast_to(constraint_of_ball(matrix), (len(normals), 6, 6)).copy()
    flat = np.abs(normals).max(axis=1) > 0.0
    constraint[flat] = _ROUND * constraint[flat] + (1.0 - _ROUND) * constraint_of_layer(matrix, normals[flat])
    return constraint


def constraint_of_layer(matrix: Material, normals: FloatArray) -> FloatArray:
    """T [Pa] of flat layers, ``(n, 6, 6)``, with plane stress in the plane of the layer.

    `normals` are ``(n, 3)``, of any nonzero length.
    """
    nu, G = matrix.poisson_ratio, matrix.shear_modulus
    n = normals / np.linalg.norm(normals, axis=1, keepdims=True)
    planes = np.eye(3) - n[:, :, None] * n[:, None, :]
    trace = np.stack([planes[:, i, j] * (1.0 if i == j else SQRT2) for i, j in INDICES], axis=1)
    return np.asarray(2.0 * G * (mandel_rotation(planes) + nu / (1.0 - nu) * trace[:, :, None] * trace[:, None, :]))


def compliance(material: Material) -> FloatArray:
    """Mandel compliance ``(6, 6)`` [1/Pa]; also finite for ν = 0.5."""
    nu = material.poisson_ratio
    out = (1.0 + nu) * np.eye(6)
    out[:3, :3] -= nu
    return out / material.young_modulus
