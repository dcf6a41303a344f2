"""Bonded layers under a traction wave: surface compliance carried from the substrate up, tractions carried down.

Each wavevector splits the problem: displacement along it and along z (in-plane: a pair), and across it (antiplane: one
number). With the wavenumber k and fields times exp(iks), the amplitudes are real for

    u_s = i a,   u_z = w,   σ_sz = -i q,   σ_zz = -p,   u_t = v,   σ_tz = -r

so that (p, q) is the traction on the part below and 2k (w, a) = C (p, q), 2k v = c r there. C is symmetric, positive
definite, in 1/Pa, and finite as k goes to 0 or infinity. For a half-space of shear modulus G, C = A/G with

    A = [[2(1-ν), 1-2ν], [1-2ν, 2(1-ν)]],   c = 2/G.

A wave that decays downwards is at depth z again such a wave, of traction P(kz) (p, q), with P(d) = exp(-d) [[1+d, d],
[-d, 1-d]]. A wave that decays upwards is its mirror image; a bar marks the change of sign of the off-diagonal terms.
With B = G C of the part below a layer, d = kh, and R = (Ā + B)⁻¹ (A - B), Q = P̄ R P:

    G C' = (A - Ā Q) (1 + Q)⁻¹,    (p, q) below = 4(1-ν) (Ā + B)⁻¹ P (1 + Q)⁻¹ (p, q) above.

Ā + B is a sum of positive definite matrices, and nothing grows. For d < 1 the matrix 1 + Q of a stiff layer on a soft
one is a small difference. The program then uses the transfer matrix exp(-N d) of the state (w, a, p, q), which is at
most e. Because (N² - 1)² = 0, it is exactly, with M = N² - 1,

    exp(-N d) = cosh d - N sinh d + M (d sinh d)/2 - N M (d cosh d - sinh d)/2,

and the last function, which determines the bending of a thin plate, is summed as a series that starts with d³/3.

Inside a layer, d₁ below its top and d₂ above its lower face (times k), the field is that of two waves,

    (p, q) = P(d₁) f + P̄(d₂) g,    G (w, a) = A P(d₁) f - Ā P̄(d₂) g,    f = (1 + Q)⁻¹ (p, q) above,  g = R P f,

or, for d < 1, the state on its lower face times exp(-N d₂). Both amplitudes belong to the wave; all depths share them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import factorial

import numpy as np

from eigencontact.plugin import FloatArray, Material

__all__ = ["Slab", "State", "Waves"]


IDENTITY = np.eye(2)[..., None]
# Below this k h a layer uses its transfer matrix, above it decaying waves.
THIN = 1.0
# d cosh d - sinh d = d³ Σ c_n d^(2n), to double precision up to d = 1.
BENDING = [2 * n / factorial(2 * n + 1) for n in range(1, 10)]


@dataclass(frozen=True, slots=True)
class Slab:
    """Layer: thickness [m] and material."""

    thickness: float
    material: Material


@dataclass(frozen=True, slots=True)
class State:
    """Displacement times 2k [1/Pa] and traction [-] at some depths, per unit (p, q) or r on the surface.

    `pair` and `pair_traction` are (w, a) and (p, q), ``(2, nz, n)``; `across` and `across_traction` are v and r. The
    fields are returned without their phases. A traction t along the wavevector is q = -i t. Under a pressure,
    components with one index along the surface are therefore these numbers times i; under a shear, those with no such
    index or two are times -i.
    """

    k: FloatArray
    pair: FloatArray
    pair_traction: FloatArray
    across: FloatArray
    across_traction: FloatArray

    def displacement(self) -> dict[str, FloatArray]:
        """Displacement [m/Pa] along the wavevector (s), across it (t) and z."""
        scale = 0.5 / self.k
        return {"s": self.pair[1] * scale, "t": self.across * scale, "z": self.pair[0] * scale}

    def stress(self, material: Material) -> dict[str, FloatArray]:
        """Plain stress components [-] on the side of `material`; ν = 1/2 needs no limit."""
        G, nu = material.shear_modulus, material.poisson_ratio
        p, q = self.pair_traction
        along = -(nu * p + G * self.pair[1]) / (1 - nu)
        return {
            "ss": along, "tt": nu * (along - p), "zz": -p,
            "sz": -q, "tz": -self.across_traction, "st": -0.5 * G * self.across,
        }  # fmt: skip


class Waves:
    """Waves in layers on a substrate under a unit traction: wave-dependent data, and the state at any depth.

    Parameters
    ----------
    k : (n,) float64
        Wavenumbers [rad/m], positive.
    slabs : sequence of Slab
        Layers from the surface down.
    substrate : Material
        Half-space below the last layer.
    load : "p" or "q"
        Traction on the surface for (w, a, p, q); the traction for v and r is r = 1.
    """

    def __init__(self, k: FloatArray, slabs: Sequence[Slab], substrate: Material, load: str) -> None:
        self.k, self.slabs, self.substrate = k, slabs, substrate
        pair = np.broadcast_to(_half_space(substrate) / substrate.shear_modulus, (2, 2, k.size))
        across = np.full(k.size, 2.0 / substrate.shear_modulus)
        # Compliances below each slab and finally on the surface, from the substrate up; matrices through each slab.
        self._compliances = [(pair, across)]
        through: list[tuple[FloatArray, FloatArray]] = []
        for slab in reversed(slabs):
            pair, down = _pass_pair(k * slab.thickness, slab.material, pair)
            across, down_across = _pass_across(k * slab.thickness, slab.material, across)
            self._compliances.insert(0, (pair, across))
            through.insert(0, (down, down_across))
        traction = np.zeros((2, k.size))
        traction[0 if load == "p" else 1] = 1.0
        self._tractions = [(traction, np.ones(k.size))]
        for down, down_across in through:
            traction, shear = self._tractions[-1]
            self._tractions.append((_product(down, traction), down_across * shear))

    def on_interface(self, number: int) -> State:
        """State on the surface (0), or on the lower face of slab `number`."""
        (pair, across), (traction, shear) = self._compliances[number], self._tractions[number]
        moved = _product(pair, traction)
        return State(self.k, moved[:, None], traction[:, None], (across * shear)[None], shear[None])

    def inside(self, number: int, depths: FloatArray) -> State:
        """State at depths ``(nz,)`` [m] below the top of slab `number`, or of the substrate after the last slab."""
        d = depths[:, None] * self.k
        traction, shear = self._tractions[number]
        if number == len(self.slabs):
            G, decay = self.substrate.shear_modulus, np.exp(-d)
            below = _decayed(d, traction)
            return State(
                self.k, _product(_half_space(self.substrate) / G, below), below, 2.0 / G * shear * decay, shear * decay
            )
        slab, (pair, across) = self.slabs[number], self._compliances[number + 1]
        thickness, G = self.k * slab.thickness, slab.material.shear_modulus
        up = np.maximum(thickness - d, 0.0)
        state = np.empty((4, *d.shape))
        thin = thickness < THIN
        if thin.any():
            under = self._tractions[number + 1][0][:, thin]
            tractions = np.concatenate([G * _product(pair[..., thin], under), under])
            state[..., thin] = _transferred(up[:, thin], slab.material, tractions)
        if not thin.all():
            thick = ~thin
            distances = (d[:, thick], up[:, thick], thickness[thick])
            state[..., thick] = _two_waves(distances, slab.material, G * pair[..., thick], traction[:, thick])
        state[:2] /= G
        b, cosh, sinh = 0.5 * G * across, 1 + np.exp(-2 * up), -np.expm1(-2 * up)
        factor = shear * np.exp(-d) / (1 + np.exp(-2 * thickness) - b * np.expm1(-2 * thickness))
        return State(self.k, state[:2], state[2:], 2.0 / G * factor * (b * cosh + sinh), factor * (cosh + b * sinh))


def _product(*factors: FloatArray) -> FloatArray:
    """Product of matrices ``(i, j, n)``, the last of which may be a vector ``(j, [nz,] n)``; n may be 1."""
    *matrices, total = factors
    for matrix in reversed(matrices):
        total = np.einsum("ijn,j...n->i...n", matrix, total)
    return total


def _decayed(d: FloatArray, traction: FloatArray) -> FloatArray:
    """Traction P(d) (p, q) of waves ``(2, n)`` that decay downwards, ``(2, nz, n)``."""
    p, q = traction
    decay = np.exp(-d)
    drop = d * decay
    return np.array([(decay + drop) * p + drop * q, (decay - drop) * q - drop * p])


def _two_waves(
    distances: tuple[FloatArray, FloatArray, FloatArray], material: Material, B: FloatArray, traction: FloatArray
) -> FloatArray:
    """State (G w, G a, p, q) ``(4, nz, n)`` inside a thick layer from the traction above; see the module."""
    d, up, thickness = distances
    A, swap = _half_space(material), np.array([1.0, -1.0])[:, None, None]
    P, R, Q = _reflection(thickness, material, B)
    down_wave = _product(_inverse(IDENTITY + Q), traction)
    up_wave = _product(R, P, down_wave)
    falling = _decayed(d, down_wave)
    # A wave that decays upwards is the mirror image: P with a bar is P with a change of the sign of q before and after.
    rising = _decayed(up, up_wave * swap[:, 0])
    moved = _product(A, falling) - swap * _product(A, rising)
    return np.concatenate([moved, falling + swap * rising])


def _half_space(material: Material) -> FloatArray:
    """Matrix A of the module, (2, 2, 1)."""
    nu = material.poisson_ratio
    return np.array([[2 * (1 - nu), 1 - 2 * nu], [1 - 2 * nu, 2 * (1 - nu)]])[..., None]


def _pass_pair(d: FloatArray, material: Material, pair: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Compliance above a layer from that below it, and the matrix of tractions downwards, ``(2, 2, n)``."""
    G = material.shear_modulus
    B = G * pair
    over, down = np.empty_like(B), np.empty_like(B)
    thin = d < THIN
    for waves, formula in ((thin, _thin), (~thin, _thick)):
        if waves.any():
            over[..., waves], down[..., waves] = formula(d[waves], material, B[..., waves])
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
    """State (G w, G a, p, q) ``(4, nz, n)`` at heights d ``(nz, n)`` above the lower face, from ``(4, n)`` there."""
    out = np.zeros((4, *d.shape))
    for factor, matrix in _transfer(d, material):
        out += factor * (matrix @ state)[:, None]
    return out


def _thin(d: FloatArray, material: Material, B: FloatArray) -> tuple[FloatArray, FloatArray]:
    T = np.add.reduce([matrix[..., None] * factor for factor, matrix in _transfer(d, material)])
    down = _inverse(_product(T[2:, :2], B) + T[2:, 2:])
    return _product(_product(T[:2, :2], B) + T[:2, 2:], down), down


def _thick(d: FloatArray, material: Material, B: FloatArray) -> tuple[FloatArray, FloatArray]:
    A = _half_space(material)
    P, _, Q = _reflection(d, material, B)
    total = _inverse(IDENTITY + Q)
    down = 4 * (1 - material.poisson_ratio) * _product(_inverse(_mirrored(A) + B), P, total)
    return _product(A - _product(_mirrored(A), Q), total), down


def _reflection(d: FloatArray, material: Material, B: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Matrices P, R and Q of the module, ``(2, 2, n)``."""
    A = _half_space(material)
    decay, drop = np.exp(-d), d * np.exp(-d)
    P = np.array([[decay + drop, drop], [-drop, decay - drop]])
    R = _product(_inverse(_mirrored(A) + B), A - B)
    return P, R, _product(_mirrored(P), R, P)


def _mirrored(matrix: FloatArray) -> FloatArray:
    """Change the sign of the off-diagonal terms: the same relation for waves that decay upwards."""
    return np.asarray(matrix * np.array([[1.0, -1.0], [-1.0, 1.0]])[..., None])


def _inverse(matrix: FloatArray) -> FloatArray:
    """Inverse of 2x2 matrices by cofactors."""
    (a, b), (c, d) = matrix
    return np.asarray(np.array([[d, -b], [-c, a]]) / (a * d - b * c))


def _pass_across(d: FloatArray, material: Material, across: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Antiplane compliance above a layer from that below it, and the factor of the traction from above to below."""
    G = material.shear_modulus
    b = 0.5 * G * across
    tanh = np.tanh(d)
    below = 2 * np.exp(-d) / ((1 + np.exp(-2 * d)) - b * np.expm1(-2 * d))
    return 2 / G * (b + tanh) / (1 + b * tanh), below
