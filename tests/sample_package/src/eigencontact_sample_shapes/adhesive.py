"""Friction with a strength at no pressure, as of a film that glues the surfaces where they touch."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from eigencontact.plugin import FrictionLaw, Stress, hookimpl, require


@dataclass(frozen=True, kw_only=True)
class Adhesive(FrictionLaw):
    """Shear strength that begins at tau0 and grows with the pressure up to a cap: min(tau0 + coefficient p, cap).

    Parameters
    ----------
    tau0 : float
        Shear strength where the pressure is close to 0 [Pa].
    coefficient : float
        Growth with the pressure [-].
    cap : float
        Largest shear strength [Pa], at least tau0.
    """

    key: ClassVar[str] = "adhesive"
    references: ClassVar[tuple[str, ...]] = ("B. J. Briscoe and D. Tabor 1975, Wear 34, 29",)

    tau0: Stress
    coefficient: float
    cap: Stress

    def __post_init__(self):
        require(0 <= self.tau0 < np.inf, self.key, "tau0", self.tau0, "zero or positive, and finite [Pa]")
        rule = "zero or positive, and finite [-]"
        require(0 <= self.coefficient < np.inf, self.key, "coefficient", self.coefficient, rule)
        require(
            self.tau0 <= self.cap < np.inf, self.key, "cap", self.cap, f"finite and at least tau0, {self.tau0} [Pa]"
        )

    def shear_bound(self, state):
        """Shear bound [Pa]; out of contact the framework takes none."""
        return np.minimum(self.tau0 + self.coefficient * state.pressure, self.cap)


@hookimpl
def eigencontact_register():
    """Register the law."""
    return [Adhesive]
