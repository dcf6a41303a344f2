"""Error bars of all numbers of a run: coarser runs of the same scene, one part of the discretisation at a time."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
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


def error_bars(plan: Plan, summary: Mapping[str, Any], solve: Solve) -> Accuracy:
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

    Returns
    -------
    Accuracy
        A source that no coarser run could vary is listed with its reason and is in no bar.

    Notes
    -----
    The cells of the grid become 1.5 and 2 times larger. Every other source is varied by itself on the coarsest of these
    grids that could be solved, whose error from this source stands for that of the run. The errors of all sources are
    added. They do not contain errors of the model: half-space, small strain, laws.
    """
    began = perf_counter()
    tables = plan.scene.resolved()
    sizes = {"cells": _edge(plan)}
    base_tables, base_plan, base = tables, plan, summary
    parts: dict[str, dict[str, Estimate]] = {}
    left_out = {
        warning["number"]: warning["words"]
        for warning in summary["warnings"]
        if warning.get("number") and warning["order"] == 0.0
    }
    runs = 0
    for source in error_sources(plan):
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
            ratio = variation.ratio if source.on_coarse else _edge(coarse_plan) / sizes["cells"]
            if ratio == 1.0:
                break
            others.append((ratio, coarse))
            if not source.on_coarse:
                base_tables, base_plan, base = varied, coarse_plan, coarse
        if others:
            left_out.pop(source.name, None)
            parts[source.name] = dict(_estimates(start[2], others, source))
    return Accuracy(
        bars=_joined(summary, parts), left_out=left_out, runs=runs, seconds=perf_counter() - began
    )


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
    summary: Mapping[str, Any], others: list[tuple[float, Mapping[str, Any]]], source: ErrorSource
) -> Iterator[tuple[str, Estimate]]:
    """Estimates of one source, by name of the number; a number that a coarser run lacks has none."""
    values = [(ratio, dict(_results(coarse))) for ratio, coarse in others]
    slow = _slow(summary) if not source.on_coarse else {}
    for name, value in _results(summary):
        pairs = [(ratio, coarse[name]) for ratio, coarse in values if name in coarse]
        order = slow.get(name)
        if pairs and order != 0.0:
            scatters = bool(summary["numbers"][name].get("scatters"))
            yield name, estimate(value, pairs, order or source.lowest, order or source.highest, scatters=scatters)


def _slow(summary: Mapping[str, Any]) -> dict[str, float]:
    """Orders of the numbers that a warning says converge slowly, 0 for those that do not."""
    return {warning["number"]: warning["order"] for warning in summary["warnings"] if warning.get("number")}


def _joined(summary: Mapping[str, Any], parts: Mapping[str, Mapping[str, Estimate]]) -> dict[str, ErrorBar]:
    """Bar of each number from its parts."""
    bars = {}
    endless = {name for name, order in _slow(summary).items() if order == 0.0}
    for name, value in _results(summary):
        if name in endless:
            continue
        own = {source: estimates[name] for source, estimates in parts.items() if name in estimates}
        if not own:
            continue
        largest = max(own, key=lambda source: own[source].error)
        bars[name] = ErrorBar(
            value=value, error=sum(part.error for part in own.values()), source=largest, order=own[largest].order,
            parts={source: part.error for source, part in own.items()},
        )  # fmt: skip
    return bars
