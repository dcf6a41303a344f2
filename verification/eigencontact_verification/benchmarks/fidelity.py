"""Lower fidelities of the half-space and their price: error by depth, time and memory, against the exact theorem.

Cells of edge h in a window of n x n columns and 16 layers; all six components of eigenstrain at once. The judge is
`eigencontact.inclusion_field` of a cube, for each layer of the source on all offsets in the plane, summed by a plain
`scipy.fft` convolution. An error is the largest in a plane over the largest exact value of that plane.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
import scipy.fft

from eigencontact_verification.benchmarks.benchmark import Benchmark, Sample, Task, Trial
from eigencontact_verification.benchmarks.codes import Code
from eigencontact_verification.benchmarks.measure import FloatArray, largest_error
from eigencontact_verification.reporting.table import Column

if TYPE_CHECKING:
    from collections.abc import Callable


__all__ = ["BENCHMARK", "BUILDERS", "CASES", "DEPTHS", "ERRORS", "METHODS", "Case", "Problem", "measure", "reference"]

LAYERS = 16
#: Planes of cell centres on which the stress is judged [h].
DEPTHS = (0.5, 1.5, 4.5, 12.5)
POISSON_RATIO = 0.3
#: All six components; Mandel.
DIRECTION = np.array([0.3, -1.0, 0.7, 0.4 * 2**0.5, -0.6 * 2**0.5, 0.5 * 2**0.5])
#: Waves of the periodic scheme beyond those of the grid, each way.
ALIASES = 2


@dataclass(frozen=True, kw_only=True, slots=True)
class Case:
    """Cells that have eigenstrain."""

    name: str  #: name in the table
    cells: tuple[int, int]  #: cells along x and y, and along z
    top: float  #: depth of the uppermost face [h]

    def amplitude(self, n: int) -> FloatArray:
        """Factor on the eigenstrain in each cell, ``(layers, n, n)``: a bump as wide as the zone, 1 in a lone cell."""
        wide, layers = self.cells
        y = x = np.arange(wide) - 0.5 * (wide - 1)
        z = np.arange(layers) - 0.5 * (layers - 1)
        bump = np.exp(-(z[:, None, None] ** 2 + y[:, None] ** 2 + x**2) / (2.0 * 1.8**2))
        out = np.zeros((layers, n, n))
        first = (n - wide) // 2
        out[:, first : first + wide, first : first + wide] = bump / bump.max()
        return out


CASES = {
    case.name: case
    for case in (
        Case(name="cell, flush", cells=(1, 1), top=0.0),
        Case(name="cell, 2 h below", cells=(1, 1), top=2.0),
        Case(name="cell, 8 h below", cells=(1, 1), top=8.0),
        Case(name="zone, flush", cells=(8, 4), top=0.0),
        Case(name="zone, 6 h below", cells=(8, 4), top=6.0),
    )
}


@dataclass(frozen=True, kw_only=True)
class Problem:
    """Cells of one case, in edges h = 1 and Young's modulus 1."""

    case: Case
    n: int
    threads: int

    @property
    def grid(self) -> Any:
        """Columns of cells."""
        from eigencontact.core.grid import Grid

        return Grid(nx=self.n, ny=self.n, dx=1.0, dy=1.0)

    @property
    def material(self) -> Any:
        """The body."""
        from eigencontact.core.material import Material

        return Material(young_modulus=1.0, poisson_ratio=POISSON_RATIO)

    @property
    def cell(self) -> Any:
        """Shape of the cells."""
        from eigencontact_plugins.shapes.cuboid import Cuboid

        return Cuboid(center=(0.0, 0.0, 0.0), edges=(1.0, 1.0, 1.0))

    def cells(self, top: float, layers: int) -> Any:
        """Layers of cells whose first centre lies at a depth."""
        from eigencontact.solvers.cells import Cells

        first = (float(self.grid.x[0]), float(self.grid.y[0]), top)
        return Cells(first=first, pitch=(1.0, 1.0, 1.0), shape=(layers, self.n, self.n))

    @property
    def source(self) -> Any:
        """Layers that may have eigenstrain."""
        return self.cells(self.case.top + 0.5, self.case.cells[1])

    def target(self, quantity: str) -> Any:
        """Centres of all cells; the surface for displacement."""
        return self.cells(0.5, LAYERS) if quantity == "stress" else self.cells(0.0, 1)


def exact(problem: Problem, quantity: str, precision: str = "double") -> Callable[[FloatArray], FloatArray]:
    """Convolution and correlation with the kernels of the theorem."""
    from eigencontact.solvers.eigenstrain import VolumeField

    body = problem.material
    field = VolumeField(
        problem.cell, problem.source, problem.target(quantity), poisson_ratio=POISSON_RATIO, quantity=quantity,
        shear_modulus=body.shear_modulus, precision=precision, threads=problem.threads,
    )  # fmt: skip
    return lambda eigenstrain: np.asarray(field.apply(eigenstrain))


def exact_single(problem: Problem, quantity: str) -> Callable[[FloatArray], FloatArray]:
    """Same in single precision."""
    return exact(problem, quantity, "single")


def image_pressure(problem: Problem, quantity: str) -> Callable[[FloatArray], FloatArray]:
    """Full space, mirror image and a sampled pressure."""
    from eigencontact.solvers.image_pressure import ImagePressure, ImagePressureVolume
    from eigencontact_plugins.surface_loads import PressureLoad

    scheme = ImagePressure(grid=problem.grid, kernel=PressureLoad(), material=problem.material, threads=problem.threads)
    target = problem.target(quantity)
    return ImagePressureVolume(scheme, problem.cell, problem.source, target, quantity=quantity).apply


def periodic(problem: Problem, quantity: str, padding: float) -> Callable[[FloatArray], FloatArray]:
    """Fourier series in the plane."""
    from eigencontact.solvers.eigenstrain_periodic import PeriodicHalfSpace

    layers, unit = problem.case.cells[1], problem.material.shear_modulus if quantity == "stress" else 1.0
    space = PeriodicHalfSpace(
        grid=problem.grid, interfaces=problem.case.top + np.arange(layers + 1.0), poisson_ratio=POISSON_RATIO,
        padding=padding, aliases=ALIASES, threads=problem.threads,
    )  # fmt: skip
    depths = problem.target(quantity).centres(2)
    return lambda eigenstrain: unit * space.apply(eigenstrain, quantity, depths=depths)


#: Builders of a function from eigenstrain to field, by name of the treatment.
BUILDERS: dict[str, Callable[[Problem, str], Callable[[FloatArray], FloatArray]]] = {
    "exact": exact,
    "exact, single": exact_single,
    "image-pressure": image_pressure,
    "periodic, pad 1": lambda problem, quantity: periodic(problem, quantity, 1.0),
    "periodic, pad 2": lambda problem, quantity: periodic(problem, quantity, 2.0),
    "periodic, pad 4": lambda problem, quantity: periodic(problem, quantity, 4.0),
}
_MODULES = (
    "pyfftw",
    "scipy.fft",
    "eigencontact.library.inclusions",
    "eigencontact.solvers.eigenstrain",
    "eigencontact.solvers.image_pressure",
    "eigencontact.solvers.eigenstrain_periodic",
    "eigencontact_plugins.surface_loads",
    "eigencontact_plugins.shapes.cuboid",
)
_SETTINGS = {
    "exact": "VolumeField",
    "exact, single": "VolumeField, precision 'single'",
    "image-pressure": "ImagePressureVolume, pressure on the window",
}
_WAVES = f"PeriodicHalfSpace, {2 * ALIASES + 1} x {2 * ALIASES + 1} waves for each of the grid"
#: Ways of computing, by their names in the table.
METHODS = {
    name: Code(name=name, distribution="eigencontact", modules=_MODULES, settings=_SETTINGS.get(name, _WAVES))
    for name in BUILDERS
}


@cache
def _response(quantity: Literal["displacement", "stress"], below: float, depth: float, n: int) -> FloatArray:
    """Field at `depth` of one cube of the eigenstrain with its middle at z = `below`, on all offsets of the window."""
    from eigencontact import inclusion_field
    from eigencontact.core.tensors import to_mandel, to_matrix
    from eigencontact_plugins.shapes.cuboid import Cuboid

    offsets = np.arange(-(n - 1), n, dtype=float)
    y, x = (axis.ravel() for axis in np.meshgrid(offsets, offsets, indexing="ij"))
    cube = Cuboid(center=(0.0, 0.0, below), edges=(1.0, 1.0, 1.0))
    points = np.column_stack([x, y, np.full(x.size, depth)])
    field = inclusion_field(
        cube, to_matrix(DIRECTION), points, young_modulus=1.0, poisson_ratio=POISSON_RATIO, quantity=quantity
    )
    if quantity == "stress":
        rows = [field[:, j, k] for j, k in ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))]
        return to_mandel(rows).reshape(6, offsets.size, offsets.size)
    return np.ascontiguousarray(field.T).reshape(3, offsets.size, offsets.size)


def reference(case: Case, quantity: Literal["displacement", "stress"], depth: float, n: int) -> FloatArray:
    """Exact field of a case in one plane, ``(3 or 6, n, n)``; lengths in h, stress in E."""
    size = 3 * n
    total: FloatArray | float = 0.0
    for layer, amplitude in enumerate(case.amplitude(n)):
        rows, columns = np.nonzero(amplitude)
        kernel = _response(quantity, case.top + layer + 0.5, depth, n)
        if rows.size == 1:
            row, column = n - 1 - rows[0], n - 1 - columns[0]
            total = total + amplitude[rows[0], columns[0]] * kernel[:, row : row + n, column : column + n]
            continue
        waves = scipy.fft.rfft2(kernel, s=(size, size)) * scipy.fft.rfft2(amplitude, s=(size, size))
        whole = scipy.fft.irfft2(waves, s=(size, size))
        total = total + whole[:, n - 1 : 2 * n - 1, n - 1 : 2 * n - 1]
    return np.asarray(total)


def measure(code: Code, task: Task) -> Sample:
    """Time set-up and application for stress in the volume, then judge stress and surface displacement."""
    case, build = CASES[task.case], BUILDERS[code.name]
    problem = Problem(case=case, n=task.n, threads=task.threads)
    eigenstrain = DIRECTION[:, None, None, None] * case.amplitude(task.n)
    apply = cache(lambda: build(problem, "stress"))

    def judge(stress: FloatArray) -> dict[str, Any]:
        errors = {
            f"stress_{depth:g}": largest_error(stress[:, int(depth - 0.5)], reference(case, "stress", depth, task.n))
            for depth in DEPTHS
        }
        expected = reference(case, "displacement", 0.0, task.n)[2]
        displacement = build(problem, "displacement")(eigenstrain)[2, 0]
        errors["u_z"] = largest_error(displacement, expected)
        errors["u_z_shape"] = float(
            np.abs(displacement - displacement.mean() - expected + expected.mean()).max() / np.abs(expected).max()
        )
        return errors

    return Trial(call=lambda: apply()(eigenstrain), judge=judge).run(task)


#: Values of a sample that are errors.
ERRORS = ("u_z", "u_z_shape", *(f"stress_{depth:g}" for depth in DEPTHS))
BENCHMARK = Benchmark(
    name="fidelity",
    help="lower fidelities of the half-space and their price",
    measure=measure,
    worst=ERRORS,
    methods=METHODS,
    ours=tuple(METHODS),
    cases=tuple(CASES),
    sizes=(32,),
    columns=(
        Column("N", "n", "d", brief=False),
        Column("eigenstrain", "case"),
        Column("half-space", "code"),
        Column("u_z", "u_z", ".1e"),
        Column("u_z less its mean", "u_z_shape", ".1e"),
        *(Column(f"stress, z = {depth:g} h", f"stress_{depth:g}", ".1e") for depth in DEPTHS),
        Column("first [s]", "first_s", ".2g"),
        Column("again [s]", "again_s", ".2g"),
        Column("peak [MB]", "peak_bytes", ".0f", scale=1e-6),
        Column("processes", "processes", "d", brief=False),
    ),
)
