"""Predicted memory and time, from counts of work and two speeds measured on the spot."""

from __future__ import annotations

import resource
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from math import log2
from pathlib import Path
from time import perf_counter

import numpy as np

from eigencontact.convolution import Layout
from eigencontact.convolution.backends import available_threads
from eigencontact.convolution.layout import fast_even
from eigencontact.core.material import Material
from eigencontact.core.tensors import COMPONENTS
from eigencontact.planning.blocks import Cost
from eigencontact.plugin import SurfaceInfluence

__all__ = [
    "Speed",
    "friction_cost",
    "normal_cost",
    "peak_bytes",
    "resident_bytes",
    "sampling_seconds",
    "speed",
    "stress_cost",
    "superposition_cost",
    "timed",
]


#: Applications of the tangential kernels that one solve takes, and rounds of normal and tangential solves, typically.
_APPLICATIONS, _ROUNDS = 40, 6


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
    from eigencontact.convolution import Convolver

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
    iteration += 1.5e-8 * by * bx + 4e-4  # the vectors of the conjugate gradients
    whole = pace.convolution(fast_even(ny + by), fast_even(nx + bx)) + 3e-8 * ny * nx
    solve = 8.5 * iteration * 1.25 + levels * 2.5e-3 + whole + 1.5e-8 * (ny + by) * (nx + bx) / 4
    if periodic:
        solve += 1.2e-7 * ny * nx  # the response of every wave, and the coefficients of one period from it
    real = 8 if precision == "double" else 4
    held = 8.0 * ny * nx * 8 + real * by * bx * 12 + real * (fy * fx / 4 + 3 * by * fx) + 8 * (ny + by) * (nx + bx)
    return Cost(memory=held, seconds_per_step=solve)


def friction_cost(
    shape: tuple[int, int],
    box: tuple[int, int],
    pairs: Sequence[tuple[str, str]],
    *,
    periodic: bool,
    precision: str,
    threads: int | None,
) -> Cost:
    """Normal and tangential contact together, by the directions of displacement and traction that have a kernel.

    The counts are those of smooth contacts: `_APPLICATIONS` of the tangential kernels and half as many of their rough
    inverse per round, and `_ROUNDS` rounds where the pressure feels the shear; rough contacts take about twice as many.
    """
    pace = speed(precision, threads)
    normal = normal_cost(shape, box, periodic=periodic, precision=precision, threads=threads)
    (ny, nx), (by, bx) = shape, (shape if periodic else box)
    fy, fx = (by, bx) if periodic else (fast_even(2 * by), fast_even(2 * bx))
    directions = {j for i, j in pairs if "z" not in (i, j)}
    count, cross = len(directions), sum((i == "z") != (j == "z") for i, j in pairs)
    coupled = any(i == "z" and j != "z" for i, j in pairs)
    rounds = _ROUNDS if coupled else 1
    one = count * (pace.convolution(fy, fx) + 0.5 * pace.convolution(fast_even(by), fast_even(bx)))
    one += 1.2e-7 * count * by * bx + 5e-4  # the vectors of the iteration, cell by cell
    whole = pace.convolution(fast_even(ny + by), fast_even(nx + bx))
    once = len(pairs) * 3e-7 * (ny + by) * (nx + bx) / 4  # coefficients of the cross terms cost more than those of p
    solve = rounds * (_APPLICATIONS * one + (count + cross) * whole) + (rounds - 1) * normal.seconds_per_step
    real = 8 if precision == "double" else 4
    padded = real * (ny + by) * (nx + bx)
    kept = 3 if coupled else 1  # the contact changes from round to round, and each box has spectra of its own
    held = 8.0 * ny * nx * (8 + 10 * count) + real * by * bx * 24 * count
    held += padded * (kept * len(pairs) + 2 * count) + 2.0 * len(pairs) * (ny + by) * (nx + bx)
    return Cost(memory=normal.memory + held, seconds_once=once, seconds_per_step=normal.seconds_per_step + solve)


def timed(call: Callable[[], object], laps: int = 3) -> float:
    """Shortest of a few times that a call takes [s]."""
    found = []
    for _ in range(laps):
        began = perf_counter()
        call()
        found.append(perf_counter() - began)
    return min(found)


@cache
def sampling_seconds(influence: SurfaceInfluence, body: Material) -> float:
    """Measured time of six stress coefficients at one lattice point [s]."""
    x = np.arange(96.0)
    return timed(lambda: influence.sample("stress", COMPONENTS, x, x, 1.0, (0.5, 0.5), body)) / x.size**2


def stress_cost(
    layout: Layout,
    depths: int,
    sampling: float,
    *,
    precision: str,
    threads: int | None,
    kernels: int = 6,
    tractions: int = 1,
) -> Cost:
    """So many components at so many depths: coefficients and spectra once, then one inverse transform each.

    Parameters
    ----------
    layout : Layout
        From the loaded box to the target points.
    sampling : float
        Time of six coefficients at one lattice point [s].
    tractions : int
        Components of traction that cause it, each with coefficients of its own.
    """
    pace, real = speed(precision, threads), (8 if precision == "double" else 4)
    y, x = layout.y, layout.x
    lattice = y.lattice.size * x.lattice.size
    stored = x.half * (y.half if y.symmetric else y.length) * (1 if y.symmetric and x.symmetric else 2)
    outputs = kernels * depths
    values = outputs * y.targets * x.targets * 8.0
    workers = min(threads or available_threads(), max(1, depths))
    once = depths * sampling * lattice * kernels / 6 / (0.75 * workers) + outputs * (stored * 5e-9 + 8e-5)
    once *= tractions
    share = 0.1 + 0.1 * min(1.0, 2.0 * y.targets / y.length)  # the forward transform serves all outputs
    step = outputs * (pace.convolution(y.length, x.length) - pace.per_call) * share + outputs * 8e-5 + 1e-8 * values
    step += (tractions - 1) * outputs * stored * 4e-9  # products of spectra
    memory = tractions * outputs * stored * real + 4.0 * values + workers * lattice * 8.0 * 3 * kernels
    return Cost(memory=memory, seconds_once=once, seconds_per_step=step)


def superposition_cost(points: int, box: tuple[int, int], sampling: float, *, threads: int | None) -> Cost:
    """Direct superposition of the cells of a box at scattered points, anew at each step."""
    cells = box[0] * box[1]
    workers = threads or available_threads()
    seconds = points * (sampling * cells + 1e-4) / (0.75 * workers)
    return Cost(memory=cells * 8.0 * 30 * workers, seconds_per_step=seconds)


def resident_bytes() -> float:
    """Memory of this process now; what the interpreter and its libraries take before the work begins."""
    try:
        pages = Path("/proc/self/statm").read_text(encoding="ascii").split()[1]
        return float(pages) * resource.getpagesize()
    except OSError:
        return float(peak_bytes())


def peak_bytes() -> int:
    """Largest memory that this process has had so far."""
    try:
        lines = Path("/proc/self/status").read_text(encoding="ascii").splitlines()
        return next(1024 * int(line.split()[1]) for line in lines if line.startswith("VmHWM"))
    except (OSError, StopIteration):
        unit = 1 if sys.platform == "darwin" else 1024
        return unit * int(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)
