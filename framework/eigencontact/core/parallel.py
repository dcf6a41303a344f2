"""Threads for work that releases the interpreter lock: FFT plans, large numpy operations."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor, wait
from functools import cache
from os import cpu_count, sched_getaffinity
from threading import current_thread
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["available_threads", "in_parallel", "parts", "working_threads"]

_THREADS = "eigencontact-worker"


def available_threads() -> int:
    """Cores this process may use."""
    try:
        return len(sched_getaffinity(0))
    except (AttributeError, OSError):
        return cpu_count() or 1


def working_threads(threads: int, gain: float = 0.5) -> float:
    """Speed-up by threads, for prices: cores share the memory, and short calls share the interpreter.

    Parameters
    ----------
    gain : float
        What each further thread adds, in threads.
    """
    return 1.0 + gain * (threads - 1)


def parts(rows: NDArray[Any], threads: int) -> list[NDArray[Any]]:
    """Rows of an array in one part for each thread; fewer where there are fewer rows."""
    return np.array_split(rows, min(threads, len(rows))) if len(rows) else []


@cache
def _pool(threads: int) -> ThreadPoolExecutor:
    return ThreadPoolExecutor(threads, thread_name_prefix=_THREADS)


def in_parallel(threads: int, tasks: Iterable[Callable[[], Any]]) -> None:
    """Run functions of no arguments, in threads where more than one is allowed; the first error is raised.

    Called from one of these threads it runs them one after the other, so that nested calls cannot wait for each other.
    """
    tasks = list(tasks)
    if threads <= 1 or len(tasks) <= 1 or current_thread().name.startswith(_THREADS):
        for task in tasks:
            task()
        return
    futures = [_pool(threads).submit(task) for task in tasks[1:]]
    try:
        tasks[0]()  # this thread need not wait idly
    finally:
        wait(futures)
    for future in futures:
        future.result()
