"""Rules of the parameters of criteria."""

from __future__ import annotations

import numpy as np

from eigencontact.plugin import require

__all__ = ["check_positive", "check_slope"]


def check_slope(where: str, name: str, value: float) -> None:
    """Refuse a weight of the mean or normal stress that is negative: tension does not make a material endure more."""
    require(0 <= value < np.inf, where, name, value, "zero or positive, and finite [-]")


def check_positive(where: str, name: str, value: float, unit: str = "Pa") -> None:
    """Refuse a limit that is not positive."""
    require(0 < value < np.inf, where, name, value, f"positive and finite [{unit}]")
