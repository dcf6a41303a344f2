"""No hardening."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from eigencontact.plugin import FloatArray, IsotropicHardening, Stress, hook_for, require

__all__ = ["Perfect"]


@dataclass(frozen=True, kw_only=True)
class Perfect(IsotropicHardening):
    """Perfect plasticity: the flow stress is constant.

    Parameters
    ----------
    yield_stress : float
        Yield stress in tension [Pa], positive.
    """

    key: ClassVar[str] = "perfect"
    example: ClassVar[dict[str, Any]] = {"yield_stress": "1 GPa"}
    references: ClassVar[tuple[str, ...]] = ("R. Hill 1950, The Mathematical Theory of Plasticity, chapter II",)

    yield_stress: Stress

    def __post_init__(self) -> None:
        good = 0 < self.yield_stress < np.inf
        require(good, self.key, "yield_stress", self.yield_stress, "positive and finite [Pa]")

    def flow_stress(self, p: FloatArray) -> tuple[FloatArray, FloatArray]:
        """See `IsotropicHardening.flow_stress`."""
        return np.full_like(p, self.yield_stress), np.zeros_like(p)


eigencontact_register = hook_for(Perfect)
