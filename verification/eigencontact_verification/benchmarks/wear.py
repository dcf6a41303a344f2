"""Surfaces that wear: time of whole histories, and what moving and storing the surfaces adds to solving the contact.

A rigid sphere of 200 um under 12.307 N on steel, in a window of n x n cells, everything stored, no pictures.
``gross sliding``: the sphere slides and wears to 100 times the volume pi a^4 / 4 R of its first contact (WR-9).
``partial slip``: friction .5, to and fro by .025 a, 40 increments a cycle, 5000 cycles with jump-error 1e-2.

``update / contact`` is the time in which the surfaces are moved, jumps over cycles and the gone-through cycles after
them apart, by that in which the contacts of the same steps are solved; ``stored`` is the part of the run that writes.
"""

from __future__ import annotations

from tempfile import TemporaryDirectory
from time import perf_counter
from typing import Any

import numpy as np

from eigencontact_verification.benchmarks.benchmark import Benchmark, Sample, Task, Trial
from eigencontact_verification.benchmarks.codes import Code, ours
from eigencontact_verification.reporting.table import Column

__all__ = ["BENCHMARK", "CASES", "METHODS", "measure"]

CASES = ("gross sliding", "partial slip")
METHODS = ours(
    "tolerance 1e-6, double precision, coupling none",
    "pyfftw", "scipy.fft", "eigencontact.app", "eigencontact.execution.wear.surface",
)  # fmt: skip
_RADIUS, _LOAD, _CONTACT = 200e-6, 12.307, 20e-6
_CYCLES = 5000


def _scene(task: Task) -> dict[str, Any]:
    scene: dict[str, Any] = {
        "body1": {"young-modulus": "210 GPa", "poisson-ratio": 0.3},
        "body2": {"rigid": True},
        "geometry": {"type": "sphere", "radius": _RADIUS},
        "numerics": {"coupling": "none", "threads": task.threads},
        "output": {"pictures": False},
    }
    if task.case == "gross sliding":
        friction, coefficient = 0.25, 1e-18
        volume = 100.0 * np.pi * _CONTACT**4 / (4.0 * _RADIUS)
        size, body = 8.4 * _CONTACT, 2
        steps: list[dict[str, Any]] = [
            {"normal-load": _LOAD, "sliding-distance": volume / (coefficient * friction * _LOAD)}
        ]
    else:
        friction, coefficient, size, body = 0.5, 2.723e-12, 2.6 * _CONTACT, 1
        way = 0.025 * _CONTACT
        cycle = [
            {"shift-x": way, "increments": 10},
            {"shift-x": -way, "increments": 20},
            {"shift-x": 0.0, "increments": 10},
        ]
        steps = [{"normal-load": _LOAD}, {"cycle": cycle, "repeat": _CYCLES}]
    return {
        **scene,
        "friction": {"type": "coulomb", "coefficient": friction},
        "wear": {"type": "dissipated-energy", "coefficient": coefficient, "body": body, "jump-error": 1e-2},
        "grid": {"cells": [task.n, task.n], "size": [size, size]},
        "steps": steps,
    }


def _watch(**methods: tuple[type, str]) -> dict[str, float]:
    """Wall times [s] spent in methods of classes from now on, by name."""
    spent = dict.fromkeys(methods, 0.0)

    def watched(name: str, method: Any) -> Any:
        def call(*args: Any, **kwargs: Any) -> Any:
            began = perf_counter()
            try:
                return method(*args, **kwargs)
            finally:
                spent[name] += perf_counter() - began

        return call

    for name, (owner, method) in methods.items():
        setattr(owner, method, watched(name, getattr(owner, method)))
    return spent


def measure(_: Code, task: Task) -> Sample:
    """Measure one case in this process, which is a fresh one."""
    import eigencontact as ec
    from eigencontact.execution.mechanics.mechanics import RunningMechanics
    from eigencontact.execution.wear.surface import WornSurface
    from eigencontact.results.store import ResultStore

    spent = _watch(
        solve=(RunningMechanics, "advance"),
        skip=(WornSurface, "begin"),
        update=(WornSurface, "advance"),
        write=(ResultStore, "write_step"),
        join=(ResultStore, "finish"),
    )
    scene = ec.Scene(**_scene(task))

    def call() -> Any:
        with TemporaryDirectory() as folder:
            return ec.run(scene, f"{folder}/run")

    def judge(result: Any) -> dict[str, Any]:
        numbers = result.summary
        return {
            "run_s": result.seconds,
            "solve_s": spent["solve"],
            "move_s": spent["skip"] + spent["update"],
            "against": spent["update"] / spent["solve"],
            "stored": (spent["write"] + spent["join"]) / result.seconds,
            "cycles": int(numbers["cycles"]),
            "steps": numbers["steps"],
            "volume": numbers["worn_volume"],
            "depth": numbers["max_worn_depth"],
            "peak": numbers["max_pressure"],
            "error": numbers["wear_error"],
            "identity": numbers["energy_volume_residual"],
        }

    return Trial(call=call, judge=judge).run(task, warm=0)


BENCHMARK = Benchmark(
    name="wear",
    help="histories of surfaces that wear",
    measure=measure,
    medians=("run_s", "solve_s", "move_s", "against", "stored"),
    methods=METHODS,
    cases=CASES,
    sizes=(64, 128, 256),
    columns=(
        Column("case", "case"),
        Column("cells", "n", "d"),
        Column("cycles", "cycles", "d"),
        Column("steps solved", "steps", "d"),
        Column("run [s]", "run_s", ".2g"),
        Column("contacts [s]", "solve_s", ".2g"),
        Column("surfaces [s]", "move_s", ".2g"),
        Column("update / contact", "against", ".2f"),
        Column("stored", "stored", ".2f"),
        Column("worn [um^3]", "volume", ".5g", scale=1e18),
        Column("deepest [nm]", "depth", ".5g", scale=1e9),
        Column("peak [MPa]", "peak", ".5g", scale=1e-6),
        Column("stated error", "error", ".0e"),
        Column("energy to volume", "identity", ".0e"),
        Column("processes", "processes", "d", brief=False),
    ),
)
