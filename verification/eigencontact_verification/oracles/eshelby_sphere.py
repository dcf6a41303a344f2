"""Eshelby's inhomogeneous sphere in full space, of any anisotropy: the equivalent eigenstrain in closed form.

A sphere of stiffness C with a prestrain p lies in an isotropic body under a uniform stress at infinity. Its strain is
uniform, ``e = e0 + S e*``, and so is its stress, ``C (e - p) = Cm (e - e*)``: six equations for e*.

Conventions: plain tensors (3, 3) and (3, 3, 3, 3), tension positive.

References
----------
J. D. Eshelby 1957, Proc. R. Soc. A 241, 376; T. Mura 1987, Micromechanics of Defects in Solids, section 22.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eigencontact_verification.oracles.eshelby import apply, sphere_tensor

__all__ = ["cubic_stiffness", "isotropic_stiffness", "sphere_in_body", "turned"]

FloatArray = NDArray[np.float64]

_PAIRS = ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))


def isotropic_stiffness(young: float, nu: float) -> FloatArray:
    """Stiffness (3, 3, 3, 3), nu < 0.5."""
    shear, one = young / (2 * (1 + nu)), np.eye(3)
    lame = 2 * shear * nu / (1 - 2 * nu)
    twin = np.einsum("ik,jl->ijkl", one, one) + np.einsum("il,jk->ijkl", one, one)
    return np.asarray(lame * np.einsum("ij,kl->ijkl", one, one) + shear * twin)


def cubic_stiffness(c11: float, c12: float, c44: float) -> FloatArray:
    """Stiffness (3, 3, 3, 3) in crystal axes: isotropy, and what is left along the axes."""
    young = c44 * (3 * c12 + 2 * c44) / (c12 + c44)
    out = isotropic_stiffness(young, 0.5 * c12 / (c12 + c44))
    for axis in range(3):
        out[axis, axis, axis, axis] += c11 - c12 - 2 * c44
    return out


def turned(stiffness: ArrayLike, rotation: ArrayLike) -> FloatArray:
    """The same turned by a rotation (3, 3), whose columns are then the crystal's axes."""
    R = np.asarray(rotation, dtype=float)
    return np.asarray(np.einsum("ip,jq,kr,ls,pqrs->ijkl", R, R, R, R, np.asarray(stiffness, dtype=float)))


def sphere_in_body(
    stiffness: ArrayLike, young: float, nu: float, stress: ArrayLike, prestrain: ArrayLike | None = None
) -> tuple[FloatArray, FloatArray]:
    """Stress in the sphere and its equivalent eigenstrain, both (3, 3).

    Parameters
    ----------
    stiffness : (3, 3, 3, 3)
        Of the sphere; zero for a void.
    young, nu : float
        Of the body, -1 < nu < 0.5.
    stress : (3, 3)
        At infinity.
    prestrain : (3, 3), optional
        Stress-free strain of the sphere.
    """
    C, body, S = np.asarray(stiffness, dtype=float), isotropic_stiffness(young, nu), sphere_tensor(nu)
    remote = np.asarray(stress, dtype=float)
    far = ((1 + nu) * remote - nu * np.trace(remote) * np.eye(3)) / young
    own = np.zeros((3, 3)) if prestrain is None else np.asarray(prestrain, dtype=float)

    def gap(eigenstrain: FloatArray) -> FloatArray:
        """Stress by the sphere's own law less that of the body with the eigenstrain."""
        strain = far + apply(S, eigenstrain)
        return apply(C, strain - own) - apply(body, strain - eigenstrain)

    start = gap(np.zeros((3, 3)))
    columns = []
    for i, j in _PAIRS:
        unit = np.zeros((3, 3))
        unit[i, j] = unit[j, i] = 1.0
        change = gap(unit) - start
        columns.append([change[pair] for pair in _PAIRS])
    amounts = np.linalg.solve(np.array(columns).T, [-start[pair] for pair in _PAIRS])
    answer = np.zeros((3, 3))
    for amount, (i, j) in zip(amounts, _PAIRS, strict=True):
        answer[i, j] = answer[j, i] = amount
    return apply(body, far + apply(S, answer) - answer), answer
