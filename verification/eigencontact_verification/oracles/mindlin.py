"""Displacement of a point force inside a half-space, component by component, and what follows for eigenstrain.

A unit force acts at depth c >= 0 in the body z >= 0 with a free surface z = 0, or in full space. The components are
those of R. D. Mindlin 1936, Physics 7, 195, in the notation (R1, R2, c, z) of his paper; Kelvin's solution is their
part in R1. With mu the shear modulus the module handles the *numerator*

    N_ij = 16 pi mu (1 - nu) G_ij           displacement i, force j

which is a polynomial of degree two in nu. Everything about eigenstrain follows from it by division of polynomials, so
that nothing here depends on potentials, on a closed form of the strain, or on nu being away from 1/2:

* Eigenstrain e in a region acts like the forces ``p_jk n_k`` on its boundary, ``p = lambda tr(e) I + 2 mu e``. With
  ``T_ijk(nu)`` the integral of ``N_ij n_k`` over the boundary,
  ``16 pi (1 - nu) u_i = 2 e_jk T_ijk(nu) + 2 nu tr(e) T_ijj(nu) / (1 - 2 nu)``.
* ``T_ijj`` is a polynomial of degree two that vanishes at nu = 1/2 (a centre of dilatation does nothing to an
  incompressible body), hence ``T_ijj(nu) / (1 - 2 nu) = (1 - nu) T_ijj(0) - nu T_ijj(1)`` exactly, nu = 1/2 included.
* The dilatation beyond the eigenstrain, ``16 pi (1 - nu) (u_k,k - tr(e) inside)``, is another polynomial of degree two
  that vanishes at nu = 1/2; divided in the same way it is the mean stress.

Conventions: z into the body, tension positive, plain tensor components, indices in the order x, y, z.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["NODES", "dilatation_defect", "displacement", "green", "image", "kelvin", "strain", "stress"]

FloatArray = NDArray[np.float64]

#: Values of nu that moments are taken at; a polynomial of degree two is known from them.
NODES = (0.0, 0.5, 1.0)


def kelvin(x: Any, y: Any, z: Any, nu: Any) -> NDArray[Any]:
    """Numerator of Kelvin's solution for the offset (x, y, z) = field - source: ``(3, 3, ...)`` [1/m].

    Real or complex offsets (complex steps); nu broadcasts against them.
    """
    R = np.sqrt(x * x + y * y + z * z)
    offset = (x, y, z)
    cube = R * R * R
    diagonal = (3 - 4 * nu) / R
    out = np.empty((3, 3, *np.shape(diagonal)), dtype=np.result_type(diagonal, 1.0))
    for i in range(3):
        for j in range(i + 1):
            out[i, j] = out[j, i] = offset[i] * offset[j] / cube
        out[i, i] += diagonal
    return out


def image(X: Any, Y: Any, Z: Any, z: Any, nu: Any) -> NDArray[Any]:
    """Mindlin's numerator without Kelvin's part: ``(3, 3, ...)`` [1/m], the terms in R2.

    Parameters
    ----------
    X, Y : array_like
        Field minus source in the plane [m].
    Z : array_like
        Depth of the field point plus depth c of the force [m], >= 0 (not all of X, Y, Z zero).
    z : array_like
        Depth of the field point [m], 0 <= z <= Z.
    nu : array_like
        Poisson's ratio.
    """
    R = np.sqrt(X * X + Y * Y + Z * Z)
    c = Z - z
    below = z - c
    n = 4 * (1 - nu) * (1 - 2 * nu)
    k = 3 - 4 * nu
    S = R + Z
    R3 = R * R * R
    R5 = R3 * R * R
    cross = X * Y * (k / R3 - 6 * c * z / R5 - n / (R * S * S))
    # a horizontal force moves a point down by (with + n); a vertical force moves it outward by (with - n)
    down = k * below / R3 - 6 * c * z * Z / R5 + n / (R * S)
    out = k * below / R3 + 6 * c * z * Z / R5 - n / (R * S)

    def along(a: Any) -> Any:
        bend = 2 * c * z / R3 * (1 - 3 * a * a / (R * R)) + n / S * (1 - a * a / (R * S))
        return 1 / R + k * a * a / R3 + bend

    deep = (8 * (1 - nu) ** 2 - k) / R + (k * Z * Z - 2 * c * z) / R3 + 6 * c * z * Z * Z / R5
    return np.array([[along(X), cross, X * out], [cross, along(Y), Y * out], [X * down, Y * down, deep]])


def green(field: ArrayLike, source: ArrayLike, nu: float, space: str = "half") -> NDArray[Any]:
    """Displacement ``(3, 3)`` [m/N] times the shear modulus [Pa] at `field` by unit forces at `source`, points in m."""
    x, s = np.asarray(field), np.asarray(source)
    total = kelvin(x[0] - s[0], x[1] - s[1], x[2] - s[2], nu)
    if space == "half":
        total = total + image(x[0] - s[0], x[1] - s[1], x[2] + s[2], x[2], nu)
    return np.asarray(total / (16 * np.pi * (1 - nu)))


def _at(moments: FloatArray, nu: float) -> FloatArray:
    """Polynomial of degree two through the values at NODES, which are the first axis."""
    weights = ((1 - nu) * (1 - 2 * nu), 4 * nu * (1 - nu), nu * (2 * nu - 1))
    return np.asarray(np.tensordot(weights, moments, axes=1))


def _divided(values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """``P / (1 - 2 nu)`` of polynomials P with P(1/2) = 0, as its values at nu = 0 and 1."""
    return values[0], -values[2]


def _combine(moments: FloatArray, eigenstrain: FloatArray, nu: float) -> FloatArray:
    """``16 pi (1 - nu)`` times the field that the moments of N_ij n_k, ``(3, ..., j, k)``, give."""
    low, high = _divided(np.einsum("...jj->...", moments))
    pressure = (1 - nu) * low + nu * high
    return np.asarray(
        2 * np.einsum("...jk,jk->...", _at(moments, nu), eigenstrain) + 2 * nu * np.trace(eigenstrain) * pressure
    )


def displacement(moments: FloatArray, eigenstrain: ArrayLike, nu: float) -> FloatArray:
    """Displacement [m] from the boundary integrals of N_ij n_k.

    Parameters
    ----------
    moments : (3, n, 3, 3, 3) array
        At the NODES of nu, for n points: indices i, j, k [m].
    eigenstrain : (3, 3) array_like
        Tensor components.
    nu : float
        Poisson's ratio, 0 to 0.5 inclusive.

    Returns
    -------
    (n, 3) array
    """
    return _combine(moments, np.asarray(eigenstrain, dtype=float), nu) / (16 * np.pi * (1 - nu))


def strain(gradients: FloatArray, eigenstrain: ArrayLike, nu: float) -> FloatArray:
    """Total strain ``(n, 3, 3)`` from the integrals of dN_ij/dx_l n_k, ``(3, n, i, l, j, k)``."""
    slope = _combine(gradients, np.asarray(eigenstrain, dtype=float), nu) / (16 * np.pi * (1 - nu))
    return np.asarray((slope + np.swapaxes(slope, -1, -2)) / 2)


def dilatation_defect(
    gradients: FloatArray, eigenstrain: ArrayLike, nu: float, inside: ArrayLike
) -> tuple[FloatArray, float]:
    """``(e_kk - inside tr e*) / (1 - 2 nu)`` ``(n,)``, and how far the polynomial is from zero at nu = 1/2.

    `inside` is 1 inside, 0 outside, 1/2 on a face.
    """
    e = np.asarray(eigenstrain, dtype=float)
    trace, share = np.trace(e), np.asarray(inside, dtype=float)
    values = [np.einsum("nii->n", _combine(gradients, e, v)) - 16 * np.pi * (1 - v) * trace * share for v in NODES]
    low, high = _divided(np.array(values))
    return ((1 - nu) * low + nu * high) / (16 * np.pi * (1 - nu)), float(np.abs(values[1]).max())


def stress(
    gradients: FloatArray, eigenstrain: ArrayLike, nu: float, inside: ArrayLike, shear_modulus: float = 1.0
) -> FloatArray:
    """Stress ``(n, 3, 3)`` [Pa], from the same integrals; nu up to and including 1/2."""
    e = np.asarray(eigenstrain, dtype=float)
    share = np.asarray(inside, dtype=float)[:, None, None]
    defect, _ = dilatation_defect(gradients, e, nu, inside)
    elastic = strain(gradients, e, nu) - share * e + nu * defect[:, None, None] * np.eye(3)
    return np.asarray(2 * shear_modulus * elastic)
