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

__all__ = ["BoxProblem", "BoxState", "enforce_forces", "rigid_fit", "solve_box"]

Array = NDArray[Any]


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
    modes : (m, ny, nx) array
        Fields of the rigid modes whose force is prescribed.
    forces : (m,) array
        Their forces: ``sum(modes * p)``.
    """

    apply: Callable[[Array], Array]
    precondition: Callable[[Array], Array]
    separation: Array
    modes: Array
    forces: Array


@dataclass(slots=True)
class BoxState:
    """Iterate on a box: pressure, its displacement plus separation, rigid displacements, residual."""

    pressure: Array
    gap: Array
    rigid: Array
    residual: float


def _gram(modes: Array, weight: Array) -> Array:
    """Matrix ``sum(modes_i modes_j weight)``."""
    flat = modes.reshape(len(modes), -1).astype(float, copy=False)
    return (flat * weight.ravel()) @ flat.T


def rigid_fit(gap: Array, modes: Array, loaded: Array) -> Array:
    """Least-squares rigid displacements of the gap over the loaded cells (weights 0 or 1), shape (m,)."""
    if len(modes) == 1:  # the hot path: a mean
        count = float(np.sum(loaded, dtype=float))
        return np.array([float(np.vdot(gap, loaded)) / count if count else 0.0])
    right = np.array([float(np.vdot(mode * gap, loaded)) for mode in modes])
    return np.asarray(np.linalg.lstsq(_gram(modes, loaded), right, rcond=1e-13)[0])


def enforce_forces(pressure: Array, modes: Array, forces: Array) -> Array:
    """Scale a pressure by ``1 + c . modes`` so that it carries the forces, clipped to stay positive."""
    for _ in range(30):
        carried = np.array([float(np.vdot(mode, pressure)) for mode in modes])
        error = forces - carried
        if not np.any(np.abs(error) > 1e-14 * np.abs(forces).max()):
            break
        if len(modes) == 1:
            if carried[0] > 0:
                pressure = pressure * (forces[0] / carried[0])
            break
        change = np.linalg.lstsq(_gram(modes, pressure), error, rcond=1e-13)[0]
        factor = 1.0 + np.tensordot(change, modes, 1)
        pressure = pressure * np.maximum(factor, 0.1)
    return pressure


def _without_rigid(field: Array, modes: Array, loaded: Array) -> None:
    """Remove from `field` (zero outside the loaded cells) its rigid part, in place."""
    if len(modes):
        part = np.tensordot(rigid_fit(field, modes, loaded), modes, 1)
        field -= part * loaded


def solve_box(
    problem: BoxProblem,
    pressure: Array,
    loaded: Array,
    *,
    tolerance: float,
    max_iterations: int,
    on_iteration: Callable[[float], None],
) -> BoxState:
    """Iterate until the relative residual on the box is within the tolerance, or the iterations are used up.

    Parameters
    ----------
    problem : BoxProblem
        The problem.
    pressure : (ny, nx) array
        Start; positive at loaded cells.
    loaded : (ny, nx) array of 0 and 1
        Loaded cells of the start (a pressure of zero may still count as loaded).
    on_iteration : callable
        Told the residual of each iteration.

    Returns
    -------
    BoxState
        ``residual`` tells whether it got there.
    """
    modes = problem.modes
    p = enforce_forces(pressure, modes, problem.forces) if len(modes) else pressure.copy()
    c = loaded.astype(p.dtype)
    displacement = problem.apply(p)
    g = displacement + problem.separation
    direction = np.zeros_like(p)
    r_old, slope_old = None, 0.0
    rigid = np.zeros(len(modes))
    residual = np.inf
    for _ in range(max_iterations):
        rigid = rigid_fit(g, modes, c)
        gap = g - np.tensordot(rigid, modes, 1).astype(p.dtype) if len(modes) else g
        r = gap * c
        inside = max(float(r.max()), -float(r.min()))
        outside = gap - r
        overlap = -float(outside.min())
        # Deflection of the loaded cells: what gaps are measured against.
        deflection = float(np.max((g - problem.separation) * c))
        residual = max(inside, overlap, 0.0) / deflection if deflection > 0 else (np.inf if overlap > 0 else 0.0)
        on_iteration(residual)
        if residual <= tolerance or not np.isfinite(residual) and not overlap > 0:
            break
        if overlap > 0:
            taken = outside < 0
            c[taken] = 1
            np.copyto(r, gap, where=taken)
        np.negative(r, out=r)
        _without_rigid(r, modes, c)
        z = problem.precondition(r)
        z *= c
        _without_rigid(z, modes, c)
        slope = float(np.vdot(r, z))
        beta = max(0.0, (slope - float(np.vdot(r_old, z))) / slope_old) if r_old is not None and slope_old > 0 else 0.0
        r_old, slope_old = r, slope
        direction *= beta
        direction *= c
        direction += z
        if beta > 0:
            _without_rigid(direction, modes, c)
        response = problem.apply(direction)
        curvature = float(np.vdot(direction, response))
        if not curvature > 0:
            break
        step = float(np.vdot(r, direction)) / curvature
        p += step * direction
        if float(p.min()) < 0:
            np.maximum(p, 0, out=p)
            c = (p > 0).astype(p.dtype)
            if len(modes):
                p = enforce_forces(p, modes, problem.forces)
            g = problem.apply(p)
            g += problem.separation
        else:
            response *= step
            g += response
    return BoxState(p, g, rigid, residual)
