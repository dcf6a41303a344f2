"""Predicted cost of a run to an accuracy, from the cost of each source and known orders, without a solution."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

from eigencontact.accuracy.levers import cheapest, levers_of
from eigencontact.accuracy.pursuit import DEFAULT_TIME, pilot_tables
from eigencontact.accuracy.sources import error_sources
from eigencontact.accuracy.targets import Targets, check_names
from eigencontact.core.numbers import ErrorBar
from eigencontact.core.units import readable, time_in_words
from eigencontact.model.resolution import cells_per_radius, pressure_error

if TYPE_CHECKING:
    from eigencontact.planning.plan import Plan
    from eigencontact.scene.accuracy import Accuracy as Table

__all__ = ["forecast", "forecast_text"]

#: Errors of the first run, in times of the target, for which the way is told.
_EXCESS = (2.0, 5.0, 20.0)
#: Known orders: of pressures and displacements, of areas and what scatters.
_ORDERS = (2.0, 1.0)


def forecast(plan: Plan, table: Table, make: Callable[[Mapping[str, Any]], Plan]) -> dict[str, Any]:
    """Cost of the first run, of each source of error, and of finer runs by the ratio of its error to the target.

    Parameters
    ----------
    plan : Plan
        Of the scene as it is.
    table : Accuracy
        What is asked for.
    make : callable
        Tables to their plan.

    Returns
    -------
    dict
        Times [s] and memory of arrays [bytes], as the plans predict them; plain data.
    """
    check_names(table, plan)
    tables = pilot_tables(plan)
    pilot = make(tables)
    levers = levers_of(pilot, make)
    runs = 1 + sum(len(source.variations(pilot)) for source in error_sources(pilot))
    cells = [lever for lever in levers if lever.source.name == "cells"]
    finer = []
    for excess in _EXCESS if cells else ():
        sizes = []
        for order in _ORDERS:
            bar = ErrorBar(value=1.0, error=excess, source="cells", order=order, parts={"cells": excess})
            way = cheapest(cells, {"any": bar}, Targets(allowed={"any": 1.0}), far=True)
            sizes.append(_size(make(way.changes(pilot, tables))))
        finer.append({"excess": excess, "least": sizes[0], "most": sizes[1]})
    expected = pilot.model.window.expected
    return {
        "targets": ({} if table.numbers is None else {"numbers": table.numbers}) | table.targets,
        "time": table.time or DEFAULT_TIME,
        "memory": table.memory,
        "first": {**_size(pilot), "runs": runs},
        "pressure_error": None if expected is None else pressure_error(cells_per_radius(expected, pilot.grid)),
        "sources": {
            lever.source.name: {"factor": lever.source.stride, "seconds": lever.seconds, "memory": lever.memory}
            for lever in levers
        },
        "finer": finer,
    }


def _size(plan: Plan) -> dict[str, Any]:
    cells = [plan.grid.nx, plan.grid.ny]
    return {"cells": cells, "load_steps": plan.steps, "seconds": plan.seconds, "memory": plan.cost.peak}


def forecast_text(told: Mapping[str, Any]) -> str:
    """Forecast in words."""
    targets = ", ".join(
        f"{'all main results' if name == 'numbers' else name} {target}" for name, target in told["targets"].items()
    )
    first = told["first"]
    lines = [
        "accuracy asked for",
        f"  targets: {targets}; at most {time_in_words(told['time'])}",
        f"  first run: {_words(first)}; with its coarser runs {first['runs']} runs",
    ]
    if told["pressure_error"] is not None:
        lines.append(f"  there the largest pressure is known to {100 * told['pressure_error']:.2g} % or better")
    for name, price in told["sources"].items():
        factor = price["factor"]
        time, memory = factor ** price["seconds"], factor ** price["memory"]
        lines.append(
            f"  {name}: {factor:g} times finer takes {time:.2g} times the time and {memory:.2g} times the memory"
        )
    lines += [
        f"  if its error is {row['excess']:g} targets: {_words(row['least'])}, to {_words(row['most'])}"
        for row in told["finer"]
    ]
    return "\n".join([*lines, "  less for pressures, most for areas; its error bars decide"])


def _words(row: Mapping[str, Any]) -> str:
    nx, ny = row["cells"]
    price = f"{time_in_words(row['seconds'])}, {readable(float(row['memory']), 'B')}"
    return f"{nx} x {ny} cells, {row['load_steps']} step{'s' if row['load_steps'] != 1 else ''}, {price}"
