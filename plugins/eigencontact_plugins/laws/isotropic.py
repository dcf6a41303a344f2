"""Isotropic elasticity."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from eigencontact.plugin import (
    FloatArray,
    LinearLaw,
    SceneError,
    Stress,
    hook_for,
    isotropic_factors,
    isotropic_stiffness,
    readable,
    require,
)

__all__ = ["Isotropic"]


@dataclass(frozen=True, kw_only=True)
class Isotropic(LinearLaw):
    """Isotropic elasticity.

    Parameters
    ----------
    young_modulus : float
        E [Pa], finite; 0 is a void.
    poisson_ratio : float
        ν [-] in (-1, 0.5]; 0.5 is exact.
    """

    key: ClassVar[str] = "isotropic"
    example: ClassVar[dict[str, Any]] = {"young_modulus": "210 GPa", "poisson_ratio": 0.3}
    references: ClassVar[tuple[str, ...]] = ("R. Hooke 1678, Lectures de potentia restitutiva",)
    isotropic: ClassVar[bool] = True

    young_modulus: Stress
    poisson_ratio: float

    def __post_init__(self) -> None:
        E, nu = self.young_modulus, self.poisson_ratio
        require(0 <= E < np.inf, self.key, "young_modulus", E, "zero (a void) or positive, and finite [Pa]")
        require(-1 < nu <= 0.5, self.key, "poisson_ratio", nu, "in (-1, 0.5] [-]")

    def stiffness_matrix(self) -> FloatArray:
        """See `LinearLaw.stiffness_matrix`."""
        if self.poisson_ratio == 0.5 and self.young_modulus > 0:
            raise SceneError(f"{self.key}.poisson_ratio must be below 0.5 for a finite stiffness (got 0.5)")
        return isotropic_stiffness(self.young_modulus, self.poisson_ratio)

    def factors(self, shear_modulus: float) -> tuple[FloatArray, FloatArray]:
        """See `LinearLaw.factors`."""
        return isotropic_factors(self.young_modulus, self.poisson_ratio, shear_modulus)

    @property
    def words(self) -> str:
        """See `ConstitutiveLaw.words`."""
        return f"E = {readable(self.young_modulus, 'Pa')}, ν = {self.poisson_ratio:g}"


eigencontact_register = hook_for(Isotropic)
