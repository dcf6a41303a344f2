"""Does a run to an accuracy reach it? Bundled scenes with one target for all main results, judged by a finer run.

The judge refines every source of error of the answer once more (`random_scenes.finer`). The scene with the cells
that its author chose is solved too, and judged alike. The scene with the settings of the answer is solved by itself:
this is what a hand-chosen scene of the same true error takes. Times are processor times.
"""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from typing import Any

import numpy as np

from eigencontact.scene.loader import bundled_names
from eigencontact_verification.benchmarks.benchmark import Benchmark, Sample, Task, timed
from eigencontact_verification.benchmarks.codes import Code
from eigencontact_verification.benchmarks.error_bars import METHODS
from eigencontact_verification.benchmarks.random_scenes import finer
from eigencontact_verification.reporting.table import Column, Row

__all__ = ["BENCHMARK", "measure", "verdict"]

#: Time that a run to the accuracy may take, and longest predicted time of the judge [s].
_TIME, _JUDGE = 200.0, 400.0


def measure(_: Code, task: Task) -> Sample:
    """One scene with a target of `task.n` per cent."""
    from eigencontact import app
    from eigencontact.errors import EigencontactError

    quiet = ["output.pictures=false", "output.vtk=false", "output.animation=false", f"numerics.threads={task.threads}"]
    scene = app.load_scene(task.case, quiet)
    hand, _wall, hand_seconds = timed(lambda: app.run(scene))
    targets = {"numbers": f"{task.n} %", "time": _TIME}
    try:
        answer, _wall, seconds = timed(lambda: app.run(scene, accuracy=targets))
    except EigencontactError as problem:
        return {"status": "ok", "took_s": hand_seconds, "hand_s": hand_seconds, "said": " ".join(str(problem).split())}
    entry = answer.summary["accuracy"]
    sample = {
        "status": "ok", "took_s": seconds, "hand_s": hand_seconds, "rungs": len(entry["rungs"]), "runs": entry["runs"],
        "said": entry["stopped"],
    }  # fmt: skip
    planned = app.plan(tomllib.loads(answer.dataset.attrs["scene"]))
    sample["alone_s"] = timed(lambda: app.run(planned))[2]
    truth, reason = _truth(planned, entry["rungs"][-1]["seconds"] / planned.seconds)
    if truth is None:
        sample["said"] += f" (no judge: {reason})"
    return sample | verdict(answer.summary, hand.summary, truth)


def _truth(planned: Any, ratio: float) -> tuple[Mapping[str, Any] | None, str]:
    """Summary of the judge, or None and the reason; `ratio` is the time of the answer relative to its prediction.

    The judge has no stress regions where they exceed the memory or the time. Their numbers are then not judged.
    """
    from eigencontact import app
    from eigencontact.errors import EigencontactError

    reason = ""
    for with_regions in (True, False):
        try:
            tables = finer(planned)
            finest = app.plan(tables if with_regions else {**tables, "stress": []})
            if (seconds := ratio * finest.seconds) < _JUDGE:
                return app.run(finest).summary, ""
            reason = f"it would take {seconds:.0f} s"
        except EigencontactError as problem:
            reason = " ".join(str(problem).split())
    return None, reason


def verdict(answer: Mapping[str, Any], hand: Mapping[str, Any], truth: Mapping[str, Any] | None) -> Row:
    """Targets that hold by the bars and against the judge; largest errors in parts of the target."""
    targets = answer["accuracy"]["targets"]
    met = [name for name, row in targets.items() if row["holds"]]
    judged = [name for name in met if truth is not None and np.isfinite(_value(truth, name))]
    row: Row = {
        "held": f"{len(met)} of {len(targets)}",
        "missed": ", ".join(sorted(set(targets) - set(met))) or "none",
    }
    if truth is None or not judged:
        return row

    def worst(summary: Mapping[str, Any]) -> tuple[float, str]:
        return max(
            (abs(_value(summary, name) - _value(truth, name)) / targets[name]["allowed"], name) for name in judged
        )

    true = [name for name in judged if abs(_value(answer, name) - _value(truth, name)) <= targets[name]["allowed"]]
    return row | {
        "true": f"{len(true)} of {len(judged)}", "error": worst(answer)[0], "hand_error": worst(hand)[0],
        "untrue": ", ".join(sorted(set(judged) - set(true))) or "none",
    }  # fmt: skip


def _value(summary: Mapping[str, Any], name: str) -> float:
    value = summary.get(name, summary["observed"].get(name))
    return float("nan") if value is None else float(value)


def _remarks(rows: list[Row]) -> list[str]:
    return [f"{row['case']}: {row['said']}" for row in rows if row.get("said")]


BENCHMARK = Benchmark(
    name="accuracy_asked",
    help="bundled scenes with a target for all main results beside their own cells",
    measure=measure,
    methods=METHODS,
    cases=tuple(bundled_names()),
    sizes=(2,),
    unit="PERCENT",
    remarks=_remarks,
    columns=(
        Column("scene", "case"),
        Column("hold by the bars", "held"),
        Column("not held", "missed"),
        Column("true, of these judged", "true"),
        Column("largest true error / target", "error", ".2f"),
        Column("same, cells of the scene", "hand_error", ".2f"),
        Column("runs", "runs", "d"),
        Column("time [s]", "took_s", ".1f"),
        Column("time, settings of the answer alone [s]", "alone_s", ".1f"),
        Column("time, cells of the scene [s]", "hand_s", ".1f"),
    ),
)
