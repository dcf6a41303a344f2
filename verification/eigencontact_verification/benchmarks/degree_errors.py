"""Do the errors that whole inhomogeneities state by their degree hold? Random scenes, stated beside true errors.

The scenes are those of `eigencontact_verification.benchmarks.degree_scenes`: of 200, 120 with one ball, 60 with two
and 20 with an ellipsoid; of fewer, the first of each. Degrees 2 to 5 are judged by degree 10 on the same grid of 33
cells across 2.6 contact radii (ellipsoids: degrees 2 and 3 by degree 5). A stated error holds where the true one is at
most twice as large; a foretold one is meant as a bound and holds where the true one is not larger. The errors of each
scene are stored as one line of JSON, so that a later call continues.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import asdict
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter
from typing import Any

import numpy as np

from eigencontact_verification.benchmarks.benchmark import Benchmark, Sample, Task, timed
from eigencontact_verification.benchmarks.codes import Code, ours
from eigencontact_verification.benchmarks.degree_scenes import KINDS, SOLVED, judged, random_scenes
from eigencontact_verification.reporting.table import Column

__all__ = ["BENCHMARK", "DEGREES", "FACTORS", "agreement", "collect", "measure"]

DEGREES = (2, 3, 4, 5)
#: By what a true error may exceed the stated one.
FACTORS = {"pressure": 2.0, "eigenstrain": 2.0, "foretold": 1.0}
METHODS = ours("tolerance 1e-7, one thread, in memory", "pyfftw", "scipy.fft", "eigencontact.app")
#: Part of the scenes, degrees, and the degree that judges, by kind.
_PARTS = {"ball": (0.6, DEGREES, 10), "two balls": (0.3, DEGREES, 10), "ellipsoid": (0.1, DEGREES[:2], 5)}
_CELLS = 33


def collect(kind: str, numbers: Iterable[int], file: Path, seconds: float) -> dict[int, dict[str, Any]]:
    """Errors of the scenes of a kind by number and degree; those that the file lacks are measured and added to it.

    Parameters
    ----------
    seconds : float
        Wall time after which no further scene is begun [s].
    """
    lines = file.read_text(encoding="utf-8").splitlines() if file.exists() else []
    stored = {row["scene"]: row["errors"] for row in map(json.loads, lines)}
    _, degrees, truth = _PARTS[kind]
    numbers, began = list(numbers), perf_counter()
    scenes = random_scenes(kind, max(numbers, default=-1) + 1)
    for number in numbers:
        if number not in stored and perf_counter() - began < seconds:
            errors = judged(scenes[number], degrees, truth, _CELLS)
            stored[number] = {str(degree): asdict(item) for degree, item in errors.items()}
            with file.open("a", encoding="utf-8") as rows:
                rows.write(json.dumps({"scene": number, "errors": stored[number]}) + "\n")
    return {number: stored[number] for number in numbers if number in stored}


def measure(_: Code, task: Task) -> Sample:
    """Scenes of a kind, as far as the time goes."""
    count = max(1, round(_PARTS[task.case][0] * task.n))
    with TemporaryDirectory() as scratch:
        folder = Path(task.rows or scratch)
        folder.mkdir(parents=True, exist_ok=True)
        file = folder / f"{task.case}.jsonl"
        errors, seconds, _cpu = timed(lambda: collect(task.case, range(count), file, task.budget))
    raw = list(errors.values())
    return {"status": "ok", "scenes": len(raw), "took_s": seconds, "raw": raw, **agreement(raw)}


def agreement(raw: Iterable[Mapping[str, Any]]) -> dict[str, Any]:
    """Share of scenes in which an error holds, median of stated over true, and both in words, by error and degree.

    Errors below what the tolerance of the solution leaves hold, and take no part in the median.
    """
    shares: dict[str, Any] = {}
    for degree in DEGREES:
        for name, factor in FACTORS.items():
            pairs = np.array([errors[str(degree)][name] for errors in raw if str(degree) in errors]).reshape(-1, 2)
            if len(pairs):
                stated, true = pairs.T
                above = true > SOLVED
                share = float(np.mean((true <= factor * stated) | ~above))
                ratio = float(np.median(stated[above] / true[above])) if above.any() else float("nan")
                key = f"{name} {degree}"
                shares |= {f"{key} share": share, f"{key} ratio": ratio, key: f"{100 * share:.0f} %, {ratio:.1f}"}
    return shares


def _columns(name: str) -> list[Column]:
    return [Column(f"{name}, degree {degree}", f"{name} {degree}") for degree in DEGREES]


BENCHMARK = Benchmark(
    name="degree_errors",
    help="stated beside true errors of whole inhomogeneities in random scenes",
    measure=measure,
    methods=METHODS,
    cases=KINDS,
    sizes=(200,),
    unit="SCENES",
    rows=True,
    columns=(
        Column("scenes with", "case"),
        Column("scenes", "scenes", "d"),
        *(column for name in FACTORS for column in _columns(name)),
        Column("took [s]", "took_s", ".0f", brief=False),
    ),
)
