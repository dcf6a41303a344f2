"""Wear by the friction work beyond a threshold."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, ClassVar

import numpy as np

from eigencontact.plugin import FloatArray, Unit, WearLaw, WearState, hook_for, require
from eigencontact_plugins.wear.dissipated_energy import VolumePerEnergy

__all__ = ["ThresholdEnergy"]


@dataclass(frozen=True, kw_only=True)
class ThresholdEnergy(WearLaw):
    """Depth proportional to the friction work per area beyond a local threshold.

    Parameters
    ----------
    coefficient : float
        Worn volume per friction work beyond the threshold [m³/J].
    threshold : float
        Friction work per area at a point before wear begins [J/m²].
    """

    key: ClassVar[str] = "threshold-energy"
    example: ClassVar[dict[str, Any]] = {"coefficient": "1e-3 mm^3/J", "threshold": "1 kJ/m^2"}
    references: ClassVar[tuple[str, ...]] = (
        "S. Fouvry, T. Liskiewicz, P. Kapsa et al., Wear 255 (2003) 287, doi:10.1016/S0043-1648(03)00117-0",
    )
    needs_friction: ClassVar[bool] = True

    coefficient: VolumePerEnergy
    threshold: Annotated[float, Unit("J/m^2", "a work by area")]

    def __post_init__(self) -> None:
        for name, unit in (("coefficient", "m^3/J"), ("threshold", "J/m^2")):
            value = getattr(self, name)
            require(0 <= value < np.inf, self.key, name, value, f"zero or positive, and finite [{unit}]")

    def depth(self, state: WearState) -> FloatArray:
        """Worn depth [m]; see `WearLaw`."""
        before = np.maximum(state.total_energy - self.threshold, 0.0)
        after = np.maximum(state.total_energy + state.energy - self.threshold, 0.0)
        return self.coefficient * (after - before)


eigencontact_register = hook_for(ThresholdEnergy)
