"""Cattaneo-Mindlin contact: the tangential solve against the bare FFTs of one application, and its error.

The set-up (normal contact, coefficients known before the tangential load comes) is timed apart from the tangential
solve, where a code can do that; the first solve in a fresh process includes the coefficients and FFT plans of shear.
A loop of forty load steps is timed where a code keeps the history.
"""

from __future__ import annotations

import importlib
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from functools import cache
from typing import Any

import numpy as np

from eigencontact_verification.benchmarks.benchmark import Benchmark, Sample, Task, Trial, repeated, timed
from eigencontact_verification.benchmarks.codes import ASPHER, KERNELS, TAMAAS, Code
from eigencontact_verification.benchmarks.measure import FloatArray
from eigencontact_verification.benchmarks.sliding import ShearConvolution, SlidingProblem, judge_sliding
from eigencontact_verification.reporting.table import Column, Row

__all__ = ["BENCHMARK", "CASES", "METHODS", "PEERS", "ShearCode", "Sheared", "growth", "measure"]

#: Poisson's ratio of each case.
CASES = {"nu-0.3": 0.3, "nu-0.5": 0.5}
#: Load steps of the cycle, and the size at which it is run.
CYCLE_STEPS, CYCLE_SIZE = 40, 128


@dataclass(frozen=True, slots=True)
class Sheared:
    """A code's answer: pressure (n, n) and shear (2, n, n) [E*]; counts where it reports them."""

    pressure: FloatArray
    shear: FloatArray
    iterations: int | None = None
    applications: int | None = None


@dataclass(frozen=True, slots=True)
class Prepared:
    """A code ready for the tangential load: the solve, and a cycle of that many steps that returns applications."""

    solve: Callable[[], Sheared]
    cycle: Callable[[int], int] | None = None


@dataclass(frozen=True, kw_only=True, slots=True)
class ShearCode(Code):
    """One code, or one way of using it."""

    #: ``prepare(problem, threads) -> Prepared``, everything that can be done before the tangential load is known.
    prepare: Callable[[SlidingProblem, int], Prepared]


def prepare_eigencontact(problem: SlidingProblem, threads: int) -> Prepared:
    """Solve with this package, as a library user would."""
    from eigencontact.core.grid import Grid
    from eigencontact.core.material import Material
    from eigencontact.model.kernels import PairCoefficients
    from eigencontact.solvers.control import Control
    from eigencontact.solvers.normal import NormalOptions
    from eigencontact.solvers.tangential.contact import FrictionalContact
    from eigencontact.solvers.tangential.control import TangentialControl
    from eigencontact.solvers.tangential.solver import TangentialOptions
    from eigencontact_plugins.surface_loads import PressureLoad, ShearLoadX, ShearLoadY

    n, hertz = problem.n, problem.hertz
    body = Material(young_modulus=1.0 - problem.poisson_ratio**2, poisson_ratio=problem.poisson_ratio)
    loads = {"x": ShearLoadX(), "y": ShearLoadY(), "z": PressureLoad()}
    contact = FrictionalContact(
        Grid(nx=n, ny=n, dx=hertz.cell, dy=hertz.cell),
        {(i, j): PairCoefficients(loads[j], (body, None), i) for i, j in ("xx", "xy", "yx", "yy", "zz")},
        lambda pressure, _: problem.friction * pressure,
        NormalOptions(tolerance=1e-6, threads=threads),
        TangentialOptions(tolerance=1e-6, threads=threads),
    )
    control, most = Control(normal_load=hertz.load), problem.friction * hertz.load
    pressed = contact.step(hertz.separation, control, TangentialControl()).sliding

    def solve() -> Sheared:
        load = TangentialControl(tangential_load_x=problem.tangential_load)
        solution = contact.step(hertz.separation, control, load, pressed)
        report = solution.tangential.report
        return Sheared(solution.normal.pressure, solution.tangential.shear, report.iterations, report.convolutions)

    def cycle(steps: int) -> int:
        state, count = pressed, 0
        for number in range(1, steps + 1):
            load = 0.9 * most * float(np.sin(2 * np.pi * number / steps))
            solution = contact.step(hertz.separation, control, TangentialControl(tangential_load_x=load), state)
            state, count = solution.sliding, count + solution.tangential_convolutions
        return count

    return Prepared(solve, cycle)


def prepare_tamaas(name: str, tolerance: float = 1e-8, most: int = 2000) -> Callable[[SlidingProblem, int], Prepared]:
    """One of the friction solvers of Tamaas: periodic, both loads at once, normal contact included."""

    def prepare(problem: SlidingProblem, threads: int) -> Prepared:
        tamaas: Any = importlib.import_module("tamaas")
        n, side = problem.n, problem.hertz.side
        tamaas.set_log_level(tamaas.LogLevel.error)
        tamaas.initialize(threads)

        def solve() -> Sheared:
            model = tamaas.ModelFactory.createModel(tamaas.model_type.surface_2d, [side] * 2, [n, n])
            model.E, model.nu = 1.0 - problem.poisson_ratio**2, problem.poisson_ratio
            solver = getattr(tamaas, name)(model, -problem.hertz.separation, tolerance, problem.friction)
            solver.max_iter, solver.dump_freq = most, 10 * most
            solver.solve([problem.tangential_load / side**2, 0.0, problem.hertz.load / side**2])
            tractions = np.array(model.traction)
            return Sheared(tractions[..., 2], np.moveaxis(tractions[..., :2], -1, 0))

        return Prepared(solve)

    return prepare


def prepare_aspher(problem: SlidingProblem, threads: int) -> Prepared:  # noqa: ARG001 - one signature for all
    """Incremental solver of ASPHER, preconditioned, FFT operator; a step that it refuses counts as a failure."""
    aspher: Any = importlib.import_module("aspher")
    n, area = problem.n, problem.hertz.side**2

    def pressed() -> Any:
        model = aspher.CoulombFriction(problem.friction)
        solver = aspher.FrictionSolver(n, problem.hertz.side, E_star=1.0, nu=problem.poisson_ratio, model=model)
        solver.set_gap(problem.hertz.separation)
        result = solver.step(p_bar=problem.hertz.load / area)
        if not result.converged:
            raise RuntimeError(f"normal step must converge (got {result.status_reason})")
        return solver

    ready = [pressed()]

    def solve() -> Sheared:
        solver = ready.pop() if ready else pressed()
        result = solver.step(q_bar=(problem.tangential_load / area, 0.0))
        if not result.converged:
            raise RuntimeError(f"tangential step must converge (got {result.status_reason})")
        shear = np.stack([np.array(result.qx).reshape(n, n), np.array(result.qy).reshape(n, n)])
        return Sheared(np.array(solver.pressure).reshape(n, n), shear, int(result.tangential_iters))

    return Prepared(solve)


def measure(code: ShearCode, task: Task) -> Sample:
    """Prepare, solve, and solve again in turn with bare applications; then the cycle."""
    problem = SlidingProblem(n=task.n, poisson_ratio=CASES[task.case])
    prepared = cache(lambda: code.prepare(problem, task.threads))

    def floors() -> Mapping[str, Callable[[], list[float]]]:
        application, field = ShearConvolution(problem), np.stack([problem.shear, problem.shear])
        application(field, task.threads)
        return {"application": lambda: repeated(lambda: application(field, task.threads))}

    def judge(answer: Sheared) -> dict[str, Any]:
        numbers: dict[str, Any] = {"iterations": answer.iterations, "applications": answer.applications}
        cycle = prepared().cycle
        if cycle is not None and task.n == CYCLE_SIZE:
            numbers["cycle_applications"], numbers["cycle_s"], _ = timed(lambda: cycle(CYCLE_STEPS))
        return numbers | asdict(judge_sliding(problem, answer.pressure, answer.shear))

    return Trial(setup=prepared, call=lambda: prepared().solve(), floors=floors, judge=judge).run(task)


def growth(rows: list[Row]) -> list[str]:
    """Sentences on how applications and time grow with N, and on the cycle, for codes that report them."""
    sentences = []
    for case, code in dict.fromkeys((row["case"], row["code"]) for row in rows):
        mine = [row for row in rows if (row["case"], row["code"]) == (case, code)]
        for key, words in (("applications", "applications"), ("again_s", "seconds")):
            pairs = [(row["n"], row[key]) for row in mine if row[key]]
            if len(pairs) < 3:
                continue
            n, value = np.log(np.array(pairs, dtype=float)).T
            power = float(np.polyfit(n, value, 1)[0])
            sentences.append(f"{case}, {code}: {words} grow as N^{power:.2f} from N = {pairs[0][0]} to {pairs[-1][0]}")
        sentences += [
            f"{case}, {code}: a cycle of {CYCLE_STEPS} load steps, |Q| up to 0.9 of friction, at N = {row['n']} takes"
            f" {row['cycle_s']:.2g} s and {row['cycle_applications']} applications"
            for row in mine
            if row.get("cycle_s") is not None
        ]
    return sentences


PEERS = ("tamaas-condat", "tamaas-polonsky-keer", "tamaas-kato", "aspher")
_TAMAAS = (
    "{}, periodic, normal and tangential load at once (the solve includes the normal contact), fully coupled, "
    "tolerance 1e-8, at most 2000 iterations"
)
METHODS = {
    code.name: code
    for code in (
        ShearCode(
            name="eigencontact", distribution="eigencontact", prepare=prepare_eigencontact,
            modules=("pyfftw", "scipy.fft", "eigencontact.solvers.tangential.contact", *KERNELS),
            settings="FrictionalContact, x with y coupled, tolerance 1e-6",
        ),
        *(
            ShearCode(
                name=f"tamaas-{name}", settings=_TAMAAS.format(solver), prepare=prepare_tamaas(solver), **TAMAAS
            )
            for name, solver in (("condat", "Condat"), ("polonsky-keer", "PolonskyKeerTan"), ("kato", "Kato"))
        ),
        ShearCode(
            name="aspher", settings="FrictionSolver, preconditioned, FFT, default tolerances",
            prepare=prepare_aspher, **ASPHER,
        ),
    )
}  # fmt: skip

BENCHMARK = Benchmark(
    name="tangential",
    help="partial slip against one bare application",
    measure=measure,
    floors=("application",),
    remarks=growth,
    methods=METHODS,
    peers=PEERS,
    cases=tuple(CASES),
    sizes=(64, 128, 256, 512),
    columns=(
        Column("case", "case"),
        Column("N", "n", "d"),
        Column("code", "code"),
        Column("set-up [s]", "setup_s", ".2g"),
        Column("first solve [s]", "first_s", ".3g"),
        Column("again [s]", "again_s", ".3g"),
        Column("applications", "applications", "d"),
        Column("iterations", "iterations", "d"),
        Column("again / bare application", "again_per_application", ".3g"),
        Column("residual", "residual", ".1e"),
        Column("q error, L2", "shear_error", ".1e"),
        Column("c/a", "stick_radius", ".4f"),
        Column("load error", "load_error", "+.0e"),
        Column("cores", "cores", ".1f", brief=False),
        Column("processes", "processes", "d", brief=False),
    ),
)
