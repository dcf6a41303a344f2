"""Common rules of criteria: checks of parameters, and a limit with a weight of the mean or normal stress."""

from __future__ import annotations

from abc import ABC
from dataclasses import dataclass

import numpy as np

from eigencontact.plugin import FatigueCriterion, Stress, require

__all__ = ["WeightedNormalStress", "check_positive", "check_slope"]


def check_slope(where: str, name: str, value: float) -> None:
    """Refuse a negative weight of the mean or normal stress: tension must not increase the endurance."""
    require(0 <= value < np.inf, where, name, value, "zero or positive, and finite [-]")


def check_positive(where: str, name: str, value: float, unit: str = "Pa") -> None:
    """Refuse a limit that is not positive."""
    require(0 < value < np.inf, where, name, value, f"positive and finite [{unit}]")


@dataclass(frozen=True, kw_only=True)
class WeightedNormalStress(FatigueCriterion, ABC):
    """A shear amplitude plus `slope` times a mean or normal stress, below `limit_amplitude` [Pa]."""

    slope: float
    limit_amplitude: Stress

    def __post_init__(self) -> None:
        check_slope(self.key, "slope", self.slope)
        check_positive(self.key, "limit_amplitude", self.limit_amplitude)

    @property
    def limit(self) -> float:
        """The limit [Pa]."""
        return self.limit_amplitude
