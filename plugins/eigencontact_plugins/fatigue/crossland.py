"""Crossland's criterion."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from eigencontact.plugin import SQRT2, DamageParameter, FloatArray, PathBounds, StressCycle, hook_for, smallest_balls
from eigencontact_plugins.fatigue.rules import WeightedNormalStress

__all__ = ["Crossland"]


@dataclass(frozen=True, kw_only=True)
class Crossland(WeightedNormalStress):
    """``sqrt(J2)_amplitude + slope max p``: the amplitude of the deviator and the largest mean normal stress.

    The amplitude is the radius of the smallest ball around the path of the deviator, divided by sqrt 2. For fully
    reversed torsion it is the amplitude of the shear stress. The criterion has no plane.

    Parameters
    ----------
    slope : float
        Weight of the largest mean normal stress [-]: ``(t - b / sqrt 3) / (b / 3)`` of limits t of torsion and b of
        bending, both amplitudes, fully reversed.
    limit_amplitude : float
        Shear stress amplitude [Pa] that the material endures in fully reversed torsion.
    """

    key: ClassVar[str] = "crossland"
    example: ClassVar[dict[str, Any]] = {"slope": 0.3, "limit_amplitude": "250 MPa"}
    references: ClassVar[tuple[str, ...]] = (
        "B. Crossland 1956, Proc. Int. Conf. on Fatigue of Metals, Instn Mech. Engrs, 138",
    )

    def damage(self, cycle: StressCycle) -> DamageParameter:
        """Damage parameter [Pa]; see `FatigueCriterion`."""
        amplitude = smallest_balls(cycle.deviator)[1] / np.sqrt(2.0)
        return DamageParameter(amplitude + self.slope * cycle.hydrostatic.max(axis=0))

    def upper_bound(self, cycle: StressCycle) -> FloatArray:
        """With the ball around the centre of the box of the deviator; see `HasUpperBound`."""
        amplitude = PathBounds(cycle.stress).deviator_radius() / SQRT2
        return np.asarray(amplitude + self.slope * cycle.hydrostatic.max(axis=0))

    def known_values(self, amplitude: float, young_modulus: float, poisson_ratio: float) -> Mapping[str, float]:
        """Closed forms; see `HasKnownValues`."""
        del young_modulus, poisson_ratio
        tension = 1 / np.sqrt(3.0)
        values = {
            "tension": tension + self.slope / 3,
            "pulsating-tension": tension + 2 * self.slope / 3,
            "torsion": 1.0,
            "tension-and-torsion": 1.0 + self.slope / 3,
            "three-shears": 1.0,
        }
        return {name: amplitude * value for name, value in values.items()}


eigencontact_register = hook_for(Crossland)
