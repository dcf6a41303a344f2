"""Friction law for each material at the surface: coating and substrate, matrix and grains."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any, ClassVar

import numpy as np

from eigencontact.plugin import FloatArray, FrictionLaw, FrictionState, SceneError, by_material, hook_for
from eigencontact_plugins.friction.coulomb import Coulomb, check_coefficient

__all__ = ["ByMaterial"]


@dataclass(frozen=True, kw_only=True)
class ByMaterial(FrictionLaw):
    """Friction law by exposed material: each column of the contact uses the law of its material.

    The names of materials are the ``name`` of inclusions and layers in the scene; all other material is ``substrate``.

    Parameters
    ----------
    coefficients : table of float
        Coulomb's coefficient [-] by name: ``{ coating = 0.2, substrate = 0.6 }``.
    laws : table of FrictionLaw
        Other laws by name: ``{ coating = { type = "shear-cap", ... } }``.
    """

    key: ClassVar[str] = "by-material"
    example: ClassVar[dict[str, Any]] = {"coefficients": {"substrate": 0.3}}
    references: ClassVar[tuple[str, ...]] = ("C. A. Coulomb 1785, Theorie des machines simples",)

    coefficients: dict[str, float] = field(default_factory=dict)
    laws: dict[str, FrictionLaw] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for name, value in self.coefficients.items():
            check_coefficient(f"{self.key}.coefficients", name, value)
        if not self.materials:
            raise SceneError(f"{self.key} must have coefficients, laws or both, by name of a material (got neither)")
        duplicates = sorted(self.coefficients.keys() & self.laws.keys())
        if duplicates:
            raise SceneError(
                f"{self.key} must have one law for {duplicates[0]!r} (got a coefficient and a law); leave one out"
            )

    @property
    def materials(self) -> tuple[str, ...]:
        """See `NamesMaterials.materials`."""
        return (*self.coefficients, *self.laws)

    def shear_bound(self, state: FrictionState) -> FloatArray:
        """Shear bound [Pa]; see `FrictionLaw`."""
        bound = np.zeros_like(state.pressure)
        for name, exposed in by_material(f"friction law {self.key!r}", state, self.materials):
            law = self.laws.get(name) or Coulomb(coefficient=self.coefficients[name])
            exposed_state = replace(state, pressure=np.where(exposed, state.pressure, 0.0))
            bound = np.where(exposed, law.shear_bound(exposed_state), bound)
        return bound


eigencontact_register = hook_for(ByMaterial)
