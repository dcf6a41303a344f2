"""The code behind each kind of block; a runner is built once per run and called once per load step."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.grid import Box
from eigencontact.core.tensors import from_mandel, hydrostatic, principal, tresca, von_mises
from eigencontact.errors import EigencontactError, PluginError
from eigencontact.planning.blocks import Block
from eigencontact.planning.kernels import PairCoefficients, StressCoefficients
from eigencontact.planning.plan import Plan
from eigencontact.planning.regions import RegionLattice
from eigencontact.plugin import HasReferencePressure, StepView
from eigencontact.results.records import RegionRecord
from eigencontact.scene.schema import StressRequest
from eigencontact.solvers.contact_area import contact_area
from eigencontact.solvers.control import Control
from eigencontact.solvers.normal import NormalOptions, NormalSolver
from eigencontact.solvers.report import Progress

__all__ = ["Runner", "State", "build_runner"]

FloatArray = NDArray[np.float64]


@dataclass(slots=True)
class State:
    """What one load step has produced so far."""

    index: int
    control: Control
    fields: dict[str, FloatArray] = field(default_factory=dict)
    scalars: dict[str, float] = field(default_factory=dict)
    regions: dict[str, RegionRecord] = field(default_factory=dict)
    observed: dict[str, float] = field(default_factory=dict)
    progress: Progress | None = None


class Runner(Protocol):
    """Advances the state of one load step."""

    def __call__(self, state: State) -> None:
        """Read what its block requires from the state and add what it provides."""
        ...


def build_runner(plan: Plan, block: Block) -> Runner:
    """Runner of a declared block; nothing of a block is built before this."""
    return _BUILDERS[block.runner](plan, block)


class _Separation:
    def __init__(self, plan: Plan, _block: Block) -> None:
        self._field = plan.separation()

    def __call__(self, state: State) -> None:
        state.fields["separation"] = self._field


class _NormalContact:
    def __init__(self, plan: Plan, _block: Block) -> None:
        numerics = plan.scene.numerics
        options = NormalOptions(
            tolerance=numerics.tolerance,
            max_iterations=numerics.max_iterations,
            precision=numerics.precision,
            threads=numerics.threads,
            periodic=numerics.boundary == "periodic",
            allow_contact_at_edge=numerics.allow_contact_at_edge,
        )
        coefficients = PairCoefficients(plan.influences["p"], plan.bodies, "z")
        self._solver = NormalSolver(plan.grid, coefficients, options)

    def __call__(self, state: State) -> None:
        solution = self._solver.solve(state.fields["separation"], state.control, progress=state.progress)
        state.fields["pressure"] = solution.pressure
        state.fields["gap"] = solution.gap
        state.fields["displacement_z"] = solution.displacement
        certificate = solution.report.certificate
        assert certificate is not None
        loaded = solution.pressure > 0
        area = contact_area(loaded, self._solver.grid, periodic=self._solver.options.periodic)
        state.scalars |= {
            "normal_load": solution.normal_load,
            "approach": solution.approach,
            "tilt_x": solution.tilt_x,
            "tilt_y": solution.tilt_y,
            "moment_x": solution.moment_x,
            "moment_y": solution.moment_y,
            "contact_area": area,
            "contact_area_counted": float(np.count_nonzero(loaded)) * self._solver.grid.cell_area,
            "contact_radius": float(np.sqrt(area / np.pi)),
            "max_pressure": float(solution.pressure.max()),
            "iterations": float(solution.report.iterations),
            "convolutions": float(solution.report.convolutions),
            "solve_seconds": solution.report.seconds,
            "gap_residual": certificate.gap,
            "penetration_residual": certificate.penetration,
            "load_residual": certificate.load,
        }


class _TangentialDisplacement:
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
        values = self._convolver.apply(state.fields["pressure"][None], self._kernels)
        state.fields["displacement_x"], state.fields["displacement_y"] = np.asarray(values, dtype=float)


class _ReferencePressure:
    def __init__(self, plan: Plan, _block: Block) -> None:
        from eigencontact.core.material import contact_modulus

        self._grid = plan.grid
        self._modulus = contact_modulus(*plan.bodies)
        geometry = plan.geometries[0]
        assert isinstance(geometry, HasReferencePressure)
        self._geometry = geometry

    def __call__(self, state: State) -> None:
        if state.scalars["normal_load"] <= 0 or state.scalars["tilt_x"] or state.scalars["tilt_y"]:
            return
        y, x = self._grid.axes()
        field_ = self._geometry.reference_pressure(x, y, state.scalars["normal_load"], self._modulus)
        state.fields["reference_pressure"] = np.broadcast_to(field_, self._grid.shape)


class _Stress:
    """One region; the spectra are kept as long as the contact stays in the box that they were made for."""

    def __init__(self, plan: Plan, block: Block) -> None:
        request, lattice = block.settings["request"], block.settings["lattice"]
        assert isinstance(request, StressRequest)
        assert isinstance(lattice, RegionLattice)
        self._request, self._lattice, self._grid = request, lattice, plan.grid
        body = plan.bodies[request.body - 1]
        assert body is not None
        self._kernel = StressCoefficients(plan.influences["p"], body)
        self._numerics = plan.scene.numerics
        self._operator: Any = None

    def __call__(self, state: State) -> None:
        pressure = state.fields["pressure"]
        request, lattice = self._request, self._lattice
        stress = self._at_points(pressure) if lattice.points is not None else self._on_lattice(pressure)
        fields = {"stress": from_mandel(stress)}
        scalars: dict[str, Callable[[FloatArray], FloatArray]] = {
            "von_mises": von_mises,
            "tresca": tresca,
            "principal": principal,
            "hydrostatic": hydrostatic,
        }
        fields |= {name: scalars[name](stress) for name in request.quantities}
        record = self._record(fields)
        state.regions[request.label] = record
        mises = fields.get("von_mises")
        mises = von_mises(stress) if mises is None else mises
        where = int(np.argmax(mises))
        largest = float(mises.flat[where])
        if largest >= state.scalars.get("max_von_mises", -1.0):
            depth = np.broadcast_to(self._depth_of(record), mises.shape).flat[where]
            state.scalars["max_von_mises"], state.scalars["max_von_mises_depth"] = largest, float(depth)

    def _at_points(self, pressure: FloatArray) -> FloatArray:
        from eigencontact.solvers.subsurface import stress_at_points

        assert self._lattice.points is not None
        points, threads = self._lattice.points, self._numerics.threads
        return stress_at_points(self._grid, [self._kernel], [pressure], points, threads=threads)

    def _on_lattice(self, pressure: FloatArray) -> FloatArray:
        from eigencontact.solvers.subsurface import SubsurfaceStress

        lattice, numerics = self._lattice, self._numerics
        box = Box.around(pressure > 0)
        shape = (6, lattice.depths.size, *lattice.target)
        if box is None:
            return self._cut(np.zeros(shape))
        if self._operator is None or not self._operator.covers(box):
            margin = 0 if self._operator is None else max(2, max(box.shape) // 6)
            self._operator = None  # its memory goes before the next is made
            self._operator = SubsurfaceStress(
                self._grid,
                [self._kernel],
                source=box.grown(margin, margin, self._grid.shape),
                target=lattice.target,
                origin=lattice.origin,
                depths=lattice.depths,
                periodic=numerics.boundary == "periodic",
                precision=numerics.precision,
                threads=numerics.threads,
            )
        return self._cut(np.asarray(self._operator.apply([pressure]), dtype=float))

    def _cut(self, stress: FloatArray) -> FloatArray:
        """Drop the axis of length one of a plane."""
        if self._request.shape != "plane":
            return stress
        return np.squeeze(stress, axis={"z": 1, "y": 2, "x": 3}[self._request.normal])

    def _record(self, fields: dict[str, FloatArray]) -> RegionRecord:
        request, lattice = self._request, self._lattice
        coords: dict[str, FloatArray | float]
        if lattice.points is not None:
            dims: tuple[str, ...] = ("point",)
            coords = {name: lattice.points[:, i] for i, name in enumerate("xyz")}
        else:
            axes = {"z": lattice.depths, "y": lattice.y, "x": lattice.x}
            flat = request.normal if request.shape == "plane" else ""
            dims = tuple(name for name in "zyx" if name != flat)
            coords = {name: float(axis[0]) if name == flat else axis for name, axis in axes.items()}
        return RegionRecord(
            name=request.label, shape=request.shape, body=request.body, dims=dims, coords=coords, fields=fields
        )

    @staticmethod
    def _depth_of(record: RegionRecord) -> FloatArray:
        depth = np.asarray(record.coords["z"], dtype=float)
        if record.dims and record.dims[0] == "z":
            return depth.reshape(-1, *[1] * (len(record.dims) - 1))
        return depth


class _Observer:
    def __init__(self, plan: Plan, block: Block) -> None:
        number = block.settings["number"]
        assert isinstance(number, int)
        self._name, self._observer = plan.observers[number]
        self._prefix = self._name.replace("-", "_")
        if [name for name, _ in plan.observers].count(self._name) > 1:
            self._prefix += f"_{number + 1}"
        self._grid = plan.grid

    def __call__(self, state: State) -> None:
        fields = {}
        for name, values in state.fields.items():
            view = values.view()
            view.flags.writeable = False
            fields[name] = view
        step = StepView(index=state.index, grid=self._grid, fields=fields, scalars=dict(state.scalars))
        try:
            numbers = self._observer.observe(step)
            state.observed |= {f"{self._prefix}_{name}": float(value) for name, value in numbers.items()}
        except EigencontactError:
            raise
        except Exception as problem:
            raise PluginError(
                f"observer {self._name!r} must return named numbers (got {type(problem).__name__}: {problem})"
            ) from problem


_BUILDERS: dict[str, Callable[[Plan, Block], Runner]] = {
    "separation": _Separation,
    "normal-contact": _NormalContact,
    "tangential-displacement": _TangentialDisplacement,
    "reference-pressure": _ReferencePressure,
    "stress": _Stress,
    "observer": _Observer,
}
