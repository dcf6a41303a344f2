"""The criterion of Smith, Watson and Topper."""

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
from eigencontact_plugins.fatigue.rules import check_positive

__all__ = ["SmithWatsonTopper"]


@dataclass(frozen=True, kw_only=True)
class SmithWatsonTopper(FatigueCriterion):
    """``largest normal stress times normal strain amplitude``, on the plane where that is largest.

    A plane that is never in tension counts as zero.

    Parameters
    ----------
    limit_product : float
        Product of largest normal stress and normal strain amplitude [Pa] that the material endures:
        ``limit^2 / E`` of the stress amplitude in fully reversed tension.
    """

    key: ClassVar[str] = "smith-watson-topper"
    unit: ClassVar[str] = "Pa"
    needs_strain: ClassVar[bool] = True
    amplitude_power: ClassVar[float] = 2.0
    example: ClassVar[dict[str, Any]] = {"limit_product": "0.8 MPa"}
    references: ClassVar[tuple[str, ...]] = ("K. N. Smith, P. Watson, T. H. Topper 1970, J. Mater. 5, 767",)

    limit_product: Stress

    def __post_init__(self) -> None:
        check_positive(self.key, "limit_product", self.limit_product)

    @property
    def limit(self) -> float:
        """The limit [Pa]."""
        return self.limit_product

    def damage(self, cycle: StressCycle) -> DamageParameter:
        """Damage parameter [Pa]; see `FatigueCriterion`."""
        stress, strain = PlanePaths(cycle.stress), PlanePaths(np.asarray(cycle.strain))
        return DamageParameter(
            *worst_planes(lambda at: np.maximum(stress.normal_maximum(at), 0.0) * strain.normal_amplitude(at))
        )

    def upper_bound(self, cycle: StressCycle) -> FloatArray:
        """Product of the largest principal stress and the largest strain amplitude; see `HasUpperBound`."""
        strain = PathBounds(np.asarray(cycle.strain)).normal_amplitude()
        return np.asarray(np.maximum(PathBounds(cycle.stress).normal_maximum(), 0.0) * strain)

    def known_values(self, amplitude: float, young_modulus: float, poisson_ratio: float) -> Mapping[str, float]:
        """Closed forms; see `HasKnownValues`."""
        values = {"tension": 1.0, "pulsating-tension": 2.0, "torsion": 1.0 + poisson_ratio}
        return {name: amplitude**2 / young_modulus * value for name, value in values.items()}


eigencontact_register = hook_for(SmithWatsonTopper)
