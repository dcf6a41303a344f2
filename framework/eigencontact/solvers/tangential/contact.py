"""Normal and tangential contact, coupled: one load increment of two bodies with friction."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from eigencontact.core.array_types import FloatArray
from eigencontact.core.grid import Box, Grid
from eigencontact.errors import NotConverged
from eigencontact.solvers.anderson import Anderson
from eigencontact.solvers.coarse_to_fine import refuse_edge
from eigencontact.solvers.control import Control
from eigencontact.solvers.normal import NormalSolver
from eigencontact.solvers.report import Progress
from eigencontact.solvers.solution import NormalOptions, NormalSolution
from eigencontact.solvers.tangential.compliance import MatrixOperator, Pair, ParityCoefficients
from eigencontact.solvers.tangential.control import TangentialControl
from eigencontact.solvers.tangential.solver import Overloaded, TangentialOptions, TangentialSolution, TangentialSolver

__all__ = ["FrictionalContact", "FrictionalSolution", "Sliding"]

#: Fraction of the tolerance for the normal and the tangential solve in the last round of the coupling.
_INNER = 0.2
#: Largest number of rounds of normal and tangential solves in one increment.
_ROUNDS = 120
#: Tolerance of the two solves in the first round.
_LOOSEST = 1e-2
#: Tolerance of the two solves in later rounds, relative to the change in the previous round.
_SHARE = 0.1


@dataclass(frozen=True, kw_only=True, slots=True)
class Sliding:
    """State of the contact at the end of an increment, input of the next increment (thesis eq. 2.75).

    Attributes
    ----------
    pressure : (ny, nx) float64
        [Pa].
    shear : (k, ny, nx) float64
        Shear traction on body 1 [Pa].
    position : (k, ny, nx) float64
        Position of body 1 relative to body 2, zero for unloaded bodies [m].
    lift : (ny, nx) float64
        Normal displacement by the shear [m].
    rigid : (3,) float64
        δ_x, δ_y [m], φ_z [rad].
    slip_distance : (ny, nx) float64
        Length of the slip path in contact so far [m].
    dissipated : (ny, nx) float64
        Friction work so far [J/m²].
    """

    pressure: FloatArray
    shear: FloatArray
    position: FloatArray
    lift: FloatArray
    rigid: FloatArray = field(default_factory=lambda: np.zeros(3))
    slip_distance: FloatArray
    dissipated: FloatArray

    @classmethod
    def at_rest(cls, grid: Grid, components: str = "xy") -> Sliding:
        """State without contact."""
        plane, zero = np.zeros((len(components), *grid.shape)), np.zeros(grid.shape)
        return cls(pressure=zero, shear=plane, position=plane, lift=zero, slip_distance=zero, dissipated=zero)


@dataclass(frozen=True, kw_only=True, slots=True)
class FrictionalSolution:
    """Converged increment.

    Attributes
    ----------
    normal : NormalSolution
        Solution of the normal contact; its displacement is that by the pressure.
    tangential : TangentialSolution
        Solution of the tangential contact; its displacement is that by the shear.
    sliding : Sliding
        State at the end of the increment.
    tangential_by_pressure : (k, ny, nx) float64
        Tangential displacement by the pressure, body 1 minus body 2 [m]; zero if the coupling neglects it.
    rounds : int
        Number of rounds of normal and tangential solves.
    coupling_residual : float
        Last change of the normal displacement by the shear, relative to the largest deflection.
    normal_convolutions, tangential_convolutions : int
        Number of convolutions in all rounds.
    """

    normal: NormalSolution
    tangential: TangentialSolution
    sliding: Sliding
    tangential_by_pressure: FloatArray
    rounds: int
    coupling_residual: float
    normal_convolutions: int
    tangential_convolutions: int


@dataclass(frozen=True, slots=True)
class _Increment:
    """Arguments of one increment; see `FrictionalContact.step`."""

    separation: FloatArray
    control: Control
    tangential: TangentialControl
    before: Sliding
    offset: FloatArray | None
    tolerance: float | None
    slide: FloatArray | None
    moved: bool
    progress: Progress | None


@dataclass(frozen=True, slots=True)
class _Round:
    """Results of one normal and one tangential solution, with the convolutions so far."""

    normal: NormalSolution
    tangential: TangentialSolution
    carried: FloatArray
    bound: FloatArray
    convolutions: tuple[int, int]

    def shear_under(self, bound: FloatArray) -> FloatArray:
        """Shear for another bound: slipping cells are scaled with it, because most of them will slip again."""
        slipping = (self.bound > 0) & ~self.tangential.stick
        return self.tangential.shear * np.where(slipping, bound / np.where(slipping, self.bound, 1.0), 1.0)


class FrictionalContact:
    """Two bodies with friction on one grid, increment by increment.

    Parameters
    ----------
    grid : Grid
        Cells.
    coefficients : mapping of (str, str) to ParityCoefficients
        Keyed by directions of displacement and traction, ``"x"``, ``"y"``, ``"z"``. The pairs decide the coupling:
        equal directions only (none); also x with y (partial); also x and y by z (one-way: Goodman's approximation); all
        (full). ``("z", "z")`` and one tangential direction are required.
    bound : callable
        Shear bound [Pa] ``(ny, nx)`` from the pressure and the state at the start of the increment.
    normal_options, options
        Options of the two solvers; the tolerance of the tangential solver is also that of the coupling.
    """

    def __init__(
        self,
        grid: Grid,
        coefficients: Mapping[Pair, ParityCoefficients],
        bound: Callable[[FloatArray, Sliding], FloatArray],
        normal_options: NormalOptions | None = None,
        options: TangentialOptions | None = None,
    ) -> None:
        self.grid, self.bound = grid, bound
        self.options = options or TangentialOptions()
        normal_options = normal_options or NormalOptions()
        self.components = "".join(c for c in "xy" if (c, c) in coefficients)
        self._by_pressure = self._matrix(coefficients, self.components, "z")
        self._by_shear = self._matrix(coefficients, "z", self.components)
        self._at_edge = normal_options.allow_contact_at_edge
        if self._by_shear is not None:  # the edge is checked at the end; during the rounds the contact may exceed it
            normal_options = replace(normal_options, allow_contact_at_edge=True)
        self.normal = NormalSolver(grid, coefficients["z", "z"], normal_options)
        self.tangential = TangentialSolver(grid, coefficients, self.components, self.options)
        self._last: tuple[FloatArray, Control, NormalSolution] | None = None

    def _matrix(
        self, coefficients: Mapping[Pair, ParityCoefficients], targets: str, sources: str
    ) -> MatrixOperator | None:
        if not any((i, j) in coefficients for i in targets for j in sources):
            return None
        return MatrixOperator(self.grid, coefficients, targets, sources, self.options)

    def step(
        self,
        separation: FloatArray,
        control: Control,
        tangential: TangentialControl,
        before: Sliding | None = None,
        *,
        offset: FloatArray | None = None,
        tolerance: float | None = None,
        start: FrictionalSolution | None = None,
        slide: FloatArray | None = None,
        moved: bool = False,
        progress: Progress | None = None,
    ) -> FrictionalSolution:
        """Solve one increment.

        Parameters
        ----------
        separation : (ny, nx) float64
            Initial separation, with all changes except those by pressure and shear [m].
        control, tangential
            Prescribed loads or rigid displacements at the end of the increment.
        before : Sliding, optional
            State at the end of the last increment; at rest by default.
        offset : (k, ny, nx) float64, optional
            Tangential displacement by other causes than pressure and shear, body 1 minus body 2 [m].
        start : FrictionalSolution, optional
            Similar solution: that of the same increment with another offset.
        slide : (k,) float64, optional
            Sliding distance of body 2 on body 1 for sliding of the whole contact [m], not counted among the rigid
            displacements. The shear then equals its bound everywhere, against the motion; `tangential` is not used.
        moved : bool
            Whether the separation has changed since the end of the last increment. The bound at the start is then
            unknown, and the friction work uses the bound at the end.
        tolerance, progress
            See `eigencontact.solvers.normal.NormalSolver.solve`.

        Raises
        ------
        NotConverged, SceneError, DomainTooSmall
            See `NormalSolver` and `TangentialSolver`.
        """
        before = before or Sliding.at_rest(self.grid, self.components)
        increment = _Increment(separation, control, tangential, before, offset, tolerance, slide, moved, progress)
        last = None
        if start is not None:
            bound = self.bound(start.normal.pressure, before)
            last = _Round(start.normal, start.tangential, start.tangential_by_pressure, bound, (0, 0))
        if self._by_shear is None:
            return self._solution(increment, self._round(increment, last, before.lift, tolerance), before.lift, 1, 0.0)
        return self._agreed(increment, last, before.lift if start is None else start.sliding.lift)

    def _agreed(self, increment: _Increment, last: _Round | None, lift: FloatArray) -> FrictionalSolution:
        """Rounds of normal and tangential contact until the normal displacement by the shear is constant."""
        tolerance = increment.tolerance or self.options.tolerance
        finest, mixer, change = _INNER * tolerance, Anderson(), 0.0
        inner = _LOOSEST if last is None else finest
        for rounds in range(1, _ROUNDS + 1):
            try:
                last = self._round(increment, last, lift, inner)
            except Overloaded as error:
                if error.at_any_place and increment.control.normal_load is not None:
                    raise
                raise NotConverged(
                    f"{error} (under the pressure of round {rounds}, before normal and tangential contact had agreed; "
                    "take smaller increments)",
                    last.tangential.report if last else None,
                ) from error
            image = self.lift(last.tangential.shear)
            change = self._change(image - lift, last.normal)
            if increment.progress is not None:
                increment.progress("normal and tangential", change, tolerance)
            if change <= tolerance and inner <= finest:
                if not (self._at_edge or self.options.periodic):
                    refuse_edge(last.normal.pressure, self.grid)
                return self._solution(increment, last, image, rounds, change)
            # A change below the tolerance of the two solves has no information; the combination would overweight it.
            lift = mixer.next(lift, image) if change > inner else image
            inner = min(_LOOSEST, max(_SHARE * change, finest))
        raise NotConverged(
            f"normal and tangential contact did not agree in {_ROUNDS} rounds (last change {change:.1e} of the "
            f"deflection, tolerance {tolerance:.1e}); take smaller increments or loosen the tolerance",
            last.tangential.report if last else None,
        )

    def _round(self, increment: _Increment, last: _Round | None, lift: FloatArray, inner: float | None) -> _Round:
        """Normal, then tangential contact from the last results, to the tolerance `inner` or that of the options."""
        before = increment.before
        start = before.pressure if np.any(before.lift) else None
        normal = self._normal(increment, lift, last.normal.pressure if last else start, inner)
        bound, carried = self.bound(normal.pressure, before), self._carried(normal.pressure)
        offset = carried - before.position if increment.offset is None else carried + increment.offset - before.position
        if increment.slide is not None:
            direction = increment.slide / np.linalg.norm(increment.slide)
            tangential = self.tangential.slid(bound, offset, direction, before.rigid)
        else:
            tangential = self.tangential.solve(
                bound, offset, increment.tangential, start=last.shear_under(bound) if last else before.shear,
                tolerance=inner, progress=increment.progress,
            )  # fmt: skip
        counts = (normal.report.convolutions, tangential.report.convolutions)
        if last is not None:
            counts = (counts[0] + last.convolutions[0], counts[1] + last.convolutions[1])
        return _Round(normal, tangential, carried, bound, counts)

    def _normal(
        self, increment: _Increment, lift: FloatArray, start: FloatArray | None, inner: float | None
    ) -> NormalSolution:
        """Solution of the normal contact; the last one if its input has not changed."""
        separation, control = increment.separation + lift, increment.control
        if start is None and self._last is not None:
            last_separation, last_control, solution = self._last
            if last_control == control and np.array_equal(last_separation, separation):
                solution.report.convolutions = 0
                return solution
        finest = self.normal.options.tolerance
        tolerance = None if inner is None else max(_INNER * finest, inner * finest / self.options.tolerance)
        solution = self.normal.solve(separation, control, start=start, tolerance=tolerance, progress=increment.progress)
        self._last = (separation, control, solution) if start is None else None
        return solution

    def _solution(
        self, increment: _Increment, last: _Round, lift: FloatArray, rounds: int, change: float
    ) -> FrictionalSolution:
        return FrictionalSolution(
            normal=last.normal, tangential=last.tangential,
            sliding=self._end_state(increment.before, last.normal.pressure, last.tangential, lift, increment),
            tangential_by_pressure=last.carried, rounds=rounds, coupling_residual=change,
            normal_convolutions=last.convolutions[0], tangential_convolutions=last.convolutions[1],
        )  # fmt: skip

    def _carried(self, pressure: FloatArray) -> FloatArray:
        """Tangential displacement by the pressure."""
        if self._by_pressure is None:
            return np.zeros((len(self.components), *self.grid.shape))
        return self._everywhere(self._by_pressure, pressure[None])

    def lift(self, shear: FloatArray) -> FloatArray:
        """Normal displacement by a shear ``(k, ny, nx)`` [m], sum of both bodies; zero if the coupling neglects it."""
        if self._by_shear is None:
            return np.zeros(self.grid.shape)
        return np.asarray(self._everywhere(self._by_shear, shear)[0])

    def _everywhere(self, operator: MatrixOperator, tractions: FloatArray) -> FloatArray:
        window = Box(0, self.grid.ny, 0, self.grid.nx)
        box = window if self.options.periodic else Box.around(np.any(tractions != 0, axis=0))
        if box is None:
            return np.zeros((len(operator.targets), *self.grid.shape))
        return operator.apply(tractions[:, *box.slices], box, window)

    def _change(self, difference: FloatArray, normal: NormalSolution) -> float:
        """Largest change of the normal displacement in contact, relative to the largest deflection there."""
        loaded = normal.pressure > 0
        deflection = float(np.max(normal.displacement, where=loaded, initial=0.0))
        largest = float(np.max(np.abs(difference), where=loaded, initial=0.0))
        return largest / deflection if deflection > 0 else 0.0

    def _end_state(
        self, before: Sliding, pressure: FloatArray, tangential: TangentialSolution, lift: FloatArray,
        increment: _Increment,
    ) -> Sliding:  # fmt: skip
        """State at the end of the increment.

        The friction work uses the mean of the bounds at both ends, also in cells that lose contact. It is never
        negative, and hardly depends on the number of increments. (The mean of the shears would balance the work of the
        loads exactly, but count the shear before slip started.) For sliding of the whole contact, and for surfaces that
        have moved before the increment, it uses the bound at the end.
        """
        loaded, left = pressure > 0, (before.pressure > 0) & (pressure <= 0)
        slip = tangential.slip * ((loaded & ~tangential.stick) | left)
        distance = np.sqrt(np.einsum("kij,kij->ij", slip, slip))
        if increment.slide is not None:
            distance = loaded * float(np.linalg.norm(increment.slide))
        after = self.bound(pressure, before)
        has_path = increment.slide is None and not increment.moved
        work = (after if not has_path else 0.5 * (self.bound(before.pressure, before) + after)) * distance
        return Sliding(
            pressure=pressure, shear=tangential.shear, position=before.position + tangential.slip, lift=lift,
            rigid=tangential.rigid, slip_distance=before.slip_distance + distance,
            dissipated=before.dissipated + work,
        )  # fmt: skip
