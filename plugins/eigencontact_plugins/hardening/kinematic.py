"""Back-stresses: laws of Prager and of Armstrong and Frederick, and Chaboche's sum of the latter."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from eigencontact.plugin import FloatArray, KinematicHardening, Stress, hook_for, require

__all__ = ["ArmstrongFrederick", "Prager"]


@dataclass(frozen=True, kw_only=True)
class Prager(KinematicHardening):
    """``dX = (2/3) C dε_p``: the back-stress follows the plastic strain.

    Parameters
    ----------
    modulus : float
        C [Pa], zero or positive: the slope of stress over plastic strain in tension.
    """

    key: ClassVar[str] = "prager"
    example: ClassVar[dict[str, Any]] = {"modulus": "20 GPa"}
    references: ClassVar[tuple[str, ...]] = ("W. Prager 1955, Proc. Inst. Mech. Eng. 169, 41",)

    modulus: Stress

    def __post_init__(self) -> None:
        require(0 <= self.modulus < np.inf, self.key, "modulus", self.modulus, "zero or positive and finite [Pa]")

    def recall(self, dp: FloatArray) -> tuple[FloatArray, FloatArray]:
        """See `KinematicHardening.recall`."""
        return np.ones_like(dp), np.zeros_like(dp)


@dataclass(frozen=True, kw_only=True)
class ArmstrongFrederick(KinematicHardening):
    """``dX = (2/3) C dε_p - γ X dp``: the back-stress saturates at C/γ. Several of these laws are Chaboche's law.

    Parameters
    ----------
    modulus : float
        C [Pa], zero or positive.
    recovery : float
        γ [-], zero or positive.
    """

    key: ClassVar[str] = "armstrong-frederick"
    example: ClassVar[dict[str, Any]] = {"modulus": "100 GPa", "recovery": 500.0}
    references: ClassVar[tuple[str, ...]] = (
        "P. J. Armstrong, C. O. Frederick 1966, CEGB report RD/B/N 731",
        "J.-L. Chaboche 1986, Int. J. Plasticity 2, 149",
    )

    modulus: Stress
    recovery: float

    def __post_init__(self) -> None:
        require(0 <= self.modulus < np.inf, self.key, "modulus", self.modulus, "zero or positive and finite [Pa]")
        require(0 <= self.recovery < np.inf, self.key, "recovery", self.recovery, "zero or positive and finite [-]")

    def recall(self, dp: FloatArray) -> tuple[FloatArray, FloatArray]:
        """See `KinematicHardening.recall`; backward Euler."""
        theta = 1.0 / (1.0 + self.recovery * dp)
        return theta, -self.recovery * theta**2


eigencontact_register = hook_for(Prager, ArmstrongFrederick)
