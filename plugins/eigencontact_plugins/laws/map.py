"""Isotropic elasticity with constants from a file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np

from eigencontact.plugin import (
    ConstitutiveLaw,
    DataFile,
    FloatArray,
    GriddedData,
    LawStep,
    LinearLaw,
    Response,
    hook_for,
    isotropic_factors,
    isotropic_stiffness,
    read_gridded,
    require,
)

__all__ = ["ElasticityMap"]


@dataclass(frozen=True, kw_only=True)
class ElasticityMap(ConstitutiveLaw):
    """Isotropic constants at the points of a lattice: linear between the points, constant outside.

    Parameters
    ----------
    file : path
        ``.npz``, NetCDF, or text in columns ``x y z young_modulus poisson_ratio``, with ``x``, ``y``, ``z`` [m],
        ascending, ``young_modulus`` [Pa] (0 is a void) and ``poisson_ratio`` [-] on them ``(nz, ny, nx)``, or single
        numbers (`eigencontact.plugin.read_gridded`).
    """

    key: ClassVar[str] = "map"
    references: ClassVar[tuple[str, ...]] = ("T. Mura 1987, Micromechanics of Defects in Solids, section 22",)
    isotropic: ClassVar[bool] = True

    file: DataFile

    def __post_init__(self) -> None:
        _ = self._data  # read and check the file before the run

    @cached_property
    def _data(self) -> GriddedData:
        data = read_gridded(f"{self.key}.file", self.file, {"young_modulus": "Pa", "poisson_ratio": "1"})
        E, nu = data.values["young_modulus"], data.values["poisson_ratio"]
        rule = "a file whose young_modulus must be zero (a void) or positive [Pa]"
        require(bool(np.all(E >= 0)), self.key, "file", self.file, rule)
        rule = "a file whose poisson_ratio must be in (-1, 0.5] [-]"
        require(bool(np.all((nu > -1) & (nu <= 0.5))), self.key, "file", self.file, rule)
        return data

    def at(self, x: FloatArray, y: FloatArray, z: FloatArray) -> IsotropicPoints:
        """See `ConstitutiveLaw.at`."""
        young_modulus, poisson_ratio = (self._data.at(name, z, y, x) for name in ("young_modulus", "poisson_ratio"))
        return IsotropicPoints(young_modulus=young_modulus, poisson_ratio=poisson_ratio)

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
    isotropic: ClassVar[bool] = True

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


eigencontact_register = hook_for(ElasticityMap)
