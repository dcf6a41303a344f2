"""Frictionless Hertz contact: a whole solve against one bare convolution, and what it is worth.

Rigid paraboloid, load control, exact Love kernel, window of four contact radii. The time that counts is that of the
**first call in a fresh process**, imports excluded: it includes kernel, operator and FFT plans, as a user's call does.
"""

from __future__ import annotations

import time
from dataclasses import asdict
from math import log2
from statistics import median
from typing import TYPE_CHECKING

from eigencontact_verification.benchmarks.clock import sample, timed
from eigencontact_verification.benchmarks.measure import Convolution, HertzProblem, judge
from eigencontact_verification.benchmarks.memory import PeakMemory
from eigencontact_verification.benchmarks.table import Column, Row

if TYPE_CHECKING:
    from eigencontact_verification.benchmarks.codes import Code
    from eigencontact_verification.benchmarks.task import Sample, Task

__all__ = ["COLUMNS", "measure", "scaling", "summarise"]


def measure(code: Code, task: Task) -> Sample:
    """Solve once cold and `task.warm` times more, alternating with bare convolutions, in this process.

    Raises
    ------
    ImportError
        If the code is absent.
    """
    if code.solve is None:
        raise ImportError("takes no part in this benchmark")
    solve, began = code.solve, time.perf_counter()
    code.load()
    memory = PeakMemory()
    (pressure, iterations, convolutions), first, cpu = timed(lambda: solve(task.n, task.threads, task.precision))
    peak = memory.peak()

    problem = HertzProblem(n=task.n)
    judgement = judge(problem, pressure)
    convolution, field = Convolution(problem), problem.pressure
    workers = sorted({1, task.threads})
    floors: dict[int, list[float]] = {w: [] for w in workers}

    def bare() -> None:
        for w in workers:
            floors[w] += sample(lambda: convolution(field, w))  # noqa: B023 - called at once

    convolution(field, task.threads)
    again: list[float] = []
    bare()
    while len(again) < task.warm and time.perf_counter() - began + 2 * first < task.budget:
        again.append(timed(lambda: solve(task.n, task.threads, task.precision))[1])
        bare()
    return {
        "status": "ok",
        "first_s": first,
        "first_cpu_s": cpu,
        "again_s": again,
        "peak_bytes": peak,
        "peak_reset": memory.reset,
        "iterations": iterations,
        "convolutions": convolutions,
        "convolution_1_s": median(floors[1]),
        "convolution_threads_s": median(floors[task.threads]),
        **asdict(judgement),
    }


def summarise(task: Task, samples: list[Sample]) -> Row:
    """One row of the table from the processes of one code and size; medians over processes."""
    first = [s["first_s"] for s in samples]
    again = [t for s in samples for t in s["again_s"]]
    peaks = [s["peak_bytes"] for s in samples if s["peak_bytes"] is not None]
    last = samples[-1]
    points = task.n**2 * log2(task.n) if task.n > 1 else 1.0
    kept = ("iterations", "convolutions", "gap", "tension", "load_error", "peak_error", "radius_error")
    return {
        "code": task.code,
        "n": task.n,
        "threads": task.threads,
        "precision": task.precision,
        "processes": len(samples),
        "first_s": median(first),
        "first_min_s": min(first),
        "again_s": median(again) if again else None,
        "again_min_s": min(again) if again else None,
        "cores": median(s["first_cpu_s"] / s["first_s"] for s in samples),
        "convolution_1_s": median(s["convolution_1_s"] for s in samples),
        "convolution_threads_s": median(s["convolution_threads_s"] for s in samples),
        "first_per_convolution_1": median(s["first_s"] / s["convolution_1_s"] for s in samples),
        "first_per_convolution_threads": median(s["first_s"] / s["convolution_threads_s"] for s in samples),
        "again_per_convolution_1": (
            median(median(s["again_s"]) / s["convolution_1_s"] for s in samples if s["again_s"]) if again else None
        ),
        "again_per_convolution_threads": (
            median(median(s["again_s"]) / s["convolution_threads_s"] for s in samples if s["again_s"])
            if again
            else None
        ),
        "peak_bytes": max(peaks) if peaks else None,
        "first_ns_per_point_log": 1e9 * median(first) / points,
        "again_ns_per_point_log": 1e9 * median(again) / points if again else None,
        "pressure_error": last["pressure_error"],
        **{key: last[key] for key in kept},
    }


def scaling(rows: list[Row], small: int = 512, large: int = 2048, bound: float = 1.5) -> list[str]:
    """Sentences on how the cost per point and log2(N) grows from `small` to `large`, for codes that ran both."""
    cost = {(row["code"], row["n"]): row for row in rows}
    said = []
    for code in dict.fromkeys(row["code"] for row in rows):
        if (code, small) not in cost or (code, large) not in cost:
            continue
        for key, words in (("first_ns_per_point_log", "first call"), ("again_ns_per_point_log", "again")):
            before, after = cost[code, small][key], cost[code, large][key]
            if before is None or after is None:
                continue
            ratio = after / before
            verdict = "within" if ratio <= bound else "beyond"
            said.append(
                f"{code}, {words}: cost per point and log2 N at {large} is {ratio:.2f} times that at {small}"
                f" ({verdict} {bound})"
            )
    return said


COLUMNS = (
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
)
