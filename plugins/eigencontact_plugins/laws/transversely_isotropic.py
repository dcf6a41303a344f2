"""Elasticity that is isotropic in the plane normal to an axis."""

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
    hook_for,
    mandel_rotation,
    require,
    unit_vector,
)

__all__ = ["TransverselyIsotropic"]


_ROUNDING = 1e-9


@dataclass(frozen=True, kw_only=True)
class TransverselyIsotropic(LinearLaw):
    """Transversely isotropic elasticity, isotropic in the plane normal to an axis: fibres, wood, hexagonal crystals.

    Parameters
    ----------
    axial_modulus, transverse_modulus : float
        Young's moduli [Pa] along and across the axis, positive.
    axial_poisson_ratio : float
        Contraction across the axis under tension along it.
    transverse_poisson_ratio : float
        Contraction across the axis under tension across the axis. The elastic energy must not be negative;
        incompressible is allowed.
    axial_shear_modulus : float
        Shear modulus [Pa] in planes that contain the axis; positive.
    axis : (float, float, float)
        Direction in scene axes, of any length.
    """

    key: ClassVar[str] = "transversely-isotropic"
    example: ClassVar[dict[str, Any]] = {
        "axial_modulus": "230 GPa",
        "transverse_modulus": "15 GPa",
        "axial_poisson_ratio": 0.2,
        "transverse_poisson_ratio": 0.4,
        "axial_shear_modulus": "24 GPa",
    }
    references: ClassVar[tuple[str, ...]] = (
        "S. G. Lekhnitskii 1963, Theory of Elasticity of an Anisotropic Elastic Body, section 3",
    )

    axial_modulus: Stress
    transverse_modulus: Stress
    axial_poisson_ratio: float
    transverse_poisson_ratio: float
    axial_shear_modulus: Stress
    axis: Direction = (0.0, 0.0, 1.0)

    def __post_init__(self) -> None:
        for name in ("axial_modulus", "transverse_modulus", "axial_shear_modulus"):
            value = getattr(self, name)
            require(0 < value < np.inf, self.key, name, value, "positive and finite [Pa]")
        across, along = self.transverse_poisson_ratio, self.axial_poisson_ratio
        require(-1 < across < 1, self.key, "transverse_poisson_ratio", across, "in (-1, 1) [-]")
        bound = float(np.sqrt(0.5 * (1.0 - across) * self.axial_modulus / self.transverse_modulus))
        stable = abs(along) <= bound * (1.0 + _ROUNDING)
        require(stable, self.key, "axial_poisson_ratio", along, f"in [-{bound:.6g}, {bound:.6g}] for these moduli [-]")
        unit_vector(self.key, "axis", self.axis)

    def _turn(self) -> FloatArray:
        axis = unit_vector(self.key, "axis", self.axis)
        aside = np.eye(3)[int(np.argmin(np.abs(axis)))]
        first = np.cross(aside, axis)
        first /= np.linalg.norm(first)
        return mandel_rotation(np.column_stack([first, np.cross(axis, first), axis]))

    def compliance_matrix(self) -> FloatArray:
        """Mandel compliance ``(6, 6)`` [1/Pa] in scene axes, also finite for incompressible solids."""
        across, along, nu = self.transverse_modulus, self.axial_modulus, self.transverse_poisson_ratio
        shear = 0.5 / self.axial_shear_modulus
        compliance = np.diag([1.0 / across, 1.0 / across, 1.0 / along, shear, shear, (1.0 + nu) / across])
        compliance[0, 1] = compliance[1, 0] = -nu / across
        compliance[2, :2] = compliance[:2, 2] = -self.axial_poisson_ratio / along
        turn = self._turn()
        return turn @ compliance @ turn.T

    def stiffness_matrix(self) -> FloatArray:
        """See `LinearLaw.stiffness_matrix`."""
        compliance = self.compliance_matrix()
        softest, stiffest = np.linalg.eigvalsh(compliance)[[-1, 0]]
        rule = "such that the solid is not incompressible, for a finite stiffness"
        require(stiffest > _ROUNDING * softest, self.key, "axial_poisson_ratio", self.axial_poisson_ratio, rule)
        return np.asarray(np.linalg.inv(compliance))

    def factors(self, shear_modulus: float) -> tuple[FloatArray, FloatArray]:
        """See `LinearLaw.factors`."""
        return factors_of_compliance(self.compliance_matrix(), shear_modulus)


eigencontact_register = hook_for(TransverselyIsotropic)
