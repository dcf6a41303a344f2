"""Findley's criterion."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from eigencontact.plugin import (
    DamageParameter,
    FloatArray,
    PathBounds,
    PlanePaths,
    StressCycle,
    hook_for,
    worst_planes,
)
from eigencontact_plugins.fatigue.rules import WeightedNormalStress

__all__ = ["Findley"]


@dataclass(frozen=True, kw_only=True)
class Findley(WeightedNormalStress):
    """``shear stress amplitude + slope largest normal stress``, on the plane where that is largest.

    Parameters
    ----------
    slope : float
        Weight of the largest normal stress of the cycle on the plane [-]; 0.2 to 0.4 for many metals.
    limit_amplitude : float
        Damage parameter [Pa] that the material endures: ``sqrt(1 + slope^2)`` times the limit of torsion.
    """

    key: ClassVar[str] = "findley"
    example: ClassVar[dict[str, Any]] = {"slope": 0.3, "limit_amplitude": "260 MPa"}
    references: ClassVar[tuple[str, ...]] = ("W. N. Findley 1959, J. Eng. Ind. 81, 301",)

    def damage(self, cycle: StressCycle) -> DamageParameter:
        """Damage parameter [Pa]; see `FatigueCriterion`."""
        planes = PlanePaths(cycle.stress)
        return DamageParameter(
            *worst_planes(lambda at: planes.shear_amplitude(at) + self.slope * planes.normal_maximum(at))
        )

    def upper_bound(self, cycle: StressCycle) -> FloatArray:
        """Sum of the largest shear amplitude and the largest principal stress; see `HasUpperBound`."""
        bounds = PathBounds(cycle.stress)
        return bounds.shear_amplitude() + self.slope * bounds.normal_maximum()

    def known_values(self, amplitude: float, young_modulus: float, poisson_ratio: float) -> Mapping[str, float]:
        """Closed forms; see `HasKnownValues`."""
        del young_modulus, poisson_ratio
        k = self.slope
        values = {
            "tension": (k + np.hypot(1, k)) / 2,
            "pulsating-tension": k + np.hypot(1, 2 * k) / 2,
            "torsion": np.hypot(1, k),
        }
        return {name: amplitude * float(value) for name, value in values.items()}


eigencontact_register = hook_for(Findley)
