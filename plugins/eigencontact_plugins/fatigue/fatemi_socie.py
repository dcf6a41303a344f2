"""The criterion of Fatemi and Socie."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from eigencontact.plugin import (
    DamageParameter,
    FatigueCriterion,
    FloatArray,
    PathBounds,
    PlanePaths,
    Stress,
    StressCycle,
    hook_for,
    worst_planes,
)
from eigencontact_plugins.fatigue.rules import check_positive, check_slope

__all__ = ["FatemiSocie"]


@dataclass(frozen=True, kw_only=True)
class FatemiSocie(FatigueCriterion):
    """``shear strain amplitude (1 + slope largest normal stress / yield stress)``, on the plane where that is largest.

    The shear strain is the engineering strain. For a plane without tension the parameter is its shear strain amplitude.

    Parameters
    ----------
    slope : float
        Weight of the largest normal stress [-].
    yield_stress : float
        Yield stress in tension [Pa].
    limit_strain_amplitude : float
        Damage parameter [-] that the material endures: slightly above the shear strain amplitude in fully reversed
        torsion.
    """

    key: ClassVar[str] = "fatemi-socie"
    unit: ClassVar[str] = "1"
    needs_strain: ClassVar[bool] = True
    example: ClassVar[dict[str, Any]] = {"slope": 0.3, "yield_stress": "900 MPa", "limit_strain_amplitude": 4e-3}
    references: ClassVar[tuple[str, ...]] = (
        "A. Fatemi, D. F. Socie 1988, Fatigue Fract. Eng. Mater. Struct. 11, 149; largest value over all planes",
    )

    slope: float
    yield_stress: Stress
    limit_strain_amplitude: float

    def __post_init__(self) -> None:
        check_slope(self.key, "slope", self.slope)
        check_positive(self.key, "yield_stress", self.yield_stress)
        check_positive(self.key, "limit_strain_amplitude", self.limit_strain_amplitude, "-")

    @property
    def limit(self) -> float:
        """The limit [-]."""
        return self.limit_strain_amplitude

    def damage(self, cycle: StressCycle) -> DamageParameter:
        """Damage parameter [-]; see `FatigueCriterion`."""
        stress, strain = PlanePaths(cycle.stress), PlanePaths(np.asarray(cycle.strain))
        weight = self.slope / self.yield_stress
        return DamageParameter(
            *worst_planes(
                lambda at: (
                    2.0 * strain.shear_amplitude(at) * (1.0 + weight * np.maximum(stress.normal_maximum(at), 0.0))
                )
            )
        )

    def upper_bound(self, cycle: StressCycle) -> FloatArray:
        """With the largest shear amplitude and the largest principal stress; see `HasUpperBound`."""
        shear, weight = PathBounds(np.asarray(cycle.strain)).shear_amplitude(), self.slope / self.yield_stress
        return np.asarray(2.0 * shear * (1.0 + weight * np.maximum(PathBounds(cycle.stress).normal_maximum(), 0.0)))

    def known_values(self, amplitude: float, young_modulus: float, poisson_ratio: float) -> Mapping[str, float]:
        """Closed forms at the angle from the axis of the largest shear; see `HasKnownValues`."""
        weight = self.slope * amplitude / self.yield_stress
        shear = 2.0 * (1.0 + poisson_ratio) * amplitude / young_modulus
        angle = np.linspace(0.0, np.pi, 200001)
        values = {}
        for name, mean in (("tension", 1.0), ("pulsating-tension", 2.0)):
            values[name] = 0.5 * np.abs(np.sin(2 * angle)) * (1.0 + mean * weight * np.cos(angle) ** 2)
        values["torsion"] = np.abs(np.cos(2 * angle)) * (1.0 + weight * np.abs(np.sin(2 * angle)))
        return {name: shear * float(value.max()) for name, value in values.items()}


eigencontact_register = hook_for(FatemiSocie)
