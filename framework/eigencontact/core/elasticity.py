r"""Elastic constants in the form a solver can use for anything from a void to a rigid body.

A stiffness C (6 x 6, Mandel) enters only through the pair

    soft = (C + 2 G I)^-1    [1/Pa]        stiff = C (C + 2 G I)^-1    [-]

with the shear modulus G of the material around: both are bounded and symmetric for every stiffness, for a void
(1/2G, 0) and for an incompressible solid, whose C has an infinite eigenvalue; ``stiff + 2 G soft = I``.

References
----------
M. M. Mehrabadi and S. C. Cowin 1990, Q. J. Mech. Appl. Math. 43, 15 (Mandel form, its rotation and its eigenvalues).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eigencontact.core.array_types import FloatArray
from eigencontact.core.tensors import INDICES, SQRT2
from eigencontact.errors import require

__all__ = [
    "Elasticity",
    "ElasticityOfCells",
    "checked_stiffness",
    "factors_of_compliance",
    "factors_of_stiffness",
    "frame_of",
    "isotropic",
    "isotropic_factors",
    "isotropic_stiffness",
    "mandel_rotation",
    "shear_ratios",
    "unit_vector",
]

# What rounding may leave of symmetry or of a zero eigenvalue, relative to the largest entry.
_ROUNDING = 1e-9


@runtime_checkable
class Elasticity(Protocol):
    """Elastic constants in the form that the solvers use."""

    def factors(self, shear_modulus: float) -> tuple[FloatArray, FloatArray]:
        """``soft`` [1/Pa] and ``stiff`` [-], ``(6, 6)``, for the shear modulus [Pa] of the material around."""


@runtime_checkable
class ElasticityOfCells(Protocol):
    """Elastic constants that differ from cell to cell of a box."""

    def of_cells(self, index: NDArray[np.intp]) -> Elasticity:
        """Elasticity of chosen cells, by flat index; its factors are ``(n, 6, 6)``."""


def factors_of_stiffness(stiffness: ArrayLike, shear_modulus: float) -> tuple[FloatArray, FloatArray]:
    """``soft`` and ``stiff`` of Mandel stiffnesses ``(..., 6, 6)`` [Pa] without negative eigenvalues.

    Examples
    --------
    >>> soft, stiff = factors_of_stiffness(np.zeros((6, 6)), 0.5)
    >>> bool(np.all(soft == np.eye(6))), bool(np.any(stiff))
    (True, False)
    """
    matrices, double_shear = np.asarray(stiffness, dtype=float), 2.0 * shear_modulus
    values, axes = np.linalg.eigh(0.5 * (matrices + matrices.swapaxes(-1, -2)))
    values = np.maximum(values, 0.0)[..., None, :]
    turned = axes.swapaxes(-1, -2)
    return (axes / (values + double_shear)) @ turned, (axes * (values / (values + double_shear))) @ turned


def factors_of_compliance(compliance: ArrayLike, shear_modulus: float) -> tuple[FloatArray, FloatArray]:
    """``soft`` and ``stiff`` of a Mandel compliance ``(6, 6)`` [1/Pa], which may be singular: incompressible solids.

    Examples
    --------
    >>> soft, stiff = factors_of_compliance(np.zeros((6, 6)), 1.0)  # rigid
    >>> bool(np.allclose(stiff, np.eye(6)) and not soft.any())
    True
    """
    matrix = np.asarray(compliance, dtype=float)
    stiff = np.linalg.inv(np.eye(6) + 2.0 * shear_modulus * matrix)
    soft = matrix @ stiff
    return 0.5 * (soft + soft.T), 0.5 * (stiff + stiff.T)


def isotropic_factors(
    young_modulus: ArrayLike, poisson_ratio: ArrayLike, shear_modulus: float
) -> tuple[FloatArray, FloatArray]:
    """``soft`` and ``stiff`` of isotropic solids, ``(..., 6, 6)``; E = 0 is a void, ν = 0.5 is exact.

    Examples
    --------
    >>> soft, stiff = isotropic_factors(2.6, 0.5, 1.0)  # incompressible: the stiffness is not finite, the factors are
    >>> bool(np.allclose(stiff + 2.0 * soft, np.eye(6)))
    True
    """
    E, nu = np.broadcast_arrays(np.asarray(young_modulus, dtype=float), np.asarray(poisson_ratio, dtype=float))
    G, void = shear_modulus, E == 0.0
    # Written with 1 - 2ν above the line, so that 0.5 is an ordinary value.
    squeeze = E + np.where(void, 2.0 * G, 2.0 * G * (1.0 - 2.0 * nu))
    soft_volume = np.where(void, 1.0, 1.0 - 2.0 * nu) / squeeze
    shear = E + 2.0 * G * (1.0 + nu)
    soft, stiff = isotropic(soft_volume, (1.0 + nu) / shear), isotropic(E / squeeze, E / shear)
    return soft, stiff


def shear_ratios(elasticity: Elasticity, shear_modulus: float) -> tuple[float, float]:
    """Least and largest stiffness against a change of shape, relative to that of the material around.

    Of the six eigenvalues of the stiffness, over 2 G, the largest is left out: that against a change of volume.

    Examples
    --------
    >>> class Twice:
    ...     def factors(self, shear_modulus):
    ...         return isotropic_factors(2.6 * 2.0, 0.3, shear_modulus)
    >>> [round(ratio, 9) for ratio in shear_ratios(Twice(), 1.0)]
    [2.0, 2.0]
    """
    _, stiff = elasticity.factors(shear_modulus)
    values = np.linalg.eigvalsh(stiff)[..., :-1]
    ratios = values / np.maximum(1.0 - values, np.finfo(float).tiny)
    return max(float(ratios.min()), 0.0), float(ratios.max())


def isotropic_stiffness(young_modulus: ArrayLike, poisson_ratio: ArrayLike) -> FloatArray:
    """Mandel stiffness ``(..., 6, 6)`` [Pa] of isotropic solids; infinite entries at ν = 0.5.

    Examples
    --------
    >>> isotropic_stiffness(2.6, 0.3).diagonal().round(6).tolist()
    [3.5, 3.5, 3.5, 2.0, 2.0, 2.0]
    """
    E, nu = np.broadcast_arrays(np.asarray(young_modulus, dtype=float), np.asarray(poisson_ratio, dtype=float))
    with np.errstate(divide="ignore", invalid="ignore"):
        volume = np.where(E == 0.0, 0.0, E / (1.0 - 2.0 * nu))
    return isotropic(volume, E / (1.0 + nu))


def isotropic(of_volume: FloatArray, of_shear: FloatArray) -> FloatArray:
    """Isotropic matrices from their values for pure dilatation and for shear."""
    volume = np.zeros((6, 6))
    volume[:3, :3] = 1.0 / 3.0
    return np.asarray(of_volume[..., None, None] * volume + of_shear[..., None, None] * (np.eye(6) - volume))


def checked_stiffness(where: str, name: str, stiffness: ArrayLike) -> FloatArray:
    """Mandel stiffness ``(6, 6)`` [Pa], refused unless finite, symmetric and without negative eigenvalues.

    Examples
    --------
    >>> checked_stiffness("crystal", "stiffness", np.eye(6)).shape
    (6, 6)
    """
    matrix = np.asarray(stiffness, dtype=float)
    require(matrix.shape == (6, 6), where, name, matrix.tolist(), "of 6 x 6 Mandel components [Pa]")
    require(bool(np.isfinite(matrix).all()), where, name, matrix.tolist(), "finite [Pa]")
    size = float(np.abs(matrix).max())
    symmetric = float(np.abs(matrix - matrix.T).max()) <= _ROUNDING * size
    require(symmetric, where, name, matrix.tolist(), "symmetric, 6 x 6 Mandel components [Pa]")
    least = float(np.linalg.eigvalsh(0.5 * (matrix + matrix.T))[0])
    require(least >= -_ROUNDING * size, where, name, matrix.tolist(), "without negative eigenvalues [Pa]")
    return matrix


def mandel_rotation(rotation: ArrayLike) -> FloatArray:
    """Matrices ``(..., 6, 6)`` that turn Mandel vectors as rotations R ``(..., 3, 3)`` turn vectors: ``R e R^T``.

    A rotation's is orthogonal, Q; a Mandel stiffness turns as ``Q C Q^T``. Any matrix may be given, a projection too.

    Examples
    --------
    >>> turned = mandel_rotation([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])  # x becomes y
    >>> (turned @ [1.0, 0.0, 0.0, 0.0, 0.0, 0.0]).tolist()
    [0.0, 1.0, 0.0, 0.0, 0.0, 0.0]
    """
    R = np.asarray(rotation, dtype=float)
    out = np.empty((*R.shape[:-2], 6, 6))
    for row, (i, j) in enumerate(INDICES):
        for column, (k, l) in enumerate(INDICES):
            products = R[..., i, k] * R[..., j, l] + R[..., i, l] * R[..., j, k]
            out[..., row, column] = products * (SQRT2 if row > 2 else 1.0) / (SQRT2 if column > 2 else 2.0)
    return out


def unit_vector(where: str, name: str, direction: Sequence[float]) -> FloatArray:
    """Unit vector ``(3,)`` along a direction of any length; refuses vectors without a direction.

    Examples
    --------
    >>> unit_vector("crystal", "axis", (0, 3, 4)).tolist()
    [0.0, 0.6, 0.8]
    """
    vector = np.asarray(direction, dtype=float)
    good = vector.shape == (3,) and bool(np.isfinite(vector).all()) and bool(vector.any())
    require(good, where, name, direction, "three finite numbers (x, y, z), not all zero")
    vector = vector / np.abs(vector).max()
    return np.asarray(vector / np.linalg.norm(vector))


def frame_of(where: str, x_axis: Sequence[float], y_axis: Sequence[float]) -> FloatArray:
    """Rotation ``(3, 3)`` whose columns are the axes of a crystal; two axes must be perpendicular to within 1e-6.

    Examples
    --------
    >>> (frame_of("crystal", (0, 2, 0), (-1, 0, 0)) + 0.0).tolist()
    [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]
    """
    x, y = unit_vector(where, "x_axis", x_axis), unit_vector(where, "y_axis", y_axis)
    require(abs(x @ y) <= 1e-6, where, "y_axis", tuple(y_axis), f"at right angles to x_axis = {tuple(x_axis)}")
    y = y - (x @ y) * x
    y /= np.linalg.norm(y)
    return np.column_stack([x, y, np.cross(x, y)])
