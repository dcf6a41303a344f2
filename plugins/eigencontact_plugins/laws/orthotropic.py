"""Elasticity with three planes of symmetry."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from eigencontact.plugin import (
    Direction,
    FloatArray,
    LinearLaw,
    Stress,
    factors_of_compliance,
    frame_of,
    hook_for,
    mandel_rotation,
    require,
)

__all__ = ["Orthotropic"]


_ROUNDING = 1e-9


@dataclass(frozen=True, kw_only=True)
class Orthotropic(LinearLaw):
    """Orthotropic elasticity, with three perpendicular planes of symmetry: laminates, rolled sheet, bone.

    Parameters
    ----------
    moduli : (float, float, float)
        Young's moduli [Pa] along the axes 1, 2, 3 of the material, positive.
    poisson_ratios : (float, float, float)
        ν12, ν13, ν23 [-]: ν12 is the contraction along 2 under tension along 1. The elastic energy must not be
        negative;
        incompressible is allowed.
    shear_moduli : (float, float, float)
        G12, G13, G23 [Pa], positive.
    x_axis, y_axis : (float, float, float)
        Directions of the axes 1 and 2 in scene axes, of any length, at right angles.
    """

    key: ClassVar[str] = "orthotropic"
    example: ClassVar[dict[str, Any]] = {
        "moduli": ["130 GPa", "10 GPa", "8 GPa"],
        "poisson_ratios": [0.3, 0.25, 0.4],
        "shear_moduli": ["5 GPa", "4 GPa", "3 GPa"],
    }
    references: ClassVar[tuple[str, ...]] = (
        "S. G. Lekhnitskii 1963, Theory of Elasticity of an Anisotropic Elastic Body, section 3",
    )

    moduli: tuple[Stress, Stress, Stress]
    poisson_ratios: tuple[float, float, float]
    shear_moduli: tuple[Stress, Stress, Stress]
    x_axis: Direction = (1.0, 0.0, 0.0)
    y_axis: Direction = (0.0, 1.0, 0.0)

    def __post_init__(self) -> None:
        for name in ("moduli", "shear_moduli"):
            values = np.asarray(getattr(self, name), dtype=float)
            good = bool(np.all((values > 0) & (values < np.inf)))
            require(good, self.key, name, values.tolist(), "positive and finite [Pa]")
        ratios = np.asarray(self.poisson_ratios, dtype=float)
        require(np.all(np.isfinite(ratios)), self.key, "poisson_ratios", ratios.tolist(), "finite [-]")
        frame_of(self.key, self.x_axis, self.y_axis)
        # Scaled to a unit diagonal, so that the smallest eigenvalue shows the distance from a negative energy.
        compliance = self._compliance_in_axes()
        size = 1.0 / np.sqrt(np.diag(compliance))
        least = float(np.linalg.eigvalsh(compliance * np.outer(size, size))[0])
        rule = "such that no strain has negative energy with these moduli [-]"
        require(least >= -_ROUNDING, self.key, "poisson_ratios", self.poisson_ratios, rule)

    def _compliance_in_axes(self) -> FloatArray:
        """Compliance in the axes of the material."""
        E1, E2, _ = self.moduli
        nu12, nu13, nu23 = self.poisson_ratios
        G12, G13, G23 = self.shear_moduli
        compliance = np.diag([*(1.0 / E for E in self.moduli), 0.5 / G23, 0.5 / G13, 0.5 / G12])
        compliance[0, 1] = compliance[1, 0] = -nu12 / E1
        compliance[0, 2] = compliance[2, 0] = -nu13 / E1
        compliance[1, 2] = compliance[2, 1] = -nu23 / E2
        return compliance

    def compliance_matrix(self) -> FloatArray:
        """Mandel compliance ``(6, 6)`` [1/Pa] in scene axes, also finite for incompressible solids."""
        turn = mandel_rotation(frame_of(self.key, self.x_axis, self.y_axis))
        return turn @ self._compliance_in_axes() @ turn.T

    def stiffness_matrix(self) -> FloatArray:
        """See `LinearLaw.stiffness_matrix`."""
        compliance = self.compliance_matrix()
        softest, stiffest = np.linalg.eigvalsh(compliance)[[-1, 0]]
        rule = "such that the solid is not incompressible, for a finite stiffness"
        require(stiffest > _ROUNDING * softest, self.key, "poisson_ratios", self.poisson_ratios, rule)
        return np.asarray(np.linalg.inv(compliance))

    def factors(self, shear_modulus: float) -> tuple[FloatArray, FloatArray]:
        """See `LinearLaw.factors`."""
        return factors_of_compliance(self.compliance_matrix(), shear_modulus)


eigencontact_register = hook_for(Orthotropic)
