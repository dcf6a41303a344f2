"""Time that `explain` predicts for every bundled scene and its blocks, against the time that they take.

Each scene is planned and run in a process of its own, in memory, without pictures. A prediction times a few
convolutions and kernels where it is made and counts them: on a busy machine neither side is reliable.
"""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path
from typing import Any

from eigencontact_verification.benchmarks.benchmark import Benchmark, Sample, Task, Trial
from eigencontact_verification.benchmarks.codes import Code, ours
from eigencontact_verification.reporting.table import Column, Row

__all__ = ["BENCHMARK", "FACTOR", "measure"]

#: By what a prediction may be wrong, either way.
FACTOR = 2.0

METHODS = ours(
    "bundled scenes as they are, in memory, without pictures",
    "eigencontact.app", "eigencontact.planning.planner", "eigencontact.results.memory", "scipy.fft",
)  # fmt: skip
_PLAIN = [f"output.{name}=false" for name in ("pictures", "vtk", "animation")]


def _bundled() -> tuple[str, ...]:
    """Names of the bundled scenes, found without importing the package: interpreters of peers do not have it."""
    package = find_spec("eigencontact")
    roots = [] if package is None else package.submodule_search_locations or []
    return tuple(sorted(path.stem for root in roots for path in Path(root, "gallery").glob("*.toml")))


def measure(_: Code, task: Task) -> Sample:
    """Plan and run one scene in this process, which is a fresh one."""
    import eigencontact as ec

    plan: Any = ec.plan(ec.load_scene(task.case, [*_PLAIN, f"numerics.threads={task.threads}"]))

    def judge(result: Any) -> dict[str, Any]:
        numbers = result.summary
        took: dict[str, float] = numbers["seconds_by_block"]
        predicted = {
            block.name: block.cost.seconds_once + plan.steps * block.cost.seconds_per_step for block in plan.blocks
        }
        worst = max(predicted, key=lambda name: abs(predicted[name] - took.get(name, 0.0)))
        return {
            "planned_s": plan.seconds_planned,
            "predicted_s": numbers["predicted_seconds"],
            "took_s": numbers["compute_seconds"],
            "factor": numbers["predicted_seconds"] / numbers["compute_seconds"],
            "memory": numbers["predicted_memory_bytes"] / numbers["peak_memory_bytes"],
            "worst": worst,
            "worst_predicted_s": predicted[worst],
            "worst_took_s": took.get(worst, 0.0),
            "blocks": {name: [predicted.get(name, 0.0), seconds] for name, seconds in took.items()},
        }

    return Trial(call=lambda: ec.run(plan), judge=judge).run(task, warm=0)


def _remarks(rows: list[Row]) -> list[str]:
    good = sum(1 / FACTOR <= row["factor"] <= FACTOR for row in rows)
    return [f"predicted within a factor of {FACTOR:.0f}: {good} of {len(rows)} scenes"]


BENCHMARK = Benchmark(
    name="predictions",
    help="time that is predicted of the bundled scenes, and time that they take",
    measure=measure,
    medians=("factor",),
    remarks=_remarks,
    methods=METHODS,
    cases=_bundled(),
    columns=(
        Column("scene", "case"),
        Column("predicted [s]", "predicted_s", ".2f"),
        Column("took [s]", "took_s", ".2f"),
        Column("predicted / took", "factor", ".2f"),
        Column("most wrong in block", "worst"),
        Column("predicted [s]", "worst_predicted_s", ".2f"),
        Column("took [s]", "worst_took_s", ".2f"),
        Column("planned in [s]", "planned_s", ".2f", brief=False),
        Column("memory predicted / peak", "memory", ".2f"),
    ),
)
