"""Runners of a contact: separation, normal contact, tangential displacement, closed form beside it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.grid import Grid
from eigencontact.execution.runners import State
from eigencontact.planning.blocks import Block
from eigencontact.planning.kernels import PairCoefficients
from eigencontact.planning.plan import Plan
from eigencontact.plugin import HasReferencePressure
from eigencontact.scene.holding import TRAVEL
from eigencontact.scene.schema import Numerics
from eigencontact.solvers.contact_area import contact_area
from eigencontact.solvers.normal import NormalSolver
from eigencontact.solvers.solution import NormalOptions, NormalSolution

__all__ = [
    "NormalContact",
    "ReferencePressure",
    "Separation",
    "TangentialDisplacement",
    "normal_options",
    "normal_scalars",
]

FloatArray = NDArray[np.float64]


def normal_options(numerics: Numerics) -> NormalOptions:
    """Options of the normal solver from the numerics of a scene."""
    return NormalOptions(
        tolerance=numerics.tolerance,
        max_iterations=numerics.max_iterations,
        precision=numerics.precision,
        threads=numerics.threads,
        periodic=numerics.boundary == "periodic",
        allow_contact_at_edge=numerics.allow_contact_at_edge,
    )


def normal_scalars(solution: NormalSolution, grid: Grid, *, periodic: bool) -> dict[str, float]:
    """Numbers of a normal contact, as they are stored."""
    certificate = solution.report.certificate
    assert certificate is not None
    loaded = solution.pressure > 0
    area = contact_area(loaded, grid, periodic=periodic)
    return {
        "normal_load": solution.normal_load,
        "approach": solution.approach,
        "tilt_x": solution.tilt_x,
        "tilt_y": solution.tilt_y,
        "moment_x": solution.moment_x,
        "moment_y": solution.moment_y,
        "contact_area": area,
        "contact_area_counted": float(np.count_nonzero(loaded)) * grid.cell_area,
        "contact_radius": float(np.sqrt(area / np.pi)),
        "max_pressure": float(solution.pressure.max()),
        "iterations": float(solution.report.iterations),
        "convolutions": float(solution.report.convolutions),
        "solve_seconds": solution.report.seconds,
        "gap_residual": certificate.gap,
        "penetration_residual": certificate.penetration,
        "load_residual": certificate.load,
    }


class Separation:
    """The initial gap; where the geometry rolls, at the place that it has reached, which is stored."""

    def __init__(self, plan: Plan, block: Block) -> None:
        self._plan, self._rolls = plan, bool(block.settings.get("rolls", False))
        self._at: tuple[float, float] | None = None
        self._field = np.empty(0)

    def __call__(self, state: State) -> None:
        """Advance one step; see `Runner`."""
        if state.travel != self._at:
            self._field, self._at = self._plan.separation(state.travel), state.travel
        state.fields["separation"] = self._field
        if self._rolls:
            state.scalars |= dict(zip(TRAVEL, state.travel, strict=True))


class NormalContact:
    """Pressure and gap; eigenstrain that lifts or lowers the surfaces changes the gap before any load."""

    def __init__(self, plan: Plan, _block: Block) -> None:
        coefficients = PairCoefficients(plan.influences["p"], plan.bodies, "z")
        self._solver = NormalSolver(plan.grid, coefficients, normal_options(plan.scene.numerics))

    def __call__(self, state: State) -> None:
        """Advance one step; see `Runner`."""
        self._solve(state, None, None)

    def attempt(self, state: State, tolerance: float) -> None:
        """Solve to a tolerance, from the pressure that the state may hold; on the way contact may pass the edge."""
        given = self._solver.options
        self._solver.options = replace(given, allow_contact_at_edge=True)
        try:
            self._solve(state, tolerance, state.fields.get("pressure"))
        finally:
            self._solver.options = given

    def _solve(self, state: State, tolerance: float | None, start: FloatArray | None) -> None:
        separation, control = state.fields["separation"], state.control
        assert control is not None
        residual = state.fields.get("residual_displacement_z")
        if residual is not None:
            separation = separation + residual
        solution = self._solver.solve(separation, control, start=start, tolerance=tolerance, progress=state.progress)
        state.fields["pressure"] = solution.pressure
        state.fields["gap"] = solution.gap
        state.fields["displacement_z"] = solution.displacement
        state.scalars |= normal_scalars(solution, self._solver.grid, periodic=self._solver.options.periodic)


class TangentialDisplacement:
    """Displacement along the surface under the pressure."""

    def __init__(self, plan: Plan, _block: Block) -> None:
        from eigencontact.convolution import Convolver, Layout

        grid, numerics = plan.grid, plan.scene.numerics
        periodic = numerics.boundary == "periodic"
        layout = Layout(grid.shape, grid.shape, periodic=periodic)
        self._kernels = []
        for component in "xy":
            pair = PairCoefficients(plan.influences["p"], plan.bodies, component)
            if periodic:
                ky, kx = layout.wavenumbers(grid.dy, grid.dx)
                spectrum = layout.spectrum_from_response(
                    pair.response(kx[None, :], ky[:, None]), pair.parity, precision=numerics.precision
                )
            else:
                table = pair.table(
                    layout.lattice_x * grid.dx, layout.lattice_y * grid.dy, (0.5 * grid.dx, 0.5 * grid.dy)
                )
                spectrum = layout.spectrum(table, pair.parity, precision=numerics.precision)
            self._kernels.append([spectrum])
        self._convolver = Convolver(layout, precision=numerics.precision, threads=numerics.threads)

    def __call__(self, state: State) -> None:
        """Advance one step; see `Runner`."""
        values = self._convolver.apply(state.fields["pressure"][None], self._kernels)
        state.fields["displacement_x"], state.fields["displacement_y"] = np.asarray(values, dtype=float)


class ReferencePressure:
    """Closed form of the pressure, where the geometry has one that holds for this step.

    For a body with layers, inclusions or eigenstrain it is that without them, and stored under another name.
    """

    def __init__(self, plan: Plan, block: Block) -> None:
        from eigencontact.core.material import contact_modulus
        from eigencontact.planning.bodies import without_layers

        self._grid = plan.grid
        self._modulus = contact_modulus(*without_layers(plan.bodies))
        (self._name,) = block.provides
        geometry = plan.geometries[0]
        assert isinstance(geometry, HasReferencePressure)
        self._geometry = geometry

    def __call__(self, state: State) -> None:
        """Advance one step; see `Runner`."""
        if state.scalars["normal_load"] <= 0 or state.scalars["tilt_x"] or state.scalars["tilt_y"]:
            return
        y, x = self._grid.axes()
        x, y = x - state.travel[0], y - state.travel[1]
        field_ = self._geometry.reference_pressure(x, y, state.scalars["normal_load"], self._modulus)
        state.fields[self._name] = np.broadcast_to(field_, self._grid.shape)
