"""Worn volume proportional to the friction work."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, ClassVar

import numpy as np

from eigencontact.plugin import FloatArray, Unit, WearLaw, WearState, hook_for, require

__all__ = ["DissipatedEnergy", "VolumePerEnergy"]


#: Worn volume per friction work: 1 mm³/J is 1e-9 m³/J.
VolumePerEnergy = Annotated[float, Unit("m^3/J", "a worn volume by work of friction")]


@dataclass(frozen=True, kw_only=True)
class DissipatedEnergy(WearLaw):
    """Depth proportional to the friction work per area: the worn volume is the coefficient times the energy.

    Parameters
    ----------
    coefficient : float
        Worn volume per friction work [m³/J], as ``"1e-3 mm^3/J"``.
    """

    key: ClassVar[str] = "dissipated-energy"
    example: ClassVar[dict[str, Any]] = {"coefficient": "1e-3 mm^3/J"}
    references: ClassVar[tuple[str, ...]] = (
        "S. Fouvry, P. Kapsa, L. Vincent, Wear 200 (1996) 186, doi:10.1016/S0043-1648(96)07306-1",
    )
    linear_in_pressure: ClassVar[bool] = True
    needs_friction: ClassVar[bool] = True

    coefficient: VolumePerEnergy

    def __post_init__(self) -> None:
        rule = "zero or positive, and finite [m^3/J]"
        require(0 <= self.coefficient < np.inf, self.key, "coefficient", self.coefficient, rule)

    def depth(self, state: WearState) -> FloatArray:
        """Worn depth [m]; see `WearLaw`."""
        return self.coefficient * state.energy

    @property
    def volume_per_energy(self) -> float:
        """See `WearLaw.volume_per_energy`."""
        return self.coefficient


eigencontact_register = hook_for(DissipatedEnergy)
