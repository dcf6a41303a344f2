"""Frictionless Hertz contact: a whole solve against one bare convolution, and its error.

Rigid paraboloid, load control, exact Love kernel, window of four contact radii. The time that counts is that of the
**first call in a fresh process**, imports excluded: it includes kernel, operator and FFT plans, as a user's call does.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import asdict
from functools import partial
from math import log2
from typing import TYPE_CHECKING, Any

from eigencontact_verification.benchmarks.benchmark import Benchmark, Sample, Task, Trial, one_and_all, repeated
from eigencontact_verification.benchmarks.codes import PEERS
from eigencontact_verification.benchmarks.measure import Convolution, HertzProblem, judge
from eigencontact_verification.reporting.table import Column, Row

if TYPE_CHECKING:
    from eigencontact_verification.benchmarks.codes import Code, Solution

__all__ = ["BENCHMARK", "measure", "scaling"]


def measure(code: Code, task: Task) -> Sample:
    """Solve, and solve again in turn with bare convolutions."""
    assert code.solve is not None
    solve = partial(code.solve, task.n, task.threads, task.precision)

    def floors() -> Mapping[str, Callable[[], list[float]]]:
        problem = HertzProblem(n=task.n)
        convolution, field = Convolution(problem), problem.pressure
        convolution(field, task.threads)
        return one_and_all("convolution", task.threads, lambda w: repeated(lambda: convolution(field, w)))

    def judged(answer: Solution) -> dict[str, Any]:
        pressure, iterations, convolutions = answer
        errors = judge(HertzProblem(n=task.n), pressure)
        return {"iterations": iterations, "convolutions": convolutions, **asdict(errors)}

    return Trial(call=solve, floors=floors, judge=judged).run(task)


def _cost(task: Task, row: Row) -> Row:
    """Time per point and log2 N."""
    points = task.n**2 * log2(task.n) if task.n > 1 else 1.0
    return {
        f"{call}_ns_per_point_log": 1e9 * row[f"{call}_s"] / points if row[f"{call}_s"] is not None else None
        for call in ("first", "again")
    }


def scaling(rows: list[Row], small: int = 512, large: int = 2048, bound: float = 1.5) -> list[str]:
    """Sentences on how the cost per point and log2(N) grows from `small` to `large`, for codes that ran both."""
    cost = {(row["code"], row["n"]): row for row in rows}
    sentences = []
    for code in dict.fromkeys(row["code"] for row in rows):
        if (code, small) not in cost or (code, large) not in cost:
            continue
        for key, words in (("first_ns_per_point_log", "first call"), ("again_ns_per_point_log", "again")):
            before, after = cost[code, small][key], cost[code, large][key]
            if before is None or after is None:
                continue
            ratio = after / before
            verdict = "within" if ratio <= bound else "beyond"
            sentences.append(
                f"{code}, {words}: cost per point and log2 N at {large} is {ratio:.2f} times that at {small}"
                f" ({verdict} {bound})"
            )
    return sentences


BENCHMARK = Benchmark(
    name="hertz",
    help="frictionless Hertz against one bare convolution",
    measure=measure,
    function="solve",
    floors=("convolution_1", "convolution_threads"),
    derive=_cost,
    remarks=scaling,
    peers=PEERS,
    sizes=(256, 512, 1024, 2048),
    columns=(
        Column("N", "n", "d"),
        Column("code", "code"),
        Column("first call [s]", "first_s", ".3g"),
        Column("min [s]", "first_min_s", ".3g", brief=False),
        Column("again [s]", "again_s", ".3g"),
        Column("/ convolution", "first_per_convolution_1", ".3g"),
        Column("/ convolution, threads", "first_per_convolution_threads", ".3g"),
        Column("again / convolution", "again_per_convolution_1", ".3g"),
        Column("again / convolution, threads", "again_per_convolution_threads", ".3g"),
        Column("gap", "gap", ".1e"),
        Column("p0 error", "peak_error", "+.1e"),
        Column("a error", "radius_error", "+.1e", brief=False),
        Column("p error, L2", "pressure_error", ".1e"),
        Column("load error", "load_error", "+.0e", brief=False),
        Column("iterations", "iterations", "d"),
        Column("convolutions", "convolutions", "d"),
        Column("peak [MB]", "peak_bytes", ".0f", scale=1e-6),
        Column("cores", "cores", ".1f", brief=False),
        Column("ns / N² log2 N", "first_ns_per_point_log", ".3g", brief=False),
        Column("processes", "processes", "d", brief=False),
    ),
)
