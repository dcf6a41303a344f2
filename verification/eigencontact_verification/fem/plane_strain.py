"""A body in plane strain whose points answer by laws that remember, and the field of a force per length on it.

The elements are those of `yielding_body`: nine nodes, mean dilatation of the second order. Vectors are (xx, yy, zz,
sqrt2 xz); z points into the body, y along the line. Strain yy is zero, stress yy is not.

References
----------
K. L. Johnson, Contact Mechanics, 1985, sections 2.2 and 2.3 (Flamant's force). Displacements are integrated here from
its stress, up to a rigid motion; `tests/verification/test_line_elements.py` differentiates them back.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from eigencontact_verification.fem.yielding_body import YieldingBody

__all__ = ["PlaneBody", "line_force_displacement", "line_force_stress", "stretched_displacement"]

FloatArray = NDArray[np.float64]


class PlaneBody(YieldingBody):
    """Plane strain in (x, z): no strain along y, and integrals over the area alone."""

    @cached_property
    def weight(self) -> FloatArray:
        """Weight dA of each integration point, (elements, 9)."""
        return np.asarray(self.basis.dx)

    def hoop(self, value: FloatArray) -> FloatArray:
        """Strain yy, zero."""
        return np.zeros_like(value)


def line_force_displacement(
    normal: float, shear: float, young_modulus: float, poisson_ratio: float, x: FloatArray, z: FloatArray
) -> FloatArray:
    """Displacement u_x, u_z (2, n) by forces per length along z and x at the origin of a half plane [m].

    Its zero is a choice (no length but the unit enters the logarithm). Points (x, z) are not the origin.
    """
    nu = poisson_ratio
    twice = young_modulus / (1 + nu) * np.pi
    squared = x * x + z * z
    far, angle = -(1 - nu) * np.log(squared), (1 - 2 * nu) * np.arctan2(x, z)
    mixed = x * z / squared
    u_x = normal * (mixed - angle) + shear * (far + x * x / squared)
    u_z = normal * (far + z * z / squared) + shear * (mixed + angle)
    return np.stack((u_x, u_z)) / twice


def line_force_stress(normal: float, shear: float, x: FloatArray, z: FloatArray) -> FloatArray:
    """Stress xx, zz, xz (3, n) by these forces [Pa]."""
    common = -2 * (normal * z + shear * x) / (np.pi * (x * x + z * z) ** 2)
    return common * np.stack((x * x, z * z, x * z))


def stretched_displacement(
    stress: float, young_modulus: float, poisson_ratio: float, x: FloatArray, z: FloatArray
) -> FloatArray:
    """Displacement u_x, u_z (2, n) of a body under a uniform stress xx in plane strain, zero at the origin."""
    nu = poisson_ratio
    return np.asarray(stress / young_modulus * np.stack(((1 - nu**2) * x, -nu * (1 + nu) * z)))
