"""Contact conditions on one box if `constrained_cg` stalls: loaded cells change only after their gaps are closed.

If a body bends like a plate, as below a thin stiff layer on a soft ground, each loaded or released cell changes gaps
far away. No search direction of `constrained_cg` then lasts long enough to bend the plate. Here the conjugate gradients
for one set of loaded cells run until its gaps are closed; pressures may be negative until then. Then every cell with
tension is released, and every overlapping cell is loaded. This is a Newton iteration of the contact conditions. It
takes about ten sets of thirty to fifty iterations each, independent of the grid size.

References
----------
M. Hintermüller, K. Ito, K. Kunisch, SIAM J. Optim. 13 (2003) 865, doi:10.1137/S1052623401383558 (primal-dual active
sets as a semismooth Newton iteration).
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from eigencontact.core.array_types import Array
from eigencontact.solvers.constrained_cg import BoxProblem, BoxState, relative
from eigencontact.solvers.rigid import dot

__all__ = ["solve_settled"]

# Reduction of the gaps after which the set of loaded cells changes. On a layer of .1 a with a contrast of 1e4, 31² to
# 256² cells, 1e-3 took 9 to 12 sets and 264 to 467 iterations, 1e-2 up to 27 sets and as many iterations; 3e-2 did not
# always converge.
_SETTLED = 1e-3


def solve_settled(
    problem: BoxProblem,
    pressure: Array,
    loaded: Array,
    *,
    tolerance: float,
    max_iterations: int,
    on_iteration: Callable[[float], None],
) -> BoxState:
    """Iterate until the relative residual meets the tolerance; see `solve_box` for parameters and result.

    `pressure` has the prescribed forces, as every result of `solve_box`.
    """
    modes, dtype, share = problem.modes, pressure.dtype, problem.share
    p, c = pressure, loaded.astype(dtype)
    state = BoxState(p, np.zeros(len(modes)), np.inf)
    left = max_iterations
    while left > 0:
        g = problem.apply(p) + problem.separation
        direction, slope, first = np.zeros_like(p), 0.0, 0.0
        while left > 0:
            left -= 1
            weight = c if share is None else c * share
            state.rigid = modes.fit(g * weight, weight) if len(modes) else state.rigid
            outside = modes.combine(state.rigid, dtype) - g  # overlap positive
            r = outside * c
            outside -= r
            deflection = max(float(((g - problem.separation) * c).max()), problem.least_deflection)
            inside, overlap = float(np.abs(r).max()), float(outside.max())
            state.pressure, state.residual = p, relative(max(inside, overlap), deflection)
            on_iteration(state.residual)
            first = max(first, inside)
            if inside <= max(_SETTLED * first, 0.3 * tolerance * deflection):
                break
            if state.residual <= tolerance and p.min() >= 0:
                break
            if share is not None:
                modes.level(r, c, weight)
            z = problem.precondition(r) * c
            before, slope = slope, dot(r, z)
            direction = z + dtype.type(slope / before if before > 0 else 0.0) * direction
            if share is None:
                modes.remove(direction, c)
            else:
                modes.unload(direction, c * share)
            response = problem.apply(direction)
            curvature = dot(direction, response)
            if not curvature > 0:
                break
            step = dtype.type(dot(r, direction) / curvature)
            p, g = p + step * direction, g + step * response
        if state.residual <= tolerance and p.min() >= 0:
            break
        c = ((p > 0) | (outside > 0)).astype(dtype)
        p = np.maximum(p, 0)
        if len(modes):
            p = modes.carry(p, problem.forces)
        state.pressure = p
        if not modes.carries(p, problem.forces):  # `solve_box` has reported the missing part of the moments
            state.residual = max(state.residual, modes.shortage(p, problem.forces))
            break
    return state
