"""Do the errors of fields hold? The scenes and the judge of the error bars, compared at the points of every field.

The judge is carried to the points of the run. Points count where a field reaches a tenth of its largest value.
"""

from __future__ import annotations

from collections import defaultdict
from functools import reduce
from random import Random
from typing import Any

import numpy as np

from eigencontact_verification.benchmarks.benchmark import Benchmark, Sample, Task, timed
from eigencontact_verification.benchmarks.codes import Code, ours
from eigencontact_verification.benchmarks.random_scenes import KINDS, finer, random_scene
from eigencontact_verification.reporting.table import Column

__all__ = ["BENCHMARK", "compared", "measure"]

#: Points with less than this part of the largest value of a field do not count.
_MATTERS = 0.1
#: Differences below this part of the largest value are round-off.
_NOTHING = 1e-9
#: A field is held where its errors hold at this part of the points.
_SHARE = 0.95


def compared(tables: dict[str, Any]) -> dict[str, tuple[float, float]]:
    """Part of the points whose error holds, and the median of error over true error, by field, after the last step.

    Raises
    ------
    EigencontactError
        The scene or its judge cannot be solved.
    """
    from eigencontact import app
    from eigencontact.accuracy.carry import axes_of, interpolated

    planned = app.plan(tables)
    result = app.run(planned, errors=True)
    run, judge = result.dataset, app.run(finer(planned)).dataset
    shares = {}
    for name in result.summary["field_errors"]:
        values, errors = (run[stored].values[-1] for stored in (name, f"{name}_error"))
        places, judge_places = axes_of(run, name), axes_of(judge, name)
        true = interpolated(judge[name].values[-1], judge_places, places, smooth=True)
        least = _NOTHING * np.nanmax(np.abs(values))
        differences = np.abs(values - true)
        counts = (np.abs(values) > _MATTERS * np.nanmax(np.abs(values))) & (np.fmax(errors, differences) > least)
        # windows of whole cells differ a little: the judge does not know what lies beyond its own
        inside = [(at >= line[0]) & (at <= line[-1]) for at, line in zip(places, judge_places, strict=True)]
        counts &= reduce(np.logical_and.outer, inside)
        if counts.any():
            ratios = errors[counts] / np.maximum(differences[counts], least)
            shares[name] = (float(np.mean(ratios >= 1.0)), float(np.median(ratios)))
    return shares


def measure(_: Code, task: Task) -> Sample:
    """Random scenes of one kind, `task.n` of them, in turn from its bundled scenes."""
    from eigencontact.errors import EigencontactError

    scenes, shares, ratios = list(KINDS[task.case].items()), [], []
    missed: dict[str, int] = defaultdict(int)
    failed: list[str] = []

    def all_scenes() -> None:
        for number in range(task.n):
            name, cells = scenes[number % len(scenes)]
            try:
                fields = compared(random_scene(name, cells, Random(number)))  # noqa: S311
            except EigencontactError as problem:
                failed.append(f"{name} ({number}): {' '.join(str(problem).split())}")
                continue
            for field, (share, ratio) in fields.items():
                shares.append(share)
                ratios.append(ratio)
                missed[field] += share < _SHARE

    _nothing, seconds, _cpu = timed(all_scenes)
    worst = sorted((name for name in missed if missed[name]), key=lambda name: -missed[name])[:4]
    return {
        "status": "ok",
        "scenes": task.n - len(failed),
        "failed": failed,
        "took_s": seconds,
        "fields": len(shares),
        "share": float(np.mean(shares)),
        "held": float(np.mean(np.array(shares) >= _SHARE)),
        "ratio": float(np.median(ratios)),
        "missed": ", ".join(f"{name} {missed[name]}" for name in worst) or "none",
    }


BENCHMARK = Benchmark(
    name="field_errors",
    help="errors of the fields of random scenes beside the differences to finer runs",
    measure=measure,
    methods=ours("one thread, in memory", "pyfftw", "scipy.fft", "eigencontact.app"),
    cases=tuple(KINDS),
    sizes=(40,),
    unit="SCENES",
    columns=(
        Column("physics", "case"),
        Column("scenes", "scenes", "d"),
        Column("fields", "fields", "d"),
        Column("points held [-]", "share", ".3f"),
        Column("fields held at 95 % of points [-]", "held", ".3f"),
        Column("error / true error, median", "ratio", ".1f"),
        Column("fields held at fewer points", "missed"),
        Column("took [s]", "took_s", ".0f", brief=False),
    ),
)
