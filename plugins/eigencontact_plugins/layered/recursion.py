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

Inside a layer, d₁ below its top and d₂ above its underside (times k), the field is that of two waves,

    (p, q) = P(d₁) f + P̄(d₂) g,    G (w, a) = A P(d₁) f - Ā P̄(d₂) g,    f = (1 + Q)⁻¹ (p, q) above,  g = R P f,

or, where d < 1, the state on its underside times exp(-N d₂). Both amplitudes belong to the wave: all depths share them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import factorial

import numpy as np
from numpy.typing import NDArray

from eigencontact.plugin import Material

__all__ = ["Slab", "State", "Waves"]

FloatArray = NDArray[np.float64]

# Below this k h a layer is passed with its transfer matrix, above it with decaying waves.
THIN = 1.0
# d cosh d - sinh d = d³ Σ c_n d^(2n), to double precision up to d = 1.
BENDING = [2 * n / factorial(2 * n + 1) for n in range(1, 10)]


@dataclass(frozen=True, slots=True)
class Slab:
    """A layer: thickness [m] and material."""

    thickness: float
    material: Material


@dataclass(frozen=True, slots=True)
class State:
    """Displacement times 2k [1/Pa] and traction [-] at some depths, per unit traction on the surface.

    `pair` and `pair_traction` are (w, a) and (p, q), ``(2, nz, n)``; `across` and `across_traction` are v and r.
    """

    k: FloatArray
    pair: FloatArray
    pair_traction: FloatArray
    across: FloatArray
    across_traction: FloatArray

    def displacement(self, phase: complex) -> dict[str, NDArray[np.complex128]]:
        """Displacement [m/Pa] along the wavevector (s), across it (t) and z; `phase` multiplies w, a, p and q."""
        scale = 0.5 / self.k
        return {
            "s": (1j * phase) * (self.pair[1] * scale), "t": self.across * scale + 0j,
            "z": phase * (self.pair[0] * scale),
        }  # fmt: skip

    def stress(self, phase: complex, material: Material) -> dict[str, NDArray[np.complex128]]:
        """Plain stress components [-] on the side where `material` is; ν = 1/2 needs no limit."""
        G, nu = material.shear_modulus, material.poisson_ratio
        p, q = self.pair_traction
        along = -(nu * p + G * self.pair[1]) / (1 - nu)
        return {
            "ss": phase * along, "tt": phase * (nu * (along - p)), "zz": -phase * p,
            "sz": (-1j * phase) * q, "tz": -self.across_traction + 0j, "st": 0.5j * G * self.across,
        }  # fmt: skip


class Waves:
    """Waves in slabs on a substrate under a unit traction: what depends on the wave alone, and the state at any depth.

    Parameters
    ----------
    k : (n,) float64
        Wavenumbers [rad/m], positive.
    slabs : sequence of Slab
        From the surface down.
    substrate : Material
        The half-space under the last of them.
    load : "p" or "q"
        Traction on the surface that (w, a, p, q) answer to; v and r answer to r = 1 there.
    """

    def __init__(self, k: FloatArray, slabs: Sequence[Slab], substrate: Material, load: str) -> None:
        self.k, self.slabs, self.substrate = k, slabs, substrate
        pair = np.broadcast_to(_half_space(substrate) / substrate.shear_modulus, (k.size, 2, 2))
        across = np.full(k.size, 2.0 / substrate.shear_modulus)
        # Compliances under each slab and at last on the surface, from the substrate up; matrices through each slab.
        self._compliances = [(pair, across)]
        through: list[tuple[FloatArray, FloatArray]] = []
        for slab in reversed(slabs):
            pair, down = _pass_pair(k * slab.thickness, slab.material, pair)
            across, down_across = _pass_across(k * slab.thickness, slab.material, across)
            self._compliances.insert(0, (pair, across))
            through.insert(0, (down, down_across))
        traction = np.zeros((k.size, 2))
        traction[:, 0 if load == "p" else 1] = 1.0
        self._tractions = [(traction, np.ones(k.size))]
        for down, down_across in through:
            traction, shear = self._tractions[-1]
            self._tractions.append((_applied(down, traction), down_across * shear))

    def on_interface(self, number: int) -> State:
        """State on the surface (0) or on the underside of so many slabs."""
        (pair, across), (traction, shear) = self._compliances[number], self._tractions[number]
        moved = _applied(pair, traction)
        return State(self.k, moved.T[:, None], traction.T[:, None], (across * shear)[None], shear[None])

    def inside(self, number: int, depths: FloatArray) -> State:
        """State at depths ``(nz,)`` [m] below the top of slab `number`, or of the substrate after the last."""
        d = depths[:, None] * self.k
        traction, shear = self._tractions[number]
        if number == len(self.slabs):
            G, decay = self.substrate.shear_modulus, np.exp(-d)
            p, q = _decayed(d, decay, traction)
            moved = np.array(_times(_half_space(self.substrate) / G, p, q))
            return State(self.k, moved, np.array([p, q]), 2.0 / G * shear * decay, shear * decay)
        slab, (below, below_across) = self.slabs[number], self._compliances[number + 1]
        whole, G = self.k * slab.thickness, slab.material.shear_modulus
        up = np.maximum(whole - d, 0.0)
        states = np.empty((4, *d.shape))
        thin = whole < THIN
        if thin.any():
            under = self._tractions[number + 1][0][thin]
            state = np.concatenate([G * _applied(below[thin], under), under], axis=1)
            states[:, :, thin] = _transferred(up[:, thin], slab.material, state)
        if not thin.all():
            thick = ~thin
            states[:, :, thick] = _two_waves(
                (d[:, thick], up[:, thick], whole[thick]), slab.material, G * below[thick], traction[thick]
            )
        states[:2] /= G
        b, cosh, sinh = 0.5 * G * below_across, 1 + np.exp(-2 * up), -np.expm1(-2 * up)
        factor = shear * np.exp(-d) / (1 + np.exp(-2 * whole) - b * np.expm1(-2 * whole))
        return State(self.k, states[:2], states[2:], 2.0 / G * factor * (b * cosh + sinh), factor * (cosh + b * sinh))


def _applied(matrices: FloatArray, vectors: FloatArray) -> FloatArray:
    """Products of 2x2 matrices ``(n, 2, 2)`` with vectors ``(n, 2)``."""
    return np.asarray(np.einsum("nij,nj->ni", matrices, vectors))


def _times(matrix: FloatArray, p: FloatArray, q: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Product of one 2x2 matrix with the vectors (p, q)."""
    return matrix[0, 0] * p + matrix[0, 1] * q, matrix[1, 0] * p + matrix[1, 1] * q


def _decayed(d: FloatArray, decay: FloatArray, traction: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Traction P(d) (p, q) of waves ``(n, 2)`` that decay downwards."""
    p, q = traction.T
    drop = d * decay
    return (decay + drop) * p + drop * q, (decay - drop) * q - drop * p


def _two_waves(
    distances: tuple[FloatArray, FloatArray, FloatArray], material: Material, B: FloatArray, traction: FloatArray
) -> FloatArray:
    """State (G w, G a, p, q) ``(4, nz, n)`` inside a thick layer from the traction above, see the module."""
    d, up, whole = distances
    A = _half_space(material)
    P, R, Q = _reflection(whole, material, B)
    down_wave = _applied(_inverse(np.eye(2) + Q), traction)
    up_wave = _applied(R, _applied(P, down_wave))
    p, q = _decayed(d, np.exp(-d), down_wave)
    # A wave that decays upwards is the mirror image: P with bars is P with the sign of q changed before and after.
    mirrored_p, mirrored_q = _decayed(up, np.exp(-up), up_wave * (1.0, -1.0))
    w, a = _times(A, p, q)
    mirrored_w, mirrored_a = _times(A, mirrored_p, mirrored_q)
    return np.array([w - mirrored_w, a + mirrored_a, p + mirrored_p, q - mirrored_q])


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


def _transfer(d: FloatArray, material: Material) -> list[tuple[FloatArray, FloatArray]]:
    """Transfer matrix exp(-N d) upwards, as factors of the shape of d and the (4, 4) matrices that they multiply."""
    nu = material.poisson_ratio
    ratio = nu / (1 - nu)
    N = np.array([[0, ratio, -(1 - 2 * nu) / (1 - nu), 0], [-1, 0, 0, -2], [0, 0, 0, 1], [0, -1 / (1 - nu), -ratio, 0]])
    M = N @ N - np.eye(4)
    sinh = np.sinh(d)
    bending = d**3 * np.polynomial.polynomial.polyval(d * d, BENDING)
    return [(np.cosh(d), np.eye(4)), (-sinh, N), (0.5 * d * sinh, M), (-0.5 * bending, N @ M)]


def _transferred(d: FloatArray, material: Material, state: FloatArray) -> FloatArray:
    """State (G w, G a, p, q) ``(4, nz, n)`` at heights d ``(nz, n)`` over the underside, from that there ``(n, 4)``."""
    out = np.zeros((4, *d.shape))
    for factor, matrix in _transfer(d, material):
        out += factor * (state @ matrix.T).T[:, None]
    return out


def _thin(d: FloatArray, material: Material, B: FloatArray) -> tuple[FloatArray, FloatArray]:
    T = np.add.reduce([factor[:, None, None] * matrix for factor, matrix in _transfer(d, material)])
    down = _inverse(T[:, 2:, :2] @ B + T[:, 2:, 2:])
    return (T[:, :2, :2] @ B + T[:, :2, 2:]) @ down, down


def _thick(d: FloatArray, material: Material, B: FloatArray) -> tuple[FloatArray, FloatArray]:
    A = _half_space(material)
    P, _, Q = _reflection(d, material, B)
    total = _inverse(np.eye(2) + Q)
    inner = _inverse(_mirrored(A) + B)
    return (A - _mirrored(A) @ Q) @ total, 4 * (1 - material.poisson_ratio) * inner @ P @ total


def _reflection(d: FloatArray, material: Material, B: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Matrices P, R and Q of the module, ``(n, 2, 2)``."""
    A = _half_space(material)
    decay, drop = np.exp(-d), d * np.exp(-d)
    P = np.moveaxis(np.array([[decay + drop, drop], [-drop, decay - drop]]), -1, 0)
    R = _inverse(_mirrored(A) + B) @ (A - B)
    return P, R, _mirrored(P) @ R @ P


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
