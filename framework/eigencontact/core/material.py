"""Elastic constants of an isotropic half-space."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from eigencontact.core.arrays import is_real
from eigencontact.core.units import LARGEST, SMALLEST
from eigencontact.errors import require

__all__ = ["Material", "contact_modulus", "dundurs_constant"]


@dataclass(frozen=True, kw_only=True, slots=True)
class Material:
    """Isotropic linear elasticity.

    Parameters
    ----------
    young_modulus : float
        E [Pa], between 1e-30 and 1e30. A rigid body is the absence of a material (None), not an infinite modulus.
    poisson_ratio : float
        ν [-] in [-1, 0.5]. The end 0.5 is exact here: no formula of this package divides by 1 - 2ν.

    Examples
    --------
    >>> steel = Material(young_modulus=210e9, poisson_ratio=0.3)
    >>> f"{steel.shear_modulus / 1e9:.1f} GPa"
    '80.8 GPa'
    """

    young_modulus: float
    poisson_ratio: float

    def __post_init__(self) -> None:
        E, nu = self.young_modulus, self.poisson_ratio
        require(is_real(E) and 0 < E < np.inf, "material", "young_modulus", E, "positive and finite [Pa]")
        rule = f"between {SMALLEST:g} and {LARGEST:g} [Pa]"
        require(SMALLEST <= E <= LARGEST, "material", "young_modulus", E, rule)
        require(is_real(nu) and -1 < nu <= 0.5, "material", "poisson_ratio", nu, "in (-1, 0.5] [-]")

    @property
    def shear_modulus(self) -> float:
        """G = E / (2 (1 + ν)) [Pa]."""
        return self.young_modulus / (2.0 * (1.0 + self.poisson_ratio))

    @property
    def plane_strain_modulus(self) -> float:
        """E / (1 - ν²) [Pa]."""
        return self.young_modulus / ((1.0 - self.poisson_ratio) * (1.0 + self.poisson_ratio))


def contact_modulus(*bodies: Material | None) -> float:
    """Contact modulus E* [Pa], ``1/E* = Σ (1 - ν²)/E`` over the elastic bodies (K. L. Johnson 1985, eq. 4.21)."""
    compliance = sum(1.0 / body.plane_strain_modulus for body in bodies if body is not None)
    return 1.0 / compliance if compliance > 0 else float("inf")


def dundurs_constant(body1: Material | None, body2: Material | None) -> float:
    """Dundurs constant β [-] that couples normal and tangential contact (K. L. Johnson 1985, eq. 5.3).

    Zero for like materials and for two incompressible ones; None stands for a rigid body.

    Examples
    --------
    >>> round(dundurs_constant(Material(young_modulus=1.0, poisson_ratio=0.3), None), 4)
    0.2857
    """

    def terms(body: Material | None) -> tuple[float, float]:
        if body is None:
            return 0.0, 0.0
        return (
            (1.0 - 2.0 * body.poisson_ratio) / body.shear_modulus,
            (1.0 - body.poisson_ratio) / body.shear_modulus,
        )

    (n1, d1), (n2, d2) = terms(body1), terms(body2)
    return 0.5 * (n1 - n2) / (d1 + d2) if d1 + d2 > 0 else 0.0
