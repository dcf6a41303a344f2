"""Tangential contact with friction under a prescribed pressure, for one or many increments on one grid."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from time import perf_counter

import numpy as np

from eigencontact.core.array_types import BoolArray, FloatArray
from eigencontact.core.grid import Box, Grid
from eigencontact.errors import NotConverged, SceneError, require
from eigencontact.solvers.report import FrictionCertificate, Progress, SolveReport
from eigencontact.solvers.solution import SolverOptions
from eigencontact.solvers.tangential.compliance import MatrixOperator, Pair, ParityCoefficients
from eigencontact.solvers.tangential.control import MODES, TangentialControl, mode_fields
from eigencontact.solvers.tangential.discs import Infeasible, RigidPlane, length_of
from eigencontact.solvers.tangential.newton import DiscProblem, DiscState, solve_discs

__all__ = ["Overloaded", "TangentialOptions", "TangentialSolution", "TangentialSolver"]

#: Part of the largest force of friction from which on a force counts as at its limit.
_LIMIT = 1.0 - 1e-6
#: Slip, relative to the largest tangential displacement in contact, that counts as round-off.
_NOTHING = 1e-12


class Overloaded(SceneError):
    """Error: prescribed forces exceed the limit of friction under the present pressure.

    Attributes
    ----------
    at_any_place : bool
        Whether the resultant alone exceeds the sum of all bounds, so that no other position of this pressure could
        carry it.
    """

    def __init__(self, message: str, *, at_any_place: bool) -> None:
        super().__init__(message)
        self.at_any_place = at_any_place


@dataclass(frozen=True, kw_only=True, slots=True)
class TangentialOptions(SolverOptions):
    """Options of the tangential solver: the tolerance bounds the `FrictionCertificate`, iterations are Newton steps."""

    max_iterations: int = 200


@dataclass(frozen=True, kw_only=True, slots=True)
class TangentialSolution:
    """Converged increment.

    Attributes
    ----------
    shear : (k, ny, nx) float64
        Shear traction on body 1 [Pa].
    displacement : (k, ny, nx) float64
        Displacement by the shear alone, body 1 minus body 2 [m].
    slip : (k, ny, nx) float64
        Motion of body 1 relative to body 2 in this increment [m], also outside the contact.
    stick : (ny, nx) bool
        Loaded cells without slip in this increment.
    rigid : (3,) float64
        δ_x, δ_y [m], φ_z [rad].
    forces : (3,) float64
        Q_x, Q_y [N] and M_z [N m] of the shear.
    report : SolveReport
        Certificate, history, numbers and time.
    """

    shear: FloatArray
    displacement: FloatArray
    slip: FloatArray
    stick: BoolArray
    rigid: FloatArray
    forces: FloatArray
    report: SolveReport[FrictionCertificate]


class TangentialSolver:
    """Friction on one grid for any number of solutions; coefficients, spectra and plans are reused.

    Parameters
    ----------
    grid : Grid
        Cells.
    coefficients : mapping of (str, str) to ParityCoefficients
        Keyed by directions of displacement and traction, sum of both bodies [m/Pa]; the physics neglects missing pairs.
    components : {"xy", "x", "y"}
        Directions of the shear.
    options : TangentialOptions, optional
        Tolerance and other options.

    Examples
    --------
    >>> class Bed:  # springs of 1 m/Pa, each cell by itself
    ...     parity = (1, 1)
    ...     def table(self, x, y, half_widths):
    ...         return np.where((x[None] == 0) & (y[:, None] == 0), 1.0, 0.0)
    >>> grid = Grid(nx=4, ny=4, dx=1.0, dy=1.0)
    >>> solver = TangentialSolver(grid, {("x", "x"): Bed()}, "x")
    >>> bound = np.array([[0.0, 0.1, 0.25, 0.3]] * 4)
    >>> solution = solver.solve(bound, np.zeros((1, 4, 4)), TangentialControl(shift_x=0.2))
    >>> solution.shear[0, 0].round(6).tolist(), solution.stick[0].tolist()
    ([0.0, 0.1, 0.2, 0.2], [False, False, True, True])
    """

    def __init__(
        self,
        grid: Grid,
        coefficients: Mapping[Pair, ParityCoefficients],
        components: str = "xy",
        options: TangentialOptions | None = None,
    ) -> None:
        self.grid, self.components, self.options = grid, components, options or TangentialOptions()
        self.operator = MatrixOperator(grid, coefficients, components, components, self.options)

    def solve(
        self,
        bound: FloatArray,
        offset: FloatArray,
        control: TangentialControl,
        *,
        start: FloatArray | None = None,
        tolerance: float | None = None,
        progress: Progress | None = None,
    ) -> TangentialSolution:
        """Solve for shear, stick and slip of one increment.

        The slip ``A q + offset - rigid`` is zero where ``|q| < bound``, and opposed to q where ``|q| = bound``.

        Parameters
        ----------
        bound : (ny, nx) float64
            Largest shear traction of each cell [Pa]; 0 outside the contact.
        offset : (k, ny, nx) float64
            Slip of the increment without shear and rigid displacement: the displacement by the pressure, minus the
            position of body 1 relative to body 2 at the start of the increment [m].
        control : TangentialControl
            Forces or rigid displacements at the end of the increment.
        start : (k, ny, nx) float64, optional
            Shear near the solution: that of the last step.
        tolerance, progress
            See `eigencontact.solvers.normal.NormalSolver.solve`.

        Raises
        ------
        NotConverged
            The exception has the report; a partial result is never returned.
        Overloaded
            The forces exceed the limit of friction.
        SceneError
            The bound is negative or not finite.
        """
        began, report, before = perf_counter(), SolveReport[FrictionCertificate](), self.operator.applications
        require(bound.shape == self.grid.shape, "friction", "bound", bound.shape, f"of shape {self.grid.shape}")
        if not (np.all(np.isfinite(bound)) and float(bound.min()) >= 0):
            raise SceneError(
                f"friction law must give a finite shear bound of zero or more at every cell (got {bound.min()} to "
                f"{bound.max()}); check its coefficient"
            )
        try:
            return self._solve(bound, offset, control, start, report, tolerance or self.options.tolerance, progress)
        finally:
            report.convolutions = self.operator.applications - before
            report.seconds = perf_counter() - began

    def slid(
        self, bound: FloatArray, offset: FloatArray, direction: FloatArray, rigid: FloatArray
    ) -> TangentialSolution:
        """Shear of a contact with slip in one direction in all cells.

        Parameters
        ----------
        bound, offset : (ny, nx), (k, ny, nx) float64
            See `solve`.
        direction : (k,) float64
            Unit vector of the sliding of body 2 on body 1.
        rigid : (3,) float64
            Other rigid displacements [m, m, rad]; the slip of the solution contains them, but not the sliding distance.
        """
        shear, window = direction[:, None, None] * bound, Box(0, self.grid.ny, 0, self.grid.nx)
        box = window if self.options.periodic else Box.around(bound > 0)
        report, displacement = SolveReport[FrictionCertificate](), np.zeros_like(shear)
        if box is not None:
            before = self.operator.applications
            displacement = self.operator.apply(shear[:, *box.slices], box, window)
            report.convolutions = self.operator.applications - before
        return self._without_stick(shear, displacement, offset, rigid, report, tolerance=0.0)

    def _without_stick(
        self, shear: FloatArray, displacement: FloatArray, offset: FloatArray, rigid: FloatArray,
        report: SolveReport[FrictionCertificate], *, tolerance: float,
    ) -> TangentialSolution:  # fmt: skip
        """Exact solution without sticking cells."""
        fields = mode_fields(self.grid, self.components)
        report.certificate = FrictionCertificate(bound=0.0, stick=0.0, alignment=0.0, load=0.0, tolerance=tolerance)
        return TangentialSolution(
            shear=shear, displacement=displacement, rigid=rigid, report=report,
            slip=displacement + offset - np.einsum("m,mkij->kij", rigid, fields),
            stick=np.zeros(self.grid.shape, dtype=bool),
            forces=np.einsum("mkij,kij->m", fields, shear) * self.grid.cell_area,
        )  # fmt: skip

    def _solve(
        self,
        bound: FloatArray,
        offset: FloatArray,
        control: TangentialControl,
        start: FloatArray | None,
        report: SolveReport[FrictionCertificate],
        tolerance: float,
        progress: Progress | None,
    ) -> TangentialSolution:
        grid, options = self.grid, self.options
        window = Box(0, grid.ny, 0, grid.nx)
        box = window if options.periodic else Box.around(bound > 0)
        if box is None:
            return self._without_contact(offset, control, report)
        cut = (slice(None), *box.slices)
        # Tractions are in units of the largest bound, lengths in units of its deflection of one cell: numbers of order
        # one.
        unit, traction = self.operator.unit(), float(bound.max())
        length = unit * traction
        fields = mode_fields(grid, self.components)
        free = control.forces()
        self._check_directions(control)
        modes = fields[list(free)][:, :, *box.slices] if free else np.zeros((0, len(self.components), *box.shape))
        sizes = np.array([float(np.abs(mode).max()) or 1.0 for mode in modes])
        forces = np.array(list(free.values())) / (traction * grid.cell_area)
        plane = RigidPlane(modes / sizes[:, None, None, None], forces / sizes) if free else RigidPlane(modes, forces)
        offset_in_box = offset[cut].copy()
        for mode, value in control.displacements().items():
            if value:
                offset_in_box -= value * fields[mode][cut]
        problem = DiscProblem(
            apply=lambda q: self.operator.apply(q, box, box) / unit,
            precondition=lambda r: self.operator.precondition(r, box),
            offset=offset_in_box / length,
            bound=bound[box.slices] / traction,
            modes=plane,
        )

        def note(residual: float) -> None:
            report.history.append((grid.nx * grid.ny, residual))
            if progress is not None:
                progress(f"friction, {grid.nx} x {grid.ny} cells", residual, tolerance)

        first = np.zeros_like(offset_in_box) if start is None else start[cut] / traction
        try:
            state = solve_discs(
                problem, first, tolerance=0.7 * tolerance, max_iterations=options.max_iterations,
                on_iteration=note,
            )  # fmt: skip
        except Infeasible:
            raise self._overloaded(bound, free, fields) from None
        rigid = np.zeros(len(MODES))
        for mode, value in control.displacements().items():
            rigid[mode] = value
        rigid[list(free)] = state.rigid / sizes * length if free else 0.0
        solution = self._certified(state, bound, offset, rigid, free, (box, traction), report, tolerance)
        if report.certificate is None or not report.certificate.holds:
            words = f"friction did not converge in {report.iterations} iterations on {grid.nx} x {grid.ny} cells: "
            raise NotConverged(
                f"{self._at_limit(bound, free, fields)}{words}{report.certificate}; take smaller increments, raise "
                "max-iterations or loosen the tolerance"
                + (" or use double precision" if options.precision == "single" else ""),
                report,
            )
        return solution

    def _certified(
        self,
        state: DiscState,
        bound: FloatArray,
        offset: FloatArray,
        rigid: FloatArray,
        free: Mapping[int, float],
        scale: tuple[Box, float],
        report: SolveReport[FrictionCertificate],
        tolerance: float,
    ) -> TangentialSolution:
        """Check the friction conditions by a separate convolution, outside the contact as well."""
        grid, (box, traction) = self.grid, scale
        window = Box(0, grid.ny, 0, grid.nx)
        fields = mode_fields(grid, self.components)
        shear = np.zeros((len(self.components), *grid.shape))
        shear[:, *box.slices] = state.tractions * traction
        displacement = self.operator.apply(shear[:, *box.slices], box, window)
        slip = displacement + offset - np.einsum("m,mkij->kij", rigid, fields)
        loaded = bound > 0
        largest = float(np.max(length_of(displacement) * loaded)) or np.inf
        slipping = np.zeros(grid.shape, dtype=bool)
        slipping[box.slices] = state.slipping
        slipping &= length_of(slip) > _NOTHING * largest  # an unchanged sliding state has no new slip
        stick = loaded & ~slipping
        size = length_of(shear)
        unit = np.where(slipping, shear / np.maximum(size, np.finfo(float).tiny), 0.0)
        along = np.einsum("kij,kij->ij", slip, unit)
        across = length_of(slip - unit * along) * slipping
        forces = np.einsum("mkij,kij->m", fields, shear) * grid.cell_area
        capacity = self._capacity(bound, fields)
        errors = [abs(forces[mode] - value) / capacity[mode] for mode, value in free.items()]
        report.certificate = FrictionCertificate(
            bound=float(np.max(size - bound)) / float(bound.max()),
            stick=float(np.max(length_of(slip) * stick)) / largest,
            alignment=float(max(across.max(), (along * slipping).max())) / largest,
            load=max(errors, default=0.0),
            tolerance=tolerance,
        )
        return TangentialSolution(
            shear=shear, displacement=displacement, slip=slip, stick=stick, rigid=rigid, forces=forces, report=report
        )

    def _capacity(self, bound: FloatArray, fields: FloatArray) -> FloatArray:
        """Largest friction force of each mode alone [N], [N m]."""
        arms = np.sqrt(np.einsum("mkij,mkij->mij", fields, fields))
        return np.asarray(np.einsum("mij,ij->m", arms, bound) * self.grid.cell_area + np.finfo(float).tiny)

    def _at_limit(self, bound: FloatArray, free: Mapping[int, float], fields: FloatArray) -> str:
        """Words for a force at the limit of friction, under which all cells may slip by any amount."""
        capacity = self._capacity(bound, fields)
        for mode, value in free.items():
            if abs(value) >= _LIMIT * capacity[mode]:
                displacement, force = MODES[mode]
                return (
                    f"step.{force} must be below what friction carries, and not equal to it (got {value:.9g} of "
                    f"{capacity[mode]:.9g}); lower it, or prescribe {displacement} to slide: "
                )
        return ""

    def _overloaded(self, bound: FloatArray, free: Mapping[int, float], fields: FloatArray) -> Overloaded:
        capacity = self._capacity(bound, fields)
        units = [self.grid.unit(unit) for unit in ("N", "N", "N m")]
        forces = ", ".join(
            f"{MODES[mode][1]} {value:.6g} of at most {capacity[mode]:.6g} {units[mode]}"
            for mode, value in free.items()
        )
        displacement = MODES[next(iter(free))][0]
        resultant = float(np.hypot(free.get(0, 0.0), free.get(1, 0.0)))
        return Overloaded(
            f"step.{MODES[next(iter(free))][1]} must be below what friction carries together (got {forces}); lower it, "
            f"or prescribe {displacement} to slide",
            at_any_place=resultant >= float(bound.sum()) * self.grid.cell_area,
        )

    def _check_directions(self, control: TangentialControl) -> None:
        """Refuse prescribed values outside the directions of this solver."""
        for mode, (displacement, force) in enumerate(MODES):
            missing = "xy" if mode == 2 else "xy"[mode]
            value = getattr(control, displacement) or getattr(control, force)
            if value and not set(missing) <= set(self.components):
                raise SceneError(
                    f"step.{displacement} must be 0 where shear acts along {self.components} (got {value})"
                )

    def _without_contact(
        self, offset: FloatArray, control: TangentialControl, report: SolveReport[FrictionCertificate]
    ) -> TangentialSolution:
        """Solution without contact: no shear, and the prescribed rigid displacements."""
        free = control.forces()
        for mode, value in free.items():
            require(value == 0.0, "step", MODES[mode][1], value, "zero where the bodies do not touch")
        rigid = np.zeros(len(MODES))
        for mode, value in control.displacements().items():
            rigid[mode] = value
        zero = np.zeros((len(self.components), *self.grid.shape))
        return self._without_stick(zero, zero.copy(), offset, rigid, report, tolerance=self.options.tolerance)
