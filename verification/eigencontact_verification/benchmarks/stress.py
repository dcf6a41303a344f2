"""Sub-surface stress: six components at many depths under Hertz pressure, against the bare FFTs they need.

The floor is one forward and ``6 * depths`` inverse real transforms of the zero-padded field by scipy.fft.
"""

from __future__ import annotations

from functools import cache, partial
from typing import TYPE_CHECKING

import numpy as np
import scipy.fft

from eigencontact_verification.benchmarks.benchmark import Benchmark, Sample, Task, Trial, once, one_and_all
from eigencontact_verification.benchmarks.measure import FloatArray, HertzProblem
from eigencontact_verification.reporting.table import Column

if TYPE_CHECKING:
    from eigencontact_verification.benchmarks.codes import Code

__all__ = ["BENCHMARK", "POISSON_RATIO", "axis_error", "axis_stress", "bare_transforms", "depths_of", "measure"]

POISSON_RATIO = 0.3


def depths_of(count: int) -> FloatArray:
    """Depths 0 < z < 2 a at the middles of `count` equal layers, (count,) [a]."""
    return (np.arange(count, dtype=np.float64) + 0.5) * (2.0 / count)


def axis_stress(z: FloatArray) -> FloatArray:
    """Hertz stresses xx (= yy) and zz on the axis, (2, len(z)) [E*] (Johnson 1985, eqs. 3.45)."""
    p0, nu = HertzProblem(n=1).peak, POISSON_RATIO
    fraction = 1.0 / (1.0 + z**2)
    radial = -(1.0 + nu) * (1.0 - z * np.arctan2(1.0, z)) + 0.5 * fraction
    return p0 * np.stack([radial, -fraction])


def axis_error(stress: FloatArray, z: FloatArray) -> float:
    """Largest error of xx, yy and zz on the axis over p0 [-]; the axis is the mean of the middle cells.

    Raises
    ------
    ValueError
        If the field is not of shape ``(6, len(z), n, n)`` or not finite.
    """
    if stress.ndim != 4 or stress.shape[:2] != (6, len(z)):
        raise ValueError(f"stress must be of shape (6, {len(z)}, n, n) (got {stress.shape})")
    n = stress.shape[-1]
    middle = slice((n - 1) // 2, n // 2 + 1)
    centre = stress[:3, :, middle, middle].mean(axis=(-2, -1))
    if not np.isfinite(centre).all():
        raise ValueError("stress must be finite (got nan or inf)")
    return float(np.abs(centre - axis_stress(z)[[0, 0, 1]]).max()) / HertzProblem(n=1).peak


def bare_transforms(pressure: FloatArray, depths: int, workers: int) -> None:
    """Make the transforms alone; the results are thrown away."""
    n = len(pressure)
    spectrum = scipy.fft.rfft2(pressure, s=(2 * n, 2 * n), workers=workers)
    for _ in range(6 * depths):
        scipy.fft.irfft2(spectrum, s=(2 * n, 2 * n), workers=workers)


def measure(code: Code, task: Task) -> Sample:
    """Build the operator and apply it, then apply it again in turn with bare transforms."""
    assert code.stress is not None
    z, pressure = depths_of(task.depths), HertzProblem(n=task.n).pressure
    operator = cache(partial(code.stress, task.n, z, task.threads, task.precision))
    return Trial(
        call=lambda: operator()(pressure),
        floors=lambda: one_and_all(
            "transforms", task.threads, lambda w: once(lambda: bare_transforms(pressure, task.depths, w))
        ),
        judge=lambda stress: {"axis_error": axis_error(stress, z)},
    ).run(task)


BENCHMARK = Benchmark(
    name="stress",
    help="sub-surface stress against its bare FFTs",
    measure=measure,
    function="stress",
    floors=("transforms_1", "transforms_threads"),
    sizes=(256,),
    depths=32,
    columns=(
        Column("N", "n", "d"),
        Column("depths", "depths", "d"),
        Column("code", "code"),
        Column("first call [s]", "first_s", ".3g"),
        Column("min [s]", "first_min_s", ".3g", brief=False),
        Column("again [s]", "again_s", ".3g"),
        Column("bare FFTs [s]", "transforms_1_s", ".3g", brief=False),
        Column("first / FFTs", "first_per_transforms_1", ".3g"),
        Column("again / FFTs", "again_per_transforms_1", ".3g"),
        Column("first / FFTs, threads", "first_per_transforms_threads", ".3g", brief=False),
        Column("again / FFTs, threads", "again_per_transforms_threads", ".3g"),
        Column("error on the axis / p0", "axis_error", ".1e"),
        Column("peak [MB]", "peak_bytes", ".0f", scale=1e-6),
        Column("cores", "cores", ".1f", brief=False),
        Column("processes", "processes", "d", brief=False),
    ),
)
