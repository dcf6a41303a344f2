"""Law of the material of a body, for ground of its own beside cells of other laws."""

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
    """Law of the matrix; none of an incompressible one, whose stiffness is not finite."""
    return _Matrix(material=matrix) if matrix.poisson_ratio < 0.5 else None
