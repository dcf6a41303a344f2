"""Errors of one field from one source: differences to coarser runs at points, and the order of the field."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import reduce
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from eigencontact.accuracy.carry import Axes, axes_of, carried, without_gaps
from eigencontact.accuracy.estimate import estimate
from eigencontact.results.history import HISTORY_STEP

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from eigencontact.accuracy.sources import ErrorSource

__all__ = ["Results", "Sampled", "Share", "differences", "largest_near", "neighbours", "shares_of", "time_of"]


#: All but the last, and all but the first of the points along a dimension.
_SIDES = (slice(None, -1), slice(1, None))


#: A difference is at least this part of those at the neighbours: where it changes its sign it is small by chance.
_OF_OTHERS = 0.5


class Results(Protocol):
    """Variables of results by name, in memory or in a file."""

    @property
    def variables(self) -> Mapping[str, Any]:
        """Names of all variables."""


def time_of(time: float) -> float:
    """Time in the load history, rounded, so that increments of different runs have equal times."""
    return round(float(time), 9)


class Sampled:
    """A field of one run: the places of its points, and its values by the time of each step.

    Raises
    ------
    LookupError
        The run does not have the field, or no places of its points.
    """

    def __init__(self, results: Results, name: str) -> None:
        variables = results.variables
        self.axes: Axes = axes_of(results, name)
        self._variable = variables[name]
        times = [time_of(time) for time in variables["time"].values]
        if self._variable.dims[0] == HISTORY_STEP:
            by_step = dict(zip(map(int, variables["step"].values), times, strict=True))
            times = [by_step[int(step)] for step in variables[HISTORY_STEP].values]
        self.positions = {time: at for at, time in enumerate(times)}

    def at(self, time: float) -> NDArray[Any] | None:
        """Values at a time; None if the points differ, as in a box of cells that has grown."""
        values = np.asarray(self._variable[self.positions[time]].values, dtype=float)
        return values if values.shape[values.ndim - len(self.axes) :] == tuple(map(len, self.axes)) else None


@dataclass(frozen=True)
class Share:
    """Error of a field from one source in one step: on the points of each coarser run, with the observed order.

    `extremes` has the errors of its smallest and largest value, of each component, as of two numbers.
    """

    errors: list[tuple[Axes, NDArray[Any]]]
    order: float | None
    extremes: NDArray[Any]

    def at(self, axes: Axes) -> NDArray[Any]:
        """Largest of the estimates at the points of the run."""
        return reduce(np.maximum, (carried(part, places, axes, smooth=False) for places, part in self.errors))


def differences(
    base: Sampled,
    varied: Sequence[tuple[float, Sampled]],
    source: ErrorSource,
    *,
    size: float = 1.0,
    last: bool = False,
) -> Iterator[tuple[float, Share]]:
    """Common times of the steps of all runs, and the errors of a field at these times.

    `varied` has the step size of each coarser run in that of `base`, and the field there; `size` is the step size of
    `base` in that of the run with the error. `last` takes the last of the steps alone.
    """
    if any(len(other.axes) != len(base.axes) for _, other in varied):
        return
    times = sorted(set.intersection(*(set(run.positions) for run in (base, *(other for _, other in varied)))))
    for time in times[-1:] if last else times:
        values, *fields = (run.at(time) for run in (base, *(other for _, other in varied)))
        sizes, parts, places, ends = [], [], [], []
        for (ratio, other), field in zip(varied, fields, strict=True):
            if values is None or field is None:
                break
            coarse = without_gaps(field)
            kept = [_within(at, own) for at, own in zip(other.axes, base.axes, strict=True)]
            leading = map(np.arange, coarse.shape[: coarse.ndim - len(kept)])
            places.append(tuple(at[inside] for at, inside in zip(other.axes, kept, strict=True)))
            parts.append(np.abs(coarse[np.ix_(*leading, *kept)] - carried(values, base.axes, places[-1], smooth=True)))
            sizes.append(ratio)
            ends.append(_extremes(coarse, len(kept)))
        if len(parts) < len(varied):
            continue
        factors, order = shares_of([float(np.mean(part)) for part in parts], sizes, source, size)
        errors = [
            (factor * largest_near(part, range(-len(base.axes), 0), _OF_OTHERS)).astype(np.float32)
            for factor, part in zip(factors, parts, strict=True)
        ]
        assert values is not None
        own = _extremes(without_gaps(values), len(base.axes))
        extremes = [
            estimate(value, list(zip(sizes, others, strict=True)), source.lowest, source.highest, size=size).error
            for value, *others in zip(*(run.ravel() for run in (own, *ends)), strict=True)
        ]
        yield time, Share(list(zip(places, errors, strict=True)), order, np.reshape(extremes, own.shape))


def shares_of(
    norms: Sequence[float], sizes: Sequence[float], source: ErrorSource, base: float = 1.0
) -> tuple[list[float], float | None]:
    """Factors from differences at points to errors, for each coarser run, and the observed order.

    They are those that turn the `norms` of the differences into the error of a number with the same differences. The
    compared run has the step size `base`.

    Examples
    --------
    >>> from eigencontact.accuracy.sources import SOURCES
    >>> factors, order = shares_of([3.0, 8.0], [2.0, 3.0], SOURCES[0])  # of second order, the error is 1
    >>> [f"{factor:.3f}" for factor in factors], f"{order:.2f}"
    (['0.417', '0.156'], '2.00')
    """
    signed = [norm if size > 1.0 else -norm for norm, size in zip(norms, sizes, strict=True)]
    pairs = list(zip(sizes, signed, strict=True))
    found = estimate(0.0, pairs, source.lowest, source.highest, mean=True, size=base)
    used = source.lowest if found.order is None else min(found.order, source.highest)
    ways = [abs(size**used - 1.0) for size in sizes]
    shares = [norm / way for norm, way in zip(norms, ways, strict=True)]
    reference = max(shares) if found.order is None else shares[0]
    return [found.error / (reference * way) if reference else 0.0 for way in ways], found.order


def _extremes(field: NDArray[Any], points: int) -> NDArray[Any]:
    """Smallest and largest value (2, ...) over the last `points` dimensions."""
    axes = tuple(range(-points, 0))
    return np.stack([field.min(axis=axes), field.max(axis=axes)])


def neighbours(times: Sequence[float], time: float) -> Sequence[float]:
    """Return the time, or its two neighbours in a sorted sequence of times.

    Examples
    --------
    >>> neighbours([1.0, 2.0, 3.0], 2.0), neighbours([1.0, 2.0, 3.0], 2.5), neighbours([1.0, 2.0], 0.5)
    ([2.0], [2.0, 3.0], [1.0])
    """
    at = bisect_left(times, time)
    return times[at : at + 1] if time in times[at : at + 1] else times[max(0, at - 1) : at + 1]


def largest_near(field: NDArray[Any], axes: Iterable[int], share: float = 1.0) -> NDArray[Any]:
    """Largest of the value at each point and a fraction of its neighbours, along the last dimensions.

    Examples
    --------
    >>> largest_near(np.array([0.0, 4.0, 0.0, 0.0]), [-1], 0.5)
    array([2., 4., 2., 0.])
    """
    largest = field.copy()
    for axis in axes:
        ends = [tuple(side if n == axis % field.ndim else slice(None) for n in range(field.ndim)) for side in _SIDES]
        for end, other in (ends, ends[::-1]):
            np.maximum(largest[end], share * field[other], out=largest[end])
    return largest


def _within(places: NDArray[Any], others: NDArray[Any]) -> NDArray[Any]:
    """Indices of coordinates between the first and last of others; the nearest index if there is none."""
    room = 1e-9 * (np.ptp(others) + np.ptp(places))
    inside = np.flatnonzero((places >= others[0] - room) & (places <= others[-1] + room))
    return inside if inside.size else np.array([int(np.abs(places - others.mean()).argmin())])
