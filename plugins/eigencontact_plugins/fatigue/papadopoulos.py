"""Papadopoulos's criterion."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any, ClassVar

import numpy as np

from eigencontact.plugin import SQRT2, DamageParameter, FloatArray, PathBounds, StressCycle, hook_for
from eigencontact_plugins.fatigue.rules import WeightedNormalStress

__all__ = ["Papadopoulos"]

#: Number of Gauss points of the cosine of the polar angle, of azimuths, and of directions in a plane.
_NODES = 10
#: Points per block: their components on all planes fit into the cache.
_CHUNK = 100


@dataclass(frozen=True, kw_only=True)
class Papadopoulos(WeightedNormalStress):
    """``root of 5 times the mean square resolved shear amplitude + slope max p``, over all planes and directions.

    The resolved shear amplitude is half of the range of the shear along one direction of one plane. For fully reversed
    torsion the root is the amplitude of the shear stress. The criterion is for hard metals, with ratios of the limits
    of torsion and bending from 0.577 to 0.8, and has no plane.

    Parameters
    ----------
    slope : float
        Weight of the largest mean normal stress [-]: ``(t - b / sqrt 3) / (b / 3)`` of limits t of torsion and b of
        bending.
    limit_amplitude : float
        Shear stress amplitude [Pa] that the material endures in fully reversed torsion.
    """

    key: ClassVar[str] = "papadopoulos"
    example: ClassVar[dict[str, Any]] = {"slope": 0.3, "limit_amplitude": "250 MPa"}
    references: ClassVar[tuple[str, ...]] = (
        "I. V. Papadopoulos, P. Davoli, C. Gorla, M. Filippini, A. Bernasconi 1997, Int. J. Fatigue 19, 219",
    )

    def damage(self, cycle: StressCycle) -> DamageParameter:
        """Damage parameter [Pa]; see `FatigueCriterion`."""
        rows, weights = _directions()
        mean = np.empty(cycle.points)
        for start in range(0, cycle.points, _CHUNK):
            span = slice(start, start + _CHUNK)
            high = low = rows @ cycle.stress[0, :, span]
            for step in cycle.stress[1:, :, span]:
                shear = rows @ step
                high, low = np.maximum(high, shear), np.minimum(low, shear)
            mean[span] = weights @ (0.5 * (high - low)) ** 2
        return DamageParameter(np.sqrt(5.0 * mean) + self.slope * cycle.hydrostatic.max(axis=0))

    def upper_bound(self, cycle: StressCycle) -> FloatArray:
        """With half widths of the path of the deviator along orthogonal directions; see `HasUpperBound`."""
        amplitude = PathBounds(cycle.stress).deviator_widths() / SQRT2
        return np.asarray(amplitude + self.slope * cycle.hydrostatic.max(axis=0))

    def known_values(self, amplitude: float, young_modulus: float, poisson_ratio: float) -> Mapping[str, float]:
        """Closed forms; see `HasKnownValues`."""
        del young_modulus, poisson_ratio
        tension = 1 / np.sqrt(3.0)
        values = {
            "tension": tension + self.slope / 3,
            "pulsating-tension": tension + 2 * self.slope / 3,
            "torsion": 1.0,
            "tension-and-torsion": np.sqrt(4 / 3) + self.slope / 3,
        }
        return {name: amplitude * float(value) for name, value in values.items()}


@cache
def _directions() -> tuple[FloatArray, FloatArray]:
    """Rows ``(n, 6)`` that map Mandel vectors to the shear along directions of planes, and their weights, sum 1."""
    cosines, gauss = np.polynomial.legendre.leggauss(_NODES)
    turns = np.pi * (np.arange(_NODES) + 0.5) / _NODES
    c, phi, chi = (angles.ravel() for angles in np.meshgrid(cosines, turns, turns, indexing="ij"))
    s = np.sqrt(1 - c**2)
    n = np.array([s * np.cos(phi), s * np.sin(phi), c])
    up, side = np.array([c * np.cos(phi), c * np.sin(phi), -s]), np.array([-np.sin(phi), np.cos(phi), 0 * phi])
    m = np.cos(chi) * up + np.sin(chi) * side
    pairs = ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))
    rows = np.stack([n[i] * m[j] if i == j else (n[i] * m[j] + n[j] * m[i]) / SQRT2 for i, j in pairs], axis=-1)
    return rows, np.repeat(gauss, _NODES**2) / (2 * _NODES**2)


eigencontact_register = hook_for(Papadopoulos)
