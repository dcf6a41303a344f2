"""Predicted memory and time, from counts of work and two speeds measured on the spot."""

from __future__ import annotations

import resource
import sys
from dataclasses import dataclass
from functools import cache
from math import log2
from pathlib import Path
from time import perf_counter

import numpy as np

from eigencontact.convolution.layout import fast_even
from eigencontact.planning.blocks import Cost

__all__ = ["Speed", "normal_cost", "resident_bytes", "speed", "stress_cost"]


@dataclass(frozen=True, slots=True)
class Speed:
    """Seconds per padded point and doubling of a convolution, and per call whatever its size."""

    per_point: float
    per_call: float

    def convolution(self, fy: int, fx: int) -> float:
        """Seconds of one convolution with transforms of (fy, fx)."""
        points = fy * fx
        return self.per_call + self.per_point * points * log2(max(points, 2))


@cache
def speed(precision: str, threads: int | None) -> Speed:
    """Measure two convolutions, a small and a middling one; takes about 20 ms."""
    from eigencontact.convolution import Convolver, Layout

    times = []
    for n in (16, 256):
        layout = Layout((n, n), (n, n))
        kernel = layout.spectrum(np.ones((layout.y.half, layout.x.half)), (1, 1), precision=precision)
        convolver = Convolver(layout, precision=precision, threads=threads)
        field = np.ones((n, n))
        convolver.apply(field, kernel)
        laps = []
        for _ in range(4):
            began = perf_counter()
            convolver.apply(field, kernel)
            laps.append(perf_counter() - began)
        times.append(min(laps))
    points = (2 * 256) ** 2
    return Speed(max(times[1] - times[0], 1e-6) / (points * log2(points)), times[0])


def normal_cost(
    shape: tuple[int, int], box: tuple[int, int], *, periodic: bool, precision: str, threads: int | None
) -> Cost:
    """Normal contact on a box of the window: the finest grid, the coarser ones, the certificate, the coefficients.

    The counts are those of smooth contacts (8 iterations of two convolutions and one preconditioner, each grid a
    quarter of the next); rough contacts take up to three times as many.
    """
    pace = speed(precision, threads)
    ny, nx = shape
    by, bx = (ny, nx) if periodic and 2 * max(box[0] / ny, box[1] / nx) > 1 else box
    fy, fx = (by, bx) if periodic else (fast_even(2 * by), fast_even(2 * bx))
    levels = max(1.0, log2(max(2, min(ny, nx) / 16)))
    iteration = 2.0 * pace.convolution(fy, fx) + pace.convolution(fast_even(by), fast_even(bx))
    iteration += 2.5e-8 * by * bx + 2e-4  # the vectors of the conjugate gradients
    whole = pace.convolution(fast_even(ny + by), fast_even(nx + bx)) + 3e-8 * ny * nx
    solve = 8.5 * iteration * 1.4 + levels * 2e-3 + whole + 1.5e-8 * (ny + by) * (nx + bx) / 4
    real = 8 if precision == "double" else 4
    held = 8.0 * ny * nx * 8 + real * by * bx * 12 + real * (fy * fx / 4 + 3 * by * fx) + 8 * (ny + by) * (nx + bx)
    return Cost(memory=held, seconds_per_step=solve)


def stress_cost(
    box: tuple[int, int], target: tuple[int, int], depths: int, *, packed: bool, precision: str, threads: int | None
) -> Cost:
    """Six components at so many depths: coefficients and spectra once, then one inverse transform each."""
    pace = speed(precision, threads)
    fy, fx = fast_even(box[0] + target[0]), fast_even(box[1] + target[1])
    samples = fy * fx * (0.25 if packed else 0.5)
    real = 8 if precision == "double" else 4
    spectra = 6.0 * depths * samples * real * (1 if packed else 2)
    values = 6.0 * depths * target[0] * target[1] * 8
    once = 6.0 * depths * (samples * 1.1e-7 + 1e-4)
    share = max(0.3, target[0] / fy)  # rows that are transformed back
    step = 6.0 * depths * pace.convolution(fy, fx) * share + 1e-8 * values
    return Cost(memory=spectra + 2.5 * values + 8.0 * 12 * fx * target[0], seconds_once=once, seconds_per_step=step)


def resident_bytes() -> float:
    """Memory of this process now; what the interpreter and its libraries take before the work begins."""
    try:
        pages = Path("/proc/self/statm").read_text(encoding="ascii").split()[1]
        return float(pages) * resource.getpagesize()
    except OSError:
        peak = float(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)
        return peak if sys.platform == "darwin" else 1024.0 * peak
