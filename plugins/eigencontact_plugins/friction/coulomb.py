"""Coulomb friction with one coefficient."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from eigencontact.plugin import FloatArray, FrictionLaw, FrictionState, hook_for, require

__all__ = ["Coulomb", "check_coefficient"]


def check_coefficient(where: str, field: str, value: float) -> None:
    """Refuse a coefficient of friction that is negative or not finite [-]."""
    require(0 <= value < np.inf, where, field, value, "zero or positive, and finite [-]")


@dataclass(frozen=True, kw_only=True)
class Coulomb(FrictionLaw):
    """Shear bound in proportion to the pressure: coefficient times p.

    Parameters
    ----------
    coefficient : float
        Coefficient of friction [-], equal for stick and slip; 0 is a frictionless contact.
    """

    key: ClassVar[str] = "coulomb"
    example: ClassVar[dict[str, Any]] = {"coefficient": 0.3}
    references: ClassVar[tuple[str, ...]] = ("C. A. Coulomb 1785, Theorie des machines simples",)

    coefficient: float

    def __post_init__(self) -> None:
        check_coefficient(self.key, "coefficient", self.coefficient)

    def shear_bound(self, state: FrictionState) -> FloatArray:
        """Shear bound [Pa]; see `FrictionLaw`."""
        return self.coefficient * state.pressure


eigencontact_register = hook_for(Coulomb)
