"""Sequence of runs from a pilot run on few cells to a run whose error bars meet the targets."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from math import log
from time import perf_counter
from typing import TYPE_CHECKING, Any

from eigencontact.accuracy.bars import Accuracy, Run
from eigencontact.accuracy.changes import changed, refined_window
from eigencontact.accuracy.levers import Refinement, cheapest, levers_of
from eigencontact.accuracy.runs import Runs, edge_of, memory_of
from eigencontact.accuracy.targets import Targets, check_names, is_field, targets_of, variable_of
from eigencontact.core.memory import machine_bytes
from eigencontact.core.numbers import ErrorBar
from eigencontact.core.units import readable, time_in_words
from eigencontact.errors import EigencontactError, SceneError
from eigencontact.model.resolution import cells_per_radius
from eigencontact.model.sizes import MEMORY_SHARE

if TYPE_CHECKING:
    from eigencontact.accuracy.fields import FieldErrors
    from eigencontact.planning.plan import Plan
    from eigencontact.scene.accuracy import Accuracy as Table

__all__ = ["DEFAULT_TIME", "Answer", "Rung", "pilot_cells", "pilot_tables", "pursue"]

#: Cells per contact radius of the pilot, and its least number of cells each way: fewer do not resolve a region.
_PILOT, _FEWEST = 12.0, 16
#: The pilot has twice these cells where it takes at most this factor more time, with the part of the time of a run that
#: no price predicts [s].
_DEARER, _UNPRICED = 1.25, 0.08
#: Least part of the cells of a prescribed window in the pilot: fewer do not resolve a measured surface.
_WINDOW = 0.5
#: Largest number of rungs, and of attempts at a pilot, which becomes finer if it is refused.
_RUNGS, _TRIES = 7, 3
#: Relative decrease of the errors beyond the targets below which a rung is futile.
_FALL = 0.1
#: Part of each target below which the errors of a source stay for finer cells, without new coarser runs.
_LITTLE = 0.1
#: Bounds of the predicted time of the coarser runs of the next rung, relative to the time of the rung.
_BARS = (0.4, 1.5)
#: Time limit of a pursuit if the scene gives none [s].
DEFAULT_TIME = 600.0
#: Least ratio of the cells of two rungs that give an order, and the bounds of this order.
_APART, _ORDERS = 1.2, (1.0, 2.0)


@dataclass(frozen=True, kw_only=True)
class Rung:
    """One run of the sequence, with its targets and the error bars of numbers and fields with a target."""

    run: Run
    tables: Mapping[str, Any]
    seconds: float
    accuracy: Accuracy
    targets: Targets
    bars: Mapping[str, ErrorBar]
    fields: FieldErrors | None = None

    @property
    def holds(self) -> bool:
        """Whether the error bars meet all targets."""
        return self.targets.hold(self.bars)

    @property
    def excess(self) -> float:
        """Errors beyond the targets."""
        return self.targets.excess({name: self.bars[name].error for name in self.targets.allowed})

    def to_dict(self) -> dict[str, Any]:
        """Settings, time and bars as plain data."""
        plan = self.run.plan
        return {
            "cells": [plan.grid.nx, plan.grid.ny],
            "spacing": [float(plan.grid.dx), float(plan.grid.dy)],
            "load_steps": plan.steps,
            "tolerance": plan.numerics.tolerance,
            "inclusion_refinement": plan.numerics.refinement,
            "seconds": self.seconds,
            "error_seconds": self.accuracy.seconds,
            "errors": {name: self.bars[name].error for name in self.targets.allowed},
        }


@dataclass(frozen=True, kw_only=True)
class Answer:
    """Finest run of the sequence, and the runs before it.

    Attributes
    ----------
    rungs : list of Rung
        In order; the last one is the answer.
    runs : Runs
        All runs, the coarser ones too.
    seconds : float
        Wall time of all [s].
    stopped : str
        Reason of the end if targets were not reached; otherwise empty.
    required : Refinement, optional
        Refinement of the answer that would reach them, in its time and memory.
    """

    rungs: list[Rung]
    runs: Runs
    seconds: float
    stopped: str = ""
    required: Refinement | None = None

    @property
    def last(self) -> Rung:
        """The finest run."""
        return self.rungs[-1]

    def to_dict(self) -> dict[str, Any]:
        """Plain data for ``summary.json``."""
        last = self.last
        contents: dict[str, Any] = {
            "reached": last.holds,
            "targets": last.targets.to_dict(last.bars),
            "left_out": last.targets.left_out,
            "rungs": [rung.to_dict() for rung in self.rungs],
            "runs": self.runs.solved,
            "reused": self.runs.reused,
            "seconds": self.seconds,
            "stopped": self.stopped,
        }
        if self.required is not None:
            contents["more"] = {
                "seconds": self.required.seconds * last.seconds,
                "memory": self.required.memory * memory_of(last.run.plan),
                "factors": self.required.factors,
                "holds": self.required.holds,
            }
        return {**last.accuracy.to_dict(), "accuracy": contents}


def pilot_cells(plan: Plan, make: Callable[[Mapping[str, Any]], Plan]) -> float:
    """Cells per contact radius of the first run: twice as many where more cells cost little."""
    try:
        coarse_seconds, fine_seconds = (make(pilot_tables(plan, cells)).seconds for cells in (_PILOT, 2.0 * _PILOT))
    except EigencontactError:  # the run itself is refused, or tried with more cells
        return _PILOT
    return 2.0 * _PILOT if fine_seconds + _UNPRICED <= _DEARER * (coarse_seconds + _UNPRICED) else _PILOT


def pilot_tables(plan: Plan, cells: float = _PILOT) -> dict[str, Any]:
    """Tables of the first run: the scene with few cells, which may be coarser than `allow-coarse` permits.

    The window is that of the plan, so that finer runs need not search it.
    """
    spec, expected = plan.scene.grid, plan.model.window.expected
    if spec.automatic and plan.scene.geometry:
        factor = cells / spec.cells_per_contact_radius
    else:
        share = _WINDOW if expected is None else cells / max(cells_per_radius(expected, plan.grid), 1e-9)
        factor = max(share, _WINDOW, _FEWEST / min(plan.grid.counts))
    tables = plan.scene.resolved()
    output = {**tables["output"], "errors": False}
    coarse = {"grid": refined_window(plan, min(1.0, factor), keep_parity=True)[0], "numerics": {"allow-coarse": True}}
    return changed(tables, coarse) | {"output": output}


@dataclass
class _Course:
    """State of a sequence of runs."""

    table: Table
    runs: Runs
    began: float = field(default_factory=perf_counter)

    @property
    def remaining_time(self) -> float:
        """Remaining time [s]."""
        return (self.table.time or DEFAULT_TIME) - (perf_counter() - self.began)

    @property
    def memory(self) -> float:
        """Memory that a run may take [bytes]."""
        return self.table.memory or MEMORY_SHARE * machine_bytes()

    def rung_of(self, tables: Mapping[str, Any], solved: tuple[Run, float, Accuracy, FieldErrors | None]) -> Rung:
        """Solved run with its targets."""
        run, seconds, accuracy, fields = solved
        bars = dict(accuracy.bars)
        for name in self.table.targets:
            if fields is not None and is_field(name) and (bar := fields.bar(variable_of(name))) is not None:
                bars[name] = bar
        targets = targets_of(self.table, run.summary, accuracy, bars)
        return Rung(
            run=run, tables=tables, seconds=seconds, accuracy=accuracy, targets=targets, bars=bars, fields=fields
        )

    def pilot(self, plan: Plan) -> Rung:
        """First run; a finer run if the cells of the first are refused as too coarse."""
        cells = pilot_cells(plan, self.runs.make)
        for attempt in range(_TRIES):
            tables = pilot_tables(plan, cells * 2.0**attempt)
            try:
                planned = self.runs.make(tables)
                self.refuse_pilot(planned)
                solved = self.runs.rung(planned, "pilot")
            except EigencontactError:
                if attempt == _TRIES - 1:
                    raise
            else:
                return self.rung_of(tables, solved)
        raise AssertionError

    def refuse_pilot(self, plan: Plan) -> None:
        """Refuse a budget that the first run exceeds."""
        time, memory = self.table.time, self.table.memory
        for key, budget, need in (("time", time, plan.seconds), ("memory", memory, memory_of(plan))):
            if budget is not None and need > budget:
                texts = [time_in_words(value) if key == "time" else readable(value, "B") for value in (need, budget)]
                raise SceneError(f'accuracy.{key} must be at least "{texts[0]}" for the first run (got "{texts[1]}")')

    def next_refinement(self, rungs: Sequence[Rung]) -> tuple[Refinement, Refinement | None]:
        """Next refinement, and the refinement that reaches all targets if it exceeds the budget.

        The next refinement leaves out numbers that need more than the budget, by the orders that two rungs show.
        """
        rung, orders = rungs[-1], _orders(rungs)
        bars, targets = rung.bars, rung.targets
        levers = levers_of(rung.run.plan, self.runs.make)
        time = self.remaining_time / (
            rung.seconds + min(_BARS[1] * rung.seconds, max(_BARS[0] * rung.seconds, rung.accuracy.seconds))
        )
        memory = max(0.0, self.memory - self.runs.memory_of_results) / max(memory_of(rung.run.plan), 1.0)
        required = cheapest(levers, bars, targets, orders=orders, far=True)
        affordable = required.seconds <= time and required.memory <= memory and required.holds
        if not affordable and len(rungs) > 1:
            refinements = {
                name: cheapest(levers, bars, targets.only([name]), orders=orders, far=True) for name in targets.allowed
            }
            targets = targets.only(
                name
                for name, refinement in refinements.items()
                if refinement.holds and refinement.seconds <= time and refinement.memory <= memory
            )
        next_refinement = cheapest(levers, bars, targets, orders=orders, time=time, memory=memory)
        return next_refinement, None if affordable else required


def _orders(rungs: Sequence[Rung]) -> dict[str, float]:
    """Orders of convergence with the cells, for numbers without one in a run: from a warning, or from two runs."""
    last = rungs[-1]
    slow = {w["number"]: float(w["order"]) for w in last.run.summary["warnings"] if w.get("number")}
    if len(rungs) < 2:
        return slow
    finer = edge_of(rungs[-2].run.plan) / edge_of(last.run.plan)
    observed = dict[str, float]()
    for name, bar in last.bars.items():
        previous = rungs[-2].bars.get(name)
        errors = (0.0 if previous is None else previous.parts.get("cells", 0.0), bar.parts.get("cells", 0.0))
        if bar.order is None and finer > _APART and min(errors) > 0.0:
            observed[name] = min(_ORDERS[1], max(_ORDERS[0], log(errors[0] / errors[1]) / log(finer)))
    return observed | slow


def pursue(plan: Plan, table: Table, runs: Runs) -> Answer:
    """Refine a scene, from a pilot run on, until its numbers have the prescribed accuracy.

    Parameters
    ----------
    plan : Plan
        Of the scene as it is.
    table : Accuracy
        Targets and budget.
    runs : Runs
        Plans and solves.

    Raises
    ------
    SceneError
        A target that no cells can reach, or a budget below the first run.
    EigencontactError
        The first run fails.
    """
    check_names(table, plan)
    course = _Course(table, runs)
    rungs, stopped, futile_rungs = [course.pilot(plan)], "", 0
    required: Refinement | None = None
    while not rungs[-1].holds and not stopped:
        last = rungs[-1]
        refinement, required = course.next_refinement(rungs)
        if not refinement.factors:
            stopped = "the rest needs more than the budget of time or memory" if required else "no setting can be finer"
        elif len(rungs) == _RUNGS:
            stopped = f"{_RUNGS} runs of growing fineness did not reach the targets"
        else:
            tables = refinement.changes(last.run.plan, last.tables)
            try:
                solved = runs.rung(
                    runs.make(tables), _words(refinement), refined=refinement.factors, small=_small(last)
                )
            except EigencontactError as problem:
                stopped = " ".join(str(problem).split())
                continue
            rungs.append(course.rung_of(tables, solved))
            futile_rungs = futile_rungs + 1 if rungs[-1].excess > (1.0 - _FALL) * last.excess else 0
            if futile_rungs == 2 and not rungs[-1].holds:
                stopped = "the errors no longer fall"
    seconds = perf_counter() - course.began
    return Answer(rungs=rungs, runs=runs, seconds=seconds, stopped=stopped, required=required if stopped else None)


def _small(rung: Rung) -> list[str]:
    """Sources whose errors are small in every number with a target."""
    bars = {name: rung.bars[name].parts for name in rung.targets.allowed}
    return [
        source
        for source in rung.accuracy.runs_by_source
        if all(bars[name].get(source, 0.0) <= _LITTLE * limit for name, limit in rung.targets.allowed.items())
    ]


def _words(refinement: Refinement) -> str:
    """Refinement in words."""
    return ", ".join(f"{name} {factor:.3g} times finer" for name, factor in refinement.factors.items())
