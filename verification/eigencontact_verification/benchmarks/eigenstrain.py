"""Eigenstrain in N³ cells to stress in N³ cells and to displacement of the surface, against the bare FFTs they need.

The floor of stress is 23 real transforms of the zero-padded box (six of the eigenstrain, 17 of the powers of depth of
the stress), that of the displacement 6 N forward transforms and three inverse ones of the zero-padded plane, all by
scipy.fft on arrays that are padded beforehand. Both are timed in turn with the operator; ratios are least over least.

The judge of what comes out is the closed form of one cell, at points spread over the box.
"""

from __future__ import annotations

import time
from functools import cache
from math import log2
from statistics import median
from typing import TYPE_CHECKING, Any

import numpy as np
import scipy.fft
from numpy.typing import NDArray

from eigencontact_verification.benchmarks.clock import timed
from eigencontact_verification.benchmarks.codes import Code
from eigencontact_verification.benchmarks.memory import PeakMemory
from eigencontact_verification.benchmarks.table import Column, Row

if TYPE_CHECKING:
    from collections.abc import Callable

    from eigencontact_verification.benchmarks.task import Sample, Task

__all__ = ["CASES", "COLUMNS", "METHODS", "bare_transforms", "measure", "scaling", "summarise"]

FloatArray = NDArray[np.float64]

#: What is computed, by its name in the table.
CASES = {"stress": "stress in the volume", "displacement": "displacement of the surface"}
POISSON_RATIO = 0.3
# The compiled loops are loaded before the clock starts: they are kept on disk from the first run on a machine.
_MODULES = (
    "pyfftw",
    "scipy.fft",
    "eigencontact.convolution.compiled",
    "eigencontact.inclusions",
    "eigencontact.solvers.eigenstrain",
    "eigencontact.solvers.eigenstrain_planes",
    "eigencontact_plugins.shapes.cuboid",
)
METHODS = {
    "eigencontact": Code(
        name="eigencontact",
        distribution="eigencontact",
        modules=_MODULES,
        settings="VolumeField and SurfaceDisplacement, half-space, six components, every cell filled",
    )
}
# Points at which the closed form judges.
_POINTS = 500


def _operator(task: Task) -> Any:
    """Operator of a task, all set up; lengths in edges of a cell, shear modulus 1."""
    from eigencontact.solvers.cells import Cells
    from eigencontact.solvers.eigenstrain import VolumeField
    from eigencontact.solvers.eigenstrain_planes import SurfaceDisplacement
    from eigencontact_plugins.shapes.cuboid import Cuboid

    n, threads, precision = task.n, task.threads, task.precision
    cell = Cuboid(center=(0.0, 0.0, 1.0), edges=(1.0, 1.0, 1.0))
    box = Cells(first=(0.0, 0.0, 0.5), pitch=(1.0, 1.0, 1.0), shape=(n, n, n))
    if task.case == "stress":
        return VolumeField(cell, box, box, poisson_ratio=POISSON_RATIO, precision=precision, threads=threads)
    return SurfaceDisplacement(
        cell, box, target=(n, n), poisson_ratio=POISSON_RATIO, precision=precision, threads=threads
    )


def bare_transforms(task: Task, workers: int) -> Callable[[], None]:
    """Return the transforms alone, as a function of no arguments; what they give is thrown away."""
    real = np.float64 if task.precision == "double" else np.float32
    if task.case == "stress":
        volume = np.ones((2 * task.n,) * 3, real)

        def transform() -> None:
            for _ in range(23):
                scipy.fft.rfftn(volume, workers=workers)

        return transform
    plane = np.ones((2 * task.n,) * 2, real)

    def transform_planes() -> None:
        for _ in range(6 * task.n):
            waves = scipy.fft.rfft2(plane, workers=workers)
        for _ in range(3):
            scipy.fft.irfft2(waves, s=plane.shape, workers=workers)

    return transform_planes


def cell_error(task: Task, operator: Any) -> float:
    """Largest difference from the closed form of one cell, at points of the box, over the largest value there."""
    from eigencontact import inclusion_field
    from eigencontact.core.tensors import from_mandel, to_mandel
    from eigencontact_plugins.shapes.cuboid import Cuboid

    n, rng = task.n, np.random.default_rng(1)
    xx, yy, zz, yz, xz, xy = rng.standard_normal(6)
    strain = np.zeros((6, n, n, n))
    at = (n // 8, n // 3, n // 2)
    strain[(slice(None), *at)] = to_mandel([xx, yy, zz, yz, xz, xy])
    cube = Cuboid(center=(at[2], at[1], at[0] + 0.5), edges=(1.0, 1.0, 1.0))
    index = np.vstack([at, rng.integers(0, n, (_POINTS, 3))])
    points = index[:, ::-1] + [0.0, 0.0, 0.5]
    found = np.asarray(operator.apply(strain), dtype=float)
    if task.case == "displacement":
        points[:, 2] = 0.0
        values = found[:, index[:, 1], index[:, 2]]
    else:
        values = from_mandel(found[:, index[:, 0], index[:, 1], index[:, 2]])
    exact = inclusion_field(
        cube,
        [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]],
        points,
        young_modulus=2.0 * (1.0 + POISSON_RATIO),
        poisson_ratio=POISSON_RATIO,
        quantity="displacement" if task.case == "displacement" else "stress",
    )
    if task.case == "stress":
        wanted = np.stack([exact[:, i, j] for i, j in ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))])
    else:
        wanted = exact.T
    if not np.isfinite(values).all():
        raise ValueError("field must be finite (got nan or inf)")
    return float(np.abs(values - wanted).max() / np.abs(wanted).max())


@cache
def _eigenstrain(n: int) -> FloatArray:
    return np.random.default_rng(0).standard_normal((6, n, n, n))


def measure(code: Code, task: Task) -> Sample:
    """Set up, apply, apply again in turn with the bare transforms."""
    code.load()
    strain = _eigenstrain(task.n).astype(np.float64 if task.precision == "double" else np.float32)
    began = time.perf_counter()
    memory = PeakMemory()
    operator, set_up, _ = timed(lambda: _operator(task))
    first = timed(lambda: operator.apply(strain))[1]
    peak = memory.peak()
    workers = sorted({1, task.threads})
    bare = {w: bare_transforms(task, w) for w in workers}
    floors: dict[int, list[float]] = {w: [] for w in workers}
    again: list[float] = []
    for turn in range(max(1, task.warm)):
        if turn and time.perf_counter() - began > 0.7 * task.budget:
            break
        again.append(timed(lambda: operator.apply(strain))[1])
        for w in workers:
            floors[w].append(timed(bare[w])[1])
    return {
        "status": "ok",
        "setup_s": set_up,
        "first_s": first,
        "again_s": again,
        "peak_bytes": peak,
        "peak_reset": memory.reset,
        "held_bytes": operator.nbytes,
        "kernels": operator.kernels,
        "transforms_1_s": floors[1],
        "transforms_threads_s": floors[task.threads],
        "error": cell_error(task, operator),
    }


def summarise(task: Task, samples: list[Sample]) -> Row:
    """One row from the processes of one case and size."""
    again = [t for s in samples for t in s["again_s"]]
    peaks = [s["peak_bytes"] for s in samples if s["peak_bytes"] is not None]
    set_up = [s["setup_s"] for s in samples]
    points = task.n**3 * log2(task.n) if task.n > 1 else 1.0
    row: Row = {
        "case": CASES[task.case],
        "code": task.code,
        "n": task.n,
        "threads": task.threads,
        "precision": task.precision,
        "processes": len(samples),
        "setup_s": median(set_up),
        "setup_min_s": min(set_up),
        "first_s": median(s["first_s"] for s in samples),
        "again_s": median(again),
        "again_min_s": min(again),
        "peak_bytes": max(peaks) if peaks else None,
        "held_bytes": max(s["held_bytes"] for s in samples),
        "kernels": samples[-1]["kernels"],
        "error": max(s["error"] for s in samples),
        "again_ns_per_point_log": 1e9 * min(again) / points,
        "setup_ns_per_point_log": 1e9 * min(set_up) / points,
        "peak_bytes_per_point": max(peaks) / task.n**3 if peaks else None,
    }
    for name in ("transforms_1", "transforms_threads"):
        floor = min(t for s in samples for t in s[f"{name}_s"])
        row[f"{name}_s"] = floor
        row[f"again_per_{name}"] = min(again) / floor
    return row


def scaling(rows: list[Row], bound: float = 1.5) -> list[str]:
    """Sentences on how time and memory per cell grow from the smallest to the largest size."""
    said = []
    for case in dict.fromkeys(row["case"] for row in rows):
        chosen = sorted((row for row in rows if row["case"] == case), key=lambda row: row["n"])
        small, large = chosen[0], chosen[-1]
        if small["n"] == large["n"]:
            continue
        for key, words in (
            ("again_ns_per_point_log", "again, per N³ log2 N"),
            ("setup_ns_per_point_log", "set-up, per N³ log2 N"),
            ("peak_bytes_per_point", "peak memory, per N³"),
        ):
            if small[key] and large[key]:
                ratio = large[key] / small[key]
                verdict = "within" if ratio <= bound else "beyond"
                said.append(f"{case}, {words}: {ratio:.2f} times from {small['n']} to {large['n']} ({verdict} {bound})")
    return said


COLUMNS = (
    Column("N", "n", "d"),
    Column("eigenstrain to", "case"),
    Column("precision", "precision", brief=False),
    Column("set-up [s]", "setup_s", ".3g"),
    Column("min [s]", "setup_min_s", ".3g", brief=False),
    Column("first [s]", "first_s", ".3g"),
    Column("again [s]", "again_s", ".3g"),
    Column("min [s]", "again_min_s", ".3g", brief=False),
    Column("bare FFTs [s]", "transforms_1_s", ".3g", brief=False),
    Column("bare FFTs, threads [s]", "transforms_threads_s", ".3g", brief=False),
    Column("again / FFTs", "again_per_transforms_1", ".3g"),
    Column("again / FFTs, threads", "again_per_transforms_threads", ".3g"),
    Column("error of a cell", "error", ".1e"),
    Column("kernels", "kernels", "d"),
    Column("held [MB]", "held_bytes", ".0f", scale=1e-6),
    Column("peak [MB]", "peak_bytes", ".0f", scale=1e-6),
    Column("ns / N³ log2 N", "again_ns_per_point_log", ".3g"),
    Column("processes", "processes", "d", brief=False),
)
