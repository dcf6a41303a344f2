r"""Elastic constants of an inhomogeneity, in the form a solver can use for anything from a void to a rigid body.

A stiffness C (6 x 6, Mandel) enters only through the pair

    soft = (C + 2 G I)^-1    [1/Pa]        stiff = C (C + 2 G I)^-1    [-]

with the shear modulus G of the material around: both are bounded and symmetric for every stiffness, for a void
(1/2G, 0) and for an incompressible solid, whose C has an infinite eigenvalue; ``stiff + 2 G soft = I``.

References
----------
M. M. Mehrabadi and S. C. Cowin 1990, Q. J. Mech. Appl. Math. 43, 15 (Mandel form, its rotation and its eigenvalues);
S. G. Lekhnitskii 1963, Theory of Elasticity of an Anisotropic Elastic Body (engineering constants).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eigencontact.core.tensors import COMPONENTS, SQRT2
from eigencontact.errors import require

__all__ = [
    "VOID",
    "Cubic",
    "Elasticity",
    "GivenStiffness",
    "Isotropic",
    "IsotropicField",
    "TransverselyIsotropic",
    "mandel_rotation",
]

FloatArray = NDArray[np.float64]
Direction = tuple[float, float, float]

# What rounding may leave of symmetry or of a zero eigenvalue, relative to the largest entry.
_ROUNDING = 1e-9


@runtime_checkable
class Elasticity(Protocol):
    """Elastic constants as a solver asks for them."""

    def factors(self, shear_modulus: float) -> tuple[FloatArray, FloatArray]:
        """``soft`` [1/Pa] and ``stiff`` [-], ``(6, 6)``, for the shear modulus [Pa] of the material around."""
        ...


@dataclass(frozen=True, kw_only=True)
class Isotropic:
    """Isotropic elasticity.

    Parameters
    ----------
    young_modulus : float
        E [Pa], finite; 0 is a void.
    poisson_ratio : float
        ν [-] in (-1, 0.5]; 0.5 is exact.
    """

    young_modulus: float
    poisson_ratio: float

    def __post_init__(self) -> None:
        _isotropic(np.float64(self.young_modulus), np.float64(self.poisson_ratio), "isotropic")

    def factors(self, shear_modulus: float) -> tuple[FloatArray, FloatArray]:
        """See `Elasticity.factors`."""
        return _isotropic_factors(np.float64(self.young_modulus), np.float64(self.poisson_ratio), shear_modulus)


@dataclass(frozen=True, kw_only=True, eq=False)
class IsotropicField:
    """Isotropic elasticity that differs from cell to cell.

    Parameters
    ----------
    young_modulus, poisson_ratio : arrays of one shape, or of shapes that broadcast
        As for `Isotropic`, one value for each cell of the box.
    """

    young_modulus: FloatArray
    poisson_ratio: FloatArray

    def __post_init__(self) -> None:
        for name in ("young_modulus", "poisson_ratio"):
            object.__setattr__(self, name, np.asarray(getattr(self, name), dtype=float))
        _isotropic(self.young_modulus, self.poisson_ratio, "map")
        both = (self.young_modulus.shape, self.poisson_ratio.shape)
        try:
            np.broadcast_shapes(*both)
        except ValueError:
            require(False, "map", "poisson_ratio", both[1], f"of the shape of young_modulus, {both[0]}")

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the map."""
        return np.broadcast_shapes(self.young_modulus.shape, self.poisson_ratio.shape)

    def at(self, index: NDArray[np.intp]) -> IsotropicField:
        """The same in chosen cells, by flat index."""
        E, nu = (np.broadcast_to(v, self.shape).reshape(-1)[index] for v in (self.young_modulus, self.poisson_ratio))
        return IsotropicField(young_modulus=E, poisson_ratio=nu)

    def factors(self, shear_modulus: float) -> tuple[FloatArray, FloatArray]:
        """``soft`` [1/Pa] and ``stiff`` [-] of every cell, ``(*shape, 6, 6)``."""
        return _isotropic_factors(self.young_modulus, self.poisson_ratio, shear_modulus)


@dataclass(frozen=True, kw_only=True)
class Cubic:
    """Cubic crystal.

    Parameters
    ----------
    c11, c12, c44 : float
        Stiffnesses [Pa] in the usual (Voigt) notation: ``c44`` relates shear stress to twice the tensor strain.
        Not negative: c11 - c12, c11 + 2 c12, c44.
    x_axis, y_axis : (float, float, float)
        Directions [100] and [010] of the crystal in scene axes, of any length, at right angles.
    """

    c11: float
    c12: float
    c44: float
    x_axis: Direction = (1.0, 0.0, 0.0)
    y_axis: Direction = (0.0, 1.0, 0.0)

    def __post_init__(self) -> None:
        for name in ("c11", "c12", "c44"):
            require(np.isfinite(getattr(self, name)), "cubic", name, getattr(self, name), "finite [Pa]")
        require(self.c44 >= 0, "cubic", "c44", self.c44, "zero or positive [Pa]")
        size = abs(self.c11) + abs(self.c12)
        stable = min(self.c11 - self.c12, self.c11 + 2 * self.c12) >= -_ROUNDING * size
        require(stable, "cubic", "c12", self.c12, f"between -c11 / 2 and c11 = {self.c11!r} [Pa]")
        _ = self._turn

    @cached_property
    def _turn(self) -> FloatArray:
        return mandel_rotation(_frame("cubic", self.x_axis, self.y_axis))

    def factors(self, shear_modulus: float) -> tuple[FloatArray, FloatArray]:
        """See `Elasticity.factors`."""
        stiffness = np.diag([self.c11 - self.c12] * 3 + [2.0 * self.c44] * 3)
        stiffness[:3, :3] += self.c12
        return _from_stiffness(self._turn @ stiffness @ self._turn.T, shear_modulus)


@dataclass(frozen=True, kw_only=True)
class TransverselyIsotropic:
    """Isotropic across an axis: fibres, wood, hexagonal crystals.

    Parameters
    ----------
    axial_modulus, transverse_modulus : float
        Young's moduli [Pa] along and across the axis, positive.
    axial_poisson_ratio : float
        Contraction across the axis by stretching along it.
    transverse_poisson_ratio : float
        Contraction across a stretch, both across the axis. The elastic energy must not be negative; incompressible is
        allowed.
    axial_shear_modulus : float
        [Pa], of shear in planes that contain the axis; positive.
    axis : (float, float, float)
        Direction in scene axes, of any length.
    """

    axial_modulus: float
    transverse_modulus: float
    axial_poisson_ratio: float
    transverse_poisson_ratio: float
    axial_shear_modulus: float
    axis: Direction = (0.0, 0.0, 1.0)

    def __post_init__(self) -> None:
        where = "transversely-isotropic"
        for name in ("axial_modulus", "transverse_modulus", "axial_shear_modulus"):
            value = getattr(self, name)
            require(0 < value < np.inf, where, name, value, "positive and finite [Pa]")
        across, along = self.transverse_poisson_ratio, self.axial_poisson_ratio
        require(-1 < across < 1, where, "transverse_poisson_ratio", across, "in (-1, 1) [-]")
        bound = float(np.sqrt(0.5 * (1.0 - across) * self.axial_modulus / self.transverse_modulus))
        stable = abs(along) <= bound * (1.0 + _ROUNDING)
        require(stable, where, "axial_poisson_ratio", along, f"in [-{bound:.6g}, {bound:.6g}] for these moduli [-]")
        _ = self._turn

    @cached_property
    def _turn(self) -> FloatArray:
        axis = _unit("transversely-isotropic", "axis", self.axis)
        aside = np.eye(3)[int(np.argmin(np.abs(axis)))]
        first = np.cross(aside, axis)
        first /= np.linalg.norm(first)
        return mandel_rotation(np.column_stack([first, np.cross(axis, first), axis]))

    def factors(self, shear_modulus: float) -> tuple[FloatArray, FloatArray]:
        """See `Elasticity.factors`; from the compliance, which is finite for incompressible solids too."""
        across, along, nu = self.transverse_modulus, self.axial_modulus, self.transverse_poisson_ratio
        shear = 0.5 / self.axial_shear_modulus
        compliance = np.diag([1.0 / across, 1.0 / across, 1.0 / along, shear, shear, (1.0 + nu) / across])
        compliance[0, 1] = compliance[1, 0] = -nu / across
        compliance[2, :2] = compliance[:2, 2] = -self.axial_poisson_ratio / along
        stiff = np.linalg.inv(np.eye(6) + 2.0 * shear_modulus * compliance)
        soft, stiff = (self._turn @ part @ self._turn.T for part in (compliance @ stiff, stiff))
        return 0.5 * (soft + soft.T), 0.5 * (stiff + stiff.T)


@dataclass(frozen=True, kw_only=True)
class GivenStiffness:
    """Any elasticity, in scene axes.

    Parameters
    ----------
    stiffness : (6, 6)
        Mandel stiffness [Pa] (rows and columns xx, yy, zz, √2 yz, √2 xz, √2 xy: the shear entries of a Voigt matrix
        times 2, its mixed ones times √2): symmetric, without negative eigenvalues; zero is a void.
    """

    stiffness: ArrayLike = field(repr=False)

    def __post_init__(self) -> None:
        given = np.asarray(self.stiffness, dtype=float)
        good = given.shape == (6, 6) and bool(np.isfinite(given).all())
        require(good, "stiffness", "stiffness", given.tolist(), "6 x 6 and finite [Pa]")
        size = float(np.abs(given).max())
        skew = float(np.abs(given - given.T).max())
        require(skew <= _ROUNDING * size, "stiffness", "stiffness", given.tolist(), "symmetric [Pa]")
        least = float(np.linalg.eigvalsh(0.5 * (given + given.T))[0])
        rule = "without negative eigenvalues [Pa]"
        require(least >= -_ROUNDING * size, "stiffness", "stiffness", given.tolist(), rule)
        object.__setattr__(self, "stiffness", tuple(map(tuple, given.tolist())))

    def factors(self, shear_modulus: float) -> tuple[FloatArray, FloatArray]:
        """See `Elasticity.factors`."""
        return _from_stiffness(np.array(self.stiffness), shear_modulus)


def mandel_rotation(rotation: ArrayLike) -> FloatArray:
    """Matrices ``(..., 6, 6)`` that turn Mandel vectors as rotations R ``(..., 3, 3)`` turn vectors: ``R e R^T``.

    A rotation's is orthogonal, Q; a Mandel stiffness turns as ``Q C Q^T``. Any matrix may be given, a projection too.
    """
    R = np.asarray(rotation, dtype=float)
    pairs = [("xyz".index(name[0]), "xyz".index(name[1])) for name in COMPONENTS]
    out = np.empty((*R.shape[:-2], 6, 6))
    for row, (i, j) in enumerate(pairs):
        for column, (k, l) in enumerate(pairs):
            both = R[..., i, k] * R[..., j, l] + R[..., i, l] * R[..., j, k]
            out[..., row, column] = both * (SQRT2 if row > 2 else 1.0) / (SQRT2 if column > 2 else 2.0)
    return out


def _isotropic(E: NDArray[np.float64] | np.float64, nu: NDArray[np.float64] | np.float64, where: str) -> None:
    least, most = float(np.min(E)), float(np.max(E))
    require(least >= 0 and most < np.inf, where, "young_modulus", least, "zero (a void) or positive, and finite [Pa]")
    least, most = float(np.min(nu)), float(np.max(nu))
    wrong = least if not least > -1 else most
    require(least > -1 and most <= 0.5, where, "poisson_ratio", wrong, "in (-1, 0.5] [-]")


def _isotropic_factors(E: ArrayLike, nu: ArrayLike, G: float) -> tuple[FloatArray, FloatArray]:
    """Volumetric and deviatoric parts; written with 1 - 2ν above the line, so that 0.5 is an ordinary value."""
    E, nu = np.broadcast_arrays(np.asarray(E, dtype=float), np.asarray(nu, dtype=float))
    void = E == 0.0
    squeeze = E + np.where(void, 2.0 * G, 2.0 * G * (1.0 - 2.0 * nu))
    soft_volume = np.where(void, 1.0, 1.0 - 2.0 * nu) / squeeze
    shear = E + 2.0 * G * (1.0 + nu)
    volume = np.zeros((6, 6))
    volume[:3, :3] = 1.0 / 3.0
    deviator = np.eye(6) - volume

    def both(of_volume: FloatArray, of_shear: FloatArray) -> FloatArray:
        return np.asarray(of_volume[..., None, None] * volume + of_shear[..., None, None] * deviator)

    return both(soft_volume, (1.0 + nu) / shear), both(E / squeeze, E / shear)


def _from_stiffness(stiffness: FloatArray, G: float) -> tuple[FloatArray, FloatArray]:
    values, axes = np.linalg.eigh(0.5 * (stiffness + stiffness.T))
    values = np.maximum(values, 0.0)
    return (axes / (values + 2.0 * G)) @ axes.T, (axes * (values / (values + 2.0 * G))) @ axes.T


def _unit(where: str, name: str, direction: Sequence[float]) -> FloatArray:
    given = np.asarray(direction, dtype=float)
    good = given.shape == (3,) and bool(np.isfinite(given).all()) and bool(given.any())
    require(good, where, name, direction, "three finite numbers (x, y, z), not all zero")
    given = given / np.abs(given).max()
    return np.asarray(given / np.linalg.norm(given))


def _frame(where: str, x_axis: Sequence[float], y_axis: Sequence[float]) -> FloatArray:
    """Rotation whose columns are the axes of a crystal."""
    x, y = _unit(where, "x_axis", x_axis), _unit(where, "y_axis", y_axis)
    require(abs(x @ y) <= 1e-6, where, "y_axis", tuple(y_axis), f"at right angles to x_axis = {tuple(x_axis)}")
    y = y - (x @ y) * x
    y /= np.linalg.norm(y)
    return np.column_stack([x, y, np.cross(x, y)])


#: No material at all: it carries no stress.
VOID = Isotropic(young_modulus=0.0, poisson_ratio=0.0)
