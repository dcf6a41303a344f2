"""Eshelby's inhomogeneous sphere in full space, of any anisotropy: the equivalent eigenstrain in closed form.

A sphere of stiffness C with a prestrain p lies in an isotropic body under a uniform stress at infinity. Its strain is
uniform, ``e = e0 + S e*``, and so is its stress, ``C (e - p) = Cm (e - e*)``: six equations for e*.

Conventions: plain tensors (3, 3) and (3, 3, 3, 3), tension positive.

References
----------
J. D. Eshelby 1957, Proc. R. Soc. A 241, 376; T. Mura 1987, Micromechanics of Defects in Solids, section 22;
J. W. Ju and L. Z. Sun 1999, J. Appl. Mech. 66, 570 (the tensor outside a sphere).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eigencontact_verification.oracles.eshelby import apply, sphere_tensor

__all__ = ["cubic_stiffness", "isotropic_stiffness", "sphere_in_body", "stress_about_sphere", "turned"]

FloatArray = NDArray[np.float64]

_PAIRS = ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))


def isotropic_stiffness(young: float, nu: float) -> FloatArray:
    """Stiffness (3, 3, 3, 3), nu < 0.5."""
    shear, identity = young / (2 * (1 + nu)), np.eye(3)
    lame = 2 * shear * nu / (1 - 2 * nu)
    twin = np.einsum("ik,jl->ijkl", identity, identity) + np.einsum("il,jk->ijkl", identity, identity)
    return np.asarray(lame * np.einsum("ij,kl->ijkl", identity, identity) + shear * twin)


def cubic_stiffness(c11: float, c12: float, c44: float) -> FloatArray:
    """Stiffness (3, 3, 3, 3) in crystal axes: isotropy, and what is left along the axes."""
    young = c44 * (3 * c12 + 2 * c44) / (c12 + c44)
    out = isotropic_stiffness(young, 0.5 * c12 / (c12 + c44))
    for axis in range(3):
        out[axis, axis, axis, axis] += c11 - c12 - 2 * c44
    return out


def turned(stiffness: ArrayLike, rotation: ArrayLike) -> FloatArray:
    """Stiffness turned by a rotation (3, 3), whose columns are then the crystal's axes."""
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
    initial = np.zeros((3, 3)) if prestrain is None else np.asarray(prestrain, dtype=float)

    def gap(eigenstrain: FloatArray) -> FloatArray:
        """Stress by the sphere's own law less that of the body with the eigenstrain."""
        strain = far + apply(S, eigenstrain)
        return apply(C, strain - initial) - apply(body, strain - eigenstrain)

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


def stress_about_sphere(eigenstrain: ArrayLike, young: float, nu: float, points: ArrayLike) -> FloatArray:
    """Stress ``(3, 3, n)`` outside a sphere of radius 1 about the origin by its uniform eigenstrain, without a load.

    Parameters
    ----------
    eigenstrain : (3, 3)
        Equivalent eigenstrain of the sphere.
    young, nu : float
        Of the body, -1 < nu < 0.5.
    points : (n, 3)
        Outside, or on the sphere: there the outer limit.
    """
    x, identity = np.asarray(points, dtype=float).T, np.eye(3)
    distance = np.linalg.norm(x, axis=0)
    n, s = x / distance, distance**-2.0
    pairs = np.einsum("ik,jl->ijkl", identity, identity) + np.einsum("il,jk->ijkl", identity, identity)
    mixed = np.einsum("ik,jn,ln->ijkln", identity, n, n)
    mixed = mixed + mixed.swapaxes(0, 1)
    mixed = mixed + mixed.swapaxes(2, 3)
    tensor = (
        np.einsum("n,ij,kl->ijkln", 3 * s + 10 * nu - 5, identity, identity)
        + np.einsum("n,ijkl->ijkln", 3 * s - 10 * nu + 5, pairs)
        + 15 * np.einsum("n,ij,kn,ln->ijkln", 1 - s, identity, n, n)
        + 15 * np.einsum("n,kl,in,jn->ijkln", 1 - 2 * nu - s, identity, n, n)
        + 15 * (nu - s) * mixed
        + 15 * np.einsum("n,in,jn,kn,ln->ijkln", 7 * s - 5, n, n, n, n)
    )
    tensor = tensor * distance**-3.0 / (30 * (1 - nu))
    strain = np.einsum("ijkln,kl->ijn", tensor, np.asarray(eigenstrain, dtype=float))
    return np.asarray(np.einsum("ijkl,kln->ijn", isotropic_stiffness(young, nu), strain))
