"""Isotropic elasticity whose constants are read from a file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from eigencontact.plugin import (
    Component,
    ConstitutiveLaw,
    DataFile,
    LawStep,
    LinearLaw,
    Response,
    SceneError,
    hookimpl,
    isotropic_factors,
    isotropic_stiffness,
    require,
)

if TYPE_CHECKING:
    from collections.abc import Iterable

__all__ = ["ElasticityMap"]

FloatArray = NDArray[np.float64]
_AXES, _CONSTANTS = ("z", "y", "x"), ("young_modulus", "poisson_ratio")


@dataclass(frozen=True, kw_only=True)
class ElasticityMap(ConstitutiveLaw):
    """Isotropic constants at the points of a lattice: linear between them, those of its border outside.

    Parameters
    ----------
    file : path
        ``.npz``, or NetCDF (``.nc``), with ``x``, ``y``, ``z`` [m], ascending, ``young_modulus`` [Pa] (0 is a void) and
        ``poisson_ratio`` [-] on them ``(nz, ny, nx)``, or single numbers.
    """

    key: ClassVar[str] = "map"
    references: ClassVar[tuple[str, ...]] = ("T. Mura 1987, Micromechanics of Defects in Solids, section 22",)

    file: DataFile

    def __post_init__(self) -> None:
        _ = self._lattice  # read and checked now, not in the middle of a run

    @cached_property
    def _lattice(self) -> tuple[tuple[FloatArray, FloatArray, FloatArray], FloatArray]:
        """Axes (z, y, x), and E and ν ``(nz, ny, nx, 2)``."""
        require(Path(self.file).is_file(), self.key, "file", self.file, "an existing file")
        data = self._read()
        missing = [name for name in (*_AXES, *_CONSTANTS) if name not in data]
        require(not missing, self.key, "file", self.file, f"a file with {', '.join(missing)}")
        axes = tuple(np.asarray(data[name], dtype=float) for name in _AXES)
        good = all(axis.ndim == 1 and axis.size > 1 and np.all(np.diff(axis) > 0) for axis in axes)
        require(good, self.key, "file", self.file, "with x, y, z of two ascending numbers and more [m]")
        shape = tuple(axis.size for axis in axes)
        values = [np.asarray(data[name], dtype=float) for name in _CONSTANTS]
        right = all(item.shape in (shape, ()) for item in values)
        rule = f"with young_modulus and poisson_ratio of shape (z, y, x) = {shape}"
        require(right, self.key, "file", self.file, rule)
        E, nu = values
        rule = "young_modulus must be zero (a void) or positive, and finite [Pa]"
        require(bool(np.all((E >= 0) & (np.inf > E))), self.key, "file", self.file, f"a file whose {rule}")
        rule = "a file whose poisson_ratio must be in (-1, 0.5] [-]"
        require(bool(np.all((nu > -1) & (nu <= 0.5))), self.key, "file", self.file, rule)
        both = np.stack([np.broadcast_to(item, shape) for item in values], axis=-1)
        return (axes[0], axes[1], axes[2]), both

    def _read(self) -> dict[str, Any]:
        try:
            if self.file.endswith(".npz"):
                with np.load(self.file) as data:
                    return dict(data)
            import xarray

            with xarray.open_dataset(self.file) as data:
                return {str(name): variable.values for name, variable in data.variables.items()}
        except (OSError, ValueError) as problem:
            first = str(problem).strip().split("\n")[0]
            raise SceneError(
                f"{self.key}.file must be a readable .npz or NetCDF file (got {self.file!r}): {first}"
            ) from problem

    def at(self, x: FloatArray, y: FloatArray, z: FloatArray) -> IsotropicPoints:
        """See `VariesInSpace.at`."""
        from scipy.interpolate import RegularGridInterpolator

        axes, values = self._lattice
        held = [np.clip(place, axis[0], axis[-1]) for place, axis in zip((z, y, x), axes, strict=True)]
        found = np.asarray(RegularGridInterpolator(axes, values)(np.stack(held, axis=-1)), dtype=float)
        return IsotropicPoints(young_modulus=found[..., 0], poisson_ratio=found[..., 1])

    def update(self, strain: FloatArray, before: Mapping[str, FloatArray], step: LawStep) -> Response:
        """See `ConstitutiveLaw.update`."""
        return self.at(step.x, step.y, step.z).update(strain, before, step)

    @property
    def words(self) -> str:
        """See `ConstitutiveLaw.words`."""
        return f"the map {self.file}"


@dataclass(frozen=True, kw_only=True, eq=False)
class IsotropicPoints(LinearLaw):
    """Isotropic elasticity, point by point: E [Pa] and ν [-], each ``(n,)``."""

    key: ClassVar[str] = "map"

    young_modulus: FloatArray
    poisson_ratio: FloatArray

    def stiffness_matrix(self) -> FloatArray:
        """See `LinearLaw.stiffness_matrix`."""
        solid = (self.young_modulus == 0) | (self.poisson_ratio < 0.5)
        require(bool(solid.all()), self.key, "poisson_ratio", 0.5, "below 0.5 for a finite stiffness")
        return isotropic_stiffness(self.young_modulus, self.poisson_ratio)

    def factors(self, shear_modulus: float) -> tuple[FloatArray, FloatArray]:
        """See `LinearLaw.factors`."""
        return isotropic_factors(self.young_modulus, self.poisson_ratio, shear_modulus)


@hookimpl
def eigencontact_register() -> Iterable[type[Component]]:
    """Register the map."""
    return [ElasticityMap]
