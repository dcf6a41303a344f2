"""Coulomb friction up to a shear strength."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from eigencontact.plugin import FloatArray, FrictionLaw, FrictionState, Stress, hook_for, require
from eigencontact_plugins.friction.coulomb import check_coefficient

__all__ = ["ShearCap"]


@dataclass(frozen=True, kw_only=True)
class ShearCap(FrictionLaw):
    """Coulomb friction with an upper bound by a shear strength: the smaller of coefficient times p, and cap.

    Parameters
    ----------
    coefficient : float
        Coefficient of friction [-] at low pressure.
    cap : float
        Shear strength [Pa] of the weaker surface or of a film between them; reached at the pressure cap / coefficient.
    """

    key: ClassVar[str] = "shear-cap"
    example: ClassVar[dict[str, Any]] = {"coefficient": 0.3, "cap": "200 MPa"}
    references: ClassVar[tuple[str, ...]] = ("E. Orowan 1943, Proc. Instn Mech. Engrs 150, 140",)

    coefficient: float
    cap: Stress

    def __post_init__(self) -> None:
        check_coefficient(self.key, "coefficient", self.coefficient)
        require(0 < self.cap < np.inf, self.key, "cap", self.cap, "positive and finite [Pa]")

    def shear_bound(self, state: FrictionState) -> FloatArray:
        """Shear bound [Pa]; see `FrictionLaw`."""
        return np.minimum(self.coefficient * state.pressure, self.cap)


eigencontact_register = hook_for(ShearCap)
