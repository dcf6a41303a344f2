"""Wall and processor time of one call."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, TypeVar

if TYPE_CHECKING:
    from collections.abc import Callable

__all__ = ["sample", "timed"]

T = TypeVar("T")


def timed(call: Callable[[], T]) -> tuple[T, float, float]:
    """Return what `call` returned, its wall time [s] and the processor time of all threads [s]."""
    wall, cpu = time.perf_counter(), time.process_time()
    result = call()
    return result, time.perf_counter() - wall, time.process_time() - cpu


def sample(call: Callable[[], object], *, least: int = 3, seconds: float = 0.05) -> list[float]:
    """Wall times [s] of calls repeated at least `least` times and for at least `seconds`.

    Examples
    --------
    >>> len(sample(lambda: None, least=2, seconds=0.0))
    2
    """
    times: list[float] = []
    while len(times) < least or sum(times) < seconds:
        times.append(timed(call)[1])
    return times
