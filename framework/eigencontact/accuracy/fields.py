"""Errors of the fields of a run at every point, and of its numbers in every step, from the runs that give the bars."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from eigencontact.accuracy.carry import Axes, axes_of, carried
from eigencontact.accuracy.estimate import Estimate, estimate
from eigencontact.core.field_error import FieldError, beside_edges, error_name
from eigencontact.core.numbers import Number
from eigencontact.core.quantities import QUANTITIES, Quantity
from eigencontact.results.borders import Variable

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from eigencontact.accuracy.sources import ErrorSource

__all__ = ["FieldErrors", "shares_of"]

#: Fields with errors, by the role of their variables.
_ROLES = ("field", "region")
#: At an edge a field is off by at most this part of the difference to the neighbour: the edge lies between them.
_OF_NEIGHBOUR = 0.5


class Results(Protocol):
    """Variables of results by name, in memory or in a file."""

    @property
    def variables(self) -> Mapping[str, Any]: ...


@dataclass(frozen=True)
class _Share:
    """Error of a field from one source in one step: on the points of each coarser run, with the observed order."""

    errors: list[tuple[Axes, NDArray[Any]]]
    order: float | None

    def at(self, axes: Axes) -> NDArray[Any]:
        """Largest of the estimates at the points of the run."""
        return np.asarray(np.max([carried(part, places, axes, smooth=False) for places, part in self.errors], axis=0))


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
    The finer of two runs is interpolated at the points of the coarser one, by polynomials of third degree, and the
    difference there is carried back, linearly. So a field is compared where both have values, and the interpolation
    adds less than the coarser points miss. The mean magnitude of the differences gives the order of the field as a
    whole: differences at single points change sign. Steps are compared where both runs have them; between these the
    larger error counts. At an edge of the zone in which a field of the surface is not zero, where it may have an
    infinite slope, it is at least half of the largest difference to a neighbour.
    """

    def __init__(self, run: Results, summary: Mapping[str, Any]) -> None:
        self.fields: dict[str, FieldError] = {}
        self._run = run
        self._summary = summary
        self._runs: list[tuple[Mapping[str, Any], Results]] = [(summary, run)]
        self._shares: dict[str, dict[str, dict[float, _Share]]] = {}
        self._numbers: dict[str, dict[str, dict[float, Estimate]]] = {}

    def keep(self, summary: Mapping[str, Any], results: Results) -> None:
        """Take the results of a coarser run, known by its summary."""
        self._runs.append((summary, results))

    def vary(
        self,
        names: Sequence[str],
        summary: Mapping[str, Any],
        others: Sequence[tuple[float, Mapping[str, Any]]],
        source: ErrorSource,
        orders: Mapping[str, float],
    ) -> None:
        """Take one source of error; the arguments are those of the estimates of the numbers."""
        base, varied = self._of(summary), [(ratio, self._of(coarse)) for ratio, coarse in others]
        for name in _fields(base):
            if shares := dict(_differences(name, base, varied, source)):
                self._shares.setdefault(name, {})[source.name] = shares
        for name in names:
            if values := dict(_histories(name, summary, others, source, orders)):
                self._numbers.setdefault(name, {})[source.name] = values
        # the coarsest cells are those on which the other sources are varied
        base_summary = summary if source.on_coarse else others[-1][1]
        self._runs = [run for run in self._runs if run[0] is self._summary or run[0] is base_summary]

    def _of(self, summary: Mapping[str, Any]) -> Results:
        return next(results for known, results in self._runs if known is summary)

    def variables(self) -> Iterator[Variable]:
        """Errors of each field and of each number, in all steps."""
        times = _times(self._run)
        for name, sources in self._shares.items():
            variable = self._run.variables[name]
            axes = axes_of(self._run, name)
            assert axes is not None
            edged = len(axes) if variable.attrs["role"] == "field" else 0
            total = np.zeros(variable.shape, dtype=np.float32)
            for step, time in enumerate(times):
                values = np.asarray(variable[step].values, dtype=float)
                parts = {source: _between(shares, time, axes) for source, shares in sources.items()}
                total[step] = _bounded(values, np.sum(list(parts.values()), axis=0), edged)
            self.fields[name] = error = self._field_error(name, values, total[-1], parts, edged)
            attrs: dict[str, str | int] = {
                "role": "error", "units": str(variable.attrs["units"]), "estimates": name, "source": error.source,
                "long_name": f"estimated error of: {variable.attrs['long_name']}",
            }  # fmt: skip
            yield Variable(name=error_name(name), dims=tuple(variable.dims), values=total, attrs=attrs)
        for name, estimates in self._numbers.items():
            if error_name(name) not in self._run.variables:
                yield self._number(name, estimates, times)

    def _field_error(
        self, name: str, values: NDArray[Any], errors: NDArray[Any], parts: Mapping[str, NDArray[Any]], edged: int
    ) -> FieldError:
        """One number of a field in the last step."""
        shares = {source: FieldError.of(values, part, edged).error for source, part in parts.items()}
        largest = max(shares, key=lambda source: shares[source])
        order = self._shares[name][largest][max(self._shares[name][largest])].order
        return FieldError.of(values, errors, edged, source=largest, order=order)

    def _number(self, name: str, estimates: Mapping[str, Mapping[float, Estimate]], times: Sequence[float]) -> Variable:
        """Error of a number in every step."""
        number = Number(**self._summary["numbers"][name]).own_error(error_name(name))
        values = [
            sum(max(errors[at].error for at in _near(sorted(errors), time)) for errors in estimates.values())
            for time in times
        ]
        return Variable(
            name=number.name, dims=("step",), values=np.array(values), attrs={"role": "error", **number.attributes()}
        )


def shares_of(norms: Sequence[float], sizes: Sequence[float], source: ErrorSource) -> tuple[list[float], float | None]:
    """Factors from differences at points to errors, for each coarser run, and the observed order.

    They are those that turn the `norms` of the differences into the error of a number with the same differences.

    Examples
    --------
    >>> from eigencontact.accuracy.sources import SOURCES
    >>> factors, order = shares_of([3.0, 8.0], [2.0, 3.0], SOURCES[0])  # of second order, the error is 1
    >>> [f"{factor:.3f}" for factor in factors], f"{order:.2f}"
    (['0.417', '0.156'], '2.00')
    """
    found = estimate(0.0, list(zip(sizes, norms, strict=True)), source.lowest, source.highest)
    used = source.lowest if found.order is None else min(found.order, source.highest)
    ways = [abs(size**used - 1.0) for size in sizes]
    shares = [norm / way for norm, way in zip(norms, ways, strict=True)]
    reference = max(shares) if found.order is None else shares[0]
    return [found.error / (reference * way) if reference else 0.0 for way in ways], found.order


def _fields(results: Results) -> Iterator[str]:
    """Fields that converge with the discretisation."""
    for name, variable in results.variables.items():
        attrs = variable.attrs
        quantity = str(name).removeprefix(f"{attrs['region']}_") if "region" in attrs else str(name)
        if attrs.get("role") in _ROLES and QUANTITIES.get(quantity, Quantity("", "")).converges:
            yield str(name)


def _times(results: Results) -> list[float]:
    """Places of the steps in the load history, without their rounding."""
    return [round(float(time), 9) for time in results.variables["time"].values]


def _differences(
    name: str, base: Results, varied: Sequence[tuple[float, Results]], source: ErrorSource
) -> Iterator[tuple[float, _Share]]:
    """Times, and the errors of a field there; nothing where a run does not have the field at comparable points."""
    axes = axes_of(base, name)
    others = [axes_of(results, name) if name in results.variables else None for _, results in varied]
    if axes is None or any(places is None or len(places) != len(axes) for places in others):
        return
    sizes = [ratio for ratio, _ in varied]
    positions = [{time: at for at, time in enumerate(_times(results))} for results in (base, *(r for _, r in varied))]
    for time in sorted(set.intersection(*map(set, positions))):
        values = np.asarray(base.variables[name][positions[0][time]].values, dtype=float)
        differences, places_of = [], []
        for places, (_, results), at in zip(others, varied, positions[1:], strict=True):
            assert places is not None
            coarse = np.asarray(results.variables[name][at[time]].values, dtype=float)
            kept = [_within(other, own) for other, own in zip(places, axes, strict=True)]
            places_of.append(tuple(other[inside] for other, inside in zip(places, kept, strict=True)))
            coarse = np.nan_to_num(coarse)[np.ix_(*map(np.arange, coarse.shape[: coarse.ndim - len(axes)]), *kept)]
            differences.append(np.abs(coarse - carried(values, axes, places_of[-1], smooth=True)))
        factors, order = shares_of([float(np.mean(part)) for part in differences], sizes, source)
        errors = [(factor * part).astype(np.float32) for factor, part in zip(factors, differences, strict=True)]
        yield time, _Share(list(zip(places_of, errors, strict=True)), order)


def _within(places: NDArray[Any], others: NDArray[Any]) -> NDArray[Any]:
    """Positions of places between the first and the last of others; the nearest position where there is none."""
    room = 1e-9 * (np.ptp(others) + np.ptp(places))
    inside = np.flatnonzero((places >= others[0] - room) & (places <= others[-1] + room))
    return inside if inside.size else np.array([int(np.abs(places - others.mean()).argmin())])


def _histories(
    name: str,
    summary: Mapping[str, Any],
    others: Sequence[tuple[float, Mapping[str, Any]]],
    source: ErrorSource,
    orders: Mapping[str, float],
) -> Iterator[tuple[float, Estimate]]:
    """Times, and the estimated error of a number there."""
    lowest, highest = (orders[name],) * 2 if name in orders else (source.lowest, source.highest)
    scatters = bool(summary["numbers"][name].get("scatters"))
    values = [
        {round(row["time"], 9): row.get(name) for row in run["history"]} for run in (summary, *(s for _, s in others))
    ]
    for time in sorted(set.intersection(*map(set, values))):
        value, *rest = (by_time[time] for by_time in values)
        if value is not None and all(other is not None for other in rest):
            pairs = [(ratio, other) for (ratio, _), other in zip(others, rest, strict=True)]
            yield time, estimate(value, pairs, lowest, highest, scatters=scatters)


def _near(times: Sequence[float], time: float) -> Sequence[float]:
    """The time itself, or its neighbours among `times`."""
    at = bisect_left(times, time)
    return times[at : at + 1] if time in times[at : at + 1] else times[max(0, at - 1) : at + 1]


def _between(shares: Mapping[float, _Share], time: float, axes: Axes) -> NDArray[Any]:
    """Error of one source at the points of the run and at a time."""
    return np.asarray(np.max([shares[at].at(axes) for at in _near(sorted(shares), time)], axis=0))


def _bounded(values: NDArray[Any], errors: NDArray[Any], edged: int) -> NDArray[Any]:
    """Errors that are at edges no less than a part of the difference to the neighbours; NaN where the field is."""
    steps = np.zeros(values.shape)
    for axis in range(values.ndim - edged, values.ndim):
        differences = np.abs(np.diff(np.nan_to_num(values), axis=axis))
        for side in (slice(None, -1), slice(1, None)):
            at = tuple(side if n == axis else slice(None) for n in range(values.ndim))
            np.maximum(steps[at], differences, out=steps[at])
    bounded = np.where(beside_edges(values, edged), np.maximum(errors, _OF_NEIGHBOUR * steps), errors)
    return np.where(np.isfinite(values), bounded, np.nan)
