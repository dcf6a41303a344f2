"""Damage of concrete by strain."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from eigencontact.plugin import FloatArray, StrainDamage, hook_for, require

__all__ = ["MazarsDamage"]


#: Lower bound of the remaining stiffness, relative to the undamaged material.
_LEAST = 1e-6


@dataclass(frozen=True, kw_only=True)
class MazarsDamage(StrainDamage):
    """``D = 1 - κ0 (1 - A) / κ - A exp(-B (κ - κ0))`` beyond the strain κ0, for concrete.

    In tension the stress falls from ``E κ0`` to ``(1 - A) E κ0``; it falls from the start if ``B κ0 > 1``. The source
    mixes two curves, for tension and for compression, by the state of stress, so that D would decrease if a load
    changes between them. This law uses one curve, usually that of tension. In compression the material fails by the
    transverse extension: its strength is about ``1 / (ν √2)`` times that in tension.

    Parameters
    ----------
    threshold : float
        κ0 [-], positive; about 1e-4 for concrete.
    A : float
        In [0, 1]: 1 minus the residual fraction of the strength.
    B : float
        Rate of the loss of strength [-], positive; 1e4 to 5e4 for concrete.
    length : float, optional
        Radius of averaging [m]; see `DamageLaw`.
    """

    key: ClassVar[str] = "mazars"
    example: ClassVar[dict[str, Any]] = {"threshold": 1e-4, "A": 0.9, "B": 2e4}
    references: ClassVar[tuple[str, ...]] = (
        "J. Mazars 1986, Eng. Fract. Mech. 25, 729",
        "G. Pijaudier-Cabot, Z. P. Bazant 1987, J. Eng. Mech. 113, 1512 (length)",
    )

    threshold: float
    A: float
    B: float

    def __post_init__(self) -> None:
        require(0 < self.threshold < np.inf, self.key, "threshold", self.threshold, "positive and finite [-]")
        require(0 <= self.A <= 1, self.key, "A", self.A, "in [0, 1] [-]")
        require(0 < self.B < np.inf, self.key, "B", self.B, "positive and finite [-]")

    def damage(self, driven: FloatArray) -> tuple[FloatArray, FloatArray]:
        """See `DamageLaw.damage`."""
        strain = np.maximum(driven, self.threshold)
        residual = self.threshold * (1.0 - self.A) / strain
        fading = self.A * np.exp(-self.B * (strain - self.threshold))
        grows = driven > self.threshold
        damage = np.minimum(np.where(grows, 1.0 - residual - fading, 0.0), 1.0 - _LEAST)
        return damage, np.where(grows, residual / strain + self.B * fading, 0.0)


eigencontact_register = hook_for(MazarsDamage)
