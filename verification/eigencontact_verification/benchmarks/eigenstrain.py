"""Eigenstrain in N³ cells to stress in N³ cells and to displacement of the surface, against the bare FFTs they need.

The floor of stress is 23 real transforms of the zero-padded box (six of the eigenstrain, 17 of the powers of depth of
the stress), that of the displacement 6 N forward transforms and three inverse ones of the zero-padded plane, all by
scipy.fft on arrays that are padded beforehand. Both are timed in turn with the operator; ratios are least over least.

The judge of what comes out is the closed form of one cell, at points spread over the box.
"""

from __future__ import annotations

from functools import cache
from math import log2
from typing import TYPE_CHECKING, Any

import numpy as np
import scipy.fft

from eigencontact_verification.benchmarks.benchmark import Benchmark, Sample, Task, Trial, once, one_and_all
from eigencontact_verification.benchmarks.codes import Code, ours
from eigencontact_verification.benchmarks.measure import FloatArray, largest_error
from eigencontact_verification.reporting.table import Column, Row

if TYPE_CHECKING:
    from collections.abc import Callable


__all__ = ["BENCHMARK", "CASES", "METHODS", "bare_transforms", "measure", "scaling"]

#: Field of each case, in words.
CASES = {"stress": "stress in the volume", "displacement": "displacement of the surface"}
POISSON_RATIO = 0.3
# The compiled loops are loaded before the clock starts: they are kept on disk from the first run on a machine.
METHODS = ours(
    "VolumeField and PlaneFields, half-space, six components, every cell filled",
    "pyfftw", "scipy.fft", "eigencontact.convolution.compiled", "eigencontact.library.inclusions",
    "eigencontact.solvers.eigenstrain", "eigencontact.solvers.eigenstrain_planes", "eigencontact_plugins.shapes.cuboid",
)  # fmt: skip
# Points at which the closed form judges.
_POINTS = 500


def _operator(task: Task) -> Any:
    """Operator of a task, all set up; lengths in edges of a cell, shear modulus 1."""
    from eigencontact.solvers.cells import Cells
    from eigencontact.solvers.eigenstrain import VolumeField
    from eigencontact.solvers.eigenstrain_planes import PlaneFields
    from eigencontact_plugins.shapes.cuboid import Cuboid

    n, threads, precision = task.n, task.threads, task.precision
    cell = Cuboid(center=(0.0, 0.0, 1.0), edges=(1.0, 1.0, 1.0))
    box = Cells(first=(0.0, 0.0, 0.5), pitch=(1.0, 1.0, 1.0), shape=(n, n, n))
    if task.case == "stress":
        return VolumeField(cell, box, box, poisson_ratio=POISSON_RATIO, precision=precision, threads=threads)
    return PlaneFields(
        cell, box, target=(n, n), depths=[0.0], poisson_ratio=POISSON_RATIO, quantity="displacement",
        precision=precision, threads=threads,
    )  # fmt: skip


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
    stress = np.asarray(operator.apply(strain), dtype=float)
    if task.case == "displacement":
        points[:, 2] = 0.0
        values = stress[:, 0, index[:, 1], index[:, 2]]
    else:
        values = from_mandel(stress[:, index[:, 0], index[:, 1], index[:, 2]])
    exact = inclusion_field(
        cube,
        [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]],
        points,
        young_modulus=2.0 * (1.0 + POISSON_RATIO),
        poisson_ratio=POISSON_RATIO,
        quantity="displacement" if task.case == "displacement" else "stress",
    )
    if task.case == "stress":
        expected = np.stack([exact[:, i, j] for i, j in ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))])
    else:
        expected = exact.T
    return largest_error(values, expected)


def measure(_: Code, task: Task) -> Sample:
    """Set up, apply, apply again in turn with the bare transforms."""
    real = np.float64 if task.precision == "double" else np.float32
    strain = np.random.default_rng(0).standard_normal((6, *(task.n,) * 3)).astype(real)
    operator = cache(lambda: _operator(task))

    def judged(_: FloatArray) -> dict[str, Any]:
        stress = operator()
        return {"held_bytes": stress.nbytes, "kernels": stress.kernels, "error": cell_error(task, stress)}

    return Trial(
        setup=operator,
        call=lambda: operator().apply(strain),
        floors=lambda: one_and_all("transforms", task.threads, lambda w: once(bare_transforms(task, w))),
        floor=list,
        always=1,
        judge=judged,
    ).run(task)


def _per_cell(task: Task, row: Row) -> Row:
    """Ratios to the floors, least over least, and what a cell costs."""
    points = task.n**3 * log2(task.n) if task.n > 1 else 1.0
    ratios: Row = {
        "case": CASES[task.case],
        "again_ns_per_point_log": 1e9 * row["again_min_s"] / points,
        "setup_ns_per_point_log": 1e9 * row["setup_min_s"] / points,
        "peak_bytes_per_point": row["peak_bytes"] / task.n**3 if row["peak_bytes"] else None,
    }
    for name in ("transforms_1", "transforms_threads"):
        floor = row[f"{name}_min_s"]
        ratios |= {f"{name}_s": floor, f"again_per_{name}": row["again_min_s"] / floor}
    return ratios


def scaling(rows: list[Row], bound: float = 1.5) -> list[str]:
    """Sentences on how time and memory per cell grow from the smallest to the largest size."""
    sentences = []
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
                sentences.append(
                    f"{case}, {words}: {ratio:.2f} times from {small['n']} to {large['n']} ({verdict} {bound})"
                )
    return sentences


BENCHMARK = Benchmark(
    name="eigenstrain",
    help="eigenstrain in a volume against its bare FFTs",
    measure=measure,
    worst=("held_bytes", "error"),
    derive=_per_cell,
    remarks=scaling,
    methods=METHODS,
    cases=tuple(CASES),
    sizes=(16, 32, 64, 128),
    columns=(
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
    ),
)
