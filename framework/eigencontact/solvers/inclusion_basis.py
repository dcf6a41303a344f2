"""Basis functions for the eigenstrain of one whole inclusion, and their integrals over it.

An inclusion of stiffness C' in a matrix of compliance M, with stress τ and strain e, has the eigenstrain x = e - M τ.
Fields of `eigencontact.solvers.navier_polynomials` give the pairs (e, τ), bounded from a void to a rigid inclusion.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from eigencontact.core.array_types import FloatArray, IntArray
from eigencontact.core.elasticity import Elasticity, factors_of_stiffness, isotropic_factors
from eigencontact.core.material import Material
from eigencontact.errors import require
from eigencontact.halfspace.moments import densities_up_to
from eigencontact.halfspace.potentials import HasMomentPotentials
from eigencontact.solvers.cell_conditions import compliance
from eigencontact.solvers.navier_polynomials import all_polynomials, equilibrated_polynomials

__all__ = ["InclusionBasis", "basis_of"]

#: Size of an eigenstrain, relative to the largest, below which it is round-off of a linear combination of others.
_DEPENDENT = 1e-12


@dataclass(frozen=True, eq=False)
class InclusionBasis:
    """Basis for one kind of inclusion.

    Attributes
    ----------
    degree : int
    degrees : (n,) of int
        Degree of each function, in ascending order.
    eigenstrain : (n + 6, 6, densities)
        Eigenstrain x of each function per density of the shape; then the six uniform eigenstrains, for a prestrain.
    span : (r, 6, densities)
        Linearly independent eigenstrains that span all of these; most functions contain the uniform ones. Expensive
        fields are computed only for these.
    mix : (n + 6, r)
        Coefficients of the eigenstrains in terms of `span`.
    work : (n, n + 6)
        Integral of τ of one function with x of another [m^3, in units of the matrix's shear modulus].
    overlap : (n, n)
        Mean over the inclusion of x : x.
    volume : float
        Volume of the inclusion [m^3].
    """

    degree: int
    degrees: IntArray
    eigenstrain: FloatArray
    span: FloatArray
    mix: FloatArray
    work: FloatArray
    overlap: FloatArray
    volume: float

    @property
    def size(self) -> int:
        """Number of unknowns."""
        return len(self.degrees)

    @cached_property
    def unknowns(self) -> FloatArray:
        """Eigenstrain of the functions without the uniform ones."""
        return self.eigenstrain[: self.size]

    @cached_property
    def amplitudes(self) -> FloatArray:
        """Amplitudes ``(n, 6 densities)`` of an eigenstrain per density; zero for functions without eigenstrain."""
        return np.asarray(np.linalg.pinv(self.unknowns.reshape(self.size, -1).T, rcond=1e-11), dtype=float)


def basis_of(
    shape: HasMomentPotentials, material: Elasticity | ArrayLike, matrix: Material, degree: int
) -> InclusionBasis:
    """Basis up to a degree, orthonormal in g over the inclusion, lower degrees first.

    Raises
    ------
    SceneError
        The densities of the shape do not span the polynomials.
    """
    G = matrix.shear_modulus
    soft, stiff = material.factors(G) if isinstance(material, Elasticity) else factors_of_stiffness(material, G)
    soft = 2.0 * G * soft  # strain and stress / 2G of g
    around = isotropic_factors(matrix.young_modulus, matrix.poisson_ratio, G)
    points, weights = shape.density_rule((degree + 3, degree + 3, 2 * degree + 6))
    volume = float(weights.sum())
    densities = shape.densities(degree, *points.T)
    gram = (densities * weights) @ densities.T / volume
    root = np.linalg.cholesky(gram)
    middle = weights @ points / volume
    offsets = points - middle
    size = float(np.sqrt((weights @ offsets**2).max() / volume))
    polynomials = equilibrated_polynomials(soft, stiff, around, degree, offsets / size)
    values, degrees = all_polynomials(densities, degree) if polynomials is None else polynomials
    # Coefficients per density of an orthonormal set, if the densities of the shape span the requested polynomials.
    orthonormal = np.linalg.solve(root, densities)
    rows = values.reshape(-1, len(points))
    inner = (rows * (weights / volume)) @ orthonormal.T
    fit_error = np.abs(inner @ orthonormal - rows).max() / np.abs(rows).max()
    require(fit_error < 1e-6, "inclusions", "densities", shape, f"densities that span polynomials of degree {degree}")
    flat, _ = np.linalg.qr(inner.reshape(len(values), -1).T)
    g = flat.T.reshape(len(values), 6, -1)
    M = 2.0 * G * compliance(matrix)
    strain, stress = np.einsum("ij,njd->nid", soft, g), np.einsum("ij,njd->nid", stiff, g)
    x = strain - np.einsum("ij,njd->nid", M, stress)
    uniform = np.zeros((6, 6, densities_up_to(degree)))
    uniform[:, :, 0] = np.eye(6) / densities[0].mean() * root[0, 0]
    functions = np.concatenate((x, uniform))
    to_densities = np.linalg.inv(root)
    left, sizes, right = np.linalg.svd(functions.reshape(len(functions), -1), full_matrices=False)
    independent = sizes > _DEPENDENT * sizes[0]
    return InclusionBasis(
        degree=degree,
        degrees=np.asarray(degrees, dtype=np.intp),
        eigenstrain=functions @ to_densities,
        span=right[independent].reshape(-1, *functions.shape[1:]) @ to_densities,
        mix=left[:, independent] * sizes[independent],
        work=2.0 * volume * np.tensordot(stress, functions, axes=((1, 2), (1, 2))),
        overlap=np.tensordot(x, x, axes=((1, 2), (1, 2))),
        volume=volume,
    )
