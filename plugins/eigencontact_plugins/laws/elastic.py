"""Elasticity of the surrounding body, for elastic parts of a body that yields."""

from __future__ import annotations

from dataclasses import dataclass, replace
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
    require,
)

__all__ = ["Elastic"]


@dataclass(frozen=True, kw_only=True)
class Elastic(LinearLaw):
    """Isotropic elasticity with the constants of the body: an elastic layer or region in a body that yields.

    Parameters
    ----------
    young_modulus, poisson_ratio : float, optional
        E [Pa], positive and finite, and ν [-] in (-1, 0.5); those of the body where they are not given. A region of
        other constants is `isotropic`.
    """

    key: ClassVar[str] = "elastic"
    example: ClassVar[dict[str, Any]] = {"young_modulus": "210 GPa", "poisson_ratio": 0.3}
    references: ClassVar[tuple[str, ...]] = ("R. Hooke 1678, Lectures de potentia restitutiva",)
    isotropic: ClassVar[bool] = True
    words: ClassVar[str] = "material as around, elastic"

    young_modulus: Stress | None = None
    poisson_ratio: float | None = None

    def __post_init__(self) -> None:
        E, nu = self.young_modulus, self.poisson_ratio
        require(E is None or 0 < E < np.inf, self.key, "young_modulus", E, "positive and finite [Pa]")
        require(nu is None or -1 < nu < 0.5, self.key, "poisson_ratio", nu, "in (-1, 0.5) [-]")

    def of_body(self, young_modulus: float, poisson_ratio: float) -> Elastic:
        """See `ConstitutiveLaw.of_body`."""
        return replace(
            self,
            young_modulus=young_modulus if self.young_modulus is None else self.young_modulus,
            poisson_ratio=poisson_ratio if self.poisson_ratio is None else self.poisson_ratio,
        )

    @property
    def _constants(self) -> tuple[float, float]:
        if self.young_modulus is None or self.poisson_ratio is None:
            raise SceneError(f"{self.key}.young-modulus must be that of a body (got none); name it in a scene with one")
        return self.young_modulus, self.poisson_ratio

    def stiffness_matrix(self) -> FloatArray:
        """See `LinearLaw.stiffness_matrix`."""
        return isotropic_stiffness(*self._constants)

    def factors(self, shear_modulus: float) -> tuple[FloatArray, FloatArray]:
        """See `LinearLaw.factors`."""
        return isotropic_factors(*self._constants, shear_modulus)


eigencontact_register = hook_for(Elastic)
