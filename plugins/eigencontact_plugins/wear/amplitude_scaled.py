"""Wear by friction work and slip amplitude, after Fouvry and Paulin for gross slip."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, ClassVar

import numpy as np

from eigencontact.plugin import FloatArray, Unit, WearLaw, WearState, hook_for, require

__all__ = ["AmplitudeScaled"]


@dataclass(frozen=True, kw_only=True)
class AmplitudeScaled(WearLaw):
    """Depth ``c s E`` from the friction work E per area of a cycle and the local slip amplitude s of the cycle.

    The amplitude is that of the whole cycle, a quarter of its slip distance, so that the depth does not depend on the
    number of increments.

    Parameters
    ----------
    coefficient : float
        Worn volume per friction work and amplitude [m²/J], as ``"1e4 mm^3/(J mm)"``: the coefficient of the energy law
        at a reference amplitude, divided by this amplitude.
    """

    key: ClassVar[str] = "amplitude-scaled"
    example: ClassVar[dict[str, Any]] = {"coefficient": "1e4 mm^3/(J mm)"}
    references: ClassVar[tuple[str, ...]] = (
        "S. Fouvry, C. Paulin, T. Liskiewicz, Tribol. Int. 40 (2007) 1428, doi:10.1016/j.triboint.2007.02.011",
    )
    linear_in_pressure: ClassVar[bool] = True
    needs_friction: ClassVar[bool] = True
    needs_cycles: ClassVar[bool] = True

    coefficient: Annotated[float, Unit("m^2/J", "a worn volume by work of friction and amplitude")]

    def __post_init__(self) -> None:
        rule = "zero or positive, and finite [m^2/J]"
        require(0 <= self.coefficient < np.inf, self.key, "coefficient", self.coefficient, rule)

    def depth(self, state: WearState) -> FloatArray:
        """Worn depth [m]; see `WearLaw`."""
        return self.coefficient * state.slip_amplitude * state.energy


eigencontact_register = hook_for(AmplitudeScaled)
