"""Frictionless contact: pressure and gap."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import log2
from typing import Any

import numpy as np

from eigencontact.convolution.layout import fast_even
from eigencontact.convolution.pace import speed
from eigencontact.core.array_types import FloatArray
from eigencontact.core.grid import Grid
from eigencontact.core.numbers import Number
from eigencontact.core.tractions import ALONG
from eigencontact.execution.blocks.block import Cost
from eigencontact.execution.blocks.contact import Contact, ContactAnswer, Fields, normal_options, scaled_forces
from eigencontact.execution.blocks.increment import Increment
from eigencontact.execution.blocks.precision import contact_precision
from eigencontact.execution.blocks.sampling import tables_of_images
from eigencontact.model.bodies import layered_bodies
from eigencontact.model.interface import Interface
from eigencontact.model.kernels import KernelUse, PairCoefficients
from eigencontact.model.window import Window
from eigencontact.results.records import StepRecord
from eigencontact.scene.schema import Numerics
from eigencontact.solvers.contact_area import area_under_pressure, radius_of_area
from eigencontact.solvers.control import Control
from eigencontact.solvers.normal import NormalSolver
from eigencontact.solvers.solution import NormalSolution

__all__ = [
    "NORMAL_FIELDS",
    "NORMAL_NUMBERS",
    "NormalContact",
    "cell_deflection",
    "layers_cost",
    "normal_cost",
    "normal_scalars",
    "normal_work",
    "scaled_normal",
    "surface_kernels",
]


#: Scalars of every contact.
NORMAL_NUMBERS = (
    Number(name="normal_load", unit="N", meaning="normal load", headline=True),
    Number(
        name="approach", unit="m", meaning="approach of distant points", headline=True,
        in_line="approach at the datum depth",
    ),
    Number(name="tilt_x", unit="rad", meaning="tilt about the x axis"),
    Number(name="tilt_y", unit="rad", meaning="tilt about the y axis"),
    Number(name="moment_x", unit="N m", meaning="moment about the x axis"),
    Number(name="moment_y", unit="N m", meaning="moment about the y axis"),
    Number(
        name="contact_radius", unit="m", meaning="radius of the circle of equal contact area", headline=True,
        scatters=True, in_line="half width of the contact",
    ),
    Number(
        name="contact_area", unit="m2", meaning="contact area, corrected for cells cut by the edge of the contact",
        headline=True, scatters=True, in_line="contact width",
    ),
    Number(
        name="contact_area_counted", unit="m2", meaning="area of the loaded cells", scatters=True,
        in_line="width of the loaded cells",
    ),
    Number(
        name="max_pressure", unit="Pa", meaning="largest contact pressure", headline=True, label="largest pressure"
    ),
    Number(
        name="gap_residual", unit="1", meaning="relative gap where there is pressure", role="certificate"
    ),
    Number(
        name="penetration_residual", unit="1", meaning="relative penetration where there is none", role="certificate"
    ),
    Number(name="load_residual", unit="1", meaning="relative error of the load", role="certificate"),
    Number(name="iterations", unit="1", meaning="iterations of the solver", role="effort", over="sum"),
    Number(name="convolutions", unit="1", meaning="convolutions of the solver", role="effort", over="sum"),
)  # fmt: skip
#: Surface fields of every contact.
NORMAL_FIELDS = frozenset({"pressure", "gap", "displacement_z"})


class NormalContact(Contact):
    """Pressure and gap; surface displacement by eigenstrain changes the gap before loading.

    Parameters
    ----------
    interface : Interface
    window : Window
    numerics : Numerics
    coupled : bool
        Whether inhomogeneities are iterated together with the contact.
    """

    name, reason = "normal-contact", "pressure, contact area, approach"
    fields = NORMAL_FIELDS
    numbers = NORMAL_NUMBERS

    def __init__(self, interface: Interface, window: Window, numerics: Numerics, *, coupled: bool) -> None:
        self._grid, self._coefficients = window.grid, interface.normal
        self._numerics, self.precisions = contact_precision(numerics, window.box, coupled=coupled)
        self.kernels = surface_kernels(interface, window, [("z", "z")])
        self.cost = normal_cost(window.grid.shape, window.box, self._numerics)
        self.cost += layers_cost(interface, window, ["p"], periodic=numerics.boundary == "periodic")

    def start(self) -> None:
        """See `Contact.start`."""
        self._solver = NormalSolver(self._grid, self._coefficients, normal_options(self._numerics))

    def recall(self, last: StepRecord | None, offset: Fields, bulk: Mapping[str, float]) -> None:
        """No state; see `Contact.recall`."""

    def solve(
        self,
        increment: Increment,
        memory: Any,
        offset: Fields,
        *,
        softer: float = 0.0,
        tolerance: float | None = None,
        start: ContactAnswer | None = None,
    ) -> ContactAnswer:
        """See `Contact.solve`."""
        assert increment.control is not None
        separation = increment.surface.separation
        assert separation is not None
        scale = 1.0 + softer
        solution = self._solver.solve(
            separation + offset["z"] if "z" in offset else separation,
            scaled_forces(increment.control, scale),
            start=None if start is None else scale * start.tractions["pressure"],
            tolerance=tolerance,
            progress=increment.progress,
        )
        solution = scaled_normal(solution, 1.0 / scale) if softer else solution
        return ContactAnswer(
            tractions={"pressure": solution.pressure},
            displacement={"z": solution.displacement},
            memory=memory,
            solution=solution,
            counts=normal_work(solution),
        )

    def pressed(
        self,
        control: Control,
        separation: FloatArray,
        fields: Fields,  # noqa: ARG002
        springs: FloatArray | None,
        start: FloatArray | None,
    ) -> FloatArray:
        """See `Contact.pressed`."""
        return self._solver.solve(separation, control, start=start, springs=springs).pressure

    @property
    def softness(self) -> float:
        """See `Contact.softness`."""
        return cell_deflection(self._coefficients, self._grid)

    def results(self, answers: Sequence[ContactAnswer]) -> tuple[dict[str, FloatArray], dict[str, float]]:
        """See `Contact.results`; the result does not depend on the load path."""
        solution: NormalSolution = answers[-1].solution
        fields = {"pressure": solution.pressure, "gap": solution.gap, "displacement_z": solution.displacement}
        scalars = normal_scalars(solution, self._grid, periodic=self._numerics.boundary == "periodic")
        return fields, scalars


def layers_cost(interface: Interface, window: Window, tractions: Sequence[str], *, periodic: bool) -> Cost:
    """Cost of the surface coefficients of layered bodies, for traction names with a kernel each."""
    if not layered_bodies(interface.solids):
        return Cost()
    from eigencontact.execution.blocks.layered_cost import layered_surface_cost

    return layered_surface_cost(interface.solids, window, tractions, periodic=periodic)


def surface_kernels(interface: Interface, window: Window, pairs: Sequence[tuple[str, str]]) -> tuple[KernelUse, ...]:
    """Kernels of surface displacement, by pairs of directions of displacement and traction."""
    grid, (by, bx) = window.grid, window.box
    layout = f"surface, {bx} x {by} of {grid.nx} x {grid.ny} cells"
    return tuple(KernelUse(f"displacement {i}", ALONG[j].words, interface.kernel_key(j), layout) for i, j in pairs)


def scaled_normal(solution: NormalSolution, factor: float) -> NormalSolution:
    """Solution with scaled tractions, forces and displacements by tractions; motions and gap do not change."""
    names = ("pressure", "displacement", "normal_load", "moment_x", "moment_y")
    return replace(solution, **{name: factor * getattr(solution, name) for name in names})


def cell_deflection(coefficients: PairCoefficients, grid: Grid) -> float:
    """Displacement of the centre of a cell by a unit pressure on it [m/Pa]."""
    return float(coefficients.table(np.zeros(1), np.zeros(1), grid.half_widths)[0, 0])


def normal_work(solution: NormalSolution) -> dict[str, float]:
    """Iterations and convolutions."""
    report = solution.report
    return {"iterations": float(report.iterations), "convolutions": float(report.convolutions)}


def normal_scalars(solution: NormalSolution, grid: Grid, *, periodic: bool) -> dict[str, float]:
    """Numbers of a normal contact for storage."""
    certificate = solution.report.certificate
    assert certificate is not None
    loaded = solution.pressure > 0
    area = area_under_pressure(solution.pressure, grid, periodic=periodic)
    return {
        "normal_load": solution.normal_load,
        "approach": solution.approach,
        "tilt_x": solution.tilt_x,
        "tilt_y": solution.tilt_y,
        "moment_x": solution.moment_x,
        "moment_y": solution.moment_y,
        "contact_area": area,
        "contact_area_counted": float(np.count_nonzero(loaded)) * grid.cell_area,
        "contact_radius": radius_of_area(area, grid),
        "max_pressure": float(solution.pressure.max()),
        "gap_residual": certificate.gap,
        "penetration_residual": certificate.penetration,
        "load_residual": certificate.load,
    }


def normal_cost(shape: tuple[int, int], box: tuple[int, int], numerics: Numerics) -> Cost:
    """Cost of a normal contact on a box of the window: finest grid, coarser grids, certificate, coefficients.

    The counts are typical of smooth contacts (8 iterations of two convolutions and one preconditioner, each grid with a
    quarter of the cells of the next finer one); rough contacts take up to three times as many. The fixed part was
    measured by repeated solves on grids of 24 to 96 cells per side: .1 ms per iteration, 1 ms per grid.
    """
    pace, periodic = speed(numerics.precision, numerics.threads), numerics.boundary == "periodic"
    ny, nx = shape
    by, bx = (ny, nx) if periodic and 2 * max(box[0] / ny, box[1] / nx) > 1 else box
    fy, fx = (by, bx) if periodic else (fast_even(2 * by), fast_even(2 * bx))
    levels = max(1.0, log2(max(2, min(ny, nx) / 16)))
    iteration = 2.0 * pace.convolution(fy, fx) + pace.convolution(fast_even(by), fast_even(bx))
    iteration += 1.5e-8 * by * bx + 1e-4  # the vectors of the conjugate gradients
    whole = pace.convolution(fast_even(ny + by), fast_even(nx + bx)) + 3e-8 * ny * nx
    solve = 8.5 * iteration * 1.7 + levels * 1e-3 + whole
    solve += tables_of_images(numerics) * 1.5e-8 * (ny + by) * (nx + bx) / 4
    if periodic:
        solve += 1.2e-7 * ny * nx  # the response of every wave, and the coefficients of one period from it
    real = 8 if numerics.precision == "double" else 4
    memory = 8.0 * ny * nx * 8 + real * by * bx * 12 + real * (fy * fx / 4 + 3 * by * fx) + 8 * (ny + by) * (nx + bx)
    return Cost(memory=memory, seconds_per_step=solve)
