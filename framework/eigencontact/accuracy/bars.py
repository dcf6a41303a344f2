"""Error bars of all numbers of a run: coarser runs of the same scene, one part of the discretisation at a time."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from time import perf_counter
from typing import TYPE_CHECKING, Any

from eigencontact.accuracy.changes import changed
from eigencontact.accuracy.estimate import Estimate, estimate
from eigencontact.accuracy.sources import ErrorSource, error_sources
from eigencontact.core.numbers import ErrorBar
from eigencontact.errors import EigencontactError

if TYPE_CHECKING:
    from eigencontact.planning.plan import Plan

__all__ = ["Accuracy", "error_bars"]

#: Solves a scene given by its tables, with what differs in words: the plan and the contents of its summary.
Solve = Callable[[Mapping[str, Any], str], "tuple[Plan, Mapping[str, Any]]"]


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
    """

    bars: dict[str, ErrorBar]
    left_out: dict[str, str] = field(default_factory=dict)
    runs: int = 0
    seconds: float = 0.0

    def to_dict(self) -> dict[str, Any]:
        """Plain data for ``summary.json``."""
        bars = {name: bar.to_dict() for name, bar in self.bars.items()}
        price = {"error_runs": self.runs, "error_seconds": self.seconds}
        return {"errors": bars, "errors_left_out": self.left_out, **price}


def error_bars(
    plan: Plan, summary: Mapping[str, Any], solve: Solve, sources: Sequence[ErrorSource] | None = None
) -> Accuracy:
    """Estimate the error of every result in the summary of a run.

    Parameters
    ----------
    plan : Plan
        Of the run.
    summary : mapping
        Contents of its ``summary.json``.
    solve : callable
        Tables of a scene, and what differs in words, to the plan and the summary of its run in memory; raises
        `EigencontactError`.
    sources : sequence of ErrorSource, optional
        By default those of the plan.

    Returns
    -------
    Accuracy
        A source that no coarser run could vary is listed with its reason and is in no bar.

    Notes
    -----
    The cells of the grid become larger in two runs; see `eigencontact.accuracy.sources`. Every other source is varied
    by itself on the coarsest of these grids that could be solved, whose error from this source stands for that of the
    run. The errors of all sources are added. They do not contain errors of the model: half-space, small strain, laws.
    """
    began = perf_counter()
    tables = plan.scene.resolved()
    base_tables, base_plan, base = tables, plan, summary
    parts: dict[str, dict[str, Estimate]] = {}
    slow = {warning["number"]: warning for warning in summary["warnings"] if warning.get("number")}
    left_out = {name: warning["words"] for name, warning in slow.items() if warning["order"] == 0.0}
    names = [name for name, _ in _results(summary) if name not in left_out]
    orders = {name: warning["order"] for name, warning in slow.items()}
    runs = 0
    for source in error_sources(plan) if sources is None else sources:
        start = (base_tables, base_plan, base) if source.on_coarse else (tables, plan, summary)
        others: list[tuple[float, Mapping[str, Any]]] = []
        for variation in source.variations(start[1]):
            varied = changed(start[0], variation.changes)
            try:
                coarse_plan, coarse = solve(varied, f"{source.name}, step size times {variation.ratio:.3g}")
            except EigencontactError as problem:
                left_out[source.name] = " ".join(str(problem).split())
                break
            runs += 1
            # the planner rounds the number of cells: the ratio is that of the edges
            ratio = variation.ratio if source.on_coarse else _edge(coarse_plan) / _edge(plan)
            if ratio == 1.0:
                left_out[source.name] = "the grid cannot be coarser"
                break
            others.append((ratio, coarse))
            if not source.on_coarse:
                base_tables, base_plan, base = varied, coarse_plan, coarse
        if others:
            left_out.pop(source.name, None)
            known = {} if source.on_coarse else orders
            parts[source.name] = dict(_estimates(names, start[2], others, source, known))
    bars = _joined(names, summary, parts)
    return Accuracy(bars=bars, left_out=left_out, runs=runs, seconds=perf_counter() - began)


def _edge(plan: Plan) -> float:
    """Edge of the cells, both directions alike."""
    return float((plan.grid.dx * plan.grid.dy) ** 0.5)


def _results(summary: Mapping[str, Any]) -> Iterator[tuple[str, float]]:
    """Name and value of the results in a summary."""
    for name, number in summary["numbers"].items():
        value = summary.get(name, summary["observed"].get(name))
        if number["role"] == "result" and isinstance(value, int | float):
            yield name, float(value)


def _estimates(
    names: Sequence[str],
    summary: Mapping[str, Any],
    others: Sequence[tuple[float, Mapping[str, Any]]],
    source: ErrorSource,
    orders: Mapping[str, float],
) -> Iterator[tuple[str, Estimate]]:
    """Estimates of one source, by name of the number; a number that a coarser run lacks has none.

    `orders` are those of numbers that converge more slowly than the source tells.
    """
    value_of = dict(_results(summary))
    values = [(ratio, dict(_results(coarse))) for ratio, coarse in others]
    for name in names:
        pairs = [(ratio, coarse[name]) for ratio, coarse in values if name in coarse]
        if pairs and name in value_of:
            lowest, highest = (orders[name],) * 2 if name in orders else (source.lowest, source.highest)
            scatters = bool(summary["numbers"][name].get("scatters"))
            yield name, estimate(value_of[name], pairs, lowest, highest, scatters=scatters)


def _joined(
    names: Sequence[str], summary: Mapping[str, Any], parts: Mapping[str, Mapping[str, Estimate]]
) -> dict[str, ErrorBar]:
    """Bar of each number from its parts."""
    bars, value_of = {}, dict(_results(summary))
    for name in names:
        own = {source: estimates[name] for source, estimates in parts.items() if name in estimates}
        if not own:
            continue
        largest = max(own, key=lambda source: own[source].error)
        bars[name] = ErrorBar(
            value=value_of[name], error=sum(part.error for part in own.values()), source=largest,
            order=own[largest].order, parts={source: part.error for source, part in own.items()},
        )  # fmt: skip
    return bars
