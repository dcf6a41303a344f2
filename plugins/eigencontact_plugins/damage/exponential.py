"""Damage that grows with plastic strain and saturates."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from eigencontact.plugin import FloatArray, PlasticDamage, hook_for, require

__all__ = ["ExponentialDamage"]


@dataclass(frozen=True, kw_only=True)
class ExponentialDamage(PlasticDamage):
    """Exponential damage of plastic strain, ``D = D_inf (1 - exp(-p / p0))``, for bone.

    Parameters
    ----------
    saturation : float
        D_inf in [0, 1).
    strain : float
        p0 [-], positive.
    length : float, optional
        Radius of averaging [m]; see `DamageLaw`.
    """

    key: ClassVar[str] = "exponential"
    example: ClassVar[dict[str, Any]] = {"saturation": 0.6, "strain": 0.02}
    references: ClassVar[tuple[str, ...]] = (
        "D. Garcia, P. K. Zysset, M. Charlebois, A. Curnier 2009, Biomech. Model. Mechanobiol. 8, 149",
    )

    saturation: float
    strain: float

    def __post_init__(self) -> None:
        require(0 <= self.saturation < 1, self.key, "saturation", self.saturation, "in [0, 1) [-]")
        require(0 < self.strain < np.inf, self.key, "strain", self.strain, "positive and finite [-]")

    def damage(self, p: FloatArray) -> tuple[FloatArray, FloatArray]:
        """See `DamageLaw.damage`."""
        decay = np.exp(-p / self.strain)
        return self.saturation * (1.0 - decay), self.saturation / self.strain * decay


eigencontact_register = hook_for(ExponentialDamage)
