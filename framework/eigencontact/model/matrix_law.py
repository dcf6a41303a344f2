"""Law of the material of a body, for cells without another law."""

from __future__ import annotations

from dataclasses import dataclass

from eigencontact.core.array_types import FloatArray
from eigencontact.core.elasticity import isotropic_stiffness
from eigencontact.core.material import Material
from eigencontact.plugin import LinearLaw

__all__ = ["matrix_law"]


@dataclass(frozen=True, kw_only=True)
class _Matrix(LinearLaw):
    """Elasticity of the matrix."""

    key = "matrix"

    material: Material

    def stiffness_matrix(self) -> FloatArray:
        """See `LinearLaw.stiffness_matrix`."""
        return isotropic_stiffness(self.material.young_modulus, self.material.poisson_ratio)


def matrix_law(matrix: Material) -> LinearLaw | None:
    """Law of the matrix; None for an incompressible matrix, whose stiffness is infinite."""
    return _Matrix(material=matrix) if matrix.poisson_ratio < 0.5 else None
