"""Frictionless normal contact of two elastic bodies."""

from __future__ import annotations

from time import perf_counter

import numpy as np

from eigencontact.core.array_types import FloatArray
from eigencontact.core.grid import Box, Grid
from eigencontact.errors import SceneError, require
from eigencontact.solvers.coarse_to_fine import CoarseToFine, margin
from eigencontact.solvers.control import Control
from eigencontact.solvers.operator import Coefficients, Compliance
from eigencontact.solvers.preconditioner import Circulant
from eigencontact.solvers.report import Certificate, Progress, SolveReport
from eigencontact.solvers.solution import NormalOptions, NormalSolution

__all__ = ["NormalOptions", "NormalSolution", "NormalSolver"]


class NormalSolver:
    """Normal contact on one grid for any number of solutions; coefficients, spectra and FFT plans are reused.

    Parameters
    ----------
    grid : Grid
        Cells; the pressure is uniform on each.
    coefficients : Coefficients
        Normal displacement of a uniformly loaded rectangle, both bodies summed [m/Pa].
    options : NormalOptions, optional
        Tolerance, precision, periodicity and other options.

    Examples
    --------
    >>> class Winkler:  # a bed of springs, 1 m/Pa
    ...     def table(self, x, y, half_widths):
    ...         return np.where((x[None] == 0) & (y[:, None] == 0), 1.0, 0.0)
    >>> grid = Grid(nx=8, ny=8, dx=1.0, dy=1.0)
    >>> h = 0.1 * (grid.x[None] ** 2 + grid.y[:, None] ** 2)
    >>> solution = NormalSolver(grid, Winkler()).solve(h, Control(approach=0.3))
    >>> round(float(solution.pressure.max()), 6)
    0.25
    """

    def __init__(self, grid: Grid, coefficients: Coefficients, options: NormalOptions | None = None) -> None:
        self.grid, self.coefficients, self.options = grid, coefficients, options or NormalOptions()
        self._compliances: dict[Grid, Compliance] = {}
        self._circulants: dict[Grid, tuple[Box, Circulant]] = {}

    def solve(
        self,
        separation: FloatArray,
        control: Control,
        *,
        springs: FloatArray | None = None,
        start: FloatArray | None = None,
        tolerance: float | None = None,
        progress: Progress | None = None,
    ) -> NormalSolution:
        """Solve p >= 0, g >= 0, p g = 0 for ``g = h + u(p) + k p - δ - φx y + φy x``.

        Thesis eqs 2.67-2.72, which have no springs k.

        Parameters
        ----------
        separation : (ny, nx) float64
            Initial separation h [m].
        control : Control
            Load or approach, moments or tilts.
        springs : (ny, nx) float64, optional
            Layer of independent springs k [m/Pa], nonnegative; none by default.
        start : (ny, nx) float64, optional
            Pressure near the solution; the solver then omits the coarse grids.
        tolerance : float, optional
            Replaces the tolerance of the options, for outer iterations.
        progress : callable, optional
            Called with the residual of each iteration.

        Returns
        -------
        NormalSolution
            Solution with a valid certificate.

        Raises
        ------
        NotConverged
            The exception has the report; a partial result is never returned.
        DomainTooSmall
            Contact at the edge of the window, unless allowed or periodic.
        SceneError
            Separation or springs are not finite, springs are negative, or the window cannot carry a moment.
        """
        began = perf_counter()
        _check(self.grid, separation, control, start)
        if springs is not None:
            _check_springs(self.grid, springs)
        report, before = SolveReport[Certificate](), self.convolutions
        try:
            return CoarseToFine(self, separation, control, report, progress, tolerance, springs).run(start)
        finally:
            report.convolutions = self.convolutions - before
            report.seconds = perf_counter() - began

    @property
    def convolutions(self) -> int:
        """Number of applications of the compliance, on all grids."""
        return sum(compliance.convolutions for compliance in self._compliances.values())

    def compliance(self, grid: Grid) -> Compliance:
        """Compliance on the finest or a coarser grid, built once.

        Coarser grids and the preconditioner use double precision. Single precision saved 8 % of the time, but amplified
        round-off of the input to 1e-9 of the pressure, and scaled scenes must agree to 1e-10.
        """
        if grid not in self._compliances:
            self._compliances[grid] = Compliance(grid, self.coefficients, self.options)
        return self._compliances[grid]

    def circulant(self, compliance: Compliance, box: Box) -> Circulant:
        """Circulant of one grid for preconditioners; that of the last box is cached."""
        key = compliance.grid
        cached = self._circulants.get(key)
        if cached is None or cached[0] != box:
            cached = self._circulants[key] = box, Circulant(compliance, box)
        return cached[1]

    def box(self, compliance: Compliance, pressure: FloatArray | None) -> Box:
        """Box of possible contact: the box of the start with a margin, or the whole window.

        It depends on the start alone, not on earlier solves, so that a resumed history repeats an uninterrupted one
        exactly.
        """
        grid = compliance.grid
        window = Box(0, grid.ny, 0, grid.nx)
        loaded = None if pressure is None else Box.around(pressure > 0)
        if loaded is None:
            return window
        box = loaded.grown(*margin(loaded), grid.shape)
        if self.options.periodic and max(box.shape[0] / grid.ny, box.shape[1] / grid.nx) > 0.5:
            return window
        return box


def _check(grid: Grid, separation: FloatArray, control: Control, start: FloatArray | None) -> None:
    require(separation.shape == grid.shape, "contact", "separation", separation.shape, f"of shape {grid.shape}")
    if not np.all(np.isfinite(separation)):
        bad = int(np.count_nonzero(~np.isfinite(separation)))
        raise SceneError(f"separation must be finite at every cell (got {bad} NaN or infinite of {separation.size})")
    if start is not None:
        require(start.shape == grid.shape, "contact", "start", start.shape, f"of shape {grid.shape}")
    if control.normal_load:
        sides = {
            "moment_x": (grid.center[1], grid.size[1], grid.dy),
            "moment_y": (-grid.center[0], grid.size[0], grid.dx),
        }
        unit = grid.unit("N m")
        for name, (middle, side, edge) in sides.items():
            moment = getattr(control, name)
            if moment is None:
                continue
            limit, about = 0.5 * control.normal_load * side, moment - control.normal_load * middle
            if abs(about) >= limit:
                raise SceneError(
                    f"step.{name} must be smaller than the load times half the window, {limit:.4g} {unit} "
                    f"(got {about:.4g}{' about the middle of the window' if middle else ''}); the centre of pressure "
                    "would lie outside the window"
                )
            borne = 0.5 * control.normal_load * (side - edge)
            if abs(about) > 1e-12 * limit and abs(about) >= (1.0 - 1e-12) * borne:
                raise SceneError(
                    f"step.{name} must be smaller than the load times the distance of the outermost middles "
                    f"of cells, {borne:.4g} {unit} (got {about:.4g}{' about the window' if middle else ''}): "
                    "pressure that is uniform in each cell bears no more; give smaller cells or a larger window"
                )


def _check_springs(grid: Grid, springs: FloatArray) -> None:
    require(springs.shape == grid.shape, "contact", "springs", springs.shape, f"of shape {grid.shape}")
    wrong = ~(np.isfinite(springs) & (springs >= 0))
    if np.any(wrong):
        raise SceneError(
            f"springs must be finite and zero or positive [m/Pa] at every cell (got {springs[wrong][0]:.4g} and "
            f"{np.count_nonzero(wrong) - 1} more such of {springs.size}); leave them out where there are none"
        )
