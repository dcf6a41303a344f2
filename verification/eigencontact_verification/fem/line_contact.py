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
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import block_diag, csc_matrix, csr_matrix, diags
from scipy.sparse.linalg import splu

from eigencontact_verification.fem.line_contact_model import LineBody, LineContact, LineStep, PlaneRegion
from eigencontact_verification.fem.line_half_plane import HalfPlane
from eigencontact_verification.fem.plane_recovery import recovered_plane
from eigencontact_verification.fem.plane_strain import PlaneBody
from eigencontact_verification.fem.yielding_law import State

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

#: Largest force that may be left at an unknown, as a part of the load; iterations; times that a step may be halved.
_LEFT, _ITERATIONS, _HALVINGS = 1e-9, 30, 5
#: Factors of the stiffness of the contact by which an increment is approached where the whole one fails.
_SOFTER = (1e-3, 3e-2, 1.0)
#: Stiffness of contact and stick in contact moduli over the size of the fine elements.
_STIFF = 1e4


@dataclass(frozen=True, kw_only=True, eq=False)
class LineMoment:
    """The bodies at the end of an increment.

    Attributes
    ----------
    step : LineStep
    pressure, shear, slip : (n,) float64
        At `LineSolution.x`: on body 1; slip of body 2 over body 1 since they touched [Pa, Pa, m].
    stick : (n,) bool
        Nodes in contact that the last increment did not shift.
    displacement : (unknowns + 2,) float64
        What the bodies keep (`HalfPlane`); last the rigid motion of body 2 into and along body 1.
    stresses : tuple of (4, elements, 9) float64 or None
        xx, yy, zz, sqrt2 xz at the integration points of each body; None of an elastic one.
    states : tuple
        What the laws remember, by body.
    iterations : int
        Linear systems solved for it.
    increments : int
        Into which the step was parted because the whole had no solution; 1 if it was not.
    """

    step: LineStep
    pressure: FloatArray
    shear: FloatArray
    slip: FloatArray
    stick: NDArray[np.bool_]
    displacement: FloatArray
    stresses: tuple[FloatArray | None, ...] = field(repr=False)
    states: tuple[tuple[State, ...], ...] = field(repr=False)
    iterations: int = 0
    increments: int = 1


@dataclass(frozen=True, kw_only=True, eq=False)
class LineSolution:
    """Everything after each step.

    Attributes
    ----------
    model : LineContact
    halves : tuple of HalfPlane
    x, weight : (n,) float64
        Nodes of the surface where contact is looked for, ascending, and their shares of its length [m].
    moments : tuple of LineMoment
        One for each step that was asked for.
    seconds : float
    """

    model: LineContact
    halves: tuple[HalfPlane, ...]
    x: FloatArray
    weight: FloatArray
    moments: tuple[LineMoment, ...]
    seconds: float

    @property
    def bodies(self) -> tuple[PlaneBody, ...]:
        """Meshes of the bodies."""
        return tuple(half.body for half in self.halves)

    def stress(self, points: ArrayLike, moment: int = -1, body: int = 1) -> FloatArray:
        """Stress xx, yy, zz, xz (4, n) at points (x, z), (n, 2), z into body 1 or upwards into body 2 [Pa].

        Of body 2 in the axes of body 1: its xz changes sign, because its z points the other way.
        """
        half, now, points = self.halves[body - 1], self.moments[moment], np.asarray(points, dtype=float)
        values = now.stresses[body - 1]
        if values is None:
            start = sum(len(other.kept) for other in self.halves[: body - 1])
            values = half.stress(now.displacement[start : start + len(half.kept)], now.step)
        material = half.material
        found = recovered_plane(half.body, values, points, breaks=material.breaks(), side=material.side)
        found[3] *= (1 if body == 1 else -1) / np.sqrt(2.0)
        return found

    def plastic_strain(self, points: ArrayLike, moment: int = -1, body: int = 1) -> FloatArray:
        """Equivalent plastic strain (n,) at points (x, z), (n, 2)."""
        mesh = self.bodies[body - 1]
        return mesh.read(mesh.of_state(self.moments[moment].states[body - 1]), points)

    def contact(self, moment: int = -1) -> tuple[float, float]:
        """Ends of the contact: where the squared pressure of the last nodes inside, with straight lines, is zero."""
        return self._ends(self.moments[moment].pressure ** 2)

    def stick(self, moment: int = -1) -> tuple[float, float]:
        """Ends of the stick zone, where ``(friction p - |q|)²`` is zero (a root's distance from full friction)."""
        now = self.moments[moment]
        return self._ends(np.where(now.stick, self.model.friction * now.pressure - np.abs(now.shear), 0.0) ** 2)

    def _ends(self, value: FloatArray) -> tuple[float, float]:
        """Where a function that is positive between two places and straight beside them rises from 0 and falls to 0."""
        inside = np.flatnonzero(value > 0)
        if inside.size < 4:
            return (float(self.x[inside].min(initial=0.0)), float(self.x[inside].max(initial=0.0)))
        first, last = int(inside[0]), int(inside[-1])
        ends = []
        for part, low, high in (
            (np.s_[first : first + 4], self.x[max(first - 1, 0)], self.x[first]),
            (np.s_[last - 3 : last + 1], self.x[last], self.x[min(last + 1, len(self.x) - 1)]),
        ):
            slope, start = np.polyfit(self.x[part] - self.x[first], value[part], 1)
            ends.append(float(np.clip(self.x[first] - start / slope, low, high)))
        return ends[0], ends[1]


def solve_line_contact(model: LineContact, steps: Sequence[LineStep]) -> LineSolution:
    """Follow one step after another, each an increment of backward Euler.

    Parameters
    ----------
    model : LineContact
        What touches.
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
    """Unknowns are those that the first body keeps, those of the second, the depth d and the shift s."""

    model: LineContact
    halves: tuple[HalfPlane, ...]
    largest: float
    spent: int = 0

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
    def parts(self) -> list[slice]:
        """Places of the unknowns of each body among all."""
        ends = np.cumsum([0, *(len(half.kept) for half in self.halves)])
        return [slice(*map(int, pair)) for pair in pairwise(ends)]

    @property
    def size(self) -> int:
        return sum(len(half.kept) for half in self.halves) + 2

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
        columns = [part.start + half.surface[which] for part, half in zip(self.parts, self.halves, strict=True)]
        values = np.repeat([*signs[:bodies], 1.0], n)
        rows = np.tile(np.arange(n), bodies + 1)
        columns.append(np.full(n, self.size + rigid))
        return csr_matrix((values, (rows, np.concatenate(columns))), shape=(n, self.size))

    def follow(self, steps: Sequence[LineStep]) -> Iterator[LineMoment]:
        none = np.zeros(len(self.x))
        now = LineMoment(
            step=LineStep(normal=0.0),
            pressure=none,
            shear=none,
            slip=none,
            stick=none > 0,
            displacement=np.zeros(self.size),
            stresses=(None,) * len(self.halves),
            states=tuple(half.body.rest() for half in self.halves),
        )
        if any(np.any(half.body.prestrain) for half in self.halves):
            now = self.advance(now, now.step)
        for step in steps:
            self.spent = 0
            now = self.advance(now, step)
            if now.pressure[0] or now.pressure[-1]:
                raise ValueError(f"line contact window must hold the contact (got {self.model.window}); widen it")
            yield now

    def advance(self, before: LineMoment, step: LineStep, halvings: int = _HALVINGS) -> LineMoment:
        found = self.newton(before, step) or self.approached(before, step)
        if found is not None:
            return found
        if not halvings:
            raise ArithmeticError(
                f"line contact must have a solution between {before.step} and {step} (got none in {_ITERATIONS} "
                "iterations); take smaller increments"
            )
        half = _between(before.step, step)
        first = self.advance(before, half, halvings - 1)
        second = self.advance(first, step, halvings - 1)
        return replace(second, increments=first.increments + second.increments)

    def approached(self, before: LineMoment, step: LineStep) -> LineMoment | None:
        """The whole increment by way of softer contacts, if need be at a part of its loads; None if it fails.

        From a poor start, nodes at the edge come and go for ever, or points yield that should not.
        """
        whole = self.stiffened(before, step, before)
        part = None if whole else self.stiffened(before, _between(before.step, step), before)
        return self.stiffened(before, step, part) if part else whole

    def stiffened(self, before: LineMoment, step: LineStep, start: LineMoment) -> LineMoment | None:
        found: LineMoment | None = start
        for softer in _SOFTER:
            found = found and self.newton(before, step, found, softer)
        return found

    def newton(
        self, before: LineMoment, step: LineStep, start: LineMoment | None = None, softer: float = 1.0
    ) -> LineMoment | None:
        """Newton's iteration on the semi-smooth equations, by default from `before`; None where it does not converge.

        `softer` is a factor of the stiffness of the contact.
        """
        start = start or before
        u = start.displacement.copy()
        for part, half in zip(self.parts, self.halves, strict=True):
            u[part] += half.moved(start.step, step)
        gap, loads = self.gap(step), [half.load(step) for half in self.halves]
        if step.normal and not start.step.normal:
            u[-2] = self.first_depth(u, step.normal, gap)
        loose = [half.free for half in self.halves]
        free = np.flatnonzero(np.concatenate((*loose, [step.normal > 0, self.rubs and step.normal > 0])))
        scale = self.largest or max(np.abs(step.bulk)) * self.model.fine or 1.0
        slides = np.zeros(len(self.x))  # a turn of the load begins with stick everywhere
        moved = step.place - start.step.place
        touched = np.interp(self.x - moved, self.x, start.pressure, 0.0, 0.0) > 0 if moved else None
        for tried in range(_ITERATIONS):
            try:
                inner = [
                    half.answer(u[part], states, load)
                    for part, half, states, load in zip(self.parts, self.halves, before.states, loads, strict=True)
                ]
            except ArithmeticError:
                return None
            p, q, slip, slopes, slides = self.tractions(
                u, gap, before.slip, slides, softer if step.normal else 0.0, touched if np.any(touched) else None
            )
            touched = None
            rest = np.concatenate([*(-force for force, *_ in inner), [step.normal, step.shear]])
            rest -= self.overlaps.T @ (self.weight * p) + self.shifts.T @ (self.weight * q)
            rest = rest[free]
            bounded = np.all(np.abs(q) <= self.model.friction * p * (1 + 1e-12))
            if tried and bounded and np.abs(rest).max() <= _LEFT * scale:
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
                    iterations=self.spent,
                )
            if step.normal and not np.any(p):
                return None
            self.spent += 1
            normal, shear, cross = (diags(self.weight * slope) for slope in slopes)
            springs = self.overlaps.T @ normal @ self.overlaps
            springs = springs + self.shifts.T @ (shear @ self.shifts + cross @ self.overlaps)
            try:
                u[free] += self.solved([matrix for _, matrix, _, _ in inner], springs, free, rest)
            except (RuntimeError, np.linalg.LinAlgError):  # every node slips: the halved step keeps some that stick
                return None
            if not np.all(np.isfinite(u)):
                return None
        return None

    def solved(self, matrices: list[Any], springs: csr_matrix, free: IntArray, rest: FloatArray) -> FloatArray:
        """Step (free,) of Newton's iteration; dense where no body keeps what lies inside."""
        if self.elastic:
            dense = springs.toarray()
            for part, matrix in zip(self.parts, matrices, strict=True):
                dense[part, part] += matrix
            return np.linalg.solve(dense[np.ix_(free, free)], rest)
        whole = block_diag([*map(csc_matrix, matrices), csc_matrix((2, 2))], format="csr") + springs
        factors = splu(whole[free][:, free].tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.01)
        return np.asarray(factors.solve(rest))

    @property
    def elastic(self) -> bool:
        return all(half.material.elastic for half in self.halves)

    @property
    def rubs(self) -> bool:
        return self.model.friction > 0

    def tractions(
        self,
        u: FloatArray,
        gap: FloatArray,
        slip: FloatArray,
        slides: FloatArray,
        softer: float,
        touched: NDArray[np.bool_] | None,
    ) -> tuple[FloatArray, FloatArray, FloatArray, tuple[FloatArray, FloatArray, FloatArray], FloatArray]:
        """Pressure, shear, slip, the slopes of pressure by overlap, of shear by shift and by overlap, and what slides.

        `slides` is the sign of the slip of each node, 0 where it sticks. From one iteration to the next a node that
        would turn from one sign to the other sticks in between, beyond the bound if need be: with stiff springs the
        iteration would go to and fro for ever. `touched`, where a gap has travelled, takes these nodes as in contact.
        """
        k, mu = self.stiffness, self.model.friction
        stiff, overlap = softer * k, self.overlaps @ u - gap
        touched = overlap > 0 if touched is None else touched
        p = np.where(touched, stiff * overlap, 0.0)
        shift = self.shifts @ u
        trial = k * (shift - slip)
        now = np.where(np.abs(trial) > mu * p, np.sign(trial), 0.0)
        now[(now * slides < 0) & (p > 0)] = 0.0
        touched, sticks = p != 0, (now == 0) & self.rubs
        q = np.where(touched, np.where(sticks, trial, mu * p * now), 0.0)
        after = np.where(sticks & touched, slip, shift - q / k)
        slopes = (
            np.asarray(stiff * touched),
            np.asarray(k * (sticks & touched)),
            np.asarray(mu * stiff * touched * now),
        )
        return np.asarray(p), q, after, slopes, now

    def first_depth(self, u: FloatArray, load: float, gap: FloatArray) -> float:
        """Depth whose overlap with the undeformed surface is about as wide as the contact: exact for a parabola."""
        height = gap - self.overlaps @ np.append(u[:-2], (0.0, 0.0))
        for depth in np.unique(height)[1:]:
            over = np.maximum(0.0, depth - height)
            width = self.weight[over > 0].sum() / 2
            if 3 * np.pi / 8 * self.model.contact_modulus * (self.weight @ over) / width >= load:
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
