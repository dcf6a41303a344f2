"""Preconditioned conjugate gradients for ``p >= 0, g(p) >= 0, p g = 0`` on one box, with prescribed forces.

The gap of the loaded cells is driven to zero; cells that pull are released, cells that overlap are taken in. Rigid
modes whose force is prescribed are eliminated: search directions carry no force, and the rigid displacement is the
least-squares fit of the gap over the loaded cells.

References
----------
I. A. Polonsky, L. M. Keer, Wear 231 (1999) 206 (active set inside the iteration).
E. A. H. Vollebregt, J. Tribol. 136 (2014) 041402 (bound-constrained CG with an FFT-based preconditioner).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigencontact.solvers.rigid import RigidModes, dot

__all__ = ["BoxProblem", "BoxState", "relative", "solve_box", "without_forces"]

Array = NDArray[Any]

# Iterations without half the best residual after which the loaded cells only change sides.
_STALLED = 60


@dataclass(frozen=True, slots=True)
class BoxProblem:
    """A contact problem on one box, in the solver's own units.

    Attributes
    ----------
    apply : callable
        Pressure to displacement.
    precondition : callable
        Gap residual to pressure correction; symmetric positive definite.
    separation : (ny, nx) array
        Separation less the prescribed rigid displacements.
    modes : RigidModes
        The rigid modes whose force is prescribed.
    forces : (m,) array
        Their forces: ``sum(mode * p)``.
    share : (ny, nx) array, optional
        What each loaded cell takes part in a rigid motion: where cells give way very differently, one that yields to
        the least pressure must not be asked for as much as the others. By default all the same.
    least_deflection : float
        Gaps are measured against the largest deflection of loaded cells, but never against less than this.
    energy : callable, optional
        Sum of a pressure times its displacement, roughly: it tells the cells to release before the displacement of a
        step is computed, which is then computed once and not twice.
    """

    apply: Callable[[Array], Array]
    precondition: Callable[[Array], Array]
    separation: Array
    modes: RigidModes
    forces: Array
    share: Array | None = None
    least_deflection: float = 0.0
    energy: Callable[[Array], float] | None = None


@dataclass(slots=True)
class BoxState:
    """Iterate on a box: pressure, rigid displacements of the free modes, relative residual."""

    pressure: Array
    rigid: Array
    residual: float


def solve_box(
    problem: BoxProblem,
    pressure: Array,
    loaded: Array,
    *,
    tolerance: float,
    max_iterations: int,
    on_iteration: Callable[[float], None],
) -> BoxState:
    """Iterate until the relative residual on the box is within the tolerance, stalls, or the iterations are used up.

    Parameters
    ----------
    problem : BoxProblem
        The problem.
    pressure : (ny, nx) array
        Start; positive at loaded cells.
    loaded : (ny, nx) bool array
        Loaded cells of the start (a pressure of zero may still count as loaded).
    on_iteration : callable
        Told the residual of each iteration.

    Returns
    -------
    BoxState
        ``residual`` tells whether it got there; of moments that no pressure on the box carries it is the part missed.
    """
    modes, dtype, share = problem.modes, pressure.dtype, problem.share
    p = modes.carry(pressure, problem.forces) if len(modes) else pressure.copy()
    c = loaded.astype(dtype)
    if not modes.carries(p, problem.forces):  # these cells cannot: start with all of the box
        p, c = modes.carry(np.ones_like(p), problem.forces), np.ones_like(p)
    g = problem.apply(p)
    deflection = float((g * c).max())
    g += problem.separation
    direction = r_old = np.zeros_like(p)
    slope_old = 0.0
    work = np.empty_like(p)
    careful, releasing = False, problem.energy is not None
    best, since = np.inf, 0
    state = BoxState(p, np.zeros(len(modes)), np.inf)
    for _ in range(max_iterations):
        state.pressure = p
        weight = c if share is None else c * share
        state.rigid = modes.fit(np.multiply(g, weight, out=work), weight) if len(modes) else state.rigid
        outside = np.subtract(modes.combine(state.rigid, dtype), g, out=work)  # overlap positive
        r = outside * c
        outside -= r
        overlap = float(outside.max())
        inside = max(float(r.max()), -float(r.min()))
        state.residual = relative(max(inside, overlap), max(deflection, problem.least_deflection))
        on_iteration(state.residual)
        if state.residual <= tolerance:
            short = modes.shortage(p, problem.forces)
            if short > tolerance:  # no pressure on this box carries the moments: its gaps are closed for other forces
                state.residual = short
            break
        best, since = (state.residual, 0) if state.residual < 0.5 * best else (best, since + 1)
        if since >= _STALLED:
            break
        if overlap > (10 * inside if careful else 0):  # take in the cells that overlap
            taken = outside >= overlap if careful else outside > 0
            c[taken] = 1
            np.copyto(r, outside, where=taken)
            if share is None:
                modes.remove(r, c)
            else:
                modes.level(r, c, c * share)
        # r carries no force on the loaded cells, so the rigid part of z does not enter the products with it.
        z = problem.precondition(r)
        z *= c
        slope = dot(r, z)
        beta = max(0.0, (slope - dot(r_old, z)) / slope_old) if slope_old > 0 else 0.0
        r_old, slope_old = r, slope
        if beta > 0:
            direction *= dtype.type(beta)
            direction *= c
            direction += z
        else:
            direction = z
        without_forces(modes, direction, c, share)
        descent = dot(r, direction)
        if careful and descent <= 0:  # the loaded cells have changed; the old direction leads uphill on these
            direction = z
            without_forces(modes, direction, c, share)
            descent = dot(r, direction)
        rest = _released(problem, p, direction, descent) if releasing and not careful else None
        releasing = rest is not None
        if rest is not None:  # the cells that pull are known before the product
            response = problem.apply(np.subtract(rest, p, out=work))
            if dot(r, work) >= 0.5 * dot(work, response):
                p, c = rest, (rest > 0).astype(dtype)
                g += response
                deflection = _deflection(g, problem.separation, c, work)
                continue
        response = problem.apply(direction)
        curvature = dot(direction, response)
        if not curvature > 0:
            break
        step = dtype.type(descent / curvature)
        p = p + np.multiply(direction, step, out=work)
        if float(p.min()) < 0:  # release the cells that pull; the gap is then computed anew
            pulls, releasing = p < 0, problem.energy is not None
            np.maximum(p, 0, out=p)
            if len(modes):
                p = modes.carry(p, problem.forces)
            if not modes.carries(p, problem.forces):
                # Too few cells are left for the moments: go only to the first that would pull, and release that one.
                careful = True
                room = np.where(pulls, state.pressure / np.where(pulls, -direction, 1), np.inf)
                p = np.maximum(state.pressure + room.min() * direction, 0)
                first = room <= room.min()
                p[first] = c[first] = 0
                slope_old = 0.0
            else:
                c = (p > 0).astype(dtype)
            g = problem.apply(p)
            deflection = float(np.multiply(g, c, out=work).max())
            g += problem.separation
        else:
            response *= step
            g += response
            deflection = _deflection(g, problem.separation, c, work)
    return state


def _released(problem: BoxProblem, p: Array, direction: Array, descent: float) -> Array | None:
    """Pressure after a step without the cells that would pull; None if none would, or the others cannot carry."""
    assert problem.energy is not None
    curvature = problem.energy(direction)
    if not curvature > 0:
        return None
    rest = p + direction * p.dtype.type(descent / curvature)
    if float(rest.min()) >= 0:
        return None
    np.maximum(rest, 0, out=rest)
    if len(problem.modes):
        rest = problem.modes.carry(rest, problem.forces)
    return rest if problem.modes.carries(rest, problem.forces) else None


def _deflection(gap: Array, separation: Array, loaded: Array, work: Array) -> float:
    """Largest deflection of the loaded cells."""
    np.subtract(gap, separation, out=work)
    work *= loaded
    return float(work.max())


def without_forces(modes: RigidModes, direction: Array, loaded: Array, share: Array | None) -> None:
    """Take the forces out of a search direction, in place."""
    if share is None:
        modes.remove(direction, loaded)
    else:
        modes.unload(direction, loaded * share)


def relative(worst: float, deflection: float) -> float:
    """Residual of a box: gaps are measured against the largest deflection of loaded cells.

    `BoxProblem.least_deflection` is in it: a periodic body does not deflect at all under a uniform pressure.
    """
    if deflection > 0:
        return max(worst, 0.0) / deflection
    return float("inf") if worst > 0 else 0.0
