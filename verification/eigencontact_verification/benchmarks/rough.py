"""Contact of a self-affine rough surface with a half-space, periodic or not, from first touch to a third of the area.

The times are those of the first call in a fresh process, imports excluded. Ratios are those of processor time of all
threads together, which other work on the machine disturbs least; the peers have one thread. Every answer is judged from
outside by one residual; the tolerance of each peer is the loosest round one whose residual is then at most 1e-6.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from eigencontact_verification.benchmarks import codes
from eigencontact_verification.benchmarks.benchmark import Benchmark, Sample, Task, Trial
from eigencontact_verification.benchmarks.codes import Code
from eigencontact_verification.benchmarks.measure import FloatArray
from eigencontact_verification.benchmarks.roughness import RoughProblem, residual
from eigencontact_verification.reporting.table import Column, Row

__all__ = ["BENCHMARK", "CASES", "METHODS", "RoughCode", "measure", "ratios"]

#: Boundary, and share of the area in contact that the load is chosen for.
CASES = {
    f"{boundary} {share:g} %": (boundary == "periodic", 0.01 * share)
    for boundary in ("periodic", "open")
    for share in (0.1, 1.0, 6.0, 30.0)
}


@dataclass(frozen=True, kw_only=True, slots=True)
class RoughCode(Code):
    """One code."""

    #: ``press(problem, separation, threads) -> (pressure (n, n) [E*], iterations)``, None where it reports none.
    press: Callable[[RoughProblem, FloatArray, int], tuple[FloatArray, int | None]]


def press_eigencontact(problem: RoughProblem, separation: FloatArray, threads: int) -> tuple[FloatArray, int | None]:
    """Solve with this package."""
    return codes.press_eigencontact(
        separation, 1.0, problem.mean_pressure, tolerance=1e-6, threads=threads, periodic=problem.periodic,
        allow_contact_at_edge=True,
    )[:2]  # fmt: skip


def press_tamaas(problem: RoughProblem, separation: FloatArray, threads: int) -> tuple[FloatArray, int | None]:
    """Polonsky-Keer solver of Tamaas."""
    return codes.press_tamaas(
        separation, 1.0, problem.mean_pressure, threads, tolerance=TAMAAS_TOLERANCE, periodic=problem.periodic,
        most=10_000,
    )[:2]  # fmt: skip


def press_contactmechanics(problem: RoughProblem, separation: FloatArray, _: int) -> tuple[FloatArray, int | None]:
    """Constrained conjugate gradients of ContactMechanics."""
    return codes.press_contactmechanics(
        separation, 1.0, problem.mean_pressure, periodic=problem.periodic, pentol=CONTACTMECHANICS_TOLERANCE,
        maxiter=10_000,
    )[:2]  # fmt: skip


def measure(code: RoughCode, task: Task) -> Sample:
    """Draw the surface, solve, judge."""
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
    sentences = []
    for case, n in dict.fromkeys((row["case"], row["n"]) for row in rows):
        times = {row["code"]: row["first_cpu_s"] for row in rows if (row["case"], row["n"]) == (case, n)}
        ours = times.pop("eigencontact", None)
        if ours and times:
            best = min(times, key=lambda code: times[code])
            sentences.append(
                f"{case}, N = {n}: {best}, the best peer, takes {times[best] / ours:.3g} times the processor time"
            )
    return sentences


#: Loosest round numbers with a residual of at most 1e-6 in every case at N = 256.
TAMAAS_TOLERANCE, CONTACTMECHANICS_TOLERANCE = 1e-6, 1e-8

METHODS = {
    code.name: code
    for code in (
        RoughCode(
            name="eigencontact", distribution="eigencontact", modules=(*codes.NORMAL, *codes.KERNELS),
            settings="NormalSolver, tolerance 1e-6", press=press_eigencontact,
        ),
        RoughCode(
            name="tamaas", press=press_tamaas, **codes.TAMAAS,
            settings=f"PolonskyKeerRey, tolerance {TAMAAS_TOLERANCE:g}, one thread as its wheel is built",
        ),
        RoughCode(
            name="contactmechanics", press=press_contactmechanics, **codes.CONTACTMECHANICS,
            settings=f"constrained conjugate gradients, pentol {CONTACTMECHANICS_TOLERANCE:g} of the window",
        ),
    )
}  # fmt: skip

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
