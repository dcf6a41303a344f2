r"""Implicit return to a yield surface of von Mises, with isotropic and kinematic hardening and damage.

A deviatoric strain τ (minus the plastic strain) drives a point through a compliance: ``s = w τ`` with ``1/w = 1/(2G (1
- D)) + b``. For a point with given strain b is zero. For a cell in an elastic body b is the compliance of the
surroundings (see `eigencontact.plugin.Surroundings`). A plastic increment dp along the unit flow m leads to

    s = w (τ - √(3/2) dp m),   X_i = θ_i (X_i + (2/3) C_i √(3/2) dp m),   ξ = s - Σ X_i,

and m is parallel to ``ξ* = w τ - Σ θ_i X_i``. One equation for dp remains:

    f(dp) = √(3/2) |ξ*| - (3/2) dp (w + (2/3) Σ θ_i C_i) - Y(p + dp) = 0.

For yield on the effective stress, s and σ represent ``σ / (1 - D)``.

References
----------
J. C. Simo and T. J. R. Hughes 1998, Computational Inelasticity, chapter 3; J.-L. Chaboche and G. Cailletaud 1996,
Comput. Methods Appl. Mech. Eng. 133, 125 (several back-stresses: one equation).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from eigencontact.plugin import FloatArray, IsotropicHardening, KinematicHardening, NotUnique, PlasticDamage

__all__ = ["Drive", "RadialReturn", "Returned"]


_ROOT = float(np.sqrt(1.5))
#: Largest number of steps in the search for dp.
_STEPS = 100
#: Largest number of doublings of the bracket of dp.
_DOUBLINGS = 60
#: Residual that counts as round-off, relative to the stress.
_ROUND_OFF = 1e-13


@dataclass(frozen=True, slots=True, eq=False)
class Drive:
    """Strain that drives n points, and their history variables.

    Attributes
    ----------
    tau : (6, n)
        Deviatoric Mandel strain minus the plastic strain.
    give : float
        Compliance b of the surroundings [1/Pa].
    p : (n,)
        Equivalent plastic strain.
    back : (k, 6, n)
        Back-stresses [Pa].
    mean : (n,), optional
        Mean equivalent plastic strain for the damage, if it replaces that of the point.
    """

    tau: FloatArray
    give: float
    p: FloatArray
    back: FloatArray
    mean: FloatArray | None = None

    def of(self, points: NDArray[np.intp]) -> Drive:
        """Drive of some of the points."""
        mean = None if self.mean is None else self.mean[points]
        return Drive(self.tau[:, points], self.give, self.p[points], self.back[:, :, points], mean)


@dataclass(frozen=True, slots=True, eq=False)
class Returned:
    """State for an increment dp, with derivatives by dp (names that begin with d).

    Attributes
    ----------
    residual, slope : (n,)
        f [Pa] and its derivative.
    w, dw : (n,)
        Stiffness of the points [Pa], in the stress of the yield condition.
    sound, dsound : (n,)
        1 - D.
    recalled, drecalled : (6, n)
        Σ θ X [Pa].
    reached : (6, n)
        ξ* [Pa].
    flow : (6, n)
        m; zero where ξ* is.
    theta : (k, n)
    """

    dp: FloatArray
    residual: FloatArray
    slope: FloatArray
    w: FloatArray
    dw: FloatArray
    sound: FloatArray
    dsound: FloatArray
    drecalled: FloatArray
    reached: FloatArray
    flow: FloatArray
    theta: FloatArray


@dataclass(frozen=True, kw_only=True)
class RadialReturn:
    """Return mapping of one material.

    Attributes
    ----------
    shear_modulus : float
        G of the sound material [Pa].
    isotropic : IsotropicHardening
    kinematic : sequence of KinematicHardening
    damage : PlasticDamage or None
    effective : bool
        Whether the yield condition uses the effective stress.
    """

    shear_modulus: float
    isotropic: IsotropicHardening
    kinematic: Sequence[KinematicHardening] = field(default=())
    damage: PlasticDamage | None = None
    effective: bool = False

    def elastic(self, drive: Drive) -> tuple[FloatArray, FloatArray, NDArray[np.intp]]:
        """State without a plastic increment: stiffness w [Pa], 1 - D, and the points above their yield stress."""
        w, _, sound, _ = self._stiffness(drive, drive.p)
        size = w * _size(drive.tau) if not len(drive.back) else _size(w * drive.tau - drive.back.sum(axis=0))
        return w, sound, np.flatnonzero(_ROOT * size > self._yield_stress(drive.p))

    def _yield_stress(self, p: FloatArray) -> FloatArray:
        """Yield stress [Pa] at plastic strains; most of them are zero, and only nonzero points are evaluated."""
        (first, *_), _ = self.isotropic.flow_stress(np.zeros(1))
        out, hardened = np.full(p.shape, first), np.flatnonzero(p)
        out[hardened] = self.isotropic.flow_stress(p[hardened])[0]
        return out

    def returned(self, drive: Drive, flows: NDArray[np.intp]) -> Returned:
        """State after the plastic increments of the yielding points.

        Parameters
        ----------
        drive : Drive
            Drive of these points.
        flows : (n,) of int
            Numbers of these points among all points, for messages.

        Raises
        ------
        NotUnique
            Points soften faster than the surroundings unload; their solution is not unique.
        """
        return self.state(drive, self._root(drive, flows))

    def state(self, drive: Drive, dp: FloatArray) -> Returned:
        """State after plastic increments dp."""
        p = drive.p + dp
        flow_stress, hardening = self.isotropic.flow_stress(p)
        w, dw, sound, growth = self._stiffness(drive, p)
        g, dg = w.copy(), dw.copy()
        recalled, drecalled = np.zeros_like(drive.tau), np.zeros_like(drive.tau)
        theta = np.ones((len(self.kinematic), p.size))
        for number, law in enumerate(self.kinematic):
            theta[number], falling = law.recall(dp)
            recalled += theta[number] * drive.back[number]
            drecalled += falling * drive.back[number]
            g += law.modulus / 1.5 * theta[number]
            dg += law.modulus / 1.5 * falling
        reached = w * drive.tau - recalled
        size = _size(reached)
        flow = reached / np.where(size > 0.0, size, 1.0)
        residual = _ROOT * size - 1.5 * dp * g - flow_stress
        slope = _ROOT * np.sum(flow * (dw * drive.tau - drecalled), axis=0) - 1.5 * (g + dp * dg) - hardening
        return Returned(
            dp=dp, residual=residual, slope=slope, w=w, dw=dw, sound=sound, dsound=-growth, drecalled=drecalled,
            reached=reached, flow=flow, theta=theta,
        )  # fmt: skip

    def _stiffness(self, drive: Drive, p: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """Stiffness w and its derivative by p, 1 - D, and the derivative of D."""
        if self.damage is None:
            zeros = np.zeros(p.shape)
            w = 2.0 * self.shear_modulus / (1.0 + 2.0 * self.shear_modulus * drive.give)
            return np.full(p.shape, w), zeros, np.ones(p.shape), zeros
        at = p if drive.mean is None else drive.mean
        damage, growth = self.damage.damage(at)
        if drive.mean is not None:  # damage follows from the mean, not from the plastic strain of the point
            growth = np.zeros_like(p)
        sound, double_shear = 1.0 - damage, 2.0 * self.shear_modulus
        around = 1.0 + sound * double_shear * drive.give
        if self.effective:
            return double_shear / around, growth * drive.give * (double_shear / around) ** 2, sound, growth
        return sound * double_shear / around, -growth * double_shear / around**2, sound, growth

    def _equation(self, drive: Drive, size: FloatArray, dp: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Residual f and its slope; without back-stresses from the norms |τ|, without tensors."""
        if self.kinematic:
            trial = self.state(drive, dp)
            return trial.residual, trial.slope
        p = drive.p + dp
        (flow_stress, hardening), (w, dw, *_) = self.isotropic.flow_stress(p), self._stiffness(drive, p)
        return _ROOT * w * size - 1.5 * dp * w - flow_stress, _ROOT * dw * size - 1.5 * (w + dp * dw) - hardening

    def _root(self, drive: Drive, flows: NDArray[np.intp]) -> FloatArray:
        """Root of f in a bracket by Newton's method, with bisection if it does not converge."""
        low, size = np.zeros_like(drive.p), _size(drive.tau)
        start, (w, dw, *_) = self._equation(drive, size, low), self._stiffness(drive, drive.p)
        # Slope of f at the onset of yielding: the stress of a point must increase with its driving strain.
        first = start[1] - dw / w * start[0]
        if not np.all(first < 0.0):
            raise _refusal(flows, ~(first < 0.0))
        scale = start[0] + self.isotropic.flow_stress(drive.p)[0]
        high = start[0] / (1.5 * w)
        for _ in range(_DOUBLINGS):
            residual, slope = self._equation(drive, size, high)
            above = residual > _ROUND_OFF * scale  # a point that yields only by round-off has an empty bracket
            if not above.any():
                break
            low, high = np.where(above, high, low), np.where(above, 2.0 * high, high)
        else:
            raise _refusal(flows, above)
        # For saturating hardening, tangents at both ends have zeros below the root: the first step uses the higher
        # zero.
        with np.errstate(divide="ignore", invalid="ignore"):
            dp = np.maximum(high - residual / slope, -start[0] / start[1])
        dp = np.where((dp > low) & (dp < high), dp, high)
        (residual, slope), step = self._equation(drive, size, dp), high - low
        root, slopes, left = dp.copy(), slope.copy(), np.arange(dp.size)
        for _ in range(_STEPS):
            far = ~(np.abs(residual) <= _ROUND_OFF * scale)
            if not far.all():  # converged points are left out
                root[left], slopes[left] = dp, slope
                if not far.any():
                    break
                drive, left = drive.of(np.flatnonzero(far)), left[far]
                low, high, dp, step = low[far], high[far], dp[far], step[far]
                residual, slope, scale, size = residual[far], slope[far], scale[far], size[far]
            low, high = np.where(residual > 0.0, dp, low), np.where(residual > 0.0, high, dp)
            with np.errstate(divide="ignore", invalid="ignore"):
                newton = dp - residual / slope
            good = (newton > low) & (newton < high) & (np.abs(newton - dp) < 0.5 * np.abs(step))
            following = np.where(good, newton, 0.5 * (low + high))
            dp, step = following, following - dp
            residual, slope = self._equation(drive, size, dp)
        else:
            root[left], slopes[left] = dp, slope
        unclear = ~(slopes < 0.0)
        if unclear.any():
            raise _refusal(flows, unclear)
        return root


def _size(tensor: FloatArray) -> FloatArray:
    return np.asarray(np.sqrt(np.einsum("in,in->n", tensor, tensor)))


def _refusal(flows: NDArray[np.intp], unstable: NDArray[np.bool_]) -> NotUnique:
    points = flows[unstable]
    return NotUnique(
        f"{points.size} points soften so fast that their answer is not unique, first point {points[0]}",
        points.tolist(),
    )
