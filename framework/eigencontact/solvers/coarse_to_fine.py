"""One normal solve: from coarse to fine grids, on the box of possible contact, certified on the whole window."""

from __future__ import annotations

from dataclasses import replace
from math import inf
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.array_types import FloatArray
from eigencontact.core.grid import Box, Grid
from eigencontact.core.parallel import available_threads
from eigencontact.errors import DomainTooSmall, NotConverged, SceneError, require
from eigencontact.solvers.constrained_cg import BoxProblem, BoxState, solve_box
from eigencontact.solvers.control import MODES, Control, mode_field
from eigencontact.solvers.levels import coarse_factors, prolong, restrict, restrict_springs
from eigencontact.solvers.operator import Compliance
from eigencontact.solvers.preconditioner import SpringPreconditioner
from eigencontact.solvers.report import Certificate, Progress, SolveReport
from eigencontact.solvers.rigid import RigidModes, dot
from eigencontact.solvers.settled_sets import solve_settled
from eigencontact.solvers.solution import NormalSolution

if TYPE_CHECKING:
    from eigencontact.solvers.normal import NormalSolver

__all__ = ["CoarseToFine", "margin", "refuse_edge"]

# Tolerance of the last grid before the finest. The start need not be better than the discretization error of that grid;
# a tighter start saves iterations on the finest grid.
_COARSE_TOLERANCE = 1e-3
# Tolerance of the other coarse grids; a tighter one saves no time.
_COARSER_TOLERANCE = 1e-2
# Number of merged cells below which still coarser grids cost more time than they save, for example in a row; and number
# of grids from which on this limit applies.
_FEWEST, _RUNGS = 256, 4


class CoarseToFine:
    """State of one solve."""

    def __init__(
        self,
        solver: NormalSolver,
        separation: FloatArray,
        control: Control,
        report: SolveReport[Certificate],
        progress: Progress | None,
        tolerance: float | None = None,
        springs: FloatArray | None = None,
    ) -> None:
        self.solver, self.grid, self.options = solver, solver.grid, solver.options
        if tolerance is not None:
            self.options = replace(solver.options, tolerance=tolerance)
        self.separation, self.control, self.report, self.progress = separation, control, report, progress
        self.free = control.forces()
        self._springs = {} if springs is None else {self.grid: springs}

    def run(self, start: FloatArray | None) -> NormalSolution:
        """Solve on the grids from coarse to fine; with a start, only on the finest."""
        fixed = self._without_prescribed(self.grid, self.separation)
        if self._never_touches(fixed):
            return self._empty(fixed)
        if start is not None and np.any(start > 0):
            return self._finest(fixed, np.array(start, dtype=float))
        ladder = [(self.grid, fixed, (1, 1))]
        while (factors := coarse_factors(ladder[-1][0])) is not None:
            grid, field_, _ = ladder[-1]
            if len(ladder) >= _RUNGS and grid.nx * grid.ny <= _FEWEST:
                break
            ladder.append((grid.coarsened(*factors), restrict(field_, factors), factors))
            if grid in self._springs:
                springs = restrict_springs(self._springs[grid], factors, self._cell_compliance(grid))
                self._springs[ladder[-1][0]] = springs
        return self._finest(fixed, self._from_below(ladder))

    def _from_below(self, ladder: list[tuple[Grid, FloatArray, tuple[int, int]]]) -> FloatArray | None:
        """Start for the finest grid from coarser grids, which are then released; None without a coarser grid."""
        pressure: FloatArray | None = None
        while len(ladder) > 1:
            grid, field_, factors = ladder.pop()
            tolerance = _COARSE_TOLERANCE if len(ladder) == 1 else _COARSER_TOLERANCE
            pressure = self._prolonged(self._coarse(grid, field_, pressure, tolerance), grid, ladder[-1][0], factors)
        return pressure

    def _cell_compliance(self, grid: Grid) -> float:
        """Displacement of a cell by a unit pressure on itself [m/Pa]."""
        compliance = self.solver.compliance(grid)
        compliance.table(1, 1)
        return compliance.unit

    def _prolonged(self, pressure: FloatArray, grid: Grid, finer: Grid, factors: tuple[int, int]) -> FloatArray:
        """Pressure on the next finer grid; its product with the relative compliance is smooth, and is interpolated."""
        if not self._springs:
            return prolong(pressure, factors, finer.shape)
        coarse, fine = (self._springs[level] / self._cell_compliance(level) for level in (grid, finer))
        return prolong(pressure * (1.0 + coarse), factors, finer.shape) / (1.0 + fine)

    def _coarse(self, grid: Grid, fixed: FloatArray, pressure: FloatArray | None, tolerance: float) -> FloatArray:
        """Approximate solution on a coarser grid, as a start only."""
        if 0 not in self.free and fixed.min() >= 0:  # the merged cells do not touch yet
            return np.zeros(grid.shape)
        compliance = self.solver.compliance(grid)
        box = self.solver.box(compliance, pressure)
        p, _ = self._on_box(compliance, fixed, pressure, box, max(tolerance, self.options.tolerance), 60)
        return p

    def _finest(self, fixed: FloatArray, pressure: FloatArray | None) -> NormalSolution:
        """Solve on the whole grid; grow the box while the certificate finds overlap outside it."""
        options, grid = self.options, self.grid
        compliance = self.solver.compliance(grid)
        window = Box(0, grid.ny, 0, grid.nx)
        box = self.solver.box(compliance, pressure)
        compliance.reserve(box, window)
        tolerance = 0.7 * options.tolerance  # margin of the iteration, so that the certificate holds
        budget = options.max_iterations
        for _ in range(50):
            iterations = self.report.iterations
            pressure, residual = self._on_box(compliance, fixed, pressure, box, tolerance, budget)
            budget -= self.report.iterations - iterations
            solution, overlapping = self._certify(compliance, fixed, pressure, box)
            certificate = solution.report.certificate
            if certificate is not None and certificate.holds:
                if not (options.periodic or options.allow_contact_at_edge):
                    refuse_edge(solution.pressure, grid)
                return solution
            grown = box if overlapping is None else box.union(overlapping).grown(*margin(box), grid.shape)
            if grown == box:
                if residual > tolerance or budget <= 0 or tolerance < 0.05 * options.tolerance:
                    break
                tolerance *= 0.3  # the updated gap has drifted from the true one
            box = grown
        raise NotConverged(
            f"normal contact did not converge in {self.report.iterations} iterations on {grid.nx} x {grid.ny} cells: "
            f"{self.report.certificate}; raise max-iterations, loosen the tolerance"
            + (" or use double precision" if options.precision == "single" else ""),
            self.report,
        )

    def _without_prescribed(self, grid: Grid, separation: FloatArray) -> FloatArray:
        """Separation minus the prescribed rigid displacements [m]; the separation if there are none."""
        if not any(self.control.displacements().values()):
            return np.asarray(separation, dtype=float)
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
        """Solution without contact: with zero load the bodies just touch."""
        require(not any(self.free.values()), "step", "moment", self.free, "zero where the normal load is zero")
        approach = float(fixed.min()) if 0 in self.free else float(self.control.approach or 0.0)
        gap = fixed - approach if 0 in self.free else fixed.copy()
        zero = np.zeros(self.grid.shape)
        self.report.certificate = Certificate(gap=0.0, penetration=0.0, load=0.0, tolerance=self.options.tolerance)
        rigid = self.control.displacements() | dict.fromkeys(self.free, 0.0) | {0: approach}
        return self._solution(zero, gap, zero.copy(), rigid, [0.0, 0.0, 0.0])

    def _solution(
        self, pressure: FloatArray, gap: FloatArray, displacement: FloatArray, rigid: dict[int, float],
        forces: list[float],
    ) -> NormalSolution:  # fmt: skip
        """Solution with rigid displacements and forces by number of mode."""
        return NormalSolution(
            pressure=pressure, gap=gap, displacement=displacement, report=self.report,
            **{mode.displacement: rigid[number] for number, mode in enumerate(MODES)},
            **{mode.force: forces[number] for number, mode in enumerate(MODES)},
        )  # fmt: skip

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
        separation = fixed[box.slices]
        modes, forces, _ = self._modes(grid, box)
        dtype = np.float64 if compliance.options.precision == "double" else np.float32
        # Lengths are in units of a typical deflection, pressures in length/unit, so that all numbers are of order one.
        length = unit * self.free[0] / grid.cell_area if 0 in self.free else -float(fixed.min())
        scale = length / unit
        if pressure is not None and np.any(pressure[box.slices] > 0):
            p = pressure[box.slices]  # the start is not needed again: its memory is reused
            p /= scale
            loaded = p > 0
        else:
            p, loaded = self._first(separation, grid)
            p = p / scale
        circulant = self.solver.circulant(compliance, box)
        # The circulant is cheaper. Away from the edges its energy of pressures without a resultant is right to a few %.
        energy = circulant.forward.energy if 0 in self.free and box.shape != grid.shape else operator.energy
        problem = BoxProblem(
            apply=operator,
            precondition=circulant.inverse,
            separation=(separation / length).astype(dtype),
            modes=modes,
            forces=forces / (scale * grid.cell_area),
            least_deflection=self._least_deflection(compliance) / length,
            energy=energy,
            threads=compliance.options.threads or available_threads(),
        )
        if grid in self._springs:
            springs = self._springs[grid][box.slices] / unit
            soft = springs.astype(dtype)
            problem = replace(
                problem,
                apply=lambda pressure: operator(pressure) + soft * pressure,
                precondition=SpringPreconditioner(circulant, springs),
                energy=lambda pressure: energy(pressure) + dot(pressure, soft * pressure),
                share=(circulant.middle / (circulant.middle + springs)).astype(dtype),
            )

        def note(residual: float) -> None:
            self.report.history.append((grid.nx * grid.ny, residual))
            if self.progress is not None:
                self.progress(f"{grid.nx} x {grid.ny} cells", residual, self.options.tolerance)

        state, budget = BoxState(p.astype(dtype, copy=False), np.zeros(len(modes)), inf), max(1, iterations)
        for solve in (solve_box, solve_settled):
            iterations_before = self.report.iterations
            state = solve(
                problem, state.pressure, loaded, tolerance=tolerance, max_iterations=budget, on_iteration=note
            )
            budget -= self.report.iterations - iterations_before
            if state.residual <= tolerance or budget <= 0:
                break
            loaded = state.pressure > 0
        out = np.zeros(grid.shape)
        out[box.slices] = state.pressure
        out[box.slices] *= scale  # memory pages outside the box stay untouched
        return out, state.residual

    def _modes(self, grid: Grid, box: Box) -> tuple[RigidModes, FloatArray, FloatArray]:
        """Force-controlled modes on a box scaled to order one, their forces, and the scales."""
        fields, sizes = [], []
        for mode in self.free:
            size = float(np.abs(mode_field(mode, self.grid)).max()) or 1.0
            fields.append(_cut(mode_field(mode, grid), box) / size)
            sizes.append(size)
        return RigidModes(fields), np.array(list(self.free.values())) / np.array(sizes), np.array(sizes)

    def _first(self, separation: FloatArray, grid: Grid) -> tuple[FloatArray, NDArray[np.bool_]]:
        """Start without an estimate: load on the lowest cells, or zero pressure on overlapping cells."""
        if 0 not in self.free:
            return np.zeros(separation.shape), separation < 0
        loaded = np.ones(separation.shape, dtype=bool)
        if len(self.free) == 1:
            # Round-off must not distinguish cells that are equal by symmetry; scaled scenes then take the same
            # iterations.
            low, quarter = float(separation.min()), float(np.quantile(separation, 0.25))
            loaded = separation <= quarter + 1e-6 * (quarter - low)
        return np.where(loaded, self.free[0] / (grid.cell_area * loaded.sum()), 0.0), loaded

    def _certify(
        self, compliance: Compliance, fixed: FloatArray, pressure: FloatArray, box: Box
    ) -> tuple[NormalSolution, Box | None]:
        """Check the contact conditions on the whole window, with a separate convolution."""
        grid, options = self.grid, self.options
        window = Box(0, grid.ny, 0, grid.nx)
        source = window if options.periodic else box
        inner = pressure[source.slices]
        top = float(inner.max()) or 1.0
        displacement = np.asarray(compliance.between(source, window)(inner / top), dtype=float)
        displacement *= top * compliance.unit
        deflected = displacement + self._springs[grid] * pressure if self._springs else displacement
        gap = fixed + deflected
        loaded = inner > 0
        weight = loaded.astype(float)
        modes, _, sizes = self._modes(grid, source)
        fit = modes.fit(gap[source.slices] * weight, weight) / sizes
        rigid = {mode: float(value) for mode, value in zip(self.free, fit, strict=True)}
        for mode, value in rigid.items():
            gap -= value * mode_field(mode, grid)
        # Without any pressure the overlap is relative to itself, so that such a state is never certified.
        deflection = max(float((deflected[source.slices] * weight).max()), self._least_deflection(compliance))
        deflection = deflection or max(0.0, -float(gap.min())) or inf
        near = gap[source.slices]
        inside = float(np.abs(near * weight).max()) / deflection
        overlap = max(0.0, -_least_outside(gap, source), -float((near * (1.0 - weight)).min())) / deflection
        rigid_modes = RigidModes([_cut(mode_field(mode, grid), source) for mode in range(3)])
        forces = [float(force) * grid.cell_area for force in rigid_modes.project(inner)]
        self.report.certificate = Certificate(
            gap=inside, penetration=overlap, load=self._load_error(forces), tolerance=options.tolerance
        )
        rigid |= self.control.displacements()
        overlapping = None
        if overlap > options.tolerance:
            overlapping = Box.around((pressure == 0) & (gap < -options.tolerance * deflection))
        return self._solution(pressure, gap, displacement, rigid, forces), overlapping

    def _least_deflection(self, compliance: Compliance) -> float:
        """Displacement of a cell by its share of the prescribed load, uniform over the window [m]; 0 without a load.

        On a half-space the deflection in contact is always larger. A periodic body does not deflect under a uniform
        pressure, because its mean displacement is zero by definition; this value is then the reference of its gaps.
        """
        grid = compliance.grid
        return compliance.unit * self.free.get(0, 0.0) / (grid.nx * grid.ny * grid.cell_area)

    def _load_error(self, forces: list[float]) -> float:
        """Largest relative error of the prescribed forces; moments are relative to the load at half the window."""
        load = abs(self.free.get(0, forces[0]))
        arm = 0.5 * max(self.grid.sides)
        errors = [abs(forces[m] - value) / (load * (arm if m else 1.0)) for m, value in self.free.items() if load > 0]
        return max(errors, default=0.0)


def refuse_edge(pressure: FloatArray, grid: Grid) -> None:
    """Refuse a contact at the edge of the window, because the edge may cut it off.

    Raises
    ------
    DomainTooSmall
        The outermost cells carry pressure.
    """
    ends = (pressure[:, [0, -1]], pressure[[0, -1]])
    sides = {"xy"[axis]: ends[axis] for axis in grid.ended_axes}
    touched = [name for name, edge in sides.items() if np.any(edge > 0)]
    if touched:
        sizes = " x ".join(f"{size:.4g} m" for size in grid.sides)
        raise DomainTooSmall(
            f"contact must stay inside the window (it reaches its edge along {' and '.join(touched)}; the window "
            f"is {sizes}); enlarge grid size, lower the load, or set "
            "numerics.allow-contact-at-edge = true if the bodies end there",
            touched,
        )


def margin(box: Box) -> tuple[int, int]:
    """Rows and columns around a loaded box for growth of the contact."""
    return tuple(max(2, -(-n // 128)) for n in box.shape)  # type: ignore[return-value]


def _cut(field: FloatArray, box: Box) -> FloatArray:
    """Part of a broadcastable field in a box."""
    rows, columns = box.slices
    return field[rows if field.shape[0] > 1 else slice(None), columns if field.shape[1] > 1 else slice(None)]


def _least_outside(field: FloatArray, box: Box) -> float:
    """Smallest value of a field outside a box; infinity if the box is the whole field."""
    strips = (field[: box.y0], field[box.y1 :], field[box.y0 : box.y1, : box.x0], field[box.y0 : box.y1, box.x1 :])
    return min((float(strip.min()) for strip in strips if strip.size), default=inf)
