"""Do the error bars of a run hold? Bundled scenes with random loads, constants and cells, judged by a finer run.

The judge is finer in every source of error: twice the cells each way, twice the increments and, where the scene has
them, a tenth of the tolerances, half the pitch, a degree more by two and a quarter of the error of jumps. A bar holds
where it is at least the difference to the judge. Numbers that the scene prescribes do not count.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping
from random import Random
from typing import Any

import numpy as np

from eigencontact_verification.benchmarks.benchmark import Benchmark, Sample, Task, timed
from eigencontact_verification.benchmarks.codes import Code, ours
from eigencontact_verification.reporting.table import Column

__all__ = ["BENCHMARK", "KINDS", "coverage", "finer_tables", "judged", "measure", "random_scene"]

#: Bundled scenes by physics, with the cells per contact radius (0: the scene's own window) that they are solved on.
KINDS: dict[str, dict[str, float]] = {
    "elastic": {"hertz": 20, "hertz-ellipse": 14, "dissimilar-spheres": 16, "tilted-punch": 16},
    "friction": {"cattaneo-mindlin": 14, "fretting-mode-1": 12, "rotating-shear": 12, "gross-slip": 12},
    "layers": {"coated-sphere": 14, "soft-coating": 14, "coated-fretting": 10},
    "inclusions": {"inclusion-under-contact": 6, "void-under-contact": 12, "sphere-near-surface": 0},
    "yield": {"plastic-hertz": 8, "plastic-indentation": 7, "plastic-inclusion": 7},
    "damage": {"concrete-bars-damage": 0},
    "wear": {"wear-gross-sliding": 10, "fretting-wear-gross-slip": 10},
}
METHODS = ours("one thread, in memory", "pyfftw", "scipy.fft", "eigencontact.app")
_LOADS = ("normal-load", "approach", "tangential-load-x", "tangential-load-y", "shift-x", "shift-y")
#: Differences below this part of a number are round-off.
_NOTHING = 1e-9


def random_scene(name: str, cells: float, random: Random) -> dict[str, Any]:
    """Tables of a bundled scene with other loads, another Poisson's ratio and other cells."""
    from eigencontact import app

    tables = app.load_scene(name).resolved()
    factor = random.uniform(0.7, 1.3)
    tables["steps"] = [_loaded(step, factor) for step in tables["steps"]]
    ratio = random.uniform(0.1, 0.4)
    if "poisson-ratio" in tables["body1"] and not tables["body1"].get("medium"):
        tables["body1"]["poisson-ratio"] = ratio
    share = random.uniform(0.8, 1.3)
    if cells and tables["grid"].get("cells-per-contact-radius"):
        tables["grid"]["cells-per-contact-radius"] = share * cells
    tables["output"] = {"pictures": False, "vtk": False}
    tables["numerics"] = {**tables["numerics"], "threads": 1, "allow-coarse": True}
    return tables


def _loaded(step: Mapping[str, Any], factor: float) -> dict[str, Any]:
    if step.get("cycle") is not None:
        return {**step, "cycle": [_loaded(inner, factor) for inner in step["cycle"]]}
    return {name: factor * value if name in _LOADS and value else value for name, value in step.items()}


def judged(tables: Mapping[str, Any]) -> dict[str, dict[str, Any]]:
    """Value, error bar and difference to the judge of every number, with the time of the run and of its bars.

    Raises
    ------
    EigencontactError
        The scene or its judge cannot be solved.
    """
    from eigencontact import app
    from eigencontact.accuracy.targets import ZERO, scales_of

    planned = app.plan(tables)
    result = app.run(planned, errors=True)
    truth = app.run(finer_tables(planned)).summary
    found: dict[str, dict[str, Any]] = {}
    summary = result.summary
    scales = scales_of(summary)
    for name, bar in summary["errors"].items():
        true = truth.get(name, truth["observed"].get(name))
        unit = summary["units"][name]
        zero = abs(bar["value"]) < ZERO * scales.get(unit, 0.0)
        least = ZERO * scales[unit] if zero else _NOTHING * abs(bar["value"])
        if true is not None and max(bar["error"], abs(true - bar["value"])) > least:
            found[name] = {**bar, "difference": abs(true - bar["value"])}
    spent = summary["error_seconds"]
    found[""] = {"price": spent / (result.seconds - spent), "left out": summary["errors_left_out"]}
    return found


def finer_tables(plan: Any) -> dict[str, Any]:
    """Tables of the judge: every source of error by its own stride."""
    from eigencontact.accuracy.changes import changed
    from eigencontact.accuracy.sources import error_sources

    tables: dict[str, Any] = plan.scene.resolved()
    for source in error_sources(plan):
        if source.finer is not None:
            tables = changed(tables, source.finer(plan, source.stride))
    return tables


def measure(_: Code, task: Task) -> Sample:
    """Random scenes of one kind, `task.n` of them, in turn from its bundled scenes."""
    from eigencontact.errors import EigencontactError

    scenes = list(KINDS[task.case].items())
    failed: list[str] = []

    def all_scenes() -> list[dict[str, Any]]:
        rows = []
        for number in range(task.n):
            name, cells = scenes[number % len(scenes)]
            try:
                rows.append({"scene": name, "numbers": judged(random_scene(name, cells, Random(number)))})  # noqa: S311
            except EigencontactError as problem:
                failed.append(f"{name} ({number}): {' '.join(str(problem).split())}")
        return rows

    raw, seconds, _cpu = timed(all_scenes)
    return {"status": "ok", "scenes": len(raw), "failed": failed, "took_s": seconds, "raw": raw, **coverage(raw)}


def coverage(raw: Iterable[Mapping[str, Any]]) -> dict[str, Any]:
    """Share of bars that hold, median of bar over true error, price, and the numbers whose bars fail most."""
    rows = list(raw)
    pairs = list(_pairs(rows))
    if not pairs:
        return {}
    held = np.array([bar >= true for _, bar, true in pairs])
    ratios = [bar / true for _, bar, true in pairs if true > 0.0]
    missed: dict[str, int] = defaultdict(int)
    for (name, _, _), holds in zip(pairs, held, strict=True):
        missed[name] += not holds
    worst = sorted((name for name in missed if missed[name]), key=lambda name: -missed[name])[:4]
    return {
        "numbers": len(pairs),
        "share": float(held.mean()),
        "ratio": float(np.median(ratios)) if ratios else float("nan"),
        "price": float(np.median([row["numbers"][""]["price"] for row in rows])),
        "missed": ", ".join(f"{name} {missed[name]}" for name in worst) or "none",
    }


def _pairs(rows: Iterable[Mapping[str, Any]]) -> Iterator[tuple[str, float, float]]:
    """Name, bar and true error of every number."""
    for row in rows:
        for name, bar in row["numbers"].items():
            if name:
                yield name, float(bar["error"]), float(bar["difference"])


BENCHMARK = Benchmark(
    name="error_bars",
    help="error bars of random scenes beside the differences to finer runs",
    measure=measure,
    methods=METHODS,
    cases=tuple(KINDS),
    sizes=(40,),
    unit="SCENES",
    columns=(
        Column("physics", "case"),
        Column("scenes", "scenes", "d"),
        Column("numbers", "numbers", "d"),
        Column("bar holds [-]", "share", ".3f"),
        Column("bar / true error, median", "ratio", ".1f"),
        Column("time of the bars / run", "price", ".2f"),
        Column("numbers outside", "missed"),
        Column("took [s]", "took_s", ".0f", brief=False),
    ),
)
