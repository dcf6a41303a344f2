"""Frictionless normal contact: coarse to fine, on the box that can touch, certified on the whole window."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf
from time import perf_counter

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.grid import Box, Grid
from eigencontact.errors import DomainTooSmall, NotConverged, SceneError, require
from eigencontact.solvers.constrained_cg import BoxProblem, solve_box
from eigencontact.solvers.control import Control, mode_field
from eigencontact.solvers.levels import coarse_factors, prolong, restrict
from eigencontact.solvers.operator import Coefficients, Compliance
from eigencontact.solvers.preconditioner import circulant_inverse
from eigencontact.solvers.report import Certificate, Progress, SolveReport
from eigencontact.solvers.rigid import RigidModes

__all__ = ["NormalOptions", "NormalSolution", "solve_normal"]

FloatArray = NDArray[np.float64]

# On coarser grids the start need not be better than the error of those grids.
_COARSE_TOLERANCE = 1e-3


@dataclass(frozen=True, kw_only=True, slots=True)
class NormalOptions:
    """How to solve; what to solve is the other arguments of `solve_normal`.

    Parameters
    ----------
    tolerance : float
        Bound on each residual of the `Certificate` [-].
    max_iterations : int
        Iterations allowed on the finest grid.
    precision : {"double", "single"}
        Arithmetic of the iteration. Single reaches tolerances down to about 1e-5.
    threads : int, optional
        Cores; all by default.
    periodic : bool
        The window repeats in x and y.
    allow_contact_at_edge : bool
        Accept contact that reaches the edge of the window.
    """

    tolerance: float = 1e-6
    max_iterations: int = 500
    precision: str = "double"
    threads: int | None = None
    periodic: bool = False
    allow_contact_at_edge: bool = False


@dataclass(frozen=True, kw_only=True, slots=True)
class NormalSolution:
    """A converged normal contact.

    Attributes
    ----------
    pressure, gap, displacement : (ny, nx) float64
        p [Pa], g [m] (zero to tolerance at loaded cells) and u_z [m], both bodies summed.
    approach, tilt_x, tilt_y : float
        δ [m], φx, φy [rad].
    normal_load, moment_x, moment_y : float
        P [N], Mx, My [N m], of the pressure.
    report : SolveReport
        Certificate, history, counts, time.
    """

    pressure: FloatArray
    gap: FloatArray
    displacement: FloatArray
    approach: float
    tilt_x: float
    tilt_y: float
    normal_load: float
    moment_x: float
    moment_y: float
    report: SolveReport


def solve_normal(
    grid: Grid,
    separation: FloatArray,
    coefficients: Coefficients,
    control: Control,
    options: NormalOptions | None = None,
    *,
    start: FloatArray | None = None,
    progress: Progress | None = None,
) -> NormalSolution:
    """Pressure of two elastic bodies pressed together without friction.

    Finds p with p >= 0, g >= 0, p g = 0 for ``g = h + u(p) - δ - φx y + φy x`` (thesis eqs 2.67-2.72).

    Parameters
    ----------
    grid : Grid
        Cells; the pressure is uniform on each.
    separation : (ny, nx) float64
        Initial separation h [m].
    coefficients : Coefficients
        Normal displacement of a uniformly loaded rectangle, both bodies summed [m/Pa].
    control : Control
        Load or approach, moments or tilts.
    options : NormalOptions, optional
        Tolerance, precision, periodicity and so on.
    start : (ny, nx) float64, optional
        A pressure near the answer; the coarse grids are then skipped.
    progress : callable, optional
        Told the residual of each iteration.

    Returns
    -------
    NormalSolution
        Its certificate holds.

    Raises
    ------
    NotConverged
        With the report; no half result is returned.
    DomainTooSmall
        Contact at the edge of the window, unless allowed or periodic.
    SceneError
        A separation that is not finite, a moment that the window cannot carry.

    Examples
    --------
    >>> class Winkler:  # a bed of springs, 1 m/Pa
    ...     def table(self, x, y, half_widths):
    ...         return np.where((x[None] == 0) & (y[:, None] == 0), 1.0, 0.0)
    >>> grid = Grid(nx=8, ny=8, dx=1.0, dy=1.0)
    >>> h = 0.1 * (grid.x[None] ** 2 + grid.y[:, None] ** 2)
    >>> solution = solve_normal(grid, h, Winkler(), Control(approach=0.3))
    >>> round(float(solution.pressure.max()), 6)
    0.25
    """
    began = perf_counter()
    options = options or NormalOptions()
    _check(grid, separation, control, start)
    report = SolveReport()
    solver = _Normal(grid, separation, coefficients, control, options, report, progress)
    try:
        solution = solver.solve(start)
    finally:
        report.convolutions = solver.convolutions
        report.seconds = perf_counter() - began
    return solution


def _check(grid: Grid, separation: FloatArray, control: Control, start: FloatArray | None) -> None:
    require(separation.shape == grid.shape, "contact", "separation", separation.shape, f"of shape {grid.shape}")
    if not np.all(np.isfinite(separation)):
        bad = int(np.count_nonzero(~np.isfinite(separation)))
        raise SceneError(f"separation must be finite at every cell (got {bad} NaN or infinite of {separation.size})")
    if start is not None:
        require(start.shape == grid.shape, "contact", "start", start.shape, f"of shape {grid.shape}")
    if control.normal_load:
        middles = {"moment_x": (grid.center[1], 0.5 * grid.size[1]), "moment_y": (-grid.center[0], 0.5 * grid.size[0])}
        for name, (middle, half) in middles.items():
            moment = getattr(control, name)
            if moment is None:
                continue
            limit, about = control.normal_load * half, moment - control.normal_load * middle
            if abs(about) >= limit:
                raise SceneError(
                    f"step.{name} must be smaller than the load times half the window, {limit:.4g} N m "
                    f"(got {about:.4g}{' about the middle of the window' if middle else ''}); the centre of pressure "
                    "would lie outside the window"
                )


class _Normal:
    """State of one solve. Lengths are in units of ``self.length``, pressures so that the compliance is of order 1."""

    def __init__(
        self,
        grid: Grid,
        separation: FloatArray,
        coefficients: Coefficients,
        control: Control,
        options: NormalOptions,
        report: SolveReport,
        progress: Progress | None,
    ) -> None:
        self.grid, self.control, self.options, self.report, self.progress = grid, control, options, report, progress
        self.coefficients = coefficients
        self.separation = separation
        self.free = control.forces()
        self.levels: list[Compliance] = []

    @property
    def convolutions(self) -> int:
        return sum(level.convolutions for level in self.levels)

    def compliance(self, grid: Grid, precision: str) -> Compliance:
        made = Compliance(
            grid,
            self.coefficients,
            periodic=self.options.periodic,
            precision=precision,
            threads=self.options.threads,
        )
        self.levels.append(made)
        return made

    # ------------------------------------------------------------------ course of the solve

    def solve(self, start: FloatArray | None) -> NormalSolution:
        fixed = self._without_prescribed(self.grid, self.separation)
        if self._never_touches(fixed):
            return self._empty(fixed)
        if start is not None and np.any(start > 0):
            return self._finest(fixed, np.array(start, dtype=float))
        ladder = [(self.grid, fixed, (1, 1))]
        while (factors := coarse_factors(ladder[-1][0])) is not None:
            grid, field_, _ = ladder[-1]
            ladder.append((grid.coarsened(*factors), restrict(field_, factors), factors))
        pressure: FloatArray | None = None
        for number in range(len(ladder) - 1, 0, -1):
            grid, field_, factors = ladder[number]
            pressure = self._coarse(grid, field_, pressure)
            pressure = prolong(pressure, factors, ladder[number - 1][0].shape)
        return self._finest(fixed, pressure)

    def _coarse(self, grid: Grid, fixed: FloatArray, pressure: FloatArray | None) -> FloatArray:
        """Loose solution on a coarser grid, for a start only."""
        if 0 not in self.free and fixed.min() >= 0:  # the merged cells do not touch yet
            return np.zeros(grid.shape)
        compliance = self.compliance(grid, "single")  # a start needs no more
        box = self._box(grid, pressure)
        p, _ = self._on_box(compliance, fixed, pressure, box, max(_COARSE_TOLERANCE, self.options.tolerance), 60)
        return p

    def _finest(self, fixed: FloatArray, pressure: FloatArray | None) -> NormalSolution:
        """Solve on the whole grid; grow the box while the certificate finds overlap outside it."""
        options, grid = self.options, self.grid
        compliance = self.compliance(grid, options.precision)
        whole = Box(0, grid.ny, 0, grid.nx)
        box = self._box(grid, pressure)
        compliance.reserve(box, whole)
        tolerance = 0.7 * options.tolerance  # of the iteration, so that the certificate holds with room to spare
        left = options.max_iterations
        for _ in range(50):
            done = self.report.iterations
            pressure, residual = self._on_box(compliance, fixed, pressure, box, tolerance, left)
            left -= self.report.iterations - done
            solution, overlapping = self._certify(compliance, fixed, pressure, box)
            certificate = solution.report.certificate
            if certificate is not None and certificate.holds:
                return self._checked(solution)
            grown = box if overlapping is None else _union(box, overlapping).grown(*_margin(box), grid.shape)
            if grown == box:
                if residual > tolerance or left <= 0 or tolerance < 0.05 * options.tolerance:
                    break
                tolerance *= 0.3  # the updated gap has drifted from the true one: ask for more
            box = grown
        raise NotConverged(
            f"normal contact did not converge in {self.report.iterations} iterations on {grid.nx} x {grid.ny} cells: "
            f"{self.report.certificate}; raise max-iterations, loosen the tolerance"
            + (" or use double precision" if options.precision == "single" else ""),
            self.report,
        )

    # ------------------------------------------------------------------ pieces

    def _without_prescribed(self, grid: Grid, separation: FloatArray) -> FloatArray:
        """Separation less the prescribed rigid displacements [m]."""
        out = np.array(separation, dtype=float)
        for mode, value in self.control.displacements().items():
            if value:
                out -= value * mode_field(mode, grid)
        return out

    def _never_touches(self, fixed: FloatArray) -> bool:
        if 0 in self.free:
            return self.free[0] == 0.0
        if fixed.min() < 0:
            return False
        if any(self.free.values()):
            raise SceneError("a moment must be carried by contact, but at this approach the surfaces do not touch")
        return True

    def _empty(self, fixed: FloatArray) -> NormalSolution:
        """Solution without contact: under no load the bodies just touch."""
        require(not any(self.free.values()), "step", "moment", self.free, "zero where the normal load is zero")
        approach = float(fixed.min()) if 0 in self.free else float(self.control.approach or 0.0)
        gap = fixed - approach if 0 in self.free else fixed
        zero = np.zeros(self.grid.shape)
        self.report.certificate = Certificate(gap=0.0, penetration=0.0, load=0.0, tolerance=self.options.tolerance)
        return NormalSolution(
            pressure=zero,
            gap=gap,
            displacement=zero.copy(),
            approach=approach,
            tilt_x=float(self.control.tilt_x or 0.0),
            tilt_y=float(self.control.tilt_y or 0.0),
            normal_load=0.0,
            moment_x=0.0,
            moment_y=0.0,
            report=self.report,
        )

    def _box(self, grid: Grid, pressure: FloatArray | None) -> Box:
        """Box that can touch: that of the start with a margin, or everything."""
        whole = Box(0, grid.ny, 0, grid.nx)
        loaded = None if pressure is None else Box.around(pressure > 0)
        if loaded is None:
            return whole
        box = loaded.grown(*_margin(loaded), grid.shape)
        if self.options.periodic and max(box.shape[0] / grid.ny, box.shape[1] / grid.nx) > 0.5:
            return whole
        return box

    def _on_box(
        self,
        compliance: Compliance,
        fixed: FloatArray,
        pressure: FloatArray | None,
        box: Box,
        tolerance: float,
        iterations: int,
    ) -> tuple[FloatArray, float]:
        """Solve on one box; pressures in Pa on the whole grid in and out."""
        grid = compliance.grid
        operator = compliance.between(box, box)
        unit = compliance.unit
        here = fixed[box.slices]
        modes, forces, _ = self._modes(grid, box)
        dtype = np.float64 if compliance.precision == "double" else np.float32
        # Lengths in units of a typical deflection, pressures of length/unit: all numbers are of order one.
        length = unit * self.free[0] / grid.cell_area if 0 in self.free else -float(fixed.min())
        scale = length / unit
        if pressure is not None and np.any(pressure[box.slices] > 0):
            p = pressure[box.slices] / scale
            loaded = p > 0
        else:
            p, loaded = self._first(here, grid)
            p = p / scale
        problem = BoxProblem(
            apply=operator,
            precondition=circulant_inverse(compliance, box),
            separation=(here / length).astype(dtype),
            modes=modes,
            forces=forces / (scale * grid.cell_area),
        )

        def note(residual: float) -> None:
            self.report.history.append((grid.nx * grid.ny, residual))
            if self.progress is not None:
                self.progress(f"{grid.nx} x {grid.ny} cells", residual, self.options.tolerance)

        state = solve_box(
            problem,
            p.astype(dtype),
            loaded,
            tolerance=tolerance,
            max_iterations=max(1, iterations),
            on_iteration=note,
        )
        out = np.zeros(grid.shape)
        out[box.slices] = state.pressure
        out *= scale
        return out, state.residual

    def _modes(self, grid: Grid, box: Box) -> tuple[RigidModes, FloatArray, FloatArray]:
        """Force-controlled modes on a box scaled to order one, their forces, and the scales."""
        fields, sizes = [], []
        for mode in self.free:
            size = float(np.abs(mode_field(mode, self.grid)).max()) or 1.0
            fields.append(_cut(mode_field(mode, grid), box) / size)
            sizes.append(size)
        return RigidModes(fields), np.array(list(self.free.values())) / np.array(sizes), np.array(sizes)

    def _first(self, here: FloatArray, grid: Grid) -> tuple[FloatArray, NDArray[np.bool_]]:
        """Start from nothing: the lowest cells share the load, or the overlapping cells are loaded with zero."""
        if 0 not in self.free:
            return np.zeros(here.shape), here < 0
        few = len(self.free) == 1
        loaded = here <= np.quantile(here, 0.25) if few else np.ones(here.shape, dtype=bool)
        return np.where(loaded, self.free[0] / (grid.cell_area * loaded.sum()), 0.0), loaded

    def _certify(
        self, compliance: Compliance, fixed: FloatArray, pressure: FloatArray, box: Box
    ) -> tuple[NormalSolution, Box | None]:
        """Check the contact conditions on the whole window, with a convolution of its own."""
        grid, options = self.grid, self.options
        whole = Box(0, grid.ny, 0, grid.nx)
        source = whole if options.periodic else box
        inner = pressure[source.slices]
        top = float(inner.max()) or 1.0
        displacement = np.asarray(compliance.between(source, whole)(inner / top), dtype=float)
        displacement *= top * compliance.unit
        gap = fixed + displacement
        loaded = inner > 0
        weight = loaded.astype(float)
        modes, _, sizes = self._modes(grid, source)
        fit = modes.fit(gap[source.slices] * weight, weight) / sizes
        rigid = {mode: float(value) for mode, value in zip(self.free, fit, strict=True)}
        for mode, value in rigid.items():
            gap -= value * mode_field(mode, grid)
        # Without any pressure the overlap is measured against itself: such a state must never be certified.
        deflection = float((displacement[source.slices] * weight).max()) or max(0.0, -float(gap.min())) or inf
        near = gap[source.slices]
        inside = float(np.abs(near * weight).max()) / deflection
        overlap = max(0.0, -_least_outside(gap, source), -float((near * (1.0 - weight)).min())) / deflection
        every = RigidModes([_cut(mode_field(mode, grid), source) for mode in range(3)])
        forces = [float(force) * grid.cell_area for force in every.project(inner)]
        self.report.certificate = Certificate(
            gap=inside, penetration=overlap, load=self._load_error(forces), tolerance=options.tolerance
        )
        rigid |= self.control.displacements()
        solution = NormalSolution(
            pressure=pressure,
            gap=gap,
            displacement=displacement,
            approach=rigid[0],
            tilt_x=rigid[1],
            tilt_y=rigid[2],
            normal_load=forces[0],
            moment_x=forces[1],
            moment_y=forces[2],
            report=self.report,
        )
        over = None
        if overlap > options.tolerance:
            over = Box.around((pressure == 0) & (gap < -options.tolerance * deflection))
        return solution, over

    def _load_error(self, forces: list[float]) -> float:
        """Largest relative error of the prescribed forces; moments relative to the load at half the window."""
        load = abs(self.free.get(0, forces[0]))
        arm = 0.5 * max(self.grid.size)
        errors = [abs(forces[m] - value) / (load * (arm if m else 1.0)) for m, value in self.free.items() if load > 0]
        return max(errors, default=0.0)

    def _checked(self, solution: NormalSolution) -> NormalSolution:
        """Refuse contact at the edge of the window, which the window may have cut."""
        if self.options.periodic or self.options.allow_contact_at_edge:
            return solution
        p = solution.pressure
        sides = {"x": p[:, [0, -1]], "y": p[[0, -1]]}
        touched = [name for name, edge in sides.items() if np.any(edge > 0)]
        if touched:
            width, height = self.grid.size
            raise DomainTooSmall(
                f"contact must stay inside the window (it reaches its edge along {' and '.join(touched)}; the window "
                f"is {width:.4g} m x {height:.4g} m); enlarge grid size, lower the load, or set "
                "numerics.allow-contact-at-edge = true if the bodies end there"
            )
        return solution


def _margin(box: Box) -> tuple[int, int]:
    return tuple(max(2, -(-n // 64)) for n in box.shape)  # type: ignore[return-value]


def _cut(field: FloatArray, box: Box) -> FloatArray:
    """Part of a broadcastable field that belongs to a box."""
    rows, columns = box.slices
    return field[rows if field.shape[0] > 1 else slice(None), columns if field.shape[1] > 1 else slice(None)]


def _least_outside(field: FloatArray, box: Box) -> float:
    """Smallest value of a field outside a box; infinity where there is nothing outside."""
    strips = (field[: box.y0], field[box.y1 :], field[box.y0 : box.y1, : box.x0], field[box.y0 : box.y1, box.x1 :])
    return min((float(strip.min()) for strip in strips if strip.size), default=inf)


def _union(a: Box, b: Box) -> Box:
    return Box(min(a.y0, b.y0), max(a.y1, b.y1), min(a.x0, b.x0), max(a.x1, b.x1))
