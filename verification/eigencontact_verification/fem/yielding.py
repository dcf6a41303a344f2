"""A rigid body pressed into a body of revolution that yields: load control, implicit steps, Newton's iteration.

It is a sphere, the parabola r²/2R, or has a profile of its own. The displacement is small, as in the half-space theory
that this judges. Far away the body moves as a half-space under a point force (`AxisymmetricModel.far_field`); "free"
gives it the traction of that force instead. Neither knows of the plastic strain, whose own far field falls faster by
one power of the distance.
"""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import csc_matrix, diags
from scipy.sparse.linalg import splu

from eigencontact_verification.fem.axisymmetric import point_force_displacement, point_force_traction
from eigencontact_verification.fem.yielding_body import YieldingBody
from eigencontact_verification.fem.yielding_contact import Surface, surface_of
from eigencontact_verification.fem.yielding_law import State
from eigencontact_verification.fem.yielding_model import Indentation, YieldingRegion

__all__ = ["Indentation", "IndentationSolution", "Moment", "YieldingRegion", "solve_indentation"]

FloatArray = NDArray[np.float64]

#: Largest force that may be left at an unknown, as a part of the load; iterations; times that a step may be halved.
_TOLERANCE, _ITERATIONS, _HALVINGS = 1e-9, 30, 5
#: A step overshoots where the residual along it turns and exceeds this part of what it was; shortest part of a step.
_OVERSHOT, _SHORTEST = 0.5, 0.05
#: Stiffness of the contact in Young's moduli over the size of the fine elements.
_STIFF = 1e4


@dataclass(frozen=True, kw_only=True, eq=False)
class Moment:
    """The body at the end of an increment.

    Attributes
    ----------
    load, depth : float
        Force on the sphere; its depth below the point where it touched before any load.
    contact_radius : float
    pressure, shear : (n,) float64
        At the points of `IndentationSolution.surface`; shear on the body, positive outwards.
    displacement : (unknowns,) float64
    stress : (4, elements, 9) float64
        rr, tt, zz, sqrt2 rz at the integration points.
    states : tuple
        What the laws remember.
    iterations : int
        Linear systems solved for it.
    """

    load: float
    depth: float
    contact_radius: float
    pressure: FloatArray
    shear: FloatArray
    displacement: FloatArray
    stress: FloatArray
    states: tuple[State, ...] = field(repr=False)
    iterations: int


@dataclass(frozen=True, kw_only=True, eq=False)
class IndentationSolution:
    """Everything after each load.

    Attributes
    ----------
    model : Indentation
    body : YieldingBody
    surface : Surface
    moments : tuple of Moment
        One for each load that was asked for.
    seconds : float
    """

    model: Indentation
    body: YieldingBody
    surface: Surface
    moments: tuple[Moment, ...]
    seconds: float

    def surface_displacement(self, r: ArrayLike, moment: int = -1) -> FloatArray:
        """u_z (n,) of the surface at radii (n,)."""
        r = np.asarray(r, dtype=float)
        points = np.stack((r, 0 * r), axis=1)
        return np.asarray(self.body.displacement(self.moments[moment].displacement, points)[1])

    def remembered(self, points: ArrayLike, name: str = "p", moment: int = -1) -> FloatArray:
        """One number of the state at points (r, z), (n, 2); by default equivalent plastic strain."""
        return self.body.read(self.body.of_state(self.moments[moment].states, name), points)

    def peak_plastic_strain(self, moment: int = -1) -> tuple[float, float, float]:
        """Largest equivalent plastic strain of an integration point, and its r and z."""
        values = self.body.of_state(self.moments[moment].states)
        k = np.unravel_index(values.argmax(), values.shape)
        r, z = (float(x[k]) for x in YieldingBody.points_of(self.body.grid))
        return float(values[k]), r, z

    def stress(self, points: ArrayLike, moment: int = -1) -> FloatArray:
        """Stress rr, tt, zz, rz (4, n) at points (r, z), (n, 2); each element continues its own values."""
        stress = self.body.read(self.moments[moment].stress, points)
        stress[3] /= np.sqrt(2.0)
        return stress


def solve_indentation(model: Indentation, loads: Sequence[float]) -> IndentationSolution:
    """Press with one load after another, each an increment of backward Euler.

    Parameters
    ----------
    model : Indentation
        What is pressed.
    loads : sequence of float
        Force on the sphere at the end of each increment, not negative; 0 takes it away.

    Raises
    ------
    ArithmeticError
        An increment has no solution although it was halved five times.

    Examples
    --------
    >>> steel = {"young_modulus": 1.0, "poisson_ratio": 0.3}
    >>> ball = Indentation(**steel, radius=10.0, fine=0.25, extent=1.5, reach=20.0)
    >>> found = solve_indentation(ball, [4 / 30 / 0.91])  # contact radius 1, depth a²/R
    >>> round(found.moments[0].depth, 3)
    0.1
    """
    start = time.perf_counter()
    solver = _Solver(model=model, body=model.body(), largest=max(loads, default=0.0))
    moments = tuple(solver.follow(loads))
    seconds = time.perf_counter() - start
    return IndentationSolution(model=model, body=solver.body, surface=solver.surface, moments=moments, seconds=seconds)


@dataclass(kw_only=True, eq=False)
class _Solver:
    model: Indentation
    body: YieldingBody
    largest: float
    spent: int = 0

    @cached_property
    def surface(self) -> Surface:
        model = self.model
        stiffness = _STIFF * model.young_modulus * model.divisions / model.fine
        return surface_of(
            self.body.basis, reach=model.extent, height=model.height, stiffness=stiffness, friction=model.friction
        )

    @cached_property
    def far(self) -> FloatArray:
        """Displacement of the outer boundary under a unit force, zero elsewhere."""
        basis, model = self.body.basis, self.model
        displacement = np.zeros(basis.N)
        outer = np.flatnonzero((basis.doflocs == model.reach).any(axis=0))
        point_force = point_force_displacement(1.0, model.young_modulus, model.poisson_ratio, *basis.doflocs[:, outer])
        displacement[outer] = np.where(self.body.first_component[outer], *point_force)
        return displacement

    @cached_property
    def free(self) -> NDArray[np.int64]:
        """Unknowns that nothing holds."""
        r, z = self.body.basis.doflocs
        reach, axis = self.model.reach, self.body.first_component & (r == 0)
        outer = (r == reach) | (z == reach)
        edge = (r == reach) & (z == reach) & ~self.body.first_component
        return np.flatnonzero(~(axis | (outer if self.model.outer == "fixed" else edge)))

    @cached_property
    def pull(self) -> FloatArray:
        """Force of the outer boundary's traction under a unit load, zero where the boundary is held."""
        basis, model = self.body.basis, self.model
        if model.outer == "fixed":
            return np.zeros(basis.N)
        return point_force_traction(basis, model.reach, 1.0, model.poisson_ratio)

    def follow(self, loads: Sequence[float]) -> Iterator[Moment]:
        basis = self.body.basis
        at_rest = Moment(
            load=0.0,
            depth=0.0,
            contact_radius=0.0,
            pressure=np.zeros(len(self.surface.r)),
            shear=np.zeros(len(self.surface.r)),
            displacement=np.zeros(basis.N),
            stress=np.zeros(self.body.prestrain.shape),
            states=self.body.state_at_rest(),
            iterations=0,
        )
        touch = 0.0
        if np.any(self.body.prestrain):
            at_rest = self.advance(at_rest, 0.0)
            touch = at_rest.depth
        for load in loads:
            self.spent = 0
            at_rest = self.advance(at_rest, load)
            yield self.shown(at_rest, touch)

    def shown(self, moment: Moment, touch: float) -> Moment:
        """With the depth counted from the first touch; a free body moved so that the outer traction fits its force."""
        u, shift = moment.displacement, 0.0
        if self.model.outer == "free":
            shift = float(self.pull @ (u - moment.load * self.far) / self.pull[~self.body.first_component].sum())
            u = u - np.where(self.body.first_component, 0.0, shift)
        return Moment(**{**vars(moment), "displacement": u, "depth": moment.depth - shift - touch})

    def advance(self, before: Moment, load: float, halvings: int = _HALVINGS) -> Moment:
        solution = self.newton(before, load)
        if solution is not None:
            return solution
        if not halvings:
            raise ArithmeticError(
                f"indentation must have a solution between the loads {before.load:g} and {load:g} (got none in "
                f"{_ITERATIONS} iterations); take smaller increments, or a law that softens less"
            )
        half = self.advance(before, (before.load + load) / 2, halvings - 1)
        return self.advance(half, load, halvings - 1)

    def newton(self, before: Moment, load: float) -> Moment | None:
        """Newton's iteration; a step that overshoots and gains no contact is shortened.

        Contact that is gained pushes with the stiff spring at once: that says nothing about the step.
        """
        surface, free, goal = self.surface, self.free, load / (2 * np.pi)
        u, depth = before.displacement.copy(), before.depth
        if self.model.outer == "fixed":
            u += (load - before.load) * self.far
        if load and not before.load:
            depth = surface.touching(u) + self.model.hertz_depth(load) / 2  # the overlap is as wide as Hertz's contact
        touched, step, change, slope, share = np.zeros(len(surface.r), dtype=bool), np.zeros(free.size), 0.0, 0.0, 1.0
        for tried in range(_ITERATIONS):
            try:
                force, matrix, after, stress = self.body.forces(u, before.states)
            except ArithmeticError:
                return None
            p = surface.pressure(u, depth) if load else np.zeros(len(surface.r))
            residual = load * self.pull - force
            q, slip = surface.shear(u, before.displacement, before.shear, p)
            residual[surface.unknowns] += p * surface.weight
            residual[surface.radial] += q * surface.weight
            residual = residual[free]
            scale = self.largest / (2 * np.pi) or float(np.abs(force).max())
            missing = goal - float(p @ surface.weight)
            if tried and max(np.abs(residual).max(), abs(missing)) <= _TOLERANCE * scale:
                return Moment(
                    load=load,
                    depth=depth if load else surface.touching(u),
                    contact_radius=surface.contact_radius(u, depth) if load else 0.0,
                    pressure=p,
                    shear=q,
                    displacement=u,
                    stress=stress,
                    states=after,
                    iterations=self.spent,
                )
            ahead = float(residual @ step) + missing * change
            if tried and ahead < -_OVERSHOT * slope and share > _SHORTEST and not np.any((p > 0) & ~touched):
                fraction = max(slope / (slope - ahead), 0.1)
                back = (1 - fraction) * share
                u[free] -= back * step
                depth -= back * change
                share *= fraction
                continue
            if load and not np.any(p):
                return None
            self.spent += 1
            step, change = self.linear(matrix, residual, missing, p, slip)
            if not np.all(np.isfinite(step)):
                return None
            touched, slope, share = p > 0, float(residual @ step) + missing * change, 1.0
            u[free] += step
            depth += change
        return None

    def linear(
        self, matrix: csc_matrix, residual: FloatArray, missing: float, p: FloatArray, slip: FloatArray
    ) -> tuple[FloatArray, float]:
        """Step of the free unknowns and of the depth; slip is the sense of slip of each node, 0 where it sticks."""
        surface, free, size = self.surface, self.free, matrix.shape[0]
        touching = surface.stiffness * surface.weight * (p > 0)
        sliding = surface.friction * slip * touching  # shear follows the pressure there
        spring, push = np.zeros(size), np.zeros(size)
        spring[surface.unknowns] = push[surface.unknowns] = touching
        push[surface.radial] = sliding
        spring_held = spring.copy()
        whole: Any = matrix
        options: dict[str, Any] = {"permc_spec": "MMD_AT_PLUS_A", "diag_pivot_thresh": 0.0}
        if surface.friction:
            spring_held[surface.radial] = surface.hold * surface.weight * ((p > 0) & (slip == 0))
            whole = whole + csc_matrix((sliding, (surface.radial, surface.unknowns)), shape=matrix.shape)
        else:
            options["options"] = {"SymmetricMode": True}
        factors = splu((whole + diags(spring_held)).tocsc()[free][:, free], **options)
        step = factors.solve(residual)
        if not np.any(spring):
            return step, 0.0
        lift = factors.solve(push[free])
        with np.errstate(divide="ignore", invalid="ignore"):  # an iteration that is lost; its increment is halved
            change = float((missing + spring[free] @ step) / (spring.sum() - spring[free] @ lift))
        return step + change * lift, change
