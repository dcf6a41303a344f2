"""Preconditioned conjugate gradients for ``p >= 0, g(p) >= 0, p g = 0`` on one box, with prescribed forces.

The iteration reduces the gap of the loaded cells to zero. It releases cells with tension and loads cells that overlap.
Rigid modes with prescribed force are eliminated: search directions have no resultant force, and the rigid displacement
is the least-squares fit of the gap over the loaded cells.

References
----------
I. A. Polonsky, L. M. Keer, Wear 231 (1999) 206 (active set inside the iteration).
E. A. H. Vollebregt, J. Tribol. 136 (2014) 041402 (bound-constrained CG with an FFT-based preconditioner).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from eigencontact.core.array_types import Array
from eigencontact.solvers.rigid import RigidModes, dot
from eigencontact.solvers.sweeps import Sweeps

__all__ = ["BoxProblem", "BoxState", "relative", "solve_box"]

# Iterations without a reduction of the best residual by half, after which cells only alternate between loaded and free.
_STALLED = 60


@dataclass(frozen=True, slots=True)
class BoxProblem:
    """Contact problem on one box, in dimensionless units of order one.

    Attributes
    ----------
    apply : callable
        Displacement of a pressure.
    precondition : callable
        Pressure correction for a gap residual; symmetric positive definite.
    separation : (ny, nx) array
        Separation minus the prescribed rigid displacements.
    modes : RigidModes
        Rigid modes with prescribed force.
    forces : (m,) array
        Forces of these modes: ``sum(mode * p)``.
    share : (ny, nx) array, optional
        Weight of each loaded cell in a rigid motion, 1 by default; cells on soft springs have less.
    least_deflection : float
        Smallest reference of gaps; the usual reference is the largest deflection of loaded cells.
    energy : callable, optional
        Approximate sum of a pressure times its displacement. With it the iteration selects the cells to release before
        it computes the displacement of a step; a step then needs one displacement instead of two.
    threads : int
        Cores for the operations on fields; the result does not depend on them.
    """

    apply: Callable[[Array], Array]
    precondition: Callable[[Array], Array]
    separation: Array
    modes: RigidModes
    forces: Array
    share: Array | None = None
    least_deflection: float = 0.0
    energy: Callable[[Array], float] | None = None
    threads: int = 1


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
    """Iterate until the relative residual on the box meets the tolerance, stalls, or the iterations are used up.

    Parameters
    ----------
    pressure : (ny, nx) array
        Start, positive in loaded cells. The solver overwrites it.
    loaded : (ny, nx) bool array
        Loaded cells of the start; they may have zero pressure.
    on_iteration : callable
        Called with the residual of each iteration. If no pressure on the box can carry the moments to the tolerance,
        the residual of the result is the relative part of the moments that is missing.
    """
    return _Iteration(problem, pressure, loaded).run(tolerance, max_iterations, on_iteration)


class _Iteration:
    """Fields of one solution, processed in blocks of rows that fit into the cache."""

    def __init__(self, problem: BoxProblem, pressure: Array, loaded: Array) -> None:
        self.problem, self.modes, self.dtype = problem, problem.modes, pressure.dtype
        self.sweep = Sweeps(pressure.shape, problem.threads, self.dtype)
        self.parts = [self.modes.of_rows(rows) for rows in self.sweep.blocks]
        self.p = self.modes.carry(pressure, problem.forces) if len(self.modes) else pressure.copy()
        self.c = loaded.astype(bool)
        if not self.modes.carries(self.p, problem.forces):  # too few cells for the moments: use all cells
            self.p, self.c = self.modes.carry(np.ones_like(pressure), problem.forces), np.ones_like(self.c)
        self.trial = pressure if self.p is not pressure else np.empty_like(pressure)
        self.r, self.r_old = np.empty_like(self.p), np.zeros_like(self.p)
        self.direction = np.empty_like(self.p)
        self.z = self.r  # of the preconditioner, later the change of the pressure in a step
        self.g = problem.apply(self.p)
        self.deflection, self.gram, self.projection = 0.0, np.zeros((0, 0)), np.zeros(0)
        self.gauge(problem.separation)

    def weight(self, rows: slice, out: Array) -> Array:
        """Weight of each cell of some rows in a rigid motion."""
        out[:] = self.c[rows]
        if self.problem.share is not None:
            out *= self.problem.share[rows]
        return out

    def gauge(self, more: Array, factor: float = 1.0) -> None:
        """Add to the gap; return the largest deflection of loaded cells, and the sums for the rigid displacements."""

        def measure_block(k: int, rows: slice) -> tuple[float, Array, Array]:
            gap, modes, (work, weight) = self.g[rows], self.parts[k], self.sweep.scratch(k)
            gap += more[rows] if factor == 1.0 else np.multiply(more[rows], self.dtype.type(factor), out=work)
            np.subtract(gap, self.problem.separation[rows], out=work)
            work *= self.c[rows]
            largest = float(work.max())
            self.weight(rows, weight)
            return largest, modes.project(np.multiply(gap, weight, out=work)), modes.gram(weight)

        largest, projections, grams = zip(*self.sweep(measure_block), strict=True)
        self.deflection, self.projection, self.gram = max(largest), sum(projections), sum(grams)

    def judge(self, rigid: Array, least: float) -> tuple[float, float]:
        """Evaluate gaps of the loaded cells; unloaded cells that overlap by at least `least` become loaded.

        Returns the largest overlap of unloaded cells, and the largest gap of loaded cells.
        """

        def judge_block(k: int, rows: slice) -> tuple[float, float, Array, Array]:
            modes, loaded, r, (outside, weight) = self.parts[k], self.c[rows], self.r[rows], self.sweep.scratch(k)
            np.subtract(modes.combine(rigid, self.dtype), self.g[rows], out=outside)  # overlap positive
            np.multiply(outside, loaded, out=r)
            outside -= r
            overlap, inside = float(outside.max()), max(float(r.max()), -float(r.min()))
            if overlap > 0 and overlap >= least:
                np.maximum(outside, 0, out=outside)
                if least > 0:
                    outside[outside < least] = 0
                r += outside
                loaded |= outside > 0
            self.weight(rows, weight)
            weighed = r if self.problem.share is None else np.multiply(r, weight, out=outside)
            return overlap, inside, modes.project(weighed), modes.gram(weight)

        overlaps, insides, projections, grams = zip(*self.sweep(judge_block), strict=True)
        self.projection, self.gram = sum(projections), sum(grams)
        return max(overlaps), max(insides)

    def level(self) -> None:
        """Subtract the rigid part from the gaps of the loaded cells."""
        if len(self.modes):
            amounts = self.modes.amounts(self.gram, self.projection)

            def level_block(k: int, rows: slice) -> None:
                r = self.r[rows]
                r -= self.parts[k].combine(amounts, self.dtype)
                r *= self.c[rows]

            self.sweep(level_block)

    def products(self) -> tuple[float, float]:
        """Restrict the correction to the loaded cells; return its products with the present and previous gaps."""

        def block_products(_: int, rows: slice) -> tuple[float, float]:
            z = self.z[rows]
            z *= self.c[rows]
            return dot(self.r[rows], z), dot(self.r_old[rows], z)

        new, old = zip(*self.sweep(block_products), strict=True)
        return sum(new), sum(old)

    def turn(self, beta: float) -> float:
        """Set the next search direction, without resultant forces; return its product with the gaps."""

        def project_block(k: int, rows: slice) -> Array:
            d = self.direction[rows]
            if beta > 0:
                d *= self.dtype.type(beta)
                d *= self.c[rows]
                d += self.z[rows]
            else:
                d[:] = self.z[rows]
            return self.parts[k].project(d)

        projection = np.sum(self.sweep(project_block), axis=0)
        amounts = self.modes.amounts(self.gram, projection) if len(self.modes) else projection

        def correct_block(k: int, rows: slice) -> float:
            d, (work, weight) = self.direction[rows], self.sweep.scratch(k)
            if len(self.modes):
                self.weight(rows, weight)
                d -= np.multiply(self.parts[k].combine(amounts, self.dtype), weight, out=work)
            return dot(self.r[rows], d)

        return sum(self.sweep(correct_block))

    def go(self, step: float) -> tuple[float, Array]:
        """Set `trial` to the pressure after a step, zero instead of tension; return its minimum before, and forces."""

        def step_block(k: int, rows: slice) -> tuple[float, Array]:
            stepped = np.multiply(self.direction[rows], self.dtype.type(step), out=self.trial[rows])
            stepped += self.p[rows]
            least = float(stepped.min())
            if least < 0:
                np.maximum(stepped, 0, out=stepped)
            return least, self.parts[k].project(stepped)

        least, forces = zip(*self.sweep(step_block), strict=True)
        return min(least), sum(forces)

    def carry(self, forces: Array) -> bool:
        """Scale `trial` from the present to the prescribed forces; False if no positive pressure has them."""
        factor = self.modes.factor(forces, self.problem.forces)
        if factor is None:
            self.trial = self.modes.carry(self.trial, self.problem.forces)
            return self.modes.carries(self.trial, self.problem.forces)
        self.trial *= self.dtype.type(factor)
        return True

    def release(self, descent: float) -> bool | None:
        """Take a step without the cells that would have tension, selected before the displacement of the step is known.

        Returns None if no cell would have tension, and False if the other cells cannot carry the forces or the energy
        was inaccurate.
        """
        problem = self.problem
        assert problem.energy is not None
        curvature = problem.energy(self.direction)
        if not curvature > 0:
            return None
        least, forces = self.go(descent / curvature)
        if least >= 0:
            return None
        if not self.carry(forces):
            return False
        self.sweep(lambda _, rows: np.subtract(self.trial[rows], self.p[rows], out=self.z[rows]))
        response = problem.apply(self.z)
        sums = self.sweep(lambda _, rows: (dot(self.r[rows], self.z[rows]), dot(self.z[rows], response[rows])))
        if sum(gain for gain, _ in sums) < 0.5 * sum(cost for _, cost in sums):
            return False
        self.p, self.trial = self.trial, self.p
        self.hold()
        self.gauge(response)
        return True

    def hold(self) -> None:
        """Set the loaded cells to those under pressure."""
        np.greater(self.p, 0, out=self.c)

    def run(self, tolerance: float, max_iterations: int, on_iteration: Callable[[float], None]) -> BoxState:
        """See `solve_box`."""
        problem, modes = self.problem, self.modes
        careful, releasing = False, problem.energy is not None
        best, since, slope_old = np.inf, 0, 0.0
        state = BoxState(self.p, np.zeros(len(modes)), np.inf)
        for _ in range(max_iterations):
            state.pressure = self.p
            state.rigid = modes.amounts(self.gram, self.projection) if len(modes) else state.rigid
            self.r, self.r_old = self.r_old, self.r
            overlap, inside = self.judge(state.rigid, np.inf if careful else 0.0)
            state.residual = relative(max(inside, overlap), max(self.deflection, problem.least_deflection))
            on_iteration(state.residual)
            if state.residual <= tolerance:
                short = modes.shortage(self.p, problem.forces)
                if short > tolerance:  # no pressure on this box carries the moments; other forces close its gaps
                    state.residual = short
                break
            best, since = (state.residual, 0) if state.residual < 0.5 * best else (best, since + 1)
            if since >= _STALLED:
                break
            if careful and overlap > 10 * inside:
                self.judge(state.rigid, overlap)
            # The gaps then have no resultant on the loaded cells, so the products with them do not contain the rigid
            # part of z.
            self.level()
            del self.z  # the step reuses its memory
            self.z = problem.precondition(self.r)
            slope, crossed = self.products()
            beta = max(0.0, (slope - crossed) / slope_old) if slope_old > 0 else 0.0
            slope_old = slope
            descent = self.turn(beta)
            if careful and descent <= 0:  # on the new set of loaded cells the old direction is no descent
                descent = self.turn(0.0)
            if releasing and not careful:
                released = self.release(descent)
                releasing = released is not None
                if released:
                    continue
            response = problem.apply(self.direction)
            curvature = dot(self.direction, response)
            if not curvature > 0:
                break
            step = descent / curvature
            least, forces = self.go(step)
            if least >= 0:
                self.p, self.trial = self.trial, self.p
                self.gauge(response, step)
                del response
                continue
            # Cells with tension are released, and the gap is computed again.
            releasing = problem.energy is not None
            del self.g, response
            if self.carry(forces):
                self.p, self.trial = self.trial, self.p
                self.hold()
            else:  # too few cells for the moments: step to the first zero pressure, release this cell
                careful = True
                pulls = self.p + self.dtype.type(step) * self.direction < 0
                room = np.where(pulls, self.p / np.where(pulls, -self.direction, 1), np.inf)
                self.p = np.maximum(self.p + room.min() * self.direction, 0)
                first = room <= room.min()
                self.p[first] = 0
                self.c[first] = False
                slope_old = 0.0
            self.g = problem.apply(self.p)
            self.gauge(problem.separation)
        return state


def relative(worst: float, deflection: float) -> float:
    """Residual of a box: gaps relative to the largest deflection of loaded cells.

    `BoxProblem.least_deflection` is a lower bound of the reference: a periodic body has no deflection under a uniform
    pressure.
    """
    if deflection > 0:
        return max(worst, 0.0) / deflection
    return float("inf") if worst > 0 else 0.0
