"""Dang Van's criterion."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from eigencontact.plugin import (
    SQRT2,
    DamageParameter,
    FloatArray,
    StressCycle,
    hook_for,
    smallest_balls,
)
from eigencontact_plugins.fatigue.rules import WeightedNormalStress

__all__ = ["DangVan"]


@dataclass(frozen=True, kw_only=True)
class DangVan(WeightedNormalStress):
    """``max over time of (Tresca shear of s - s* + slope p)``: shear of a grain after shakedown, and mean stress.

    s is the deviator, s* the centre of the smallest ball around its path: the residual stress to which a grain shakes
    down. The plane is that of the largest shear at the worst time.

    Parameters
    ----------
    slope : float
        Weight of the mean normal stress [-]: ``(t - b / 2) / (b / 3)`` of limits t of torsion and b of bending.
    limit_amplitude : float
        Shear stress amplitude [Pa] that the material endures in fully reversed torsion.
    """

    key: ClassVar[str] = "dang-van"
    example: ClassVar[dict[str, Any]] = {"slope": 0.3, "limit_amplitude": "250 MPa"}
    references: ClassVar[tuple[str, ...]] = (
        "K. Dang Van, B. Griveau, O. Message 1989, On a new multiaxial fatigue limit criterion, EGF 3, 479",
    )

    def damage(self, cycle: StressCycle) -> DamageParameter:
        """Damage parameter [Pa]; see `FatigueCriterion`."""
        deviator = cycle.deviator
        values, directions = np.linalg.eigh(_matrices(deviator - smallest_balls(deviator)[0]))
        at_times = 0.5 * (values[..., 2] - values[..., 0]) + self.slope * cycle.hydrostatic
        worst, points = at_times.argmax(axis=0), np.arange(cycle.points)
        axes = directions[worst, points]
        normal = (axes[..., 0] + axes[..., 2]) / SQRT2
        return DamageParameter(at_times[worst, points], normal * np.where(normal[:, 2:] < 0, -1.0, 1.0))

    def known_values(self, amplitude: float, young_modulus: float, poisson_ratio: float) -> Mapping[str, float]:
        """Closed forms; see `HasKnownValues`."""
        del young_modulus, poisson_ratio
        values = {
            "tension": 0.5 + self.slope / 3,
            "pulsating-tension": 0.5 + 2 * self.slope / 3,
            "torsion": 1.0,
            "three-shears": 1.0,
        }
        return {name: amplitude * value for name, value in values.items()}


def _matrices(mandel: FloatArray) -> FloatArray:
    """Matrices ``(steps, points, 3, 3)`` of Mandel vectors ``(steps, 6, points)``."""
    xx, yy, zz = np.moveaxis(mandel[:, :3], 1, 0)
    yz, xz, xy = np.moveaxis(mandel[:, 3:] / SQRT2, 1, 0)
    return np.stack([xx, xy, xz, xy, yy, yz, xz, yz, zz], axis=-1).reshape(*xx.shape, 3, 3)


eigencontact_register = hook_for(DangVan)
