"""Archard's law: depth proportional to pressure and slip distance."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, ClassVar

import numpy as np

from eigencontact.plugin import FloatArray, Stress, Unit, WearLaw, WearState, hook_for, require

__all__ = ["Archard"]


@dataclass(frozen=True, kw_only=True)
class Archard(WearLaw):
    """Depth ``(K / H) p s`` for a pressure p over a slip distance s; friction is not required.

    Parameters
    ----------
    coefficient : float
        K, a number, if a hardness is given; otherwise K / H [1/Pa], as ``"1e-13 m^3/(N m)"``.
    hardness : float, optional
        H [Pa].
    """

    key: ClassVar[str] = "archard"
    example: ClassVar[dict[str, Any]] = {"coefficient": "1e-13 m^3/(N m)"}
    references: ClassVar[tuple[str, ...]] = ("J. F. Archard, J. Appl. Phys. 24 (1953) 981, doi:10.1063/1.1721448",)
    linear_in_pressure: ClassVar[bool] = True

    coefficient: Annotated[float, Unit("1/Pa", "a worn volume by load and path")]
    hardness: Stress | None = None

    def __post_init__(self) -> None:
        rule = "zero or positive, and finite"
        require(0 <= self.coefficient < np.inf, self.key, "coefficient", self.coefficient, rule)
        if self.hardness is not None:
            require(0 < self.hardness < np.inf, self.key, "hardness", self.hardness, "positive and finite [Pa]")

    def depth(self, state: WearState) -> FloatArray:
        """Worn depth [m]; see `WearLaw`."""
        return self.coefficient / (self.hardness or 1.0) * state.pressure * state.slip


eigencontact_register = hook_for(Archard)
