"""Line contacts: time of Hertz's, of fretting elastic and plastic, of a fretting map, and of the fatigue criteria.

Steel or titanium in plane strain, everything in memory. ``Hertz``: 4096 cells, one load. ``cycle``: 1024 cells, one
cycle of 64 increments after loading in 17. ``map``: two loads by two amplitudes of the scene 'cylinder-fretting' with
128 cells per half width, planned anew each; the error is that of the last variant. ``plastic``: a rigid cylinder on
steel with Prager's hardening, loaded in 4 increments to 2.3 times the load of first yield and rubbed in 100 cycles of
8, on 256 x 95 cells; it has no closed form. ``criteria``: all fatigue criteria on 30 000 points and 24 steps.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact_verification.benchmarks.benchmark import Benchmark, Sample, Task, Trial
from eigencontact_verification.benchmarks.codes import Code, ours
from eigencontact_verification.benchmarks.fatigue import CRITERIA, cycle_of
from eigencontact_verification.oracles.line_contact import hertz_cylinder
from eigencontact_verification.reporting.table import Column

if TYPE_CHECKING:
    from collections.abc import Callable

__all__ = ["BENCHMARK", "measure"]

_RADIUS, _LOAD, _SHEAR, _FRICTION = 10e-3, 400e3, 192e3, 0.8
_LOADS, _AMPLITUDES = (300e3, 400e3), (100e3, 192e3)
_MODULUS, _POISSON = 119e9, 0.3
#: Cases, and the tasks that one call has.
_CASES = {"Hertz": 1, "cycle": 1, "map": len(_LOADS) * len(_AMPLITUDES), "plastic": 100, "criteria": len(CRITERIA)}
#: Cases that are judged by Hertz's pressure, and called again.
_JUDGED = ("Hertz", "cycle", "map")
#: Points and steps of the criteria.
_CYCLE = (30_000, 24)


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


def _plastic(task: Task) -> dict[str, Any]:
    hardening = [{"type": "perfect", "yield-stress": "500 MPa"}, {"type": "prager", "modulus": "5 GPa"}]
    law = {"type": "j2", "hardening": hardening}
    turns = [{"tangential-load-x": load, "increments": 4} for load in (60e3, -60e3)]
    return {
        "body1": {"young-modulus": 210e9, "poisson-ratio": 0.3, "law": law},
        "body2": {"rigid": True},
        "geometry": {"type": "cylinder", "radius": _RADIUS},
        "friction": {"type": "coulomb", "coefficient": 0.5},
        "grid": {"length": "infinite", "cells": 194, "size": 0.8e-3},
        "steps": [{"normal-load": 250e3, "increments": 4}, *turns * _CASES["plastic"]],
        "numerics": {"inclusion-pitch": 5e-6, "threads": task.threads},
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
    if task.case == "criteria":
        from eigencontact.execution.fields.fatigue import damage_in_parts

        criteria = [ec.make(name, kind="fatigue-criterion", **table) for name, table in CRITERIA.items()]
        short_cycle, cycle = cycle_of(200, _CYCLE[1]), cycle_of(*_CYCLE)
        for criterion in criteria:  # compiling is no part of it
            criterion.damage(short_cycle)
        return lambda: float(sum(damage_in_parts(criterion, cycle, task.threads)[0].max() for criterion in criteria))
    if task.case == "plastic":
        yielding = ec.plan(ec.load_scene(_plastic(task)))
        return lambda: float(ec.run(yielding).summary["max_pressure"])
    plan = ec.plan(ec.load_scene({key: value for key, value in _scene(task).items() if value is not None}))
    return lambda: float(ec.run(plan).summary["max_pressure"])


def measure(code: Code, task: Task) -> Sample:
    """Measure one case in this process, which is a fresh one; plans are made before, except in a map."""
    del code
    largest = hertz_cylinder(_LOAD, _RADIUS, 0.5 * _MODULUS / (1.0 - _POISSON**2))[1]

    def judge(pressure: float) -> dict[str, Any]:
        error = {"error": float(np.abs(pressure / largest - 1.0))} if task.case in _JUDGED else {}
        return error | {"variants": _CASES[task.case]}

    return Trial(call=_call(task), judge=judge).run(task, warm=None if task.case in _JUDGED else 0)


BENCHMARK = Benchmark(
    name="lines",
    help="line contacts: Hertz, fretting cycle, fretting map, plastic cycles, fatigue criteria",
    measure=measure,
    medians=("error", "variants"),
    methods=ours("tolerance 1e-6, double precision", "eigencontact.app", "eigencontact.sweeps.fretting_map"),
    ours=("eigencontact",),
    cases=tuple(_CASES),
    columns=(
        Column("case", "case"),
        Column("runs, cycles or criteria in one call", "variants", ".0f"),
        Column("first call [s]", "first_s", ".3g"),
        Column("processor time of the first call [s]", "first_cpu_s", ".3g"),
        Column("further calls [s]", "again_s", ".3g"),
        Column("error of the largest pressure", "error", ".1e"),
    ),
)
