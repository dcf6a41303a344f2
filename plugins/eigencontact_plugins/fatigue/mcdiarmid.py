"""McDiarmid's criterion."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

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

__all__ = ["McDiarmid"]

#: Weight of the normal stress in the search for the plane. Perpendicular planes can have equal shear amplitudes; the
#: weight selects the one with more tension, and exceeds the error of the search.
_TIE = 1e-4


@dataclass(frozen=True, kw_only=True)
class McDiarmid(FatigueCriterion):
    """``shear stress amplitude + t / (2 strength) largest normal stress``, on the plane of the largest shear amplitude.

    If several planes have the largest shear amplitude, the plane with the largest normal stress is critical. If two
    planes have nearly equal amplitudes, a small change of the stress exchanges them, and the value jumps by the
    difference of their normal stresses. This is the criterion of 1991; a later version (1994) uses the plane with the
    largest expression, like Findley. The limit t is a single number, whereas McDiarmid distinguishes cracks along the
    surface and into the body.

    Parameters
    ----------
    limit_amplitude : float
        t: shear stress amplitude [Pa] that the material endures in fully reversed torsion.
    tensile_strength : float
        Ultimate tensile strength [Pa].
    """

    key: ClassVar[str] = "mcdiarmid"
    example: ClassVar[dict[str, Any]] = {"limit_amplitude": "250 MPa", "tensile_strength": "900 MPa"}
    references: ClassVar[tuple[str, ...]] = ("D. L. McDiarmid 1991, Fatigue Fract. Eng. Mater. Struct. 14, 429",)

    limit_amplitude: Stress
    tensile_strength: Stress

    def __post_init__(self) -> None:
        check_positive(self.key, "limit_amplitude", self.limit_amplitude)
        check_positive(self.key, "tensile_strength", self.tensile_strength)

    @property
    def limit(self) -> float:
        """The limit of torsion [Pa]."""
        return self.limit_amplitude

    def damage(self, cycle: StressCycle) -> DamageParameter:
        """Damage parameter [Pa]; see `FatigueCriterion`."""
        planes = PlanePaths(cycle.stress)
        _, normal = worst_planes(lambda at: planes.shear_amplitude(at) + _TIE * planes.normal_maximum(at))
        at, weight = normal[:, None], self.limit_amplitude / (2.0 * self.tensile_strength)
        return DamageParameter((planes.shear_amplitude(at) + weight * planes.normal_maximum(at))[:, 0], normal)

    def upper_bound(self, cycle: StressCycle) -> FloatArray:
        """Sum of the largest shear amplitude and the largest principal stress; see `HasUpperBound`."""
        bounds, weight = PathBounds(cycle.stress), self.limit_amplitude / (2.0 * self.tensile_strength)
        return bounds.shear_amplitude() + weight * bounds.normal_maximum()

    def known_values(self, amplitude: float, young_modulus: float, poisson_ratio: float) -> Mapping[str, float]:
        """Closed forms; see `HasKnownValues`."""
        del young_modulus, poisson_ratio
        weight = self.limit_amplitude / (2.0 * self.tensile_strength)
        values = {
            "tension": 0.5 + 0.5 * weight,
            "pulsating-tension": 0.5 + weight,
            "torsion": 1.0,
            "three-shears": 1.0,
        }
        return {name: amplitude * value for name, value in values.items()}


eigencontact_register = hook_for(McDiarmid)
