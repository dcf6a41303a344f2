"""Contact of a self-affine rough surface with a half-space, periodic or not, from first touch to a third of the area.

The times are those of the first call in a fresh process, imports excluded. Ratios are those of processor time of all
threads together, which other work on the machine disturbs least; the peers have one thread. Every answer is judged from
outside by one residual; the tolerance of each peer is the loosest round one whose residual is then at most 1e-6.
"""

from __future__ import annotations

import importlib
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from eigencontact_verification.benchmarks.benchmark import Benchmark, Trial
from eigencontact_verification.benchmarks.codes import Code
from eigencontact_verification.benchmarks.roughness import RoughProblem, residual
from eigencontact_verification.reporting.table import Column, Row

if TYPE_CHECKING:
    from eigencontact_verification.benchmarks.task import Sample, Task

__all__ = ["BENCHMARK", "CASES", "METHODS", "RoughCode", "measure", "ratios"]

FloatArray = NDArray[np.float64]

#: Boundary, and share of the area in contact that the load is chosen for.
CASES = {
    f"{boundary} {share:g} %": (boundary == "periodic", 0.01 * share)
    for boundary in ("periodic", "open")
    for share in (0.1, 1.0, 6.0, 30.0)
}


@dataclass(frozen=True, kw_only=True, slots=True)
class RoughCode(Code):
    """One code.

    Attributes
    ----------
    press : callable
        ``press(problem, separation, threads) -> (pressure (n, n) [E*], iterations)``, None where it tells none.
    """

    press: Callable[[RoughProblem, FloatArray, int], tuple[FloatArray, int | None]]


def press_eigencontact(problem: RoughProblem, separation: FloatArray, threads: int) -> tuple[FloatArray, int | None]:
    """Solve with this package, as a library user would."""
    from eigencontact.core.grid import Grid
    from eigencontact.core.material import Material
    from eigencontact.model.kernels import PairCoefficients
    from eigencontact.solvers.control import Control
    from eigencontact.solvers.normal import NormalOptions, NormalSolver
    from eigencontact_plugins.surface_loads import PressureLoad

    n = problem.n
    solver = NormalSolver(
        Grid(nx=n, ny=n, dx=problem.cell, dy=problem.cell),
        PairCoefficients(PressureLoad(), (Material(young_modulus=1.0 - 0.3**2, poisson_ratio=0.3), None), "z"),
        NormalOptions(tolerance=1e-6, threads=threads, periodic=problem.periodic, allow_contact_at_edge=True),
    )
    solution = solver.solve(separation, Control(normal_load=problem.mean_pressure))
    return solution.pressure, solution.report.iterations


def press_tamaas(problem: RoughProblem, separation: FloatArray, threads: int) -> tuple[FloatArray, int | None]:
    """Polonsky-Keer solver of Tamaas."""
    tamaas: Any = importlib.import_module("tamaas")
    tamaas.set_log_level(tamaas.LogLevel.error)
    tamaas.initialize(threads)
    model = tamaas.ModelFactory.createModel(tamaas.model_type.basic_2d, [1.0, 1.0], [problem.n] * 2)
    model.E, model.nu = 1.0, 0.0
    solver = tamaas.PolonskyKeerRey(model, -separation, TAMAAS_TOLERANCE)
    solver.max_iter = 10_000
    if not problem.periodic:
        tamaas.ModelFactory.registerNonPeriodic(model, "non-periodic")
        solver.setIntegralOperator("non-periodic")
    error = solver.solve(problem.mean_pressure)
    if not error <= TAMAAS_TOLERANCE:  # reaching the iteration limit raises nothing
        raise RuntimeError(f"error must be at most {TAMAAS_TOLERANCE} (got {error}); the solver stopped early")
    return np.array(model.traction), None


def press_contactmechanics(
    problem: RoughProblem,
    separation: FloatArray,
    threads: int,  # noqa: ARG001 - one signature for all
) -> tuple[FloatArray, int | None]:
    """Constrained conjugate gradients of ContactMechanics; `pentol` is a length."""
    contact: Any = importlib.import_module("ContactMechanics")
    systems: Any = importlib.import_module("ContactMechanics.Systems")
    topography: Any = importlib.import_module("SurfaceTopography")
    n, sides = problem.n, (1.0, 1.0)
    kind = contact.PeriodicFFTElasticHalfSpace if problem.periodic else contact.FreeFFTElasticHalfSpace
    surface = topography.Topography(-separation, sides, periodic=problem.periodic)
    system = systems.NonSmoothContactSystem(kind((n, n), 1.0, sides), surface)
    result = system.minimize_proxy(
        external_force=problem.mean_pressure, pentol=CONTACTMECHANICS_TOLERANCE, maxiter=10_000
    )
    if not result.success:
        raise RuntimeError(f"solver must converge (got {result.message!r})")
    return np.asarray(result.jac)[:n, :n] / problem.cell**2, int(result.nit)


def measure(code: RoughCode, task: Task) -> Sample:
    """Draw the surface, solve, judge."""
    code.load()
    periodic, share = CASES[task.case]
    problem = RoughProblem(n=task.n, periodic=periodic, share=share)
    separation = problem.separation()

    def judged(answer: tuple[FloatArray, int | None]) -> dict[str, Any]:
        pressure, iterations = answer
        return {
            "iterations": iterations,
            "residual": residual(problem, separation, pressure),
            "load_error": float(pressure.mean()) / problem.mean_pressure - 1.0,
            "area": float(np.count_nonzero(pressure > 0)) / pressure.size,
            "peak": float(pressure.max()),
        }

    return Trial(call=partial(code.press, problem, separation, task.threads), judge=judged).run(task, warm=0)


def ratios(rows: list[Row]) -> list[str]:
    """Sentences on how many times the processor time the best peer takes."""
    said = []
    for case, n in dict.fromkeys((row["case"], row["n"]) for row in rows):
        times = {row["code"]: row["first_cpu_s"] for row in rows if (row["case"], row["n"]) == (case, n)}
        ours = times.pop("eigencontact", None)
        if ours and times:
            best = min(times, key=lambda code: times[code])
            said.append(
                f"{case}, N = {n}: {best}, the best peer, takes {times[best] / ours:.3g} times the processor time"
            )
    return said


#: Loosest round numbers with a residual of at most 1e-6 in every case at N = 256.
TAMAAS_TOLERANCE, CONTACTMECHANICS_TOLERANCE = 1e-6, 1e-8

METHODS = {
    code.name: code
    for code in (
        RoughCode(
            name="eigencontact",
            distribution="eigencontact",
            modules=(
                "pyfftw",
                "scipy.fft",
                "eigencontact.solvers.normal",
                "eigencontact.model.kernels",
                "eigencontact_plugins.surface_loads",
            ),
            settings="NormalSolver, tolerance 1e-6",
            press=press_eigencontact,
        ),
        RoughCode(
            name="tamaas",
            distribution="tamaas",
            modules=("tamaas",),
            settings=f"PolonskyKeerRey, tolerance {TAMAAS_TOLERANCE:g}, one thread as its wheel is built",
            press=press_tamaas,
        ),
        RoughCode(
            name="contactmechanics",
            distribution="ContactMechanics",
            modules=("ContactMechanics", "ContactMechanics.Systems", "SurfaceTopography"),
            settings=f"constrained conjugate gradients, pentol {CONTACTMECHANICS_TOLERANCE:g} of the window",
            press=press_contactmechanics,
        ),
    )
}

BENCHMARK = Benchmark(
    name="rough",
    help="self-affine rough contact, periodic and not, against other codes",
    measure=measure,
    remarks=ratios,
    methods=METHODS,
    peers=("tamaas", "contactmechanics"),
    cases=tuple(CASES),
    sizes=(256, 1024),
    columns=(
        Column("case", "case"),
        Column("N", "n", "d"),
        Column("code", "code"),
        Column("first call [s]", "first_s", ".3g"),
        Column("processor [s]", "first_cpu_s", ".3g"),
        Column("iterations", "iterations", "d"),
        Column("residual", "residual", ".1e"),
        Column("load error", "load_error", "+.0e", brief=False),
        Column("area", "area", ".4f"),
        Column("peak / E*", "peak", ".5g"),
        Column("peak [MB]", "peak_bytes", ".0f", scale=1e-6),
        Column("cores", "cores", ".1f", brief=False),
        Column("processes", "processes", "d", brief=False),
    ),
)
