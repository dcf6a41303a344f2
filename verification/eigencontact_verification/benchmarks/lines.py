"""Line contacts: time of a Hertz contact, of a fretting cycle, and of a variant of a fretting map.

Steel or titanium in plane strain, everything in memory. ``Hertz``: 4096 cells, one load. ``cycle``: 1024 cells, one
cycle of 64 increments after loading in 17. ``map``: two loads by two amplitudes of the scene 'cylinder-fretting' with
128 cells per half width, planned anew each; the error is that of the last variant.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact_verification.benchmarks.benchmark import Benchmark, Sample, Task, Trial
from eigencontact_verification.benchmarks.codes import Code, ours
from eigencontact_verification.oracles.line_contact import hertz_cylinder
from eigencontact_verification.reporting.table import Column

if TYPE_CHECKING:
    from collections.abc import Callable

__all__ = ["BENCHMARK", "measure"]

_RADIUS, _LOAD, _SHEAR, _FRICTION = 10e-3, 400e3, 192e3, 0.8
_LOADS, _AMPLITUDES = (300e3, 400e3), (100e3, 192e3)
_MODULUS, _POISSON = 119e9, 0.3
#: Cases, and the tasks that one call has.
_CASES = {"Hertz": 1, "cycle": 1, "map": len(_LOADS) * len(_AMPLITUDES)}


def _scene(task: Task) -> dict[str, Any]:
    material = {"young-modulus": _MODULUS, "poisson-ratio": _POISSON}
    turns = [{"tangential-load-x": sign * _SHEAR, "increments": 32} for sign in (-1, 1)]
    cycle = [{"tangential-load-x": _SHEAR, "increments": 16}, *turns] if task.case == "cycle" else []
    return {
        "body1": material,
        "body2": material,
        "geometry": {"type": "cylinder", "radius": _RADIUS},
        "friction": {"type": "coulomb", "coefficient": _FRICTION} if cycle else None,
        "grid": {"length": "infinite", "cells": 1024 if cycle else 4096, "size": 0.7e-3},
        "steps": [{"normal-load": _LOAD}, *cycle],
        "numerics": {"threads": task.threads},
        "output": {"pictures": False},
    }


def _call(task: Task) -> Callable[[], float]:
    """Run of a case; it returns the largest pressure [Pa]."""
    import eigencontact as ec

    if task.case == "map":
        scene = ec.load_scene("cylinder-fretting", [f"numerics.threads={task.threads}"])
        return lambda: float(
            ec.fretting_map(scene, load=_LOADS, amplitude=_AMPLITUDES).dataset["max_pressure"].values[-1, -1]
        )
    plan = ec.plan(ec.load_scene({key: value for key, value in _scene(task).items() if value is not None}))
    return lambda: float(ec.run(plan).summary["max_pressure"])


def measure(code: Code, task: Task) -> Sample:
    """Measure one case in this process, which is a fresh one; plans are made before, except in a map."""
    del code
    largest = hertz_cylinder(_LOAD, _RADIUS, 0.5 * _MODULUS / (1.0 - _POISSON**2))[1]

    def judge(pressure: float) -> dict[str, Any]:
        return {"error": float(np.abs(pressure / largest - 1.0)), "variants": _CASES[task.case]}

    return Trial(call=_call(task), judge=judge).run(task)


BENCHMARK = Benchmark(
    name="lines",
    help="line contacts: Hertz, fretting cycle, fretting map",
    measure=measure,
    medians=("error", "variants"),
    methods=ours("tolerance 1e-6, double precision", "eigencontact.app", "eigencontact.sweeps.fretting_map"),
    ours=("eigencontact",),
    cases=tuple(_CASES),
    columns=(
        Column("case", "case"),
        Column("runs in one call", "variants", ".0f"),
        Column("first call [s]", "first_s", ".3g"),
        Column("processor time of the first call [s]", "first_cpu_s", ".3g"),
        Column("further calls [s]", "again_s", ".3g"),
        Column("error of the largest pressure", "error", ".1e"),
    ),
)
