"""Error bars of all numbers of a run, from coarser runs that vary one source of discretisation at a time."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from operator import attrgetter, itemgetter
from time import perf_counter
from typing import TYPE_CHECKING, Any, NamedTuple

from eigencontact.accuracy.changes import changed
from eigencontact.accuracy.estimate import Estimate, estimate
from eigencontact.accuracy.sources import ErrorSource, error_sources, without_overlap
from eigencontact.accuracy.targets import ZERO, scales_of
from eigencontact.core.kept import ObjectCache
from eigencontact.core.numbers import ROUND_OFF, ErrorBar
from eigencontact.errors import EigencontactError

if TYPE_CHECKING:
    from eigencontact.accuracy.differences import Results
    from eigencontact.accuracy.fields import FieldErrors
    from eigencontact.planning.plan import Plan

__all__ = ["Accuracy", "CoarserRuns", "Comparison", "Run", "SourceRuns", "error_bars", "joined_bars"]

#: Memory of the operators that coarser runs share [bytes].
_OPERATOR_BYTES = 2e8
#: Parts of an error bar, and of its number, from which on the error of a source is worth a second coarser run.
_NOTABLE, _LEAST = 0.2, 1e-3
#: Why a sum over solved load steps has no error.
_SOLVED = "it is a sum over the solved cycles alone, and other cells solve other cycles"


class Run(NamedTuple):
    """One solved discretisation.

    Attributes
    ----------
    plan : Plan
    summary : mapping
        Contents of its ``summary.json``.
    results : Results, optional
        Its fields, for the errors of fields.
    storage : object
        What the caller needs to store the run.
    """

    plan: Plan
    summary: Mapping[str, Any]
    results: Results | None = None
    storage: Any = None


class SourceRuns(NamedTuple):
    """Runs of one source of error.

    Attributes
    ----------
    base : Run
        The run, or one with coarser cells.
    coarser_runs : sequence of (float, Run)
        Step size in that of `base`, and the run; the finer first.
    size : float
        Step size of `base` in that of the run.
    """

    base: Run
    coarser_runs: Sequence[tuple[float, Run]]
    size: float = 1.0


#: Solver of a scene: takes its tables and its difference to the scene of the run in words.
Solve = Callable[[Mapping[str, Any], str], Run]


@dataclass(frozen=True, kw_only=True)
class Comparison:
    """Numbers on coarser discretisations of one source of error.

    Attributes
    ----------
    source : ErrorSource
        Source of error that is varied.
    values : dict of str to float
        Results of the run that is compared with the coarser ones.
    coarser_results : list of (float, dict of str to float)
        Step size in units of that run, and the results; the finer first.
    size : float
        Step size of that run in that of the run with the error.
    known_errors : dict of str to float
        Errors that follow from the plan.
    seconds : float
        Wall time of the coarser runs [s].
    """

    source: ErrorSource
    values: Mapping[str, float] = field(default_factory=dict)
    coarser_results: Sequence[tuple[float, Mapping[str, float]]] = ()
    size: float = 1.0
    known_errors: Mapping[str, float] = field(default_factory=dict)
    seconds: float = 0.0


@dataclass(frozen=True, kw_only=True)
class Accuracy:
    """Errors of the numbers of a run.

    Attributes
    ----------
    bars : dict of str to ErrorBar
        By name of the number.
    left_out : dict of str to str
        Sources of error that could not be varied, and numbers that do not converge, with the reason.
    runs : int
        How many coarser runs were made.
    seconds : float
        Their wall time [s].
    comparisons : list of Comparison
        Numbers of these runs.
    runs_by_source : dict of str to SourceRuns
        These runs, and those that were reused.
    """

    bars: dict[str, ErrorBar]
    left_out: dict[str, str] = field(default_factory=dict)
    runs: int = 0
    seconds: float = 0.0
    comparisons: Sequence[Comparison] = ()
    runs_by_source: Mapping[str, SourceRuns] = field(default_factory=dict)

    def to_dict(self) -> dict[str, Any]:
        """Plain data for ``summary.json``."""
        bars = {name: bar.to_dict() for name, bar in self.bars.items()}
        price = {"error_runs": self.runs, "error_seconds": self.seconds}
        return {"errors": bars, "errors_left_out": self.left_out, **price}


def error_bars(
    plan: Plan,
    summary: Mapping[str, Any],
    solve: Solve,
    fields: FieldErrors | None = None,
    *,
    sources: Sequence[ErrorSource] | None = None,
    reusable_runs: Mapping[str, SourceRuns] | None = None,
    coarse: Mapping[str, Any] | None = None,
) -> Accuracy:
    """Estimate the error of every result in the summary of a run.

    Parameters
    ----------
    plan : Plan
        Of the run.
    summary : mapping
        Contents of its ``summary.json``.
    solve : callable
        Takes the tables of a scene and its difference in words; returns its run in memory or raises
        `EigencontactError`.
    fields : FieldErrors, optional
        Takes the same runs for the errors of fields.
    sources : sequence of ErrorSource, optional
        By default those of the plan.
    reusable_runs : mapping of str to SourceRuns, optional
        Earlier runs of sources that stand for those of this run.
    coarse : mapping, optional
        Table of the grid on which all sources but the cells are varied; by default the coarsest grid of the cells.

    Returns
    -------
    Accuracy
        A source that no coarser run could vary is listed with its reason and is in no bar.

    Notes
    -----
    The cells of the grid become larger in two runs; see `eigencontact.accuracy.sources`. Every other source is varied
    alone, on the coarsest of these grids that could be solved. Its error there is taken as that of the run; where its
    step size follows the grid, the error is scaled to the step size of the run. The bar is the sum over the sources;
    an error that two sources share counts once. It does not contain errors of the model: half-space, small strain,
    laws.
    """
    began = perf_counter()
    coarser = CoarserRuns(Run(plan, summary), solve, coarse)
    runs_by_source = dict(reusable_runs or {})
    comparisons: list[Comparison] = []
    left_out = {name: warning["words"] for name, warning in _slow_warnings(summary).items() if warning["order"] == 0.0}
    left_out |= dict.fromkeys(_partial_sums(summary), _SOLVED)
    for source in error_sources(plan) if sources is None else sources:
        source_began = perf_counter()
        known_errors = {} if source.known_errors is None else source.known_errors(plan, summary)
        if source.name not in runs_by_source:
            runs, reason = coarser.vary(source, runs_by_source, partial(_is_notable, summary, comparisons, source))
            if runs.coarser_runs:
                runs_by_source[source.name] = runs
            elif reason:
                left_out[source.name] = reason
                if not source.on_coarse:  # the least error alone would look like a small one
                    known_errors = {}
        comparison = Comparison(source=source)
        if source.name in runs_by_source:
            left_out.pop(source.name, None)
            comparison = _comparison(source, runs_by_source[source.name])
            if fields is not None:
                fields.vary(source, *runs_by_source[source.name])
        comparisons.append(replace(comparison, known_errors=known_errors, seconds=perf_counter() - source_began))
    bars = joined_bars(summary, comparisons)
    seconds = perf_counter() - began
    return Accuracy(
        bars=bars,
        left_out=left_out,
        runs=len(coarser.runs),
        seconds=seconds,
        comparisons=comparisons,
        runs_by_source=runs_by_source,
    )


@dataclass
class CoarserRuns:
    """Coarser runs of one run, source by source."""

    run: Run
    solve: Solve
    grid: Mapping[str, Any] | None = None
    runs: list[Run] = field(default_factory=list)
    _operators: ObjectCache = field(default_factory=lambda: ObjectCache(_OPERATOR_BYTES))
    _coarsest: tuple[Mapping[str, Any], Run] | None = None

    def vary(
        self,
        source: ErrorSource,
        runs_by_source: Mapping[str, SourceRuns],
        notable: Callable[[SourceRuns], bool] = lambda _: True,
    ) -> tuple[SourceRuns, str]:
        """Runs of a source, and the reason if one was refused; `runs_by_source` has the runs of earlier sources.

        After the first run of a sparing source, `notable` decides whether there is a second run.
        """
        coarser_runs: list[tuple[float, Run]] = []
        start, size = self.run, 1.0
        try:
            tables, start = self._start(source, runs_by_source)
            size = _edge(start.plan) / _edge(self.run.plan) if source.of_cells else 1.0
            for variation in source.variations(start.plan):
                if coarser_runs and source.sparing and not notable(SourceRuns(start, coarser_runs, size)):
                    break
                words = f"{source.name}, step size times {variation.ratio:.3g}"
                coarse = self._solved(changed(tables, variation.changes), words)
                # the planner rounds the number of cells: the ratio is that of the edges
                ratio = variation.ratio if source.on_coarse else _edge(coarse[1].plan) / _edge(self.run.plan)
                if ratio == 1.0:
                    return SourceRuns(start, coarser_runs, size), "the grid cannot be coarser"
                coarser_runs = sorted([*coarser_runs, (ratio, coarse[1])], key=itemgetter(0))
                if not source.on_coarse and self.grid is None:
                    self._coarsest = coarse
        except EigencontactError as problem:
            return SourceRuns(start, coarser_runs, size), " ".join(str(problem).split())
        return SourceRuns(start, coarser_runs, size), ""

    def _start(self, source: ErrorSource, runs_by_source: Mapping[str, SourceRuns]) -> tuple[Mapping[str, Any], Run]:
        """Tables and run from which a source is varied, on coarse cells where possible."""
        tables = self.run.plan.scene.resolved()
        if not source.on_coarse:
            return tables, self.run
        if self._coarsest is None and "cells" in runs_by_source:
            grid = self.grid or runs_by_source["cells"].coarser_runs[-1][1].plan.scene.resolved()["grid"]
            coarse = {"grid": grid, "numerics": {"allow-coarse": True}}
            self._coarsest = self._solved(changed(tables, coarse), "coarse cells")
        start = self._coarsest or (tables, self.run)
        return self._coarse_throughout(*start, runs_by_source) if source.of_cells else start

    def _coarse_throughout(
        self, tables: Mapping[str, Any], run: Run, runs_by_source: Mapping[str, SourceRuns]
    ) -> tuple[Mapping[str, Any], Run]:
        """Equally coarse cells along x, y and z, with fewer load steps, because divided cells are expensive."""
        plan = self.run.plan
        runs_of_load_steps = runs_by_source["load steps"].coarser_runs if "load steps" in runs_by_source else ()
        for ratio, coarser in runs_of_load_steps:
            if ratio > 1.0 and coarser.plan.numerics.refinement == plan.numerics.refinement:
                tables, run = coarser.plan.scene.resolved(), coarser
                break
        pitch, ratio = plan.numerics.inclusion_pitch, _edge(run.plan) / _edge(plan)
        if pitch is None or ratio == 1.0:
            return tables, run
        return self._solved(changed(tables, {"numerics": {"inclusion-pitch": ratio * pitch}}), "all cells coarse")

    def _solved(self, tables: Mapping[str, Any], words: str) -> tuple[Mapping[str, Any], Run]:
        with self._operators.offered():  # runs on the same cells share operators
            run = self.solve(tables, words)
        self.runs.append(run)
        return tables, run


def _comparison(source: ErrorSource, runs: SourceRuns) -> Comparison:
    """Numbers of the runs of a source."""
    return Comparison(
        source=source,
        values=dict(_results(runs.base.summary)),
        coarser_results=[(ratio, dict(_results(coarser.summary))) for ratio, coarser in runs.coarser_runs],
        size=runs.size,
    )


def _is_notable(
    summary: Mapping[str, Any], comparisons: Sequence[Comparison], source: ErrorSource, runs: SourceRuns
) -> bool:
    """Whether a source is a notable part of the error bar of any number that does not scatter."""
    declared, scales = summary["numbers"], scales_of(summary)
    for name, bar in joined_bars(summary, [*comparisons, _comparison(source, runs)]).items():
        zero = ZERO * scales.get(declared[name]["unit"], 0.0)
        threshold = max(_NOTABLE * bar.error, _LEAST * abs(bar.value), zero)
        if bar.parts.get(source.name, 0.0) > threshold and not declared[name].get("scatters"):
            return True
    return False


def joined_bars(summary: Mapping[str, Any], comparisons: Sequence[Comparison]) -> dict[str, ErrorBar]:
    """Error bar of each number in the summary of a run, from the numbers of coarser runs."""
    orders = {name: warning["order"] for name, warning in _slow_warnings(summary).items()}
    value_of = {name: value for name, value in _results(summary) if orders.get(name) != 0.0}
    by_source: dict[str, dict[str, Estimate]] = {}
    for comparison in comparisons:
        orders_of_source = {} if comparison.source.on_coarse else orders
        estimates = dict(_estimates(value_of, summary["numbers"], comparison, orders_of_source))
        if comparison.source.is_least_error:
            estimates = {name: least for name, least in estimates.items() if not _is_changed(name, comparisons)}
        by_source[comparison.source.name] = estimates
    return _joined(value_of, by_source)


def _is_changed(name: str, comparisons: Sequence[Comparison]) -> bool:
    """Whether any coarser run changes a number by more than round-off."""
    return any(
        name in comparison.values
        and abs(coarser.get(name, comparison.values[name]) - comparison.values[name])
        > ROUND_OFF * abs(comparison.values[name])
        for comparison in comparisons
        for _, coarser in comparison.coarser_results
    )


def _slow_warnings(summary: Mapping[str, Any]) -> dict[str, Mapping[str, Any]]:
    """Warnings about numbers that converge slowly or not at all, by number."""
    return {warning["number"]: warning for warning in summary["warnings"] if warning.get("number")}


def _edge(plan: Plan) -> float:
    """Edge of the cells, both directions alike."""
    return plan.grid.mean_edge


def _results(summary: Mapping[str, Any]) -> Iterator[tuple[str, float]]:
    """Names and values of the results in a summary, without results that another result replaces."""
    declared = summary["numbers"]
    values = {name: summary.get(name, summary["observed"].get(name)) for name in declared}
    replaced = {number.get("replaces") for name, number in declared.items() if values[name]} | set(
        _partial_sums(summary)
    )
    for name, value in values.items():
        if declared[name]["role"] == "result" and isinstance(value, int | float) and name not in replaced:
            yield name, float(value)


def _partial_sums(summary: Mapping[str, Any]) -> list[str]:
    """Sums over the solved load steps where another number has the skipped ones as well."""
    declared = summary["numbers"]
    skipped = any(
        number.get("replaces") in summary
        and abs(summary[name] - summary[number["replaces"]]) > ROUND_OFF * summary[name]
        for name, number in declared.items()
        if summary.get(name)
    )
    return [name for name, number in declared.items() if skipped and number.get("summed")]


def _estimates(
    names: Iterable[str],
    declared: Mapping[str, Mapping[str, Any]],
    comparison: Comparison,
    orders: Mapping[str, float],
) -> Iterator[tuple[str, Estimate]]:
    """Error estimates of one source, by name of the number; numbers that a coarser run lacks have none.

    `orders` has the orders of numbers that converge more slowly than the orders of the source.
    """
    source, value_of = comparison.source, comparison.values
    for name in names:
        estimates = [Estimate(comparison.known_errors[name], None)] if name in comparison.known_errors else []
        pairs = [(ratio, coarser[name]) for ratio, coarser in comparison.coarser_results if name in coarser]
        if pairs and name in value_of:
            lowest, highest = (orders[name],) * 2 if name in orders else (source.lowest, source.highest)
            scatters = bool(declared[name].get("scatters"))
            estimates.append(estimate(value_of[name], pairs, lowest, highest, scatters=scatters, size=comparison.size))
        if estimates:
            yield name, max(estimates, key=attrgetter("error"))


def _joined(value_of: Mapping[str, float], by_source: Mapping[str, Mapping[str, Estimate]]) -> dict[str, ErrorBar]:
    """Error bar of each number, combined from the sources."""
    bars = {}
    for name, value in value_of.items():
        of_number = {source: estimates[name] for source, estimates in by_source.items() if name in estimates}
        if not of_number:
            continue
        errors = without_overlap({source: share.error for source, share in of_number.items()})
        largest = max(errors, key=lambda source: errors[source])
        bars[name] = ErrorBar(
            value=value, error=sum(errors.values()), source=largest, order=of_number[largest].order, parts=errors
        )
    return bars
