"""Errors of one field from one source: differences to coarser runs at points, and the order of the field."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import reduce
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from eigencontact.accuracy.carry import Axes, axes_of, interpolated, without_gaps
from eigencontact.accuracy.estimate import estimate
from eigencontact.results.history import HISTORY_STEP

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from eigencontact.accuracy.sources import ErrorSource

__all__ = ["Results", "Sampled", "Share", "differences", "largest_near", "neighbours", "shares_of", "time_of"]


#: All but the last, and all but the first of the points along a dimension.
_SIDES = (slice(None, -1), slice(1, None))


#: A difference is at least this part of those at the neighbours: where it changes its sign it is small by chance.
_OF_NEIGHBOURS = 0.5


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
        self.positions = {time: position for position, time in enumerate(times)}

    def at(self, time: float) -> NDArray[Any] | None:
        """Values at a time; None if the points differ, as in a box of cells that has grown."""
        values = np.asarray(self._variable[self.positions[time]].values, dtype=float)
        return values if values.shape[values.ndim - len(self.axes) :] == tuple(map(len, self.axes)) else None


@dataclass(frozen=True)
class Share:
    """Error of a field from one source in one step: on the points of each coarser run, with the observed order.

    `extremes` has the errors of the smallest and the largest value of each component, each estimated like that of a
    number.
    """

    errors: list[tuple[Axes, NDArray[Any]]]
    order: float | None
    extremes: NDArray[Any]

    def at(self, axes: Axes) -> NDArray[Any]:
        """Largest of the estimates at the points of the run."""
        return reduce(np.maximum, (interpolated(errors, places, axes, smooth=False) for places, errors in self.errors))


def differences(
    base: Sampled,
    coarser_fields: Sequence[tuple[float, Sampled]],
    source: ErrorSource,
    *,
    size: float = 1.0,
    last: bool = False,
) -> Iterator[tuple[float, Share]]:
    """Common times of the steps of all runs, and the errors of a field at these times.

    `coarser_fields` has the step size of each coarser run in that of `base`, and the field there; `size` is the step
    size of `base` in that of the run with the error. With `last` only the last of the steps counts.
    """
    if any(len(coarser.axes) != len(base.axes) for _, coarser in coarser_fields):
        return
    fields = (base, *(coarser for _, coarser in coarser_fields))
    times = sorted(set.intersection(*(set(field.positions) for field in fields)))
    for time in times[-1:] if last else times:
        values, *values_of_coarser = (field.at(time) for field in fields)
        sizes, magnitudes, places, coarser_extremes = [], [], [], []
        for (ratio, coarser), coarser_values in zip(coarser_fields, values_of_coarser, strict=True):
            if values is None or coarser_values is None:
                break
            coarse = without_gaps(coarser_values)
            indices = [_within(axis, base_axis) for axis, base_axis in zip(coarser.axes, base.axes, strict=True)]
            leading = map(np.arange, coarse.shape[: coarse.ndim - len(indices)])
            places.append(tuple(axis[inside] for axis, inside in zip(coarser.axes, indices, strict=True)))
            fine = interpolated(values, base.axes, places[-1], smooth=True)
            magnitudes.append(np.abs(coarse[np.ix_(*leading, *indices)] - fine))
            sizes.append(ratio)
            coarser_extremes.append(_extremes(coarse, len(indices)))
        if len(magnitudes) < len(coarser_fields):
            continue
        factors, order = shares_of([float(np.mean(magnitude)) for magnitude in magnitudes], sizes, source, size)
        errors = [
            (factor * largest_near(magnitude, range(-len(base.axes), 0), _OF_NEIGHBOURS)).astype(np.float32)
            for factor, magnitude in zip(factors, magnitudes, strict=True)
        ]
        assert values is not None
        base_extremes = _extremes(without_gaps(values), len(base.axes))
        extremes = [
            estimate(extreme, list(zip(sizes, on_coarser, strict=True)), source.lowest, source.highest, size=size).error
            for extreme, *on_coarser in zip(*(run.ravel() for run in (base_extremes, *coarser_extremes)), strict=True)
        ]
        yield time, Share(list(zip(places, errors, strict=True)), order, np.reshape(extremes, base_extremes.shape))


def shares_of(
    norms: Sequence[float], sizes: Sequence[float], source: ErrorSource, base: float = 1.0
) -> tuple[list[float], float | None]:
    """Factors from differences at points to errors, for each coarser run, and the observed order.

    The factors turn the `norms` of the differences into the error of a number with the same differences. The compared
    run has the step size `base`.

    Examples
    --------
    >>> from eigencontact.accuracy.sources import SOURCES
    >>> factors, order = shares_of([3.0, 8.0], [2.0, 3.0], SOURCES[0])  # of second order, the error is 1
    >>> [f"{factor:.3f}" for factor in factors], f"{order:.2f}"
    (['0.417', '0.156'], '2.00')
    """
    signed = [norm if size > 1.0 else -norm for norm, size in zip(norms, sizes, strict=True)]
    pairs = list(zip(sizes, signed, strict=True))
    error, order = estimate(0.0, pairs, source.lowest, source.highest, mean=True, size=base)
    exponent = source.lowest if order is None else min(order, source.highest)
    increases = [abs(size**exponent - 1.0) for size in sizes]
    shares = [norm / increase for norm, increase in zip(norms, increases, strict=True)]
    reference = max(shares) if order is None else shares[0]
    return [error / (reference * increase) if reference else 0.0 for increase in increases], order


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
    index = bisect_left(times, time)
    return times[index : index + 1] if time in times[index : index + 1] else times[max(0, index - 1) : index + 1]


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
        for points, neighbours_of_points in (ends, ends[::-1]):
            np.maximum(largest[points], share * field[neighbours_of_points], out=largest[points])
    return largest


def _within(places: NDArray[Any], reference: NDArray[Any]) -> NDArray[Any]:
    """Indices of coordinates between the first and the last of `reference`; the nearest index if there is none."""
    room = 1e-9 * (np.ptp(reference) + np.ptp(places))
    inside = np.flatnonzero((places >= reference[0] - room) & (places <= reference[-1] + room))
    return inside if inside.size else np.array([int(np.abs(places - reference.mean()).argmin())])
