"""Predicted cost of error bars and of a run to an accuracy, from plans and known orders, without a solution."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

from eigencontact.accuracy.bars import CoarserRuns, Run, SourceRuns
from eigencontact.accuracy.levers import cheapest, levers_of
from eigencontact.accuracy.pursuit import DEFAULT_TIME, pilot_cells, pilot_tables
from eigencontact.accuracy.runs import memory_of
from eigencontact.accuracy.sources import error_sources
from eigencontact.accuracy.targets import Targets, check_names
from eigencontact.core.numbers import ErrorBar
from eigencontact.core.units import readable, time_in_words
from eigencontact.model.resolution import cells_per_radius, pressure_error
from eigencontact.planning.memory import results_bytes

if TYPE_CHECKING:
    from eigencontact.planning.plan import Plan
    from eigencontact.scene.accuracy import Accuracy as Table

__all__ = ["bars_text", "cost_of_bars", "forecast", "forecast_text"]

#: Errors of the first run, in times of the target, for which the cost is predicted.
_EXCESS = (2.0, 5.0, 20.0)
#: Known orders of pressures and displacements, and of areas and other numbers that scatter.
_ORDERS = (2.0, 1.0)


def cost_of_bars(plan: Plan, make: Callable[[Mapping[str, Any]], Plan]) -> dict[str, Any]:
    """Number of the coarser runs of error bars, their time [s] and their memory [bytes].

    All runs that a source may take are counted. Their results stay in memory until the errors of fields are known.
    """
    coarser = CoarserRuns(Run(plan, {}), lambda tables, _: Run(make(tables), {}))
    runs_by_source = dict[str, SourceRuns]()
    for source in error_sources(plan):
        runs, _ = coarser.vary(source, runs_by_source)
        if runs.coarser_runs:
            runs_by_source[source.name] = runs
    plans = [run.plan for run in coarser.runs]
    arrays = max((float(coarse.cost.peak) for coarse in plans), default=0.0)
    return {
        "runs": len(plans),
        "seconds": sum(coarse.seconds for coarse in plans),
        "memory": arrays + sum(results_bytes(coarse) for coarse in plans),
    }


def bars_text(cost: Mapping[str, Any], plan: Plan) -> str:
    """Cost of the error bars of a plan in words."""
    share = f", {cost['seconds'] / plan.seconds:.2g} times that of the run" if plan.seconds else ""
    price = f"{time_in_words(cost['seconds'])}{share}; {readable(cost['memory'], 'B')} of memory with all their results"
    return f"error bars\n  at most {cost['runs']} coarser runs, {price}"


def forecast(plan: Plan, table: Table, make: Callable[[Mapping[str, Any]], Plan]) -> dict[str, Any]:
    """Cost of the first run, of each source of error, and of finer runs by the ratio of its error to the target.

    Parameters
    ----------
    plan : Plan
        Of the scene as it is.
    table : Accuracy
        Targets and budget.
    make : callable
        Tables to their plan.

    Returns
    -------
    dict
        Times [s] and memory [bytes], as the plans predict them; plain data. The memory is that of the arrays and of the
        results of all load steps, which stay in memory until the end.
    """
    check_names(table, plan)
    tables = pilot_tables(plan, pilot_cells(plan, make))
    pilot = make(tables)
    levers = levers_of(pilot, make)
    coarser = cost_of_bars(pilot, make)
    cells = [lever for lever in levers if lever.source.name == "cells"]
    finer = []
    for excess in _EXCESS if cells else ():
        sizes = []
        for order in _ORDERS:
            bar = ErrorBar(value=1.0, error=excess, source="cells", order=order, parts={"cells": excess})
            refinement = cheapest(cells, {"any": bar}, Targets(allowed={"any": 1.0}), far=True)
            sizes.append(_size(make(refinement.changes(pilot, tables))))
        finer.append({"excess": excess, "least": sizes[0], "most": sizes[1]})
    expected = pilot.model.window.expected
    return {
        "targets": ({} if table.numbers is None else {"numbers": table.numbers}) | table.targets,
        "time": table.time or DEFAULT_TIME,
        "memory": table.memory,
        "first": {**_size(pilot), "runs": 1 + coarser["runs"], "coarser": coarser},
        "pressure_error": None if expected is None else pressure_error(cells_per_radius(expected, pilot.grid)),
        "sources": {
            lever.source.name: {"factor": lever.source.stride, "seconds": lever.seconds, "memory": lever.memory}
            for lever in levers
        },
        "finer": finer,
    }


def _size(plan: Plan) -> dict[str, Any]:
    cells = [plan.grid.nx, plan.grid.ny]
    return {"cells": cells, "load_steps": plan.steps, "seconds": plan.seconds, "memory": memory_of(plan)}


def forecast_text(prediction: Mapping[str, Any]) -> str:
    """Forecast in words."""
    targets = ", ".join(
        f"{'all main results' if name == 'numbers' else name} {target}"
        for name, target in prediction["targets"].items()
    )
    first, coarser = prediction["first"], prediction["first"]["coarser"]
    lines = [
        "accuracy asked for",
        f"  targets: {targets}; at most {time_in_words(prediction['time'])}",
        f"  first run: {_words(first)}; at most {coarser['runs']} coarser runs, {_price(coarser)}",
    ]
    if prediction["pressure_error"] is not None:
        lines.append(f"  there the largest pressure is known to {100 * prediction['pressure_error']:.2g} % or better")
    for name, price in prediction["sources"].items():
        factor = price["factor"]
        time, memory = factor ** price["seconds"], factor ** price["memory"]
        lines.append(
            f"  {name}: {factor:g} times finer takes {time:.2g} times the time and {memory:.2g} times the memory"
        )
    lines += [
        f"  if its error is {row['excess']:g} targets: {_words(row['least'])}, to {_words(row['most'])}"
        for row in prediction["finer"]
    ]
    return "\n".join([*lines, "  less for pressures, most for areas; its error bars decide"])


def _words(row: Mapping[str, Any]) -> str:
    nx, ny = row["cells"]
    return f"{nx} x {ny} cells, {row['load_steps']} step{'s' if row['load_steps'] != 1 else ''}, {_price(row)}"


def _price(row: Mapping[str, Any]) -> str:
    return f"{time_in_words(row['seconds'])}, {readable(float(row['memory']), 'B')}"
