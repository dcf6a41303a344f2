"""Contact along a line with friction, solved by finite elements of both bodies: load control, implicit steps, Newton.

Surface nodes of the two meshes face each other (small displacement). With the overlap
``o = d - g(x) - u_z1 - u_z2`` and the relative shift ``t = s + u_x2 - u_x1``, d and s being the rigid motion of body 2,
the pressure is a stiff spring, ``p = max(0, k o)``, and the shear on body 1 a stiff spring that gives way,
``q = k (t - slip)`` within ``|q| <= friction p``: a return mapping along the line, implicit as that of the plastic
strain. Forces at nodes are those of Simpson's rule, as in `yielding_contact`. No influence coefficient enters: forces
per length reach the surface by the equilibrium of d and s, and the far boundary by Flamant's field.
"""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import block_diag, csc_matrix, csr_matrix, diags
from scipy.sparse.linalg import splu

from eigencontact_verification.fem.line_contact_model import LineBody, LineContact, LineStep, PlaneRegion
from eigencontact_verification.fem.line_half_plane import HalfPlane
from eigencontact_verification.fem.line_solution import LineMoment, LineSolution

__all__ = [
    "LineBody",
    "LineContact",
    "LineMoment",
    "LineSolution",
    "LineStep",
    "PlaneRegion",
    "solve_line_contact",
]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

#: Largest residual force at an unknown over the load; largest numbers of iterations and of halvings of a step.
_RESIDUAL, _ITERATIONS, _HALVINGS = 1e-9, 30, 5
#: An iteration diverges where a step exceeds the first one by this factor. Without this rule the laws are solved at
#: strains of 1e98 before the iterations are used up: 70 s in place of 2 s.
_DIVERGES = 100.0
#: The residual must fall by half within this number of iterations: nodes at the end of stick, or points at the border
#: of the plastic zone, can alternate without end.
_PATIENCE = 8
#: Stiffness of contact and stick in contact moduli over the size of the fine elements.
_STIFF = 1e4


def solve_line_contact(model: LineContact, steps: Sequence[LineStep]) -> LineSolution:
    """Solve the steps in order, each as an increment of backward Euler.

    Parameters
    ----------
    model : LineContact
        Bodies and gap.
    steps : sequence of LineStep
        Loads at the end of each increment.

    Raises
    ------
    ValueError
        Loads that cannot be carried (`LineContact.check`), or contact that reaches the ends of the window.
    ArithmeticError
        An increment has no solution although it was halved five times.

    Examples
    --------
    >>> flat = LineBody(young_modulus=0.91, poisson_ratio=0.3)  # contact modulus 1
    >>> model = LineContact(bodies=(flat,), gap=lambda x: x**2 / 2, window=(-1.5, 1.5), fine=0.25, reach=50.0)
    >>> hertz = solve_line_contact(model, [LineStep(normal=np.pi / 4)])
    >>> round(float(hertz.moments[0].pressure.max()), 2)
    0.5
    """
    start = time.perf_counter()
    steps = tuple(steps)
    model.check(steps)
    halves = tuple(HalfPlane(model=model, number=k, body=body) for k, body in enumerate(model.meshed()))
    solver = _Solver(model=model, halves=halves, largest=max((step.normal for step in steps), default=0.0))
    moments = tuple(solver.follow(steps))
    seconds = time.perf_counter() - start
    x, weight = solver.x, solver.weight
    return LineSolution(model=model, halves=halves, x=x, weight=weight, moments=moments, seconds=seconds)


@dataclass(kw_only=True, eq=False)
class _Solver:
    """Solver with the unknowns of body 1, those of body 2, the depth d and the shift s."""

    model: LineContact
    halves: tuple[HalfPlane, ...]
    largest: float
    iterations: int = 0

    @property
    def weight(self) -> FloatArray:
        return self.halves[0].facets[0]

    @property
    def x(self) -> FloatArray:
        return self.halves[0].x

    def gap(self, step: LineStep) -> FloatArray:
        return np.asarray(self.model.gap(self.x - step.place), dtype=float)

    @cached_property
    def stiffness(self) -> float:
        return _STIFF * self.model.contact_modulus * self.model.divisions / self.model.fine

    @cached_property
    def places(self) -> list[slice]:
        """Places of the unknowns of each body among those of the solver."""
        ends = np.cumsum([0, *(len(half.unknowns) for half in self.halves)])
        return [slice(*map(int, pair)) for pair in pairwise(ends)]

    @property
    def size(self) -> int:
        return sum(len(half.unknowns) for half in self.halves) + 2

    @cached_property
    def overlaps(self) -> csr_matrix:
        """Overlap of each node by the unknowns, without the gap."""
        return self._relative(0, (-1.0, -1.0), -2)

    @cached_property
    def shifts(self) -> csr_matrix:
        """Relative shift of each node by the unknowns."""
        return self._relative(1, (-1.0, 1.0), -1)

    def _relative(self, which: int, signs: tuple[float, float], rigid: int) -> csr_matrix:
        n, bodies = len(self.x), len(self.halves)
        columns = [place.start + half.surface[which] for place, half in zip(self.places, self.halves, strict=True)]
        values = np.repeat([*signs[:bodies], 1.0], n)
        rows = np.tile(np.arange(n), bodies + 1)
        columns.append(np.full(n, self.size + rigid))
        return csr_matrix((values, (rows, np.concatenate(columns))), shape=(n, self.size))

    def follow(self, steps: Sequence[LineStep]) -> Iterator[LineMoment]:
        zeros = np.zeros(len(self.x))
        now = LineMoment(
            step=LineStep(normal=0.0),
            pressure=zeros,
            shear=zeros,
            slip=zeros,
            stick=zeros > 0,
            displacement=np.zeros(self.size),
            stresses=(None,) * len(self.halves),
            states=tuple(half.body.state_at_rest() for half in self.halves),
        )
        if any(np.any(half.body.prestrain) for half in self.halves):
            now = self.advance(now, now.step)
        for step in steps:
            self.iterations = 0
            now = self.advance(now, step)
            if now.pressure[0] or now.pressure[-1]:
                raise ValueError(f"line contact window must hold the contact (got {self.model.window}); widen it")
            yield now

    def advance(self, before: LineMoment, step: LineStep, halvings: int = _HALVINGS) -> LineMoment:
        """Whole increment if possible; where the iteration fails, two halves give a better start of the whole."""
        solution = self.newton(before, step)
        if solution is not None:
            return solution
        if not halvings:
            raise ArithmeticError(
                f"line contact must have a solution between {before.step} and {step} (got none in {_ITERATIONS} "
                "iterations); take smaller increments"
            )
        half = _between(before.step, step)
        first = self.advance(before, half, halvings - 1)
        second = self.advance(first, step, halvings - 1)
        whole = self.newton(before, step, second)
        return whole or replace(second, increments=first.increments + second.increments)

    def newton(self, before: LineMoment, step: LineStep, start: LineMoment | None = None) -> LineMoment | None:
        """Newton's iteration on the semi-smooth equations, by default from `before`; None if it does not converge."""
        start = start or before
        u = start.displacement.copy()
        for place, half in zip(self.places, self.halves, strict=True):
            u[place] += half.boundary_change(start.step, step)
        gap, loads = self.gap(step), [half.load(step) for half in self.halves]
        if step.normal and not start.step.normal:
            u[-2] = self.first_depth(u, step.normal, gap)
        movable = [half.free for half in self.halves]
        free = np.flatnonzero(np.concatenate((*movable, [step.normal > 0, self.has_friction and step.normal > 0])))
        scale = self.largest or max(np.abs(step.bulk)) * self.model.fine or 1.0
        slides = np.sign(start.slip - before.slip)  # from `before`: a turn of the load begins with stick everywhere
        travel = step.place - start.step.place
        touched = np.interp(self.x - travel, self.x, start.pressure, 0.0, 0.0) > 0 if travel else None
        first_step, residuals = np.inf, []
        for iteration in range(_ITERATIONS):
            try:
                inner = [
                    half.answer(u[place], states, load)
                    for place, half, states, load in zip(self.places, self.halves, before.states, loads, strict=True)
                ]
            except ArithmeticError:
                return None
            p, q, slip, slopes, slides = self.tractions(
                u, gap, before.slip, slides, self.stiffness * bool(step.normal), touched if np.any(touched) else None
            )
            touched = None
            residual = np.concatenate([*(-force for force, *_ in inner), [step.normal, step.shear]])
            residual -= self.overlaps.T @ (self.weight * p) + self.shifts.T @ (self.weight * q)
            residual = residual[free]
            bounded = np.all(np.abs(q) <= self.model.friction * p * (1 + 1e-12))
            if iteration and bounded and np.abs(residual).max() <= _RESIDUAL * scale:
                slipped = np.abs(slip - before.slip) > 0
                return LineMoment(
                    step=step,
                    pressure=p,
                    shear=q,
                    slip=slip,
                    stick=(p > 0) & ~slipped,
                    displacement=u,
                    stresses=tuple(stress for *_, stress in inner),
                    states=tuple(states for _, _, states, _ in inner),
                    iterations=self.iterations,
                )
            if step.normal and not np.any(p):
                return None
            self.iterations += 1
            normal, shear, cross = (diags(self.weight * slope) for slope in slopes)
            springs = self.overlaps.T @ normal @ self.overlaps
            springs = springs + self.shifts.T @ (shear @ self.shifts + cross @ self.overlaps)
            try:
                change = self.newton_step([matrix for _, matrix, _, _ in inner], springs, free, residual)
            except (RuntimeError, np.linalg.LinAlgError):  # every node slips; in a halved step some nodes stick
                return None
            step_size = np.abs(change).max()
            if not step_size <= _DIVERGES * first_step or not np.isfinite(step_size):
                return None
            if not iteration:
                first_step = step_size
            residuals.append(np.abs(residual).max())
            if iteration >= _PATIENCE and residuals[-1] > residuals[-1 - _PATIENCE] / 2:
                return None
            u[free] += change
        return None

    def newton_step(self, matrices: list[Any], springs: csr_matrix, free: IntArray, residual: FloatArray) -> FloatArray:
        """Step (free,) of Newton's iteration; dense where both bodies are condensed."""
        if self.elastic:
            dense = springs.toarray()
            for place, matrix in zip(self.places, matrices, strict=True):
                dense[place, place] += matrix
            return np.linalg.solve(dense[np.ix_(free, free)], residual)
        stiffness = block_diag([*map(csc_matrix, matrices), csc_matrix((2, 2))], format="csr") + springs
        factors = splu(stiffness[free][:, free].tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.01)
        return np.asarray(factors.solve(residual))

    @property
    def elastic(self) -> bool:
        return all(half.material.elastic for half in self.halves)

    @property
    def has_friction(self) -> bool:
        return self.model.friction > 0

    def tractions(
        self,
        u: FloatArray,
        gap: FloatArray,
        slip: FloatArray,
        slides: FloatArray,
        stiff: float,
        touched: NDArray[np.bool_] | None,
    ) -> tuple[FloatArray, FloatArray, FloatArray, tuple[FloatArray, FloatArray, FloatArray], FloatArray]:
        """Pressure, shear, slip, the slopes of pressure by overlap, of shear by shift and by overlap; sliding signs.

        `slides` is the sign of the slip of each node, 0 where it sticks. From one iteration to the next a node that
        would turn from one sign to the other sticks in between, beyond the bound if need be: with stiff springs the
        iteration would go to and fro for ever. `stiff` is the stiffness of the contact, 0 without a normal force.
        `touched`, where a gap has travelled, takes these nodes as in contact.
        """
        k, mu = self.stiffness, self.model.friction
        overlap = self.overlaps @ u - gap
        touched = overlap > 0 if touched is None else touched
        p = np.where(touched, stiff * overlap, 0.0)
        shift = self.shifts @ u
        trial = k * (shift - slip)
        sliding = np.where(np.abs(trial) > mu * p, np.sign(trial), 0.0)
        sliding[(sliding * slides < 0) & (p > 0)] = 0.0
        touched, sticks = p != 0, (sliding == 0) & self.has_friction
        q = np.where(touched, np.where(sticks, trial, mu * p * sliding), 0.0)
        new_slip = np.where(sticks & touched, slip, shift - q / k)
        slopes = (
            np.asarray(stiff * touched),
            np.asarray(k * (sticks & touched)),
            np.asarray(mu * stiff * touched * sliding),
        )
        return np.asarray(p), q, new_slip, slopes, sliding

    def first_depth(self, u: FloatArray, load: float, gap: FloatArray) -> float:
        """Depth whose overlap with the undeformed surface is about as wide as the contact: exact for a parabola."""
        height = gap - self.overlaps @ np.append(u[:-2], (0.0, 0.0))
        for depth in np.unique(height)[1:]:
            overlap = np.maximum(0.0, depth - height)
            width = self.weight[overlap > 0].sum() / 2
            if 3 * np.pi / 8 * self.model.contact_modulus * (self.weight @ overlap) / width >= load:
                return float(depth)
        return float(height.max())


def _between(old: LineStep, new: LineStep) -> LineStep:
    """Mean of two steps."""
    return LineStep(
        normal=(old.normal + new.normal) / 2,
        shear=(old.shear + new.shear) / 2,
        bulk=((old.bulk[0] + new.bulk[0]) / 2, (old.bulk[1] + new.bulk[1]) / 2),
        place=(old.place + new.place) / 2,
    )
