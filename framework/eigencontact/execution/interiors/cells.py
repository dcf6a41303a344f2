"""Inhomogeneities of one body in cells: each with an eigenstrain of its own, found by a Krylov solve or by sweeps."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigencontact.convolution import Layout
from eigencontact.execution.block import Cost
from eigencontact.execution.contact import Fields
from eigencontact.execution.increment import Increment
from eigencontact.execution.interiors.interior import Remembered, loads
from eigencontact.execution.interiors.responding import Responding
from eigencontact.execution.material_cells import MaterialCells, is_linear
from eigencontact.execution.routes.route import Pace
from eigencontact.execution.sampling import sampling_seconds, spectra_cost
from eigencontact.model.boxes import box_of_inhomogeneities
from eigencontact.model.kernels import KernelUse, StressCoefficients
from eigencontact.model.model import Model
from eigencontact.plugin import ConstitutiveLaw, LawStep, LinearLaw, VariesInSpace
from eigencontact.results.records import HistoryRecord

__all__ = ["Cells"]

FloatArray = NDArray[np.float64]

import os
SWEEP = bool(os.environ.get("SWEEP"))
#: Krylov iterations of one solve and rounds between it and the contact, typically, for the cost.
_ITERATIONS, _ROUNDS = 15, 8


class Cells(Responding):
    """Equivalent eigenstrain of the cells of one box.

    Parameters
    ----------
    model : Model
        With inhomogeneities, cut into cells, in that body.
    body : int
        1 or 2.
    directions : str
        Of ``"xyz"``: along which the displacement of the surface is wanted.
    """

    def __init__(self, model: Model, body: int, directions: str) -> None:
        sources = [source for source in model.inhomogeneities if source.body == body]
        self._box, self._grid = box_of_inhomogeneities(sources), model.grid
        super().__init__(model, body, directions, self._box.centres(model.grid))
        self._kernels = [StressCoefficients(model.influences[t.name], model.half_space(body)) for t in model.tractions]
        count = len(sources)
        self.why = f"equivalent eigenstrain of {count} inhomogeneit{'ies' if count != 1 else 'y'}"
        laws = [source.law for source in self.sources]
        self._laws: list[tuple[ConstitutiveLaw, NDArray[np.bool_]]] = []
        self.sweeps = any(not is_linear(law) for law in laws) or SWEEP
        self._declare(model)

    def _declare(self, model: Model) -> None:
        """Price and kernels."""
        (nz, ny, nx), (_, row, column) = self._box.lattice.shape, self._box.lattice.first
        key = str(getattr(self._half_space.cell, "key", "cell"))
        who = f"eigenstrain of {self._box.names}"
        uses = [KernelUse("mean stress (6 components)", who, key, self._box.words, 58)]
        one = Pace.of(self._half_space, "stress").volume(self._box.lattice, (ny, nx), (0.0, 0.0), nz)
        applications = _ITERATIONS if not self._kernels else (_ITERATIONS + 4) * (1.0 + 0.3 * (_ROUNDS - 1))
        # Eight Gauss points make the means; the solver keeps two vectors of six components an iteration.
        cost = Cost(
            memory=one.memory + 8.0 * 12 * self._box.lattice.cells * _ITERATIONS,
            seconds_once=8.0 * one.seconds_once,
            seconds_per_step=one.seconds_per_step * applications,
        )
        layout = Layout(self._grid.shape, (ny, nx), (row, column))
        for item in model.tractions:
            influence = model.influences[item.name]
            seconds = 8.0 * sampling_seconds(influence, self._half_space.material)
            cost += spectra_cost(layout, nz, seconds, model.numerics)
            uses.append(
                KernelUse("mean stress (6 components)", f"traction {item.name}", influence.key, self._box.words, nz)
            )
            uses.append(KernelUse(f"mean displacement {item.direction}", who, influence.key, "surface", nz))
        if self._surface is not None:
            cost += self._surface.cost
            words = f"displacement {', '.join(self._centres)}"
            uses.append(KernelUse(words, who, key, f"surface, {self._surface.words}"))
        self.kernels = tuple(uses)
        self.cost = cost if self._prescribed is None else cost + self._prescribed.cost

    def start(self) -> None:
        """See `Interior.start`."""
        from eigencontact.solvers.cell_sweeps import CellSweeps
        from eigencontact.solvers.equivalent_inclusions import InhomogeneousCells
        from eigencontact.solvers.law_cells import LawCells
        from eigencontact.solvers.mean_stress import MeanVolumeField
        from eigencontact.solvers.mean_surface import MeanStressKernel, SurfaceAndCells

        precision, threads = self._numerics.precision, self._numerics.threads
        cells, grid, matrix = self._box.cells(self._grid), self._grid, self._half_space.material
        self._content = content = MaterialCells(self._box, self.sources, grid)
        operator = MeanVolumeField(
            self._half_space.cell, cells, cells, precision=precision, **self._half_space.options("stress")
        )
        self._places = self._box.centres(grid).flat_points()
        linear = content.linear
        self._system = InhomogeneousCells(
            operator,
            matrix,
            [_of_box(law, self._places) for law in linear.laws],
            linear.index,
            fraction=linear.fraction,
            beside=linear.beside,
            normal=linear.normal,
        )
        if self.sweeps:
            self._laws = content.others
            groups = [(law, np.flatnonzero(index)) for law, index in self._laws]
            self._sweeps = CellSweeps(self._system, LawCells(matrix, self._system.alone, groups))
        self._joint = None
        if self._kernels:
            kernels = [MeanStressKernel(kernel, cells.pitch[2]) for kernel in self._kernels]
            directions = "".join(item.direction for item in self._tractions)
            self._joint = SurfaceAndCells(grid, kernels, directions, cells, precision=precision, threads=threads)

    def begin(self, increment: Increment, last: Remembered) -> None:
        """See `Interior.begin`."""
        super().begin(increment, last)
        self._before = [self._variables(law, np.flatnonzero(index), last) for law, index in self._laws]
        self._after = self._before
        duration = increment.times[1] - increment.times[0]
        self._steps = [_law_step(self._places, np.flatnonzero(index), self._time, duration) for _, index in self._laws]

    def _variables(self, law: ConstitutiveLaw, cells: NDArray[np.intp], last: Remembered) -> dict[str, FloatArray]:
        """What the cells of a law remember; zero at rest."""
        found = {}
        for name, variable in law.variables.items():
            known = last.get(f"{name}_{self.body}")
            shape = (variable.components, cells.size)
            found[name] = np.zeros(shape) if known is None else known.values.reshape(shape[0], -1)[:, cells]
        return found

    def remembered(self) -> dict[str, HistoryRecord]:
        """See `Interior.remembered`."""
        found = super().remembered()
        for (law, index), variables in zip(self._laws, self._after, strict=True):
            for name, variable in law.variables.items():
                own = f"{name}_{self.body}"
                if own not in found:
                    values = np.zeros((variable.components, *self._content.shape))
                    found[own] = self._record(own, values, variable.unit, variable.meaning)
                found[own].values.reshape(variable.components, -1)[:, np.flatnonzero(index)] = variables[name]
        return found

    @property
    def unknown(self) -> FloatArray:
        """See `Interior.unknown`."""
        return self.eigenstrain if self.sweeps else np.zeros(0)

    def take(self, unknown: FloatArray) -> None:
        """See `Interior.take`."""
        self.eigenstrain = unknown

    def image(self, tractions: Fields, tolerance: float) -> tuple[FloatArray, float]:
        """See `Interior.image`."""
        if not self.sweeps:
            return super().image(tractions, tolerance)
        before = self._sweeps.applications
        found = self._sweeps.sweep(self.eigenstrain, self.applied(tractions), self._own, self._before, self._steps)
        self._after, self._residual = found.remembered, found.residual
        self._spent += self._sweeps.applications - before
        return found.image, found.residual

    def prestrain(self, time: float) -> FloatArray:
        """See `Responding.prestrain`."""
        return self._content.prestrain(time)

    def applied(self, tractions: Fields) -> FloatArray:
        """See `Responding.applied`."""
        total = np.zeros((6, *self._content.shape))
        if self._prescribed is not None:
            total += self._prescribed.at(self._time)
        if self._joint is not None and tractions and any(field.any() for field in tractions.values()):
            total += self._joint.stress(loads(self.body, self._tractions, tractions))
        return total

    def solve(self, applied: FloatArray, prestrain: FloatArray, tolerance: float) -> Any:
        """See `Responding.solve`."""
        return self._system.solve(
            applied, prestrain, start=self.eigenstrain, tolerance=tolerance,
            max_iterations=self._numerics.max_iterations, progress=self.progress,
        )  # fmt: skip

    def mean_displacement(self, eigenstrain: FloatArray) -> FloatArray:
        """See `Responding.mean_displacement`."""
        assert self._joint is not None
        return self._joint.displacement(eigenstrain)


class _OfCells:
    """Law whose constants depend on the place, in the cells of a box."""

    def __init__(self, law: VariesInSpace, places: tuple[FloatArray, FloatArray, FloatArray]) -> None:
        self._law, self._places = law, places

    def of_cells(self, index: NDArray[np.intp]) -> Any:
        """See `ElasticityOfCells`."""
        x, y, z = (axis[index] for axis in self._places)
        return self._law.at(x, y, z)


def _of_box(law: Any, places: tuple[FloatArray, FloatArray, FloatArray]) -> Any:
    """Elastic constants of a law in a box, by the centres of its cells."""
    return _OfCells(law, places) if isinstance(law, VariesInSpace) else law


def _law_step(
    places: tuple[FloatArray, FloatArray, FloatArray], cells: NDArray[np.intp], time: float, duration: float
) -> LawStep:
    x, y, z = (axis[cells] for axis in places)
    return LawStep(x=x, y=y, z=z, time=time, duration=duration)
