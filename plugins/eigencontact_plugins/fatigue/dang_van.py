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
    PathBounds,
    StressCycle,
    hook_for,
    smallest_balls,
)
from eigencontact_plugins.fatigue.rules import WeightedNormalStress

__all__ = ["DangVan"]

#: Relative difference from the largest stress within which the error of the eigenvalue formula may exchange two times.
_NEAR = 1e-6


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
        deviator -= smallest_balls(deviator)[0]
        pressure = self.slope * cycle.hydrostatic
        about = _tresca(deviator) + pressure
        # The formula has a relative error of 1e-8: eigenvalues are computed at all times that may be critical.
        steps, points = np.nonzero(about >= about.max(axis=0) - _NEAR * np.abs(deviator).max(axis=(0, 1)))
        values, directions = np.linalg.eigh(_matrices(deviator[steps, :, points].T))
        at_times = np.full(about.shape, -np.inf)
        at_times[steps, points] = 0.5 * (values[:, 2] - values[:, 0]) + pressure[steps, points]
        worst, point_indices = at_times.argmax(axis=0), np.arange(cycle.points)
        number = np.empty(about.shape, np.intp)
        number[steps, points] = np.arange(steps.size)
        axes = directions[number[worst, point_indices]]
        normal = (axes[..., 0] + axes[..., 2]) / SQRT2
        return DamageParameter(at_times[worst, point_indices], normal * np.where(normal[:, 2:] < 0, -1.0, 1.0))

    def upper_bound(self, cycle: StressCycle) -> FloatArray:
        """With the ball around the centre of the box of the deviator: s* is nearer; see `HasUpperBound`."""
        amplitude = PathBounds(cycle.stress).deviator_radius() / SQRT2
        return np.asarray(amplitude + self.slope * cycle.hydrostatic.max(axis=0))

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


def _tresca(deviator: FloatArray) -> FloatArray:
    """Largest shear of deviators ``(steps, 6, points)``, by the angle of their invariants, with a small error."""
    xx, yy, zz = (deviator[:, k] for k in range(3))
    yz, xz, xy = (deviator[:, k] / SQRT2 for k in range(3, 6))
    second = 0.5 * np.einsum("tip,tip->tp", deviator, deviator)
    third = xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz)
    size = np.sqrt(second / 3.0)
    cosine = np.divide(third, 2.0 * size**3, out=np.zeros_like(third), where=size > 0.0)
    angle = np.arccos(np.clip(cosine, -1.0, 1.0)) / 3.0
    return np.asarray(np.sqrt(3.0) * size * np.sin(angle + np.pi / 3.0))


def _matrices(mandel: FloatArray) -> FloatArray:
    """Matrices ``(n, 3, 3)`` of Mandel vectors ``(6, n)``."""
    xx, yy, zz = mandel[:3]
    yz, xz, xy = mandel[3:] / SQRT2
    return np.stack([xx, xy, xz, xy, yy, yz, xz, yz, zz], axis=-1).reshape(-1, 3, 3)


eigencontact_register = hook_for(DangVan)
