"""Moments of a load history at which a formula is read: the end, the beginning, the peak, the end of a load step."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact.errors import SceneError
from eigencontact.viz.worn import ends_of_cycles, solved_cycles

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["MOMENTS"]


def _after_step(dataset: xr.Dataset, number: float) -> int:
    ends = np.flatnonzero(np.isclose(dataset["time"].values % 1.0, 0.0, rtol=0.0, atol=1e-9))
    return int(ends[int(number)])


def _cycle(dataset: xr.Dataset, number: float) -> slice:
    """Steps of a solved cycle, with the state that it began from."""
    cycle = solved_cycles(dataset)[int(number)]
    return slice(cycle.first - 1, cycle.last + 1)


def _after_cycles(dataset: xr.Dataset, count: float) -> int:
    return min(solved_cycles(dataset), key=lambda cycle: abs(cycle.cycle_count - float(count))).last


def _unloading(dataset: xr.Dataset) -> slice:
    return slice(int(dataset["normal_load"].values.argmax()), None)


def _when(dataset: xr.Dataset, course: Any, value: float) -> int:
    values = np.asarray(course)
    if values.shape != dataset["step"].shape:
        raise SceneError("the first argument of when(course, value, formula) must be a number of each step")
    return int(np.abs(values - float(value)).argmin())


#: Function of a formula whose last argument is read at that moment, and which moment it is.
MOMENTS: dict[str, tuple[Callable[..., Any], str]] = {
    "first": (lambda _: 0, "after the first increment"),
    "all": (lambda _: slice(None), "after every increment, a value each"),
    "peak": (lambda dataset: int(dataset["normal_load"].values.argmax()), "at the largest normal load"),
    "unloading": (_unloading, "from the largest normal load on, a value each"),
    "after": (_after_step, "after a load step, by its number or from the end: after(-2, ...)"),
    "when": (_when, "where a course comes nearest to a value: when(max_worn_depth, 1e-6, ...)"),
    "cycle": (_cycle, "through a solved cycle, by its number or from the end: cycle(-1, ...)"),
    "after_cycles": (_after_cycles, "after the solved cycle nearest to a count: after_cycles(10, ...)"),
    "cycles_ends": (ends_of_cycles, "at the ends of all solved cycles, a value each"),
}
