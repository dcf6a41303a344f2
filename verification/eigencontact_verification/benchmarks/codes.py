"""The codes under test: for each, one small function that makes one whole solve as a user would write it.

A solve includes everything after the import: kernel, operator, FFT plans, solution. Each peer's tolerance is the
loosest round one whose gap, measured from outside (`measure.judge`), stays at or below 1e-6 for 256 cells and more.
"""

from __future__ import annotations

import importlib
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact_verification.benchmarks.measure import FloatArray, HertzProblem

if TYPE_CHECKING:
    from collections.abc import Callable

    from eigencontact.core.material import Material

__all__ = [
    "ASPHER", "CODES", "CONTACTMECHANICS", "KERNELS", "NORMAL", "PEERS", "TAMAAS", "Code", "Solution", "find_code",
    "ours", "press_contactmechanics", "press_eigencontact", "press_tamaas",
]  # fmt: skip

#: pressure (n, n) [E*], iterations, convolutions; None where the code does not report a number
Solution = tuple[FloatArray, int | None, int | None]


@dataclass(frozen=True, kw_only=True, slots=True)
class Code:
    """One code, or one way of using it."""

    name: str  #: name in the tables
    distribution: str  #: name of the installed package, for its version
    #: Modules that a user's script imports, and those that the code imports later by itself; all of them are imported
    #: before the clock starts and before memory is counted.
    modules: tuple[str, ...]
    settings: str  #: method and tolerance, printed below the tables
    #: ``solve(n, threads, precision) -> (pressure, iterations, convolutions)``; None where the code does not take part
    #: in the Hertz benchmark.
    solve: Callable[[int, int, str], Solution] | None = None
    #: ``stress(n, depths, threads, precision) -> apply`` with ``apply(pressure) -> (6, len(depths), n, n)``, the plain
    #: tensor components xx, yy, zz, yz, xz, xy [E*] for Poisson's ratio 0.3; None likewise.
    stress: Callable[[int, FloatArray, int, str], Callable[[FloatArray], FloatArray]] | None = None

    def load(self, function: str = "") -> None:
        """Import the modules; ImportError says that the code is absent, or has no such function."""
        if function and getattr(self, function) is None:
            raise ImportError("takes no part in this benchmark")
        for name in self.modules:
            importlib.import_module(name)


def ours(settings: str, *modules: str) -> dict[str, Code]:
    """Return this package as the one code of a benchmark."""
    code = Code(name="eigencontact", distribution="eigencontact", modules=modules, settings=settings)
    return {code.name: code}


def press_eigencontact(separation: FloatArray, side: float, load: float, **options: Any) -> Solution:
    """Press a separation (n, n) on a window of this side by a load [E*], as a library user would."""
    from eigencontact.core.grid import Grid
    from eigencontact.model.kernels import PairCoefficients
    from eigencontact.solvers.control import Control
    from eigencontact.solvers.normal import NormalOptions, NormalSolver
    from eigencontact_plugins.surface_loads import PressureLoad

    n = len(separation)
    solver = NormalSolver(
        Grid(nx=n, ny=n, dx=side / n, dy=side / n),
        PairCoefficients(PressureLoad(), (_steel_like(), None), "z"),
        NormalOptions(**options),
    )
    solution = solver.solve(separation, Control(normal_load=load))
    return solution.pressure, solution.report.iterations, solution.report.convolutions


def press_tamaas(
    separation: FloatArray, side: float, load: float, threads: int, *, tolerance: float, periodic: bool = False,
    most: int | None = None,
) -> Solution:  # fmt: skip
    """Polonsky-Keer solver of Tamaas; the non-periodic operator must be registered *and* chosen."""
    tamaas: Any = importlib.import_module("tamaas")
    tamaas.set_log_level(tamaas.LogLevel.error)
    tamaas.initialize(threads)
    model = tamaas.ModelFactory.createModel(tamaas.model_type.basic_2d, [side] * 2, list(separation.shape))
    model.E, model.nu = 1.0, 0.0
    if not periodic:
        tamaas.ModelFactory.registerNonPeriodic(model, "non-periodic")
    solver = tamaas.PolonskyKeerRey(model, -separation, tolerance)
    if most is not None:
        solver.max_iter = most
    if not periodic:
        solver.setIntegralOperator("non-periodic")
    error = solver.solve(load / side**2)
    if not error <= tolerance:  # reaching the iteration limit raises nothing
        raise RuntimeError(f"error must be at most {tolerance} (got {error}); the solver stopped early")
    return np.array(model.traction), None, None


def press_contactmechanics(
    separation: FloatArray, side: float, load: float, *, periodic: bool = False, **options: Any
) -> Solution:
    """Constrained conjugate gradients of ContactMechanics; its option `pentol` is a length."""
    contact: Any = importlib.import_module("ContactMechanics")
    systems: Any = importlib.import_module("ContactMechanics.Systems")
    topography: Any = importlib.import_module("SurfaceTopography")
    n, sides = len(separation), (side, side)
    kind = contact.PeriodicFFTElasticHalfSpace if periodic else contact.FreeFFTElasticHalfSpace
    surface = topography.Topography(-separation, sides, periodic=periodic)
    system = systems.NonSmoothContactSystem(kind((n, n), 1.0, sides), surface)
    result = system.minimize_proxy(external_force=load, **options)
    if not result.success:
        raise RuntimeError(f"solver must converge (got {result.message!r})")
    return np.asarray(result.jac)[:n, :n] / (side / n) ** 2, int(result.nit), int(result.nfev)


def solve_eigencontact(n: int, threads: int, precision: str) -> Solution:
    """Solve with this package; the tolerance in single precision is 1e-5, which it can reach."""
    problem, tolerance = HertzProblem(n=n), 1e-6 if precision == "double" else 1e-5
    return press_eigencontact(
        problem.separation, problem.side, problem.load, tolerance=tolerance, precision=precision, threads=threads
    )


def stress_eigencontact(n: int, depths: FloatArray, threads: int, precision: str) -> Callable[[FloatArray], FloatArray]:
    """Sub-surface stress operator of this package, every cell loaded, every cell a target."""
    from eigencontact.core.grid import Box, Grid
    from eigencontact.core.tensors import from_mandel
    from eigencontact.model.kernels import StressCoefficients
    from eigencontact.solvers.subsurface import SubsurfaceStress
    from eigencontact_plugins.surface_loads import PressureLoad

    cell, kernel = HertzProblem(n=n).cell, StressCoefficients(PressureLoad(), _steel_like())
    operator = SubsurfaceStress(
        Grid(nx=n, ny=n, dx=cell, dy=cell), [kernel], source=Box(0, n, 0, n), target=(n, n), depths=depths,
        precision=precision, threads=threads,
    )  # fmt: skip
    return lambda pressure: from_mandel(operator.apply([pressure]))


def _steel_like() -> Material:
    """Poisson's ratio 0.3, plane-strain modulus 1."""
    from eigencontact.core.material import Material

    return Material(young_modulus=1.0 - 0.3**2, poisson_ratio=0.3)


def solve_tamaas(n: int, threads: int, precision: str) -> Solution:  # noqa: ARG001 - one signature for all
    """Polonsky-Keer solver of Tamaas."""
    problem = HertzProblem(n=n)
    return press_tamaas(problem.separation, problem.side, problem.load, threads, tolerance=1e-6)


def solve_contactmechanics(n: int, threads: int, precision: str) -> Solution:  # noqa: ARG001
    """Constrained conjugate gradients of ContactMechanics, free boundaries; tolerance in contact radii."""
    problem = HertzProblem(n=n)
    return press_contactmechanics(problem.separation, problem.side, problem.load, pentol=1e-6)


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
    options = {"E_star": 1.0, "tol": 2e-7, "backend": "fft", "precision": "float_then_double"}
    pressure = problem.load / problem.side**2
    return _from_aspher(aspher.solve_nested(n, problem.separation, pressure, domain_size=problem.side, **options), n)


PEERS = ("tamaas", "aspher", "aspher-nested", "contactmechanics")
#: Modules of a contact of this package, and of its peers.
NORMAL = ("pyfftw", "scipy.fft", "eigencontact.solvers.normal")
KERNELS = ("eigencontact.model.kernels", "eigencontact_plugins.surface_loads")
TAMAAS: dict[str, Any] = {"distribution": "tamaas", "modules": ("tamaas",)}
ASPHER: dict[str, Any] = {"distribution": "aspher", "modules": ("aspher",)}
CONTACTMECHANICS: dict[str, Any] = {
    "distribution": "ContactMechanics",
    "modules": ("ContactMechanics", "ContactMechanics.Systems", "SurfaceTopography"),
}  # fmt: skip
CODES = {
    code.name: code
    for code in (
        Code(
            name="eigencontact", distribution="eigencontact", settings="NormalSolver, tolerance 1e-6",
            modules=(*NORMAL, "eigencontact.solvers.subsurface", *KERNELS), solve=solve_eigencontact,
            stress=stress_eigencontact,
        ),
        Code(
            name="tamaas", settings="PolonskyKeerRey, non-periodic operator, tolerance 1e-6", solve=solve_tamaas,
            **TAMAAS,
        ),
        Code(
            name="aspher", settings="ContactSolver, FFT, preconditioner 'fourier', tol 1e-7", solve=solve_aspher,
            **ASPHER,
        ),
        Code(
            name="aspher-nested", solve=solve_aspher_nested, **ASPHER,
            settings="solve_nested, FFT, float_then_double, tol 2e-7; counts are those of the finest grid",
        ),
        Code(
            name="contactmechanics", settings="constrained conjugate gradients, free boundaries, pentol 1e-6",
            solve=solve_contactmechanics, **CONTACTMECHANICS,
        ),
    )
}  # fmt: skip


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
