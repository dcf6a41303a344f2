"""Hardening by a power of plastic strain: Swift's law and Ludwik's."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from eigencontact.plugin import FloatArray, IsotropicHardening, Stress, hook_for, require

__all__ = ["Ludwik", "Swift"]


#: Plastic strain below which Ludwik's slope, infinite at zero for n < 1, is the slope of the chord from zero.
_FIRST = 1e-9


@dataclass(frozen=True, kw_only=True)
class Swift(IsotropicHardening):
    """Swift's law ``Y = B (C + 1e6 p)^n``, with the plastic strain in microstrain inside the power.

    Parameters
    ----------
    B : float
        Stress [Pa], positive.
    C : float
        Microstrain [1e-6], positive, so that the first yield stress B C^n is positive.
    n : float
        Exponent in [0, 1].
    """

    key: ClassVar[str] = "swift"
    example: ClassVar[dict[str, Any]] = {"B": "1240 MPa", "C": 30.0, "n": 0.085}
    references: ClassVar[tuple[str, ...]] = (
        "H. W. Swift 1952, J. Mech. Phys. Solids 1, 1",
        "C. Jacq, D. Nelias, G. Lormand, D. Girodin 2002, J. Tribol. 124, 653 (p in microstrain)",
    )

    B: Stress
    C: float
    n: float

    def __post_init__(self) -> None:
        require(0 < self.B < np.inf, self.key, "B", self.B, "positive and finite [Pa]")
        require(0 < self.C < np.inf, self.key, "C", self.C, "positive and finite [microstrain]")
        require(0 <= self.n <= 1, self.key, "n", self.n, "in [0, 1] [-]")

    def flow_stress(self, p: FloatArray) -> tuple[FloatArray, FloatArray]:
        """See `IsotropicHardening.flow_stress`."""
        shifted = self.C + 1e6 * p
        stress = self.B * shifted**self.n
        return stress, 1e6 * self.n * stress / shifted


@dataclass(frozen=True, kw_only=True)
class Ludwik(IsotropicHardening):
    """Ludwik's law ``Y = Y0 + K p^n``.

    Parameters
    ----------
    yield_stress : float
        Y0 [Pa], positive.
    strength : float
        K [Pa], zero or positive.
    n : float
        Exponent in (0, 1].
    """

    key: ClassVar[str] = "ludwik"
    example: ClassVar[dict[str, Any]] = {"yield_stress": "1 GPa", "strength": "2 GPa", "n": 0.4}
    references: ClassVar[tuple[str, ...]] = ("P. Ludwik 1909, Elemente der technologischen Mechanik",)

    yield_stress: Stress
    strength: Stress
    n: float

    def __post_init__(self) -> None:
        good = 0 < self.yield_stress < np.inf
        require(good, self.key, "yield_stress", self.yield_stress, "positive and finite [Pa]")
        require(0 <= self.strength < np.inf, self.key, "strength", self.strength, "zero or positive and finite [Pa]")
        require(0 < self.n <= 1, self.key, "n", self.n, "in (0, 1] [-]")

    def flow_stress(self, p: FloatArray) -> tuple[FloatArray, FloatArray]:
        """See `IsotropicHardening.flow_stress`; the infinite slope at zero is replaced by that of a chord."""
        first = self.strength * _FIRST ** (self.n - 1.0)
        early = p < _FIRST
        later = np.where(early, _FIRST, p)
        grown = np.where(early, first * p, self.strength * later**self.n)
        return self.yield_stress + grown, np.where(early, first, self.n * self.strength * later ** (self.n - 1.0))


eigencontact_register = hook_for(Swift, Ludwik)
