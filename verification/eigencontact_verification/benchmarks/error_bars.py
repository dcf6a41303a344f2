"""Do the error bars of a run hold? Random scenes of all physics, each judged by a finer run.

A bar holds where it is at least the difference to the judge. Numbers that the scene prescribes, and numbers that are
zero in both, do not count. All values are stored as they come, one line of JSON for each scene, and the bars follow
from these lines: a change of the estimate needs no new run. Scenes are drawn in rounds, each scene of a physics once.
The factors of the estimate were chosen on even rounds; the table has odd rounds apart.
"""

from __future__ import annotations

import gzip
import json
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from random import Random
from statistics import median
from tempfile import TemporaryDirectory
from time import perf_counter
from typing import Any

from eigencontact_verification.benchmarks.benchmark import Benchmark, Sample, Task, timed
from eigencontact_verification.benchmarks.codes import Code, ours
from eigencontact_verification.benchmarks.random_scenes import KINDS, finer, random_scene
from eigencontact_verification.reporting.table import Column

__all__ = ["BENCHMARK", "collect", "coverage", "judged", "measure", "solved"]

METHODS = ours("one thread, in memory", "pyfftw", "scipy.fft", "eigencontact.app")
#: Cells of the judge each way; bodies with cells in depth take longer.
_FINER = {"inclusions": 2.0, "yield": 2.0, "damage": 2.0}
_FINEST = 3.0
#: Differences below this part of a number are round-off.
_NOTHING = 1e-9


def solved(tables: Mapping[str, Any], factor: float = 2.0) -> dict[str, Any]:
    """Numbers of a scene, of its coarser runs and of its judge, with the time of each.

    Raises
    ------
    EigencontactError
        The scene or its judge cannot be solved.
    """
    from eigencontact import app
    from eigencontact.accuracy.bars import Run, error_bars

    def solve(coarser: Mapping[str, Any], _: str) -> Run:
        coarse = app.plan(coarser)
        return Run(coarse, app.run(coarse).summary)

    planned = app.plan(tables)
    result = app.run(planned)
    accuracy = error_bars(planned, result.summary, solve)
    truth, seconds, _cpu = timed(lambda: app.run(finer(planned, factor)).summary)
    return {
        "edge": planned.grid.mean_edge if planned.scene.geometry and not planned.grid.line else 0.0,
        "numbers": result.summary["numbers"],
        "warnings": [dict(warning) for warning in result.summary["warnings"]],
        "values": _values(result.summary),
        "judge": _values(truth),
        "comparisons": [
            {
                "source": comparison.source.name,
                "values": dict(comparison.values),
                "others": [list(pair) for pair in comparison.coarser_results],
                "known": dict(comparison.known_errors),
                "seconds": comparison.seconds,
            }
            for comparison in accuracy.comparisons
        ],
        "left out": accuracy.left_out,
        "seconds": {"run": result.seconds, "bars": accuracy.seconds, "judge": seconds},
    }


def _values(summary: Mapping[str, Any]) -> dict[str, float]:
    named = {name: summary.get(name, summary["observed"].get(name)) for name in summary["numbers"]}
    return {name: float(value) for name, value in named.items() if isinstance(value, int | float)}


def judged(row: Mapping[str, Any]) -> dict[str, dict[str, Any]]:
    """Value, error bar and difference to the judge of every number of a stored scene."""
    from eigencontact.accuracy.bars import Comparison, joined_bars
    from eigencontact.accuracy.points import parts_of_cells
    from eigencontact.accuracy.sources import SOURCES
    from eigencontact.accuracy.targets import ZERO

    sources = {source.name: source for source in SOURCES}
    summary = {"numbers": row["numbers"], "warnings": row["warnings"], "observed": row["values"]}
    known_errors = {"cells": parts_of_cells(row["edge"], summary)}
    comparisons = [
        Comparison(
            source=sources[stored["source"]],
            values=stored["values"],
            coarser_results=stored["others"],
            known_errors=known_errors.get(stored["source"]) or stored.get("known", {}),
        )
        for stored in row["comparisons"]
        if stored["source"] in sources
    ]
    scales, truth = _scales(row), row["judge"]
    bars: dict[str, dict[str, Any]] = {}
    for name, bar in joined_bars(summary, comparisons).items():
        unit = row["numbers"][name]["unit"]
        zero = abs(bar.value) < ZERO * scales.get(unit, 0.0)
        least = ZERO * scales[unit] if zero else _NOTHING * abs(bar.value)
        compared = name in truth and (bar.value != 0.0 or truth[name] != 0.0)
        if compared and max(bar.error, abs(truth[name] - bar.value)) > least:
            bars[name] = {**bar.to_dict(), "difference": abs(truth[name] - bar.value)}
    return bars


def _scales(row: Mapping[str, Any]) -> dict[str, float]:
    """Largest of the numbers of each unit, so that numbers that are zero by symmetry are known."""
    scales: dict[str, float] = {}
    values = row["values"]
    for name, value in values.items():
        unit = row["numbers"][name]["unit"]
        scales[unit] = max(scales.get(unit, 0.0), abs(value))
    arm = values.get("normal_load", 0.0) * values.get("contact_radius", 0.0)
    return {**scales, "N m": max(scales.get("N m", 0.0), arm)}


def collect(
    case: str, count: int, file: Path, seconds: float, say: Callable[[str], None] = lambda _: None
) -> list[dict[str, Any]]:
    """All stored scenes of one physics; those of the first `count` that the file lacks are solved and added to it.

    Parameters
    ----------
    seconds : float
        Wall time after which no further scene is begun [s].
    """
    from eigencontact.errors import EigencontactError

    began, scenes = perf_counter(), list(KINDS[case].items())
    rows = list[dict[str, Any]]()
    if file.exists():
        with gzip.open(file, "rt", encoding="utf-8") as lines:
            rows = [json.loads(line) for line in lines]
    for seed in sorted(set(range(count)) - {row["seed"] for row in rows}):
        if perf_counter() - began > seconds:
            break
        turn, place = divmod(seed, len(scenes))
        name, cells = scenes[place]
        row: dict[str, Any] = {"scene": name, "seed": seed, "round": turn}
        try:
            row |= solved(random_scene(name, cells, Random(seed)), _FINER.get(case, _FINEST))  # noqa: S311
        except EigencontactError as problem:
            row["failed"] = " ".join(str(problem).split())
        rows.append(row)
        with gzip.open(file, "at", encoding="utf-8") as lines:
            lines.write(json.dumps(row) + "\n")
        say(f"{case} {seed}: {name} {row.get('failed') or row['seconds']}")
    return sorted(rows, key=lambda row: row["seed"])


def measure(_: Code, task: Task) -> Sample:
    """Random scenes of one physics, `task.n` of them as far as the time goes, in turn from its bundled scenes."""
    with TemporaryDirectory() as scratch:
        folder = Path(task.rows or scratch)
        folder.mkdir(parents=True, exist_ok=True)
        rows, took, _cpu = timed(lambda: collect(task.case, task.n, folder / f"{task.case}.jsonl.gz", task.budget))
    failed = [f"{row['scene']} ({row['seed']}): {row['failed']}" for row in rows if "failed" in row]
    good = [row for row in rows if "failed" not in row]
    apart = coverage(row for row in good if row["round"] % 2 == 1)
    odd = {f"odd_{name}": apart.get(name) for name in ("scenes", "numbers", "share", "ratio")}
    return {"status": "ok", "failed": failed, "took_s": took, **odd, **coverage(good)}


def _remarks(rows: Sequence[Mapping[str, Any]]) -> list[str]:
    """All physics together, and the scenes that were refused."""
    counted = [row for row in rows if row.get("numbers")]
    scenes, numbers = (sum(row[name] for row in counted) for name in ("scenes", "numbers"))
    honest = sum(row["share"] * row["numbers"] for row in counted)
    together = (
        f"all physics: {scenes} scenes, {numbers} numbers, bars hold for {honest / numbers:.3f}" if numbers else ""
    )
    refused = [f"{row['case']}: not solved: {text}" for row in rows for text in row.get("failed", ())]
    return [*([together] if together else []), *refused]


def coverage(rows: Iterable[Mapping[str, Any]]) -> dict[str, Any]:
    """Share of bars that hold, median of bar over true error, price, and the numbers whose bars fail most."""
    from eigencontact.accuracy.sources import SOURCES

    counted, sources = list(rows), {source.name for source in SOURCES}
    pairs = [pair for row in counted for pair in _pairs(row)]
    if not pairs:
        return {}
    ratios = [bar / true for _, bar, true, _ in pairs if true > 0.0]
    missed: dict[str, int] = defaultdict(int)
    for name, _, _, holds in pairs:
        missed[name] += not holds
    worst = sorted((name for name in missed if missed[name]), key=lambda name: -missed[name])
    spent = [
        sum(comparison["seconds"] for comparison in row["comparisons"] if comparison["source"] in sources)
        for row in counted
    ]
    return {
        "scenes": len(counted),
        "numbers": len(pairs),
        "share": sum(holds for *_, holds in pairs) / len(pairs),
        "ratio": median(ratios) if ratios else float("nan"),
        "price": median(bars / row["seconds"]["run"] for bars, row in zip(spent, counted, strict=True)),
        "missed": ", ".join(f"{name} {missed[name]}" for name in worst) or "none",
    }


def _pairs(row: Mapping[str, Any]) -> Iterator[tuple[str, float, float, bool]]:
    """Name, bar and true error of every number, and whether the bar holds up to round-off."""
    for name, bar in judged(row).items():
        error, true = float(bar["error"]), float(bar["difference"])
        yield name, error, true, true <= error + _NOTHING * abs(bar["value"])


BENCHMARK = Benchmark(
    name="error_bars",
    help="error bars of random scenes beside the differences to finer runs",
    measure=measure,
    methods=METHODS,
    cases=tuple(KINDS),
    sizes=(40,),
    unit="SCENES",
    rows=True,
    remarks=_remarks,
    columns=(
        Column("physics", "case"),
        Column("scenes", "scenes", "d"),
        Column("numbers", "numbers", "d"),
        Column("bar holds [-]", "share", ".3f"),
        Column("bar / true error, median", "ratio", ".1f"),
        Column("odd rounds: numbers", "odd_numbers", "d"),
        Column("odd rounds: bar holds [-]", "odd_share", ".3f"),
        Column("odd rounds: median", "odd_ratio", ".1f"),
        Column("time of the bars / run", "price", ".2f"),
        Column("numbers outside", "missed"),
        Column("took [s]", "took_s", ".0f", brief=False),
    ),
)
