"""The largest single contact that a given memory holds: what `explain` says fits, and what it then takes.

The cells of a contact radius are raised until the plan of the next size would need more than the memory asked for; that
size is solved in a process of its own, in memory, without pictures. Sizes of the benchmark are gibibytes.
"""

from __future__ import annotations

from typing import Any

from eigencontact_verification.benchmarks.benchmark import Benchmark, Sample, Task, Trial
from eigencontact_verification.benchmarks.codes import Code, ours
from eigencontact_verification.reporting.table import Column, Row

__all__ = ["BENCHMARK", "largest", "measure"]

METHODS = ours(
    "in memory, without pictures; the contact of 'hertz', and of 'plastic-hertz' pressed once",
    "eigencontact.app", "eigencontact.planning.planner", "eigencontact.results.memory", "scipy.fft",
)  # fmt: skip
_PLAIN = [f"output.{name}=false" for name in ("pictures", "vtk", "animation")]
#: Scene and changes of each case.
_CASES: dict[str, tuple[str, list[str]]] = {
    "elastic": ("hertz", ["stress=[]"]),
    "stress in a section": ("hertz", ['stress=[{name="section", shape="plane", normal="y", depth-max="9 um"}]']),
    "stress in a volume": ("hertz", ['stress=[{name="box", shape="volume", depth-max="9 um"}]']),
    "plastic volume": (
        "plastic-hertz",
        ["stress=[]", "observers=[]", 'steps=[{normal-load="12.307 N", increments=4}]'],
    ),
}
#: Cells per contact radius that are tried first, and the ratio of neighbouring sizes in the end.
_FIRST, _CLOSE = 8, 1.04


def largest(scene: str, changes: list[str], memory: float) -> tuple[int, Any]:
    """Cells per contact radius, and the plan, of the largest contact whose plan needs no more than `memory` [byte].

    Raises
    ------
    ValueError
        Where not even the smallest one fits.
    """
    import eigencontact as ec
    from eigencontact.core.memory import resident_bytes
    from eigencontact.errors import PlanError

    room = memory - resident_bytes()

    def plan_of(cells: int) -> Any:
        try:
            plan: Any = ec.plan(ec.load_scene(scene, [*_PLAIN, *changes, f"grid.cells-per-contact-radius={cells}"]))
        except PlanError:  # more than the machine has
            return None
        return plan if plan.cost.peak <= room else None

    low, fitting = _FIRST, plan_of(_FIRST)
    if fitting is None:
        raise ValueError(f"memory must hold {_FIRST} cells per contact radius (got {memory:.3g} byte); give more")
    high = 2 * low
    while (larger := plan_of(high)) is not None:
        low, fitting, high = high, larger, 2 * high
    while high > max(_CLOSE * low, low + 1):
        middle = (low + high) // 2
        between = plan_of(middle)
        if between is None:
            high = middle
        else:
            low, fitting = middle, between
    return low, fitting


def measure(_: Code, task: Task) -> Sample:
    """Find the size, and run it in this process, which is a fresh one."""
    import eigencontact as ec

    scene, changes = _CASES[task.case]
    cells, plan = largest(scene, [*changes, f"numerics.threads={task.threads}"], task.n * 2.0**30)

    def judge(result: Any) -> dict[str, Any]:
        numbers = result.summary
        return {
            "cells_per_radius": cells,
            "surface_cells": plan.grid.nx * plan.grid.ny,
            "across": plan.grid.nx,
            "predicted_gib": numbers["predicted_memory_bytes"] / 2**30,
            "peak_gib": numbers["peak_memory_bytes"] / 2**30,
            "took_s": numbers["compute_seconds"],
            "iterations": numbers.get("iterations"),
        }

    return Trial(call=lambda: ec.run(plan), judge=judge).run(task, warm=0)


def _remarks(rows: list[Row]) -> list[str]:
    within = sum(row["peak_gib"] <= row["n"] for row in rows if row.get("peak_gib"))
    return [f"within the memory asked for: {within} of {len(rows)}"]


BENCHMARK = Benchmark(
    name="largest",
    help="the largest single contact that a given memory holds",
    measure=measure,
    remarks=_remarks,
    methods=METHODS,
    cases=tuple(_CASES),
    sizes=(1, 4, 16),
    unit="GiB",
    columns=(
        Column("what", "case"),
        Column("memory [GiB]", "n"),
        Column("cells per contact radius", "cells_per_radius"),
        Column("cells across the surface", "across"),
        Column("predicted [GiB]", "predicted_gib", ".2f"),
        Column("peak [GiB]", "peak_gib", ".2f"),
        Column("took [s]", "took_s", ".1f"),
    ),
)
