"""The codes under test: for each, one small function that makes one whole solve as a user would write it.

A solve includes everything after the import: kernel, operator, FFT plans, solution. Each peer's tolerance is the
loosest round one whose gap, measured from outside (`measure.judge`), stays at or below 1e-6 for 256 cells and more.
"""

from __future__ import annotations

import importlib
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from eigencontact_verification.benchmarks.measure import HertzProblem

if TYPE_CHECKING:
    from collections.abc import Callable

    from eigencontact.core.material import Material

__all__ = ["CODES", "PEERS", "Code", "Solution", "find_code"]

FloatArray = NDArray[np.float64]

#: pressure (n, n) [E*], iterations, convolutions; None where the code does not report a number
Solution = tuple[FloatArray, int | None, int | None]


@dataclass(frozen=True, kw_only=True, slots=True)
class Code:
    """One code, or one way of using it.

    Attributes
    ----------
    name : str
        Name in the tables.
    distribution : str
        Name of the installed package, for its version.
    modules : tuple of str
        What a user's script imports, and what the code imports later by itself; all of it is imported before the
        clock starts and before memory is counted.
    settings : str
        Method and tolerance, printed below the tables.
    solve : callable
        ``solve(n, threads, precision) -> (pressure, iterations, convolutions)``; None where the code does not take
        part in the Hertz benchmark.
    stress : callable
        ``stress(n, depths, threads, precision) -> apply`` with ``apply(pressure) -> (6, len(depths), n, n)``, the
        plain tensor components xx, yy, zz, yz, xz, xy [E*] for Poisson's ratio 0.3; None likewise.
    """

    name: str
    distribution: str
    modules: tuple[str, ...]
    settings: str
    solve: Callable[[int, int, str], Solution] | None = None
    stress: Callable[[int, FloatArray, int, str], Callable[[FloatArray], FloatArray]] | None = None

    def load(self) -> None:
        """Import what the code needs; ImportError says that it is absent."""
        for name in self.modules:
            importlib.import_module(name)


def solve_eigencontact(n: int, threads: int, precision: str) -> Solution:
    """Solve with this package, as a library user would; single precision is asked for 1e-5, which it can reach."""
    from eigencontact.core.grid import Grid
    from eigencontact.model.kernels import PairCoefficients
    from eigencontact.solvers.control import Control
    from eigencontact.solvers.normal import NormalOptions, NormalSolver
    from eigencontact_plugins.surface_loads import PressureLoad

    problem = HertzProblem(n=n)
    grid = Grid(nx=n, ny=n, dx=problem.cell, dy=problem.cell)
    tolerance = 1e-6 if precision == "double" else 1e-5
    solver = NormalSolver(
        grid,
        PairCoefficients(PressureLoad(), (_steel_like(), None), "z"),
        NormalOptions(tolerance=tolerance, precision=precision, threads=threads),
    )
    solution = solver.solve(problem.separation, Control(normal_load=problem.load))
    return solution.pressure, solution.report.iterations, solution.report.convolutions


def stress_eigencontact(n: int, depths: FloatArray, threads: int, precision: str) -> Callable[[FloatArray], FloatArray]:
    """Sub-surface stress operator of this package, every cell loaded, every cell a target."""
    from eigencontact.core.grid import Box, Grid
    from eigencontact.core.tensors import from_mandel
    from eigencontact.model.kernels import StressCoefficients
    from eigencontact.solvers.subsurface import SubsurfaceStress
    from eigencontact_plugins.surface_loads import PressureLoad

    problem = HertzProblem(n=n)
    operator = SubsurfaceStress(
        Grid(nx=n, ny=n, dx=problem.cell, dy=problem.cell),
        [StressCoefficients(PressureLoad(), _steel_like())],
        source=Box(0, n, 0, n),
        target=(n, n),
        depths=depths,
        precision=precision,
        threads=threads,
    )

    def apply(pressure: FloatArray) -> FloatArray:
        return from_mandel(operator.apply([pressure]))

    return apply


def _steel_like() -> Material:
    """Poisson's ratio 0.3, plane-strain modulus 1."""
    from eigencontact.core.material import Material

    return Material(young_modulus=1.0 - 0.3**2, poisson_ratio=0.3)


def solve_tamaas(n: int, threads: int, precision: str) -> Solution:  # noqa: ARG001 - one signature for all
    """Polonsky-Keer solver of Tamaas; the non-periodic operator must be registered *and* chosen."""
    tamaas: Any = importlib.import_module("tamaas")
    problem = HertzProblem(n=n)
    tamaas.set_log_level(tamaas.LogLevel.error)
    tamaas.initialize(threads)
    model = tamaas.ModelFactory.createModel(tamaas.model_type.basic_2d, [problem.side] * 2, [n, n])
    model.E, model.nu = 1.0, 0.0
    tamaas.ModelFactory.registerNonPeriodic(model, "non-periodic")
    tolerance = 1e-6
    solver = tamaas.PolonskyKeerRey(model, -problem.separation, tolerance)
    solver.setIntegralOperator("non-periodic")
    error = solver.solve(problem.load / problem.side**2)
    if not error <= tolerance:  # reaching the iteration limit raises nothing
        raise RuntimeError(f"error must be at most {tolerance} (got {error}); the solver stopped early")
    return np.array(model.traction), None, None


def solve_contactmechanics(n: int, threads: int, precision: str) -> Solution:  # noqa: ARG001
    """Constrained conjugate gradients of ContactMechanics, free boundaries; `pentol` is a length, here over a."""
    contact: Any = importlib.import_module("ContactMechanics")
    systems: Any = importlib.import_module("ContactMechanics.Systems")
    topography: Any = importlib.import_module("SurfaceTopography")
    problem = HertzProblem(n=n)
    sides = (problem.side, problem.side)
    substrate = contact.FreeFFTElasticHalfSpace((n, n), 1.0, sides)
    system = systems.NonSmoothContactSystem(substrate, topography.Topography(-problem.separation, sides))
    result = system.minimize_proxy(external_force=problem.load, pentol=1e-6)
    if not result.success:
        raise RuntimeError(f"solver must converge (got {result.message!r})")
    return np.asarray(result.jac)[:n, :n] / problem.cell**2, int(result.nit), int(result.nfev)


def _from_aspher(result: Any, n: int) -> Solution:
    """Read an answer of ASPHER."""
    if not result.converged:
        raise RuntimeError(f"solver must converge (got {result.status}: {result.status_reason})")
    convolutions = int(result.matvec_count) + int(result.verification_matvec_count)
    return np.array(result.pressure).reshape(n, n), int(result.iterations), convolutions


def solve_aspher(n: int, threads: int, precision: str) -> Solution:  # noqa: ARG001
    """Preconditioned conjugate gradients of ASPHER on one grid, FFT operator."""
    aspher: Any = importlib.import_module("aspher")
    problem = HertzProblem(n=n)
    solver = aspher.ContactSolver(n, problem.side, 1.0, backend="fft")
    result = solver.solve(problem.separation, problem.load / problem.side**2, tol=1e-7, precond="fourier")
    return _from_aspher(result, n)


def solve_aspher_nested(n: int, threads: int, precision: str) -> Solution:  # noqa: ARG001
    """Nested grids of ASPHER, single then double precision; its counts are those of the finest grid."""
    aspher: Any = importlib.import_module("aspher")
    problem = HertzProblem(n=n)
    result = aspher.solve_nested(
        n,
        problem.separation,
        problem.load / problem.side**2,
        domain_size=problem.side,
        E_star=1.0,
        tol=2e-7,
        backend="fft",
        precision="float_then_double",
    )
    return _from_aspher(result, n)


PEERS = ("tamaas", "aspher", "aspher-nested", "contactmechanics")
CODES = {
    code.name: code
    for code in (
        Code(
            name="eigencontact",
            distribution="eigencontact",
            modules=(
                "pyfftw",
                "scipy.fft",
                "eigencontact.solvers.normal",
                "eigencontact.solvers.subsurface",
                "eigencontact.model.kernels",
                "eigencontact_plugins.surface_loads",
            ),
            settings="NormalSolver, tolerance 1e-6",
            solve=solve_eigencontact,
            stress=stress_eigencontact,
        ),
        Code(
            name="tamaas",
            distribution="tamaas",
            modules=("tamaas",),
            settings="PolonskyKeerRey, non-periodic operator, tolerance 1e-6",
            solve=solve_tamaas,
        ),
        Code(
            name="aspher",
            distribution="aspher",
            modules=("aspher",),
            settings="ContactSolver, FFT, preconditioner 'fourier', tol 1e-7",
            solve=solve_aspher,
        ),
        Code(
            name="aspher-nested",
            distribution="aspher",
            modules=("aspher",),
            settings="solve_nested, FFT, float_then_double, tol 2e-7; counts are those of the finest grid",
            solve=solve_aspher_nested,
        ),
        Code(
            name="contactmechanics",
            distribution="ContactMechanics",
            modules=("ContactMechanics", "ContactMechanics.Systems", "SurfaceTopography"),
            settings="constrained conjugate gradients, free boundaries, pentol 1e-6",
            solve=solve_contactmechanics,
        ),
    )
}


def find_code(name: str) -> Code:
    """Return the code of that name; ``package.module:OBJECT`` names one that lives elsewhere.

    Raises
    ------
    ValueError
        If there is no such code.
    TypeError
        If the object named is no `Code`.
    """
    if name in CODES:
        return CODES[name]
    module, _, attribute = name.partition(":")
    if not attribute:
        raise ValueError(f"code must be one of {sorted(CODES)} or 'package.module:OBJECT' (got {name!r})")
    code = getattr(importlib.import_module(module), attribute)
    if not isinstance(code, Code):
        raise TypeError(f"code must be a {Code.__qualname__} (got {type(code).__qualname__} for {name!r})")
    return code
