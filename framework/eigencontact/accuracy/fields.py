"""Errors of the fields of a run at every point, and of its numbers in every step, from the coarser runs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import reduce
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from eigencontact.accuracy.carry import equal_places, without_gaps
from eigencontact.accuracy.differences import (
    Results,
    Sampled,
    Share,
    differences,
    largest_near,
    neighbours,
    time_of,
)
from eigencontact.accuracy.estimate import Estimate, estimate
from eigencontact.accuracy.sources import without_overlap
from eigencontact.core.field_error import FieldError, beside_edges, error_name
from eigencontact.core.numbers import ErrorBar, Number
from eigencontact.core.quantities import QUANTITIES, Quantity
from eigencontact.results.borders import Variable

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from eigencontact.accuracy.bars import Run
    from eigencontact.accuracy.sources import ErrorSource

__all__ = ["FieldErrors"]

#: Fields with errors, by the role of their variables; whether they are zero outside of a zone with edges.
_ROLES = {"field": True, "history": True, "region": False}
#: At an edge a field is off by at most this part of the difference to the neighbour: the edge lies between them.
_OF_NEIGHBOUR = 0.5
#: Values are equal up to this part of them: of a symmetric field on an even number of cells several are the largest.
_EQUAL = 1e-6


class _ComparedRuns(NamedTuple):
    """Summary and results of a run, and the runs that are coarser in one source of error.

    `coarser_runs` has their step sizes in that of this run; `size` is its step size in that of the run with the error.
    """

    source: ErrorSource
    summary: Mapping[str, Any]
    results: Results
    coarser_runs: Sequence[tuple[float, Run]]
    size: float


class FieldErrors:
    """Errors of fields, collected source by source while `eigencontact.accuracy.bars` varies the sources.

    Parameters
    ----------
    run : Results
        Results of the run.
    summary : mapping
        Its summary.

    Attributes
    ----------
    fields : dict of str to FieldError
        Errors of the last step, by variable; complete when all `variables` have been taken.

    Notes
    -----
    The finer of two runs is interpolated at the points of the coarser run by polynomials of third degree. The
    difference there, at least half of that of its neighbours, is interpolated back linearly. Fields are thus compared
    where both have values, and the interpolation adds less than the coarser points miss. The mean magnitude of the
    differences gives the order of the whole field, because differences at single points change sign. Steps are compared
    at common times; between these the larger error counts.

    The error has lower bounds. A field of the surface, or of cells, may have an infinite slope at the edge of the zone
    in which it is not zero: there its error is at least half of the largest difference to a neighbour. At a peak, and
    next to it, points of coarser runs elsewhere do not show how sharp the peak is: the error is at least a part of the
    step to the neighbours. It is the whole step at a sharp peak, where this step is the largest nearby, and nothing at
    a smooth peak, where this step is at most half of the next one. At the largest and the smallest value of the field
    the error is at least that of this value as a number, which follows the peak of each run.
    """

    def __init__(self, run: Results, summary: Mapping[str, Any]) -> None:
        self.fields: dict[str, FieldError] = {}
        self._run = run
        self._summary = summary
        self._comparisons: list[_ComparedRuns] = []

    def vary(
        self, source: ErrorSource, base: Run, coarser_runs: Sequence[tuple[float, Run]], size: float = 1.0
    ) -> None:
        """Add the coarser runs of one source of error, with step sizes relative to those of `base`.

        They are compared with `base`: the run itself, or that with the coarsest cells, whose step size is `size` times
        that of the run.
        """
        results = self._run if base.results is None else base.results
        self._comparisons.append(_ComparedRuns(source, base.summary, results, coarser_runs, size))

    def bar(self, name: str) -> ErrorBar | None:
        """Error of the largest value of a field after the last step; None without errors."""
        if name not in self._run.variables or not (shares := self._shares_of(name, last=True)):
            return None
        values = (field := Sampled(self._run, name)).at(max(field.positions))
        if values is None:
            return None
        parts, errors, edged = self._errors_at(name, field, values, max(field.positions), shares)
        error = _in_one_number(values, parts, errors, edged, shares)
        return ErrorBar(
            value=error.largest, error=error.error, source=error.source, order=error.order, parts=error.parts
        )

    def _shares_of(self, name: str, *, last: bool = False) -> dict[str, dict[float, Share]]:
        """Errors of a field by source and time."""
        shares = {}
        for source, _, base, coarser_runs, size in self._comparisons:
            try:
                coarser = [
                    (ratio, Sampled(run.results, name)) for ratio, run in coarser_runs if run.results is not None
                ]
                shares[source.name] = dict(differences(Sampled(base, name), coarser, source, size=size, last=last))
            except LookupError:  # not in all runs
                continue
        return {source: by_time for source, by_time in shares.items() if by_time}

    def _estimates_of(self, name: str) -> dict[str, dict[float, Estimate]]:
        """Errors of a number by source and time."""
        estimates = {
            source.name: dict(_histories(name, summary, coarser_runs, source, size))
            for source, summary, _, coarser_runs, size in self._comparisons
        }
        return {source: by_time for source, by_time in estimates.items() if by_time}

    def variables(self, bars: Mapping[str, ErrorBar]) -> Iterator[Variable]:
        """Errors of each field and each number in all steps; empty if the cells could not be varied.

        In the last step a number has the error of its bar, and without a bar it has no errors.
        """
        if not any(not source.on_coarse for source, *_ in self._comparisons):
            return
        for name in _fields(self._run):
            if shares := self._shares_of(name):
                yield self._field(name, shares)
        times = [time_of(time) for time in self._run.variables["time"].values]
        for name, number in self._summary["numbers"].items():
            if number["role"] != "result" or name not in bars or error_name(name) in self._run.variables:
                continue
            if estimates := self._estimates_of(name):
                yield self._number(name, estimates, times, bars[name].error)

    def to_dict(self) -> dict[str, Any]:
        """Plain data for ``summary.json``, after all `variables` are computed."""
        return {"field_errors": {name: error.to_dict() for name, error in self.fields.items()}}

    def _field(self, name: str, shares: Mapping[str, Mapping[float, Share]]) -> Variable:
        """Error of a field at all points in all steps; stores the error of the last step as one number."""
        variable, field = self._run.variables[name], Sampled(self._run, name)
        total = np.full(variable.shape, np.nan, dtype=np.float32)
        source = ""
        for time, step in field.positions.items():
            if (values := field.at(time)) is None:
                continue
            parts, total[step], edged = self._errors_at(name, field, values, time, shares)
            if step == len(total) - 1:
                self.fields[name] = _in_one_number(values, parts, total[step], edged, shares)
                source = self.fields[name].source
        attrs: dict[str, str | int] = {
            "role": "error", "units": str(variable.attrs["units"]), "estimates": name, "source": source,
            "long_name": f"estimated error of: {variable.attrs['long_name']}",
        }  # fmt: skip
        return Variable(name=error_name(name), dims=tuple(variable.dims), values=total, attrs=attrs)

    def _errors_at(
        self,
        name: str,
        field: Sampled,
        values: NDArray[Any],
        time: float,
        shares: Mapping[str, Mapping[float, Share]],
    ) -> tuple[dict[str, NDArray[Any]], NDArray[Any], int]:
        """Errors of a field in one step at points, by source and in sum, and the number of dimensions with edges."""
        edged = len(field.axes) if _ROLES[self._run.variables[name].attrs["role"]] else 0
        parts = {
            source: reduce(np.maximum, (by_time[at].at(field.axes) for at in neighbours(sorted(by_time), time)))
            for source, by_time in shares.items()
        }
        places = [at for by_time in shares.values() for share in by_time.values() for at, _ in share.errors]
        moving_axes = [
            n - len(field.axes) for n, at in enumerate(field.axes) if any(not equal_places(at, ax[n]) for ax in places)
        ]
        extremes_by_source = {
            source: np.max([by_time[at].extremes for at in neighbours(sorted(by_time), time)], axis=0)
            for source, by_time in shares.items()
        }
        extremes = np.sum(list(without_overlap(extremes_by_source).values()), axis=0)
        parts = without_overlap(parts)
        return parts, _bounded(values, sum(parts.values(), np.zeros(())), extremes, edged, moving_axes), edged

    def _number(
        self, name: str, estimates: Mapping[str, Mapping[float, Estimate]], times: Sequence[float], last: float
    ) -> Variable:
        """Error of a number in every step."""
        number = Number(**self._summary["numbers"][name]).own_error(error_name(name))
        values = [
            sum(
                without_overlap(
                    {
                        source: max(errors[at].error for at in neighbours(sorted(errors), time))
                        for source, errors in estimates.items()
                    }
                ).values()
            )
            for time in times[:-1]
        ]
        attrs = {"role": "error", **number.attributes()}
        return Variable(name=number.name, dims=("step",), values=np.array([*values, last]), attrs=attrs)


def _in_one_number(
    values: NDArray[Any],
    parts: Mapping[str, NDArray[Any]],
    errors: NDArray[Any],
    edged: int,
    shares: Mapping[str, Mapping[float, Share]],
) -> FieldError:
    """Error of a field after the last step, from its errors at points by source and in sum."""
    sizes = {source: FieldError.of(values, of_source, edged).error for source, of_source in parts.items()}
    largest = max(sizes, key=lambda source: sizes[source])
    order = shares[largest][max(shares[largest])].order
    error = FieldError.of(values, errors, edged, source=largest, order=order)
    scale = error.error / (sum(sizes.values()) or 1.0)
    return replace(error, parts={source: scale * size for source, size in sizes.items()})


def _fields(results: Results) -> Iterator[str]:
    """Fields that converge with the discretisation."""
    for name, variable in results.variables.items():
        attrs = variable.attrs
        quantity = str(name).removeprefix(f"{attrs['region']}_") if "region" in attrs else str(name)
        if attrs.get("role") in _ROLES and QUANTITIES.get(quantity, Quantity("", "")).converges:
            yield str(name)


def _histories(
    name: str,
    summary: Mapping[str, Any],
    coarser_runs: Sequence[tuple[float, Run]],
    source: ErrorSource,
    size: float,
) -> Iterator[tuple[float, Estimate]]:
    """Times and estimated errors of a number; empty for a number that does not converge."""
    slow = [warning["order"] for warning in summary.get("warnings", ()) if warning.get("number") == name]
    if 0.0 in slow:
        return
    lowest, highest = (slow[0], slow[0]) if slow and not source.on_coarse else (source.lowest, source.highest)
    scatters = bool(summary["numbers"][name].get("scatters"))
    summaries = (summary, *(run.summary for _, run in coarser_runs))
    histories = [{time_of(row["time"]): row.get(name) for row in contents.get("history", ())} for contents in summaries]
    for time in sorted(set.intersection(*map(set, histories))):
        value, *coarser_values = (history[time] for history in histories)
        if value is not None and all(coarser_value is not None for coarser_value in coarser_values):
            pairs = [(ratio, number) for (ratio, _), number in zip(coarser_runs, coarser_values, strict=True)]
            yield time, estimate(value, pairs, lowest, highest, scatters=scatters, size=size)


def _bounded(
    values: NDArray[Any], errors: NDArray[Any], extremes: NDArray[Any], edged: int, moving_axes: Sequence[int]
) -> NDArray[Any]:
    """Errors with a lower bound at edges and peaks; NaN where the field is NaN.

    The bound follows from the steps between neighbours. At the smallest and the largest value it is the error of this
    value as a number, `extremes`. A field has edges along its last `edged` dimensions. Along `moving_axes` other cells
    have other points.
    """
    field = without_gaps(values)
    round_off = _EQUAL * float(np.abs(field).max(initial=0.0))
    steps, jumps, peaks = np.zeros(values.shape), np.zeros(values.shape), field != 0.0
    for axis in {*moving_axes, *range(-edged, 0)}:
        first, last = (np.take(field, [end], axis=axis) for end in (0, -1))
        rises = np.diff(field, axis=axis, prepend=first, append=last)
        rises[np.abs(rises) <= round_off] = 0.0
        rise_before, rise_after = (np.take(rises, range(n, n + field.shape[axis]), axis=axis) for n in (0, 1))
        jumps = np.maximum(jumps, np.maximum(np.abs(rise_before), np.abs(rise_after)))
        if axis in moving_axes:
            peaks &= rise_before * rise_after <= 0.0
            steps = np.maximum(steps, np.maximum(np.abs(rise_before), np.abs(rise_after)))
            for end in (0, -1) if field.shape[axis] > 1 else ():  # the field beyond is not known
                np.moveaxis(peaks, axis, 0)[end] = False
    slopes = largest_near(steps, moving_axes)
    sharpness = np.maximum(2.0 * np.divide(steps, slopes, out=np.zeros(values.shape), where=slopes > 0.0) - 1.0, 0.0)
    bounds = np.where(peaks, sharpness * steps, 0.0)
    inner = tuple(range(extremes.ndim - 1, field.ndim))
    for sign, error in zip((-1.0, 1.0), extremes, strict=True):
        highest = peaks & (sign * field >= (sign * field).max(axis=inner, keepdims=True) - round_off)
        bounds = np.where(highest, np.maximum(bounds, np.expand_dims(error, inner)), bounds)
    bounds = largest_near(bounds, moving_axes)
    bounds = np.where(beside_edges(values, edged), np.maximum(bounds, _OF_NEIGHBOUR * jumps), bounds)
    return np.where(np.isfinite(values), np.maximum(errors, bounds), np.nan)
