"""Stress of a point that yields, for the finite elements that judge: a return mapping of their own.

Vectors are (rr, tt, zz, sqrt2 rz) or any other orthonormal components of a symmetric tensor whose first three are the
normal ones, component first: ``(k, n)`` at n points. Tension is positive.

Backward Euler. With the trial deviator ``s* = 2G dev(e - e_p)``, the sound part ``w = 1 - D(p)``, the part a of the
stress that yield is asked of (``a = w`` for the nominal stress, 1 for the effective one), back-stresses
``X_i = θ_i (X_i,n + (2/3) C_i Δe_p)``, ``θ_i = 1 / (1 + γ_i Δp)``, and ``A = a s* - Σ θ_i X_i,n``, flow is along
``n = A / |A|`` and its amount is the root of

    f(Δp) = sqrt(3/2) |A| - (3 a G + Σ θ_i C_i) Δp - Y(p_n + Δp).

The stress is ``w (K tr e 1 + s* - sqrt6 G Δp n)``; the tangent is the derivative of just that.

References
----------
J. C. Simo, T. J. R. Hughes, Computational Inelasticity, 1998, chapter 3; J.-L. Chaboche, Int. J. Plasticity 2 (1986)
149; J. Lemaitre, J. Eng. Mater. Technol. 107 (1985) 83.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "Answer",
    "PointLaw",
    "YieldingLaw",
    "fading_damage",
    "linear",
    "ludwik",
    "perfect",
    "swift",
    "tabulated",
    "voce",
]

FloatArray = NDArray[np.float64]
State = Mapping[str, FloatArray]
#: A function of equivalent plastic strain (n,) and its derivative.
Curve = Callable[[FloatArray], tuple[FloatArray, FloatArray]]
#: Stress (k, n), tangent (k, k, n) and state at the end of an increment.
Answer = tuple[FloatArray, FloatArray, State]

_ROOT = float(np.sqrt(1.5))
#: Steps of the safeguarded Newton iteration, and the part of the yield stress that it leaves.
_STEPS, _TOLERANCE = 200, 1e-13


class PointLaw(Protocol):
    """Interface of a material for the elements: its state at rest, and its answer to a strain."""

    def state_at_rest(self, components: int, points: int) -> State:
        """State of points that have never been loaded; its entry ``"p"`` is equivalent plastic strain, (n,)."""
        ...

    def answer(self, strain: FloatArray, before: State) -> Answer:
        """Answer to a total strain (k, n) at the end of an increment that began with a state."""
        ...


def perfect(stress: float) -> Curve:
    """No hardening."""
    return linear(stress, 0.0)


def linear(stress: float, modulus: float) -> Curve:
    """Y + H p."""
    return lambda p: (stress + modulus * p, np.full_like(p, modulus))


def swift(B: float, C: float, n: float) -> Curve:
    """B (C + 1e6 p)^n: plastic strain in millionths."""
    return lambda p: (B * (C + 1e6 * p) ** n, 1e6 * n * B * (C + 1e6 * p) ** (n - 1))


def ludwik(stress: float, K: float, n: float) -> Curve:
    """Y + K p^n; the slope is cut off below p = 1e-12, where it has no bound for n < 1."""
    return lambda p: (stress + K * p**n, n * K * np.maximum(p, 1e-12) ** (n - 1))


def voce(stress: float, Q: float, b: float) -> Curve:
    """Y + Q (1 - exp(-b p))."""
    return lambda p: (stress + Q * (1 - np.exp(-b * p)), Q * b * np.exp(-b * p))


def tabulated(strain: Sequence[float], stress: Sequence[float]) -> Curve:
    """Lines between points whose strains rise from 0; constant beyond the last."""

    def curve(p: FloatArray) -> tuple[FloatArray, FloatArray]:
        value, slope = np.full_like(p, stress[-1]), np.zeros_like(p)
        for a, b, Y, Z in zip(strain[:-1], strain[1:], stress[:-1], stress[1:], strict=True):
            inside = (p >= a) & (p < b)
            rise = (Z - Y) / (b - a)
            value[inside], slope[inside] = Y + rise * (p[inside] - a), rise
        return value, slope

    return curve


def fading_damage(saturation: float, strain: float) -> Curve:
    """D = saturation (1 - exp(-p / strain))."""
    return voce(0.0, saturation, 1 / strain)


@dataclass(frozen=True, kw_only=True)
class YieldingLaw:
    """J2 plasticity with isotropic and kinematic hardening and damage; elastic where `hardening` is None.

    Attributes
    ----------
    young_modulus, poisson_ratio : float
        Of the sound material.
    hardening : Curve or None
        Yield stress over equivalent plastic strain.
    back_stresses : tuple of (C, gamma)
        ``dX = (2/3) C de_p - gamma X dp``: Prager for gamma = 0, else Armstrong and Frederick; several are Chaboche's.
    damage : Curve or None
        Lost part of the stiffness over equivalent plastic strain.
    effective : bool
        Whether yield is asked of the effective stress (True) or of the nominal one.
    """

    young_modulus: float
    poisson_ratio: float
    hardening: Curve | None = None
    back_stresses: tuple[tuple[float, float], ...] = ()
    damage: Curve | None = None
    effective: bool = False

    def state_at_rest(self, components: int, points: int) -> State:
        """See `PointLaw.state_at_rest`."""
        backs = (len(self.back_stresses), components, points)
        return {"p": np.zeros(points), "plastic": np.zeros((components, points)), "back": np.zeros(backs)}

    def answer(self, strain: FloatArray, before: State) -> Answer:
        """See `PointLaw.answer`.

        Raises
        ------
        ArithmeticError
            Points that soften so fast that they have no answer.
        """
        G = self.young_modulus / (2 * (1 + self.poisson_ratio))
        K = self.young_modulus / (3 * (1 - 2 * self.poisson_ratio))
        unit = np.zeros(len(strain))
        unit[:3] = 1.0
        deviator = np.eye(len(strain)) - np.outer(unit, unit) / 3
        pressed = K * (unit @ strain)
        trial = 2 * G * (deviator @ (strain - before["plastic"]))
        more = np.zeros(strain.shape[1])
        if self.hardening is not None:
            outside = self._excess(trial, before, more, G)[0] > 0
            yielding = {name: values[..., outside] for name, values in before.items()}
            more[outside] = self._increment(trial[:, outside], yielding, G)
        p = before["p"] + more
        damage, _ = self._damage_of(p)
        _, slope, along, turn = self._excess(trial, before, more, G)
        yields = more > 0
        flow = np.where(yields, _ROOT * more * along, 0.0)
        sound = pressed * unit[:, None] + trial - 2 * G * flow
        stress = (1 - damage) * sound
        after = {"p": p, "plastic": before["plastic"] + flow, "back": self._backs(before, more, flow)}
        tangent = np.repeat((K * np.outer(unit, unit) + 2 * G * deviator)[:, :, None], strain.shape[1], axis=2)
        if np.any(yields):
            k = np.flatnonzero(yields)
            factor, size, dA, w, dw = (x[..., k] for x in turn)
            n, dp = along[:, k], -2 * G * _ROOT * factor * along[:, k] / slope[k]  # dp: (k, n), by the strain
            across = np.eye(len(strain))[:, :, None] - n[:, None] * n[None]
            bend = factor * 2 * G * deviator[:, :, None] + dA[:, None] * dp[None]
            dn = np.einsum("ijn,jkn->ikn", across, bend) / size
            tangent[:, :, k] -= 2 * G * _ROOT * (n[:, None] * dp[None] + more[k] * dn)
            tangent[:, :, k] = w * tangent[:, :, k] + dw * sound[:, None, k] * dp[None]
        tangent[:, :, ~yields] *= 1 - damage[~yields]
        return stress, tangent, after

    def _damage_of(self, p: FloatArray) -> tuple[FloatArray, FloatArray]:
        return (np.zeros_like(p), np.zeros_like(p)) if self.damage is None else self.damage(p)

    def _backs(self, before: State, more: FloatArray, flow: FloatArray) -> FloatArray:
        back_stress = before["back"].copy()
        for k, (C, gamma) in enumerate(self.back_stresses):
            back_stress[k] = (back_stress[k] + 2 / 3 * C * flow) / (1 + gamma * more)
        return np.asarray(back_stress)

    def _excess(
        self, trial: FloatArray, before: State, more: FloatArray, G: float
    ) -> tuple[FloatArray, FloatArray, FloatArray, tuple[FloatArray, ...]]:
        """Excess f and its derivative, the direction n, and (a, |A|, dA/dΔp, w, dw/dΔp)."""
        damage, loss = self._damage_of(before["p"] + more)
        w, dw = 1 - damage, -loss
        a, da = (np.ones_like(w), np.zeros_like(w)) if self.effective else (w, dw)
        A, dA = a * trial, da * trial
        stiff, rise = 3 * G * a, 3 * G * da
        for X, (C, gamma) in zip(before["back"], self.back_stresses, strict=True):
            theta = 1 / (1 + gamma * more)
            A, dA = A - theta * X, dA + gamma * theta**2 * X
            stiff, rise = stiff + theta * C, rise - gamma * theta**2 * C
        Y, H = self.hardening(before["p"] + more) if self.hardening else (np.full_like(more, np.inf), 0 * more)
        size = np.sqrt((A * A).sum(axis=0))
        n = A / np.where(size > 0, size, 1.0)
        slope = _ROOT * (n * dA).sum(axis=0) - stiff - rise * more - H
        return _ROOT * size - stiff * more - Y, slope, n, (a, size, dA, w, dw)

    def _increment(self, trial: FloatArray, before: State, G: float) -> FloatArray:
        """Root of f at points where f(0) > 0: Newton's steps kept within a bracket."""
        low = np.zeros(trial.shape[1])
        high = _ROOT * np.sqrt((trial * trial).sum(axis=0)) / (3 * G)
        for _ in range(60):
            above = self._excess(trial, before, high, G)[0] > 0
            if not np.any(above):
                break
            low, high = np.where(above, high, low), np.where(above, 2 * high, high)
        else:
            raise ArithmeticError("a point that yields must have an answer (got one that softens faster than it can)")
        x = low
        for _ in range(_STEPS):
            f, slope, _, _ = self._excess(trial, before, x, G)
            if np.all(np.abs(f) <= _TOLERANCE * self.young_modulus) or np.all(high - low <= 1e-16 * high):
                return x
            low, high = np.where(f > 0, x, low), np.where(f > 0, high, x)
            step = x - f / np.where(slope < 0, slope, -1.0)
            x = np.where((slope < 0) & (step > low) & (step < high), step, (low + high) / 2)
        return x
