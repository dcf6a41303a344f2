"""Bonded layers under a traction wave: surface compliance carried from the substrate up, tractions carried down.

Each wavevector splits the problem: displacement along it and along z (in-plane: a pair), and across it (antiplane: one
number). With k the wavenumber and fields times exp(iks), the amplitudes are kept real by

    u_s = i a,   u_z = w,   σ_sz = -i q,   σ_zz = -p,   u_t = v,   σ_tz = -r

so that (p, q) is the traction on what lies below and 2k (w, a) = C (p, q), 2k v = c r there: C is symmetric, positive
definite, in 1/Pa, and finite as k goes to 0 or infinity. For a half-space of shear modulus G, C = A/G with

    A = [[2(1-ν), 1-2ν], [1-2ν, 2(1-ν)]],   c = 2/G.

A wave that decays downwards is at depth z again such a wave, of traction P(kz) (p, q), with
P(d) = exp(-d) [[1+d, d], [-d, 1-d]]; one that decays upwards is its mirror image, where a bar marks the sign change of
the off-diagonal terms. With B = G C of what lies under a layer, d = kh, and R = (Ā + B)⁻¹ (A - B), Q = P̄ R P:

    G C' = (A - Ā Q) (1 + Q)⁻¹,    (p, q) below = 4(1-ν) (Ā + B)⁻¹ P (1 + Q)⁻¹ (p, q) above.

Ā + B is a sum of positive definite matrices, and nothing grows. Where d < 1 the matrix 1 + Q of a stiff layer on a soft
one is a small difference; there the transfer matrix exp(-N d) of the state (w, a, p, q), no larger than e, is used. As
(N² - 1)² = 0 it is, exactly, with M = N² - 1,

    exp(-N d) = cosh d - N sinh d + M (d sinh d)/2 - N M (d cosh d - sinh d)/2,

and the last function, which holds the bending of a thin plate, is summed as a series: it starts with d³/3.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import factorial

import numpy as np
from numpy.typing import NDArray

from eigencontact.plugin import Material

__all__ = ["Slab", "State", "state_at_depth"]

FloatArray = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

# Below this k h a layer is passed with its transfer matrix, above it with decaying waves.
THIN = 1.0
# d cosh d - sinh d = d³ Σ c_n d^(2n), to double precision up to d = 1.
BENDING = [2 * n / factorial(2 * n + 1) for n in range(1, 10)]


@dataclass(frozen=True, slots=True)
class Slab:
    """A layer, or the part of one over or under the depth that is asked for: thickness [m] and material."""

    thickness: float
    material: Material


@dataclass(frozen=True, slots=True)
class State:
    """Displacement times 2k [1/Pa] and traction [-] at a depth, per unit traction on the surface.

    `pair` and `pair_traction` are (w, a) and (p, q), ``(2, ...)``; `across` and `across_traction` are v and r.
    """

    k: FloatArray
    pair: ComplexArray
    pair_traction: ComplexArray
    across: FloatArray
    across_traction: FloatArray

    def displacement(self) -> dict[str, ComplexArray]:
        """Displacement [m/Pa] along the wavevector (s), across it (t) and z."""
        scale = 0.5 / self.k
        return {"s": 1j * self.pair[1] * scale, "t": self.across * scale + 0j, "z": self.pair[0] * scale}

    def stress(self, material: Material) -> dict[str, ComplexArray]:
        """Plain stress components [-] on the side where `material` is; ν = 1/2 needs no limit."""
        G, nu = material.shear_modulus, material.poisson_ratio
        p, q = self.pair_traction
        along = -(nu * p + G * self.pair[1]) / (1 - nu)
        return {
            "ss": along, "tt": nu * (along - p), "zz": -p,
            "sz": -1j * q, "tz": -self.across_traction + 0j, "st": 0.5j * G * self.across,
        }  # fmt: skip


def state_at_depth(
    k: FloatArray,
    above: Sequence[Slab],
    below: Sequence[Slab],
    substrate: Material,
    load: tuple[FloatArray, FloatArray, FloatArray],
) -> State:
    """State at the interface between the slabs `above` and those `below`, both from the surface down.

    Parameters
    ----------
    k : (...) float64
        Wavenumbers [rad/m], positive.
    above, below : sequences of Slab
        `substrate` is the half-space under the last of them.
    load : three (...) float64
        Traction on the surface along z, along the wavevector, across it.
    """
    # The recursion knows k alone: on the lattice of an FFT most wavevectors share theirs with seven others.
    distinct, place = np.unique(k, return_inverse=True)
    place = place.reshape(k.shape)
    pair, across = _compliance(distinct, below, substrate)
    pair_over, across_over = pair, across
    step, step_across = np.broadcast_to(np.eye(2), pair.shape), np.ones_like(across)
    for slab in reversed(above):
        d = distinct * slab.thickness
        pair_over, through = _pass_pair(d, slab.material, pair_over)
        across_over, through_across = _pass_across(d, slab.material, across_over)
        step, step_across = step @ through, step_across * through_across
    onto = pair @ step
    # A traction t_s along the wavevector is i q, see the module.
    surface = (load[0], -1j * load[1])

    def applied(matrix: FloatArray) -> ComplexArray:
        return np.array([matrix[place, row, 0] * surface[0] + matrix[place, row, 1] * surface[1] for row in range(2)])

    return State(
        k=k,
        pair=applied(onto),
        pair_traction=applied(step),
        across=(across * step_across)[place] * load[2],
        across_traction=step_across[place] * load[2],
    )


def _compliance(k: FloatArray, slabs: Sequence[Slab], substrate: Material) -> tuple[FloatArray, FloatArray]:
    """Compliances C ``(n, 2, 2)`` and c ``(n,)`` [1/Pa] of slabs on the substrate at wavenumbers ``(n,)``."""
    G = substrate.shear_modulus
    pair = np.broadcast_to(_half_space(substrate) / G, (k.size, 2, 2))
    across = np.full(k.size, 2.0 / G)
    for slab in reversed(slabs):
        pair, _ = _pass_pair(k * slab.thickness, slab.material, pair)
        across, _ = _pass_across(k * slab.thickness, slab.material, across)
    return pair, across


def _half_space(material: Material) -> FloatArray:
    """Matrix A of the module, (2, 2)."""
    nu = material.poisson_ratio
    return np.array([[2 * (1 - nu), 1 - 2 * nu], [1 - 2 * nu, 2 * (1 - nu)]])


def _pass_pair(d: FloatArray, material: Material, pair: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Compliance over a layer from that under it, and the matrix of tractions, over to under, ``(n, 2, 2)`` each."""
    G = material.shear_modulus
    B = G * pair
    over, down = np.empty_like(B), np.empty_like(B)
    thin = d < THIN
    for chosen, formula in ((thin, _thin), (~thin, _thick)):
        if chosen.any():
            over[chosen], down[chosen] = formula(d[chosen], material, B[chosen])
    return over / G, down


def _thin(d: FloatArray, material: Material, B: FloatArray) -> tuple[FloatArray, FloatArray]:
    nu = material.poisson_ratio
    ratio = nu / (1 - nu)
    N = np.array([[0, ratio, -(1 - 2 * nu) / (1 - nu), 0], [-1, 0, 0, -2], [0, 0, 0, 1], [0, -1 / (1 - nu), -ratio, 0]])
    M = N @ N - np.eye(4)
    sinh = np.sinh(d)
    bending = d**3 * np.polynomial.polynomial.polyval(d * d, BENDING)

    def term(values: FloatArray, matrix: FloatArray) -> FloatArray:
        return values[:, None, None] * matrix

    T = term(np.cosh(d), np.eye(4)) - term(sinh, N) + term(0.5 * d * sinh, M) - term(0.5 * bending, N @ M)
    down = _inverse(T[:, 2:, :2] @ B + T[:, 2:, 2:])
    return (T[:, :2, :2] @ B + T[:, :2, 2:]) @ down, down


def _thick(d: FloatArray, material: Material, B: FloatArray) -> tuple[FloatArray, FloatArray]:
    nu = material.poisson_ratio
    A = _half_space(material)
    decay, drop = np.exp(-d), d * np.exp(-d)
    P = np.moveaxis(np.array([[decay + drop, drop], [-drop, decay - drop]]), -1, 0)
    inner = _inverse(_mirrored(A) + B)
    Q = _mirrored(P) @ inner @ (A - B) @ P
    total = _inverse(np.eye(2) + Q)
    return (A - _mirrored(A) @ Q) @ total, 4 * (1 - nu) * inner @ P @ total


def _mirrored(matrix: FloatArray) -> FloatArray:
    """Change the sign of the terms off the diagonal: the same relation for waves that decay upwards."""
    return np.asarray(matrix * np.array([[1.0, -1.0], [-1.0, 1.0]]))


def _inverse(matrix: FloatArray) -> FloatArray:
    """Inverse of 2x2 matrices by cofactors."""
    out = np.empty_like(matrix)
    out[:, 0, 0], out[:, 1, 1] = matrix[:, 1, 1], matrix[:, 0, 0]
    out[:, 0, 1], out[:, 1, 0] = -matrix[:, 0, 1], -matrix[:, 1, 0]
    determinant = matrix[:, 0, 0] * matrix[:, 1, 1] - matrix[:, 0, 1] * matrix[:, 1, 0]
    out /= determinant[:, None, None]
    return out


def _pass_across(d: FloatArray, material: Material, across: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Antiplane compliance over a layer from that under it, and the factor of the traction, over to under."""
    G = material.shear_modulus
    b = 0.5 * G * across
    tanh = np.tanh(d)
    below = 2 * np.exp(-d) / ((1 + np.exp(-2 * d)) - b * np.expm1(-2 * d))
    return 2 / G * (b + tanh) / (1 + b * tanh), below
