"""Bodies that yield: applications of the volume operator and time of a load step, and how both grow with the cells.

``EP-1`` is the bundled scene ``plastic-indentation`` (Swift's law), ``EP-2`` a sphere of 200 um under 12.307 N on a
perfectly plastic body of 7344 MPa: ten load steps and four back, n cells per contact radius of the elastic contact,
without pictures and regions. An application is that of the operator from eigenstrain to mean stress in all cells of
the box; ``step / bare`` is the time of a loading step, contact included, by the time of one bare application. Times
are those of the processor, which other work on the machine hardly changes.
The same operator is built and applied alone in a process of its own: the peak of the run is compared with the peak of
that process, which building sets, and with what the operator keeps.
"""

from __future__ import annotations

from multiprocessing import get_context
from statistics import median
from time import process_time
from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact_verification.benchmarks.benchmark import Benchmark, Sample, Task, Trial, timed
from eigencontact_verification.benchmarks.codes import Code, ours
from eigencontact_verification.reporting.memory import PeakMemory
from eigencontact_verification.reporting.table import Column, Row

if TYPE_CHECKING:
    from multiprocessing.connection import Connection


__all__ = ["BENCHMARK", "CASES", "METHODS", "measure"]

CASES = ("EP-1", "EP-2")
METHODS = ours(
    "tolerance 1e-6, double precision, exact half-space",
    "pyfftw", "scipy.fft", "eigencontact.app", "eigencontact.solvers.cell_sweeps",
)  # fmt: skip
_LOADING = 10
_STEEL = {"young-modulus": "210 GPa", "poisson-ratio": 0.3}
_SCENES: dict[str, dict[str, Any]] = {
    "EP-1": {
        "hardening": {"type": "swift", "B": "1240 MPa", "C": 30, "n": 0.085},
        "radius": "105 um",
        "load": "0.65 N",
    },
    "EP-2": {"hardening": {"type": "perfect", "yield-stress": "7344 MPa"}, "radius": "200 um", "load": "12.307 N"},
}


class _Clock:
    """Watcher of a run: processor time of every step [s]."""

    def __init__(self) -> None:
        self.steps: list[float] = []

    def step_started(self, point: Any, total: int) -> None:  # noqa: ARG002
        self._began = process_time()

    def iterated(self, text: str, residual: float, tolerance: float) -> None:
        pass

    def step_finished(self, record: Any, total: int) -> None:  # noqa: ARG002
        self.steps.append(process_time() - self._began)


def measure(_: Code, task: Task) -> Sample:
    """Measure one case in this process, which is a fresh one."""
    import eigencontact as ec

    settings = _SCENES[task.case]
    scene = ec.Scene(
        body1=_STEEL | {"law": {"type": "j2", "hardening": settings["hardening"]}},
        geometry={"type": "sphere", "radius": settings["radius"]},
        grid={"cells_per_contact_radius": task.n, "margin": 1.8},
        steps=[
            {"normal_load": settings["load"], "increments": _LOADING},
            {"normal_load": "0 N", "increments": 4},
        ],
        numerics={"threads": task.threads},
        output={"pictures": False},
    )

    def judge(result: Any) -> dict[str, Any]:
        data = result.dataset
        applied = data["inclusion_iterations"].values
        eigenstrain = data["equivalent_eigenstrain_1"][-1]
        axes = [eigenstrain[f"cells_1_{name}"].values for name in "xyz"]
        apart = _apart(axes, np.ascontiguousarray(eigenstrain.values), task.threads)
        step = float(np.mean(clock.steps[:_LOADING]))
        return {
            "cells": int(eigenstrain[0].size),
            "box": " x ".join(str(size) for size in reversed(eigenstrain.shape[1:])),
            "loading": float(applied[:_LOADING].mean()),
            "unloading": int(applied[_LOADING:].sum()),
            "step_s": step,
            "against": step / apart["bare_s"],
            "depth": float(data["approach"].max()),
            "print": float(data["print_depth"][-1]),
            "largest": float(data["max_pressure"].max()),
            "certificate": float(data["law_residual"].max()),
            **apart,
        }

    clock = _Clock()
    return Trial(call=lambda: ec.run(scene, watcher=clock), judge=judge).run(task, warm=0)


def _apart(*arguments: Any) -> dict[str, Any]:
    """Ask `_operator_cost` in a fresh process, which ends by itself even where this one is ended before."""
    context = get_context("spawn")
    answer, sender = context.Pipe(duplex=False)
    child = context.Process(target=_sent, args=(sender, *arguments))
    child.start()
    sender.close()
    answer_data: dict[str, Any] = answer.recv()
    child.join()
    return answer_data


def _sent(sender: Connection, *arguments: Any) -> None:
    sender.send(_operator_cost(*arguments))


def _operator_cost(axes: list[Any], values: Any, threads: int) -> dict[str, Any]:
    """Processor time of one application of the operator in its cells [s], and its memory [byte]."""
    METHODS["eigencontact"].load()
    from eigencontact.solvers.cells import Cells
    from eigencontact.solvers.mean_stress import MeanVolumeField
    from eigencontact_plugins.shapes.cuboid import Cuboid

    dx, dy, dz = tuple(float(axis[1] - axis[0]) for axis in axes)
    first = (float(axes[0][0]), float(axes[1][0]), float(axes[2][0]))
    cells = Cells(first=first, pitch=(dx, dy, dz), shape=values.shape[1:])
    cell, memory = Cuboid(center=(0.0, 0.0, 0.5 * dz), edges=(dx, dy, dz)), PeakMemory()
    operator = MeanVolumeField(
        cell, cells, cells, poisson_ratio=0.3, shear_modulus=1.0, threads=threads, applications=100
    )
    operator.apply(values)
    times = [timed(lambda: operator.apply(values))[2] for _ in range(3)]
    return {"bare_s": median(times), "operator_bytes": memory.peak(), "kept_bytes": operator.nbytes}


def _compared(task: Task, row: Row) -> Row:  # noqa: ARG001
    """Memory of the run in that of the operator alone, as it is built and as it is kept."""
    peak, built = row["peak_bytes"], row["operator_bytes"]
    if not peak or not built:
        return {}
    return {"by_built": peak / built, "by_kept": peak / row["kept_bytes"]}


BENCHMARK = Benchmark(
    name="plasticity",
    help="load steps of bodies that yield",
    measure=measure,
    medians=("step_s", "against"),
    worst=("operator_bytes",),
    derive=_compared,
    methods=METHODS,
    cases=CASES,
    sizes=(8, 12, 16),
    unit="CELLS-PER-CONTACT-RADIUS",
    columns=(
        Column("case", "case"),
        Column("cells per radius", "n", "d"),
        Column("box", "box"),
        Column("cells", "cells", "d", brief=False),
        Column("applications a loading step", "loading", ".1f"),
        Column("on unloading", "unloading", "d"),
        Column("loading step [s]", "step_s", ".2g"),
        Column("step / bare application", "against", ".1f"),
        Column("depth [nm]", "depth", ".2f", scale=1e9),
        Column("print [nm]", "print", ".2f", scale=1e9),
        Column("peak pressure [MPa]", "largest", ".0f", scale=1e-6),
        Column("certificate", "certificate", ".0e"),
        Column("peak [MB]", "peak_bytes", ".0f", scale=1e-6),
        Column("by the operator's alone", "by_built", ".2f"),
        Column("by what that keeps", "by_kept", ".1f"),
        Column("operator alone [MB]", "operator_bytes", ".0f", scale=1e-6, brief=False),
        Column("it keeps [MB]", "kept_bytes", ".0f", scale=1e-6, brief=False),
        Column("processes", "processes", "d", brief=False),
    ),
)
