"""Hardening that saturates."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from eigencontact.plugin import FloatArray, IsotropicHardening, Stress, hook_for, require

__all__ = ["Voce"]


@dataclass(frozen=True, kw_only=True)
class Voce(IsotropicHardening):
    """Voce's law ``Y = Y0 + Q (1 - exp(-b p))``.

    Parameters
    ----------
    yield_stress : float
        Y0 [Pa], positive.
    saturation : float
        Q [Pa]: final increase of the flow stress; a negative value softens, and Y0 + Q must be positive.
    rate : float
        b [-], positive.
    """

    key: ClassVar[str] = "voce"
    example: ClassVar[dict[str, Any]] = {"yield_stress": "1 GPa", "saturation": "0.5 GPa", "rate": 40.0}
    references: ClassVar[tuple[str, ...]] = ("E. Voce 1948, J. Inst. Metals 74, 537",)

    yield_stress: Stress
    saturation: Stress
    rate: float

    def __post_init__(self) -> None:
        good = 0 < self.yield_stress < np.inf
        require(good, self.key, "yield_stress", self.yield_stress, "positive and finite [Pa]")
        good = -self.yield_stress < self.saturation < np.inf
        require(good, self.key, "saturation", self.saturation, "finite, and above -yield-stress [Pa]")
        require(0 < self.rate < np.inf, self.key, "rate", self.rate, "positive and finite [-]")

    def flow_stress(self, p: FloatArray) -> tuple[FloatArray, FloatArray]:
        """See `IsotropicHardening.flow_stress`."""
        decay = np.exp(-self.rate * p)
        return self.yield_stress + self.saturation * (1.0 - decay), self.saturation * self.rate * decay


eigencontact_register = hook_for(Voce)
