"""Hardening by a constant modulus."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np

from eigencontact.plugin import FloatArray, IsotropicHardening, Stress, hook_for, require

__all__ = ["Linear"]


@dataclass(frozen=True, kw_only=True)
class Linear(IsotropicHardening):
    """Linear hardening or softening: the flow stress changes in proportion to plastic strain.

    Parameters
    ----------
    yield_stress : float
        Yield stress in tension [Pa], positive.
    modulus : float, optional
        Slope H of the flow stress over plastic strain [Pa]; negative softens.
    tangent_modulus : float, optional
        Slope E_t of stress over total strain in tension [Pa], below Young's modulus: H = E E_t / (E - E_t). Exactly one
        of the two moduli is required.
    least_stress : float
        Lower bound of a softening flow stress [Pa]; a thousandth of the yield stress by default.
    """

    key: ClassVar[str] = "linear"
    example: ClassVar[dict[str, Any]] = {"yield_stress": "1 GPa", "modulus": "20 GPa"}
    references: ClassVar[tuple[str, ...]] = ("J. Lemaitre, J.-L. Chaboche 1990, Mechanics of Solid Materials, 5.4",)

    yield_stress: Stress
    modulus: Stress | None = None
    tangent_modulus: Stress | None = None
    least_stress: Stress | None = None

    def __post_init__(self) -> None:
        good = 0 < self.yield_stress < np.inf
        require(good, self.key, "yield_stress", self.yield_stress, "positive and finite [Pa]")
        names = [name for name in ("modulus", "tangent_modulus") if getattr(self, name) is not None]
        require(len(names) == 1, self.key, "modulus", ", ".join(names) or None, "given, or else tangent-modulus")
        for name in names:
            require(bool(np.isfinite(getattr(self, name))), self.key, name, getattr(self, name), "finite [Pa]")
        floor = self.least_stress
        good = floor is None or 0 < floor <= self.yield_stress
        require(good, self.key, "least_stress", floor, "positive and not above the yield stress [Pa]")

    def of_material(self, young_modulus: float) -> Linear:
        """See `HardeningLaw.of_material`."""
        slope = self.tangent_modulus
        if slope is None:
            return self
        rule = f"below Young's modulus, {young_modulus:g} Pa"
        require(slope < young_modulus, self.key, "tangent_modulus", slope, rule)
        return replace(self, modulus=young_modulus * slope / (young_modulus - slope), tangent_modulus=None)

    def flow_stress(self, p: FloatArray) -> tuple[FloatArray, FloatArray]:
        """See `IsotropicHardening.flow_stress`; a tangent modulus needs the modulus of a material (`of_material`)."""
        require(self.modulus is not None, self.key, "modulus", None, "known; a tangent modulus requires a material")
        slope = float(self.modulus or 0.0)
        floor = 1e-3 * self.yield_stress if self.least_stress is None else self.least_stress
        stress = self.yield_stress + slope * p
        return np.maximum(stress, floor), np.where(stress > floor, slope, 0.0)


eigencontact_register = hook_for(Linear)
