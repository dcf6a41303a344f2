"""Strength of the interaction of two inclusions, or of an inclusion and the surface, and the required degree.

Fields of two balls are multipoles that reflect between them. The error of polynomial eigenstrain therefore falls per
degree by ``q = exp(-α)``. For a ball of radius r with its centre at depth d, cosh α = d/r. For two equal balls at
distance D, cosh α = D/(2r). For unequal balls, α = asinh(c/r) of the larger, ``c² = [(D²-r1²-r2²)² - 4 r1² r2²]/(4
D²)``. The nearest reflection in a neighbour lies at c + (c² + r²)^½ from the middle. The series of the larger ball
therefore converges more slowly, and its error also affects the smaller ball.

References
----------
G. B. Jeffery 1912, Proc. R. Soc. Lond. A 87, 109 (bispherical coordinates). Measurements show that strain converges at
the rate of the potentials of charges: for equal rigid balls a tenth of a radius apart the error falls by .71 to .73 per
degree, q = .730; for balls of 1 and 3.6 radii at a distance of 5.03 by .78 and .84 from degree 8 to 9, q = .787 (.455
by the smaller).
"""

from __future__ import annotations

from math import acosh, asinh, ceil, exp, log, sqrt

import numpy as np

from eigencontact.core.elasticity import Elasticity
from eigencontact.core.material import Material
from eigencontact.solvers.cell_conditions import compliance

__all__ = ["contrast_of", "counts_between", "degree_for", "reflection", "stated_error"]

#: Largest reflection factor; larger ones count as contact of the balls.
_TOUCHING = 0.999
#: Error of an integral over an inclusion, relative to the field.
_QUADRATURE = 1e-8
#: Error of degree 0 relative to the load, for a void or a rigid inclusion. Balls below contacts, at depths of 0.2 to 2
#: radii, with half and twice the stiffness and voids, had 0.1 to 0.5 times the contrast.
_WORST = 1.0


def reflection(distance: float, first: float, second: float) -> float:
    """Factor q per degree of two balls of radii `first` and `second` at a distance of their centres [m].

    Examples
    --------
    >>> round(reflection(2.1, 1.0, 1.0), 3), round(reflection(2.1, 1.0, 1.0 + 1e-9), 3)
    (0.73, 0.73)
    >>> round(reflection(5.03, 1.0, 3.6), 3), round(reflection(5.03, 3.6, 1.0), 3)
    (0.787, 0.787)
    """
    if distance <= first + second:
        return _TOUCHING
    if first == second:
        return min(exp(-acosh(distance / (2.0 * first))), _TOUCHING)
    product = (distance**2 - first**2 - second**2) ** 2 - 4.0 * first**2 * second**2
    return min(exp(-asinh(sqrt(product) / (2.0 * distance * max(first, second)))), _TOUCHING)


def counts_between(
    distance: float, within: float, reach: float, degree: int, *, own_field: bool = False
) -> tuple[int, int, int]:
    """Numbers of points of a quadrature over an inclusion for the field of another: radial, polar and azimuthal.

    Parameters
    ----------
    distance : float
        Distance of their centres, or of an inclusion and its image [m].
    within, reach : float
        Radii of the inclusion of integration and of the other inclusion [m].
    degree : int
        Largest degree of both.
    own_field : bool
        Whether the field is the inclusion's own field in full space, a polynomial; the quadrature is then exact.
    """
    more = 0
    if not own_field:
        # An expansion about the centre converges as (within / distance)^l. The factors were fitted to balls at depths
        # of 1.02 to 1.5 radii, so that their eigenstrain has an error of 1e-9.
        near = max(distance - 0.5 * reach, 1.02 * within)
        more = ceil(0.45 * log(1.0 / _QUADRATURE) / log(max(near / within, 1.15)))
    polar = degree + 2 + more
    return 2 + (degree + polar) // 2, polar, 2 * polar


def contrast_of(inclusion: Elasticity, matrix: Material) -> float:
    """Largest ``|k - 1| / (k + 1)`` of the ratios k of the stiffness of an inclusion to that of the matrix.

    Examples
    --------
    >>> from eigencontact.core.elasticity import isotropic_factors
    >>> class Steel:
    ...     def factors(self, shear_modulus):
    ...         return isotropic_factors(3.0, 0.3, shear_modulus)
    >>> round(contrast_of(Steel(), Material(young_modulus=1.0, poisson_ratio=0.3)), 12)
    0.5
    """
    soft, stiff = inclusion.factors(matrix.shear_modulus)
    of_matrix = compliance(matrix)
    sums, differences = stiff @ of_matrix + soft, stiff @ of_matrix - soft
    return float(np.abs(np.linalg.eigvals(np.linalg.pinv(sums) @ differences)).max())


def stated_error(contrast: float, quality: float, degree: int) -> float:
    """Predicted error of a solution of a degree, relative to the load.

    Parameters
    ----------
    contrast : float
        Largest ``|k - 1| / (k + 1)`` of the stiffness ratios k: 1 for a void or a rigid inclusion.
    quality : float
        Reduction factor q of the error per degree.
    """
    return _WORST * contrast * quality**degree


def degree_for(contrast: float, quality: float, error: float) -> int:
    """Smallest degree with a predicted error of at most `error`."""
    factor = _WORST * contrast
    return 0 if factor <= error or quality == 0.0 else ceil(log(factor / error) / -log(quality))
