"""Strength of the interaction of two inclusions, or of an inclusion and the surface, and the necessary degree.

Fields of two balls are multipoles that reflect between them, so the error of polynomial eigenstrain falls per degree by
``q = exp(-α)``: for a ball of radius r at the depth d of its centre, cosh α = d/r; for two equal balls at distance D,
cosh α = D/(2r); for unequal ones α = asinh(c/r) of the larger, ``c² = [(D²-r1²-r2²)² - 4 r1² r2²]/(4 D²)``. The nearest
reflection in a neighbour lies at c + (c² + r²)^½ from the middle: the larger ball converges more slowly, and its error
reaches the smaller one.

References
----------
G. B. Jeffery 1912, Proc. R. Soc. Lond. A 87, 109 (bispherical coordinates). That strain converges as the potentials of
charges do was measured: equal rigid balls a tenth of a radius apart fall by .71 to .73 per degree, q = .730; balls of 1
and 3.6 radii at a distance of 5.03 by .78 and .84 from degree 8 to 9, q = .787 (.455 by the smaller).
"""

from __future__ import annotations

from math import acosh, asinh, ceil, exp, log, sqrt

import numpy as np

from eigencontact.core.elasticity import Elasticity
from eigencontact.core.material import Material
from eigencontact.solvers.cell_conditions import compliance

__all__ = ["contrast_of", "counts_between", "degree_for", "reflection", "stated_error"]

#: Largest reflection that is told apart from touching.
_TOUCHING = 0.999
#: Error of an integral over an inclusion, in parts of the field.
_QUADRATURE = 1e-8
#: Error of degree 0 in parts of the load, for a void or a rigid inclusion. Balls under contacts, 0.2 to 2 radii deep,
#: of half and twice the stiffness and voids, showed 0.1 to 0.5 times the contrast.
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
    distance: float, within: float, reach: float, degree: int, *, alone: bool = False
) -> tuple[int, int, int]:
    """Points of a rule over an inclusion for the field of another, outwards, from pole to pole, and around.

    Parameters
    ----------
    distance : float
        Of their middles, or of an inclusion and its image [m].
    within, reach : float
        Radii of the inclusion that is integrated over and of the other [m].
    degree : int
        Largest of both.
    alone : bool
        The inclusion's own field in full space, a polynomial: exact.
    """
    more = 0
    if not alone:
        # An expansion about the middle converges as (within / distance)^l. The factors were fitted to balls 1.02 to 1.5
        # radii deep, whose eigenstrain is then right to 1e-9.
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
        Largest ``|k - 1| / (k + 1)`` of the ratios k of stiffness: 1 for a void or a rigid inclusion.
    quality : float
        Factor q per degree.
    """
    return _WORST * contrast * quality**degree


def degree_for(contrast: float, quality: float, error: float) -> int:
    """Least degree whose foretold error is within `error`."""
    factor = _WORST * contrast
    return 0 if factor <= error or quality == 0.0 else ceil(log(factor / error) / -log(quality))
