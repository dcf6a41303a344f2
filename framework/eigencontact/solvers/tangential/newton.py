"""Projected Newton iteration for shear tractions within discs.

The tractions q of one load increment minimise ``1/2 q.Aq + q.e`` over ``|q| <= g`` with the prescribed forces. The slip
``s = A q + e - rigid`` is then zero where |q| < g, and opposes q where |q| = g. Tractions at their bound may rotate,
but not grow. With the curvature |s|/g of their discs, the Newton step is a symmetric positive definite problem on the
free directions; preconditioned conjugate gradients solve it. Tractions outside their disc are projected to its rim. A
step that does not reduce the energy is shortened; if that does not help, a projected gradient step replaces it.

References
----------
J. J. Kalker, Three-Dimensional Elastic Bodies in Rolling Contact, Kluwer 1990, chapter 4 (the variational statement).
D. P. Bertsekas, SIAM J. Control Optim. 20 (1982) 221 (projected Newton methods).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from eigencontact.core.array_types import BoolArray, FloatArray
from eigencontact.solvers.tangential.discs import RigidPlane, inner, length_of

__all__ = ["DiscProblem", "DiscState", "solve_discs"]

_TINY = np.finfo(float).tiny
#: Largest number of conjugate-gradient steps in one Newton step.
_INNER = 80
#: Fraction of the loaded cells that may change between stick and slip for precise Newton steps.
_SETTLED = 0.01
#: Residual of a Newton step, relative to its start, if more cells change.
_ROUGH = 0.4
#: Round-off of the energy, relative to the work of the slip.
_ROUND_OFF = 4.0 * np.finfo(float).eps
#: Stiffness of a cell, in units of the largest coefficient, for the size of the first gradient step.
_SOFTEST = 0.2


@dataclass(frozen=True, slots=True)
class DiscProblem:
    """Problem of shear tractions on one box, in dimensionless units of order one.

    Attributes
    ----------
    apply : callable
        Tractions ``(k, ny, nx)`` to displacements, symmetric positive definite.
    precondition : callable
        Approximate inverse of `apply`.
    offset : (k, ny, nx) array
        Vector e: slip of the increment without tractions, minus the prescribed rigid displacements.
    bound : (ny, nx) array
        Bound g >= 0; cells with g = 0 carry no shear.
    modes : RigidPlane
        Rigid modes with prescribed forces.
    """

    apply: Callable[[FloatArray], FloatArray]
    precondition: Callable[[FloatArray], FloatArray]
    offset: FloatArray
    bound: FloatArray
    modes: RigidPlane


@dataclass(slots=True)
class DiscState:
    """Iterate: tractions, their displacements, amplitudes of the free rigid modes, slipping cells, residual."""

    tractions: FloatArray
    displacement: FloatArray
    rigid: FloatArray
    slipping: BoolArray
    residual: float = np.inf


def solve_discs(
    problem: DiscProblem,
    start: FloatArray,
    *,
    tolerance: float,
    max_iterations: int,
    on_iteration: Callable[[float], None],
) -> DiscState:
    """Iterate until the slip meets the tolerance, or the iterations are used up.

    Parameters
    ----------
    start : (k, ny, nx) array
        Any tractions; they are first projected into the discs.
    tolerance : float
        Bound of the error of the slip (total slip in sticking cells, component across the traction in slipping cells),
        relative to the largest displacement by the tractions.
    max_iterations : int
        Largest number of Newton steps.
    on_iteration : callable
        Called with the residual of each iterate, the result included.

    Raises
    ------
    Infeasible
        The bounds cannot carry the prescribed forces.
    """
    return _Iteration(problem).run(start, tolerance, max_iterations, on_iteration)


class _Iteration:
    """State and steps of one solve."""

    def __init__(self, problem: DiscProblem) -> None:
        self.problem = problem
        self.loaded = problem.bound > 0
        self.gradient_step = _SOFTEST

    def run(
        self, start: FloatArray, tolerance: float, max_iterations: int, on_iteration: Callable[[float], None]
    ) -> DiscState:
        start = start * self.loaded
        on_rim = self.loaded & (length_of(start) >= self.problem.bound * (1.0 - 1e-9))
        state = self._state(self.problem.modes.closest(start, self.problem.bound, on_rim))
        slipped: BoolArray | None = None
        for number in range(max_iterations + 1):
            slip, free, outward = self._look(state)
            on_iteration(state.residual)
            if state.residual <= tolerance or number == max_iterations:
                break
            tolerated = _SETTLED * np.count_nonzero(self.loaded)
            zones_steady = slipped is not None and np.count_nonzero(state.slipping != slipped) <= tolerated
            looseness = min(0.1, max(0.3 * state.residual**0.5, 0.01)) if zones_steady else _ROUGH
            slipped = state.slipping
            step = self._newton(free, outward, max(looseness, 0.3 * tolerance / state.residual))
            state = self._moved(state, slip, step) or self._descended(state, slip)
        return state

    def _state(self, tractions: FloatArray) -> DiscState:
        return DiscState(tractions, self.problem.apply(tractions), np.zeros(0), self.loaded)

    def _look(self, state: DiscState) -> tuple[FloatArray, FloatArray, tuple[FloatArray, FloatArray]]:
        """Classify stick and slip, fit the free rigid modes, and compute the residual of the slip."""
        problem = self.problem
        size = length_of(state.tractions)
        at_bound = self.loaded & (size >= problem.bound * (1.0 - 1e-12))
        unit = np.where(at_bound, state.tractions / np.maximum(size, _TINY), 0.0)
        raw = (state.displacement + problem.offset) * self.loaded
        slipping, slip, outward = at_bound, raw, np.zeros_like(size)
        for _ in range(6):  # cells with slip along their traction stick; this changes the fit slightly
            state.rigid = self._fit(raw, np.where(slipping, unit, 0.0))
            slip = raw - problem.modes.combine(state.rigid) * self.loaded if len(problem.modes) else raw
            outward = -np.einsum("kij,kij->ij", slip, unit)
            now_slipping = at_bound & (outward > 0)
            if np.array_equal(now_slipping, slipping):
                break
            slipping = now_slipping
        state.slipping = slipping
        unit = np.where(slipping, unit, 0.0)
        curvature = np.where(slipping, outward / np.maximum(problem.bound, _TINY), 0.0)
        wrong = _across(slip, unit)
        largest = float(np.max(length_of(state.displacement * self.loaded), initial=0.0))
        state.residual = _ratio(float(np.max(length_of(wrong), initial=0.0)), largest)
        return slip, wrong, (unit, curvature)

    def _fit(self, slip: FloatArray, unit: FloatArray) -> FloatArray:
        """Free rigid modes with the least slip in the sticking directions."""
        modes = self.problem.modes
        if not len(modes):
            return np.zeros(0)
        return modes.fitted(unit, self.loaded).amounts(_across(slip, unit))

    def _newton(self, wrong: FloatArray, discs: tuple[FloatArray, FloatArray], looseness: float) -> FloatArray:
        """Conjugate gradients in the free directions, with constant prescribed forces."""
        problem, modes = self.problem, self.problem.modes
        unit, curvature = discs
        fitted = modes.fitted(unit, self.loaded) if len(modes) else None

        def allowed(field: FloatArray) -> FloatArray:
            field = _across(field * self.loaded, unit)
            if fitted is not None:
                field -= _across(modes.combine(fitted.amounts(field)) * self.loaded, unit)
            return field

        # Tractions with strong curvature hardly rotate; the preconditioner, which neglects curvature, must not rotate
        # them.
        weight = 1.0 / np.sqrt(1.0 + curvature)

        def preconditioned(field: FloatArray) -> FloatArray:
            return allowed(weight * problem.precondition(weight * field))

        step = np.zeros_like(wrong)
        residual = -allowed(wrong)
        stop = looseness * np.sqrt(inner(residual, residual))
        direction = preconditioned(residual)
        slope = inner(residual, direction)
        for _ in range(_INNER):
            change = allowed(problem.apply(direction) + curvature * direction)
            bend = inner(direction, change)
            if not (bend > 0.0 and slope > 0.0):
                break
            amount = slope / bend
            step += amount * direction
            residual -= amount * change
            if np.sqrt(inner(residual, residual)) <= stop:
                break
            better = preconditioned(residual)
            before, slope = slope, inner(residual, better)
            direction = better + (slope / before) * direction
        return step

    def _moved(self, state: DiscState, slip: FloatArray, step: FloatArray) -> DiscState | None:
        """State after the step or a fraction of it; None if no fraction reduces the energy.

        Tractions projected to their bound have round-off errors, and so has the energy: a cell with a very small bound
        may rotate by this error.
        """
        share, round_off = 1.0, _ROUND_OFF * inner(np.abs(slip), np.abs(state.tractions))
        for _ in range(4):
            tractions = self.problem.modes.closest(state.tractions + share * step, self.problem.bound, state.slipping)
            trial = self._state(tractions)
            expected, gained = _change_of_energy(slip, state, trial)
            if gained <= 1e-4 * expected + round_off:
                return trial
            share *= 0.4
        return None

    def _descended(self, state: DiscState, slip: FloatArray) -> DiscState:
        """State after a projected gradient step; a sufficiently short one always reduces the energy."""
        trial = state
        for _ in range(12):
            tractions = self.problem.modes.closest(state.tractions - self.gradient_step * slip, self.problem.bound)
            trial = self._state(tractions)
            expected, gained = _change_of_energy(slip, state, trial)
            if gained <= 0.25 * expected:
                self.gradient_step *= 1.5
                return trial
            self.gradient_step *= 0.4
        return trial


def _change_of_energy(slip: FloatArray, state: DiscState, changed: DiscState) -> tuple[float, float]:
    """Change of the energy from one state to another with equal forces: to first order, and exact.

    It is not computed as a difference of two energies. Near the solution their round-off would exceed the change, long
    before the slip of lightly loaded cells is accurate.
    """
    change = changed.tractions - state.tractions
    first = inner(slip, change)
    return first, first + 0.5 * inner(change, changed.displacement - state.displacement)


def _across(field: FloatArray, unit: FloatArray) -> FloatArray:
    """Part of a field perpendicular to the unit vectors of the slipping cells; the whole field elsewhere."""
    return np.asarray(field - unit * np.einsum("kij,kij->ij", unit, field))


def _ratio(numerator: float, denominator: float) -> float:
    return numerator / denominator if denominator > 0.0 else (0.0 if numerator == 0.0 else np.inf)
