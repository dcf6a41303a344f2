"""Speed of convolutions on this machine: two measured times, which determine the predicted times."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from math import log2
from time import perf_counter

import numpy as np

from eigencontact.convolution.convolver import Convolver
from eigencontact.convolution.layout import Layout

__all__ = ["Speed", "speed", "timed"]


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
    """Measure a small and a medium convolution; takes about 20 ms."""
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


def timed(call: Callable[[], object], laps: int = 3) -> float:
    """Shortest measured time of a few calls [s]."""
    times = []
    for _ in range(laps):
        began = perf_counter()
        call()
        times.append(perf_counter() - began)
    return min(times)
