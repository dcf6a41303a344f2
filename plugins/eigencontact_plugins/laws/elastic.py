"""Elasticity of the surrounding body, for elastic parts of a body that yields."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from eigencontact.plugin import FloatArray, LinearLaw, hook_for, isotropic_factors, isotropic_stiffness
from eigencontact_plugins.laws.constants import BodyConstants

__all__ = ["Elastic"]


@dataclass(frozen=True, kw_only=True)
class Elastic(BodyConstants, LinearLaw):
    """Isotropic elasticity with the constants of the body: an elastic layer or region in a body that yields.

    Use `isotropic` for a region with other constants than those of the body.
    """

    key: ClassVar[str] = "elastic"
    example: ClassVar[dict[str, Any]] = {"young_modulus": "210 GPa", "poisson_ratio": 0.3}
    references: ClassVar[tuple[str, ...]] = ("R. Hooke 1678, Lectures de potentia restitutiva",)
    words: ClassVar[str] = "material as around, elastic"

    def stiffness_matrix(self) -> FloatArray:
        """See `LinearLaw.stiffness_matrix`."""
        return isotropic_stiffness(*self._young_and_poisson)

    def factors(self, shear_modulus: float) -> tuple[FloatArray, FloatArray]:
        """See `LinearLaw.factors`."""
        return isotropic_factors(*self._young_and_poisson, shear_modulus)


eigencontact_register = hook_for(Elastic)
