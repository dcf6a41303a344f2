"""Driving a plan through its load history; each accepted step is handed on at once."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Protocol

from eigencontact.execution.history import (
    LoadPoint,
    control_at,
    load_points,
    ramps,
    start_of_ramp,
    tangential_control_at,
    travel_at,
)
from eigencontact.execution.runners import Runner, State, build_runner
from eigencontact.planning.blocks import Block
from eigencontact.planning.plan import Plan
from eigencontact.results.records import StepRecord

__all__ = ["Watcher", "drive"]


class Watcher(Protocol):
    """Sees the course of a run; all methods must be quick."""

    def step_started(self, point: LoadPoint, total: int) -> None:
        """Call before a load step is solved."""
        ...

    def iterated(self, text: str, residual: float, tolerance: float) -> None:
        """Call at each iteration of a solver."""
        ...

    def step_finished(self, record: StepRecord, total: int) -> None:
        """Call after a load step is accepted."""
        ...


def drive(
    plan: Plan,
    *,
    watcher: Watcher | None = None,
    done: Mapping[int, Callable[[], StepRecord]] | None = None,
) -> Iterator[StepRecord]:
    """Solve the load steps of a plan in order.

    Parameters
    ----------
    plan : Plan
        What to do.
    watcher : Watcher, optional
        Told of the course.
    done : mapping of int to callable
        Steps already stored, by number; each is read by its callable when its turn comes and not yielded again.

    Yields
    ------
    StepRecord
        Each newly accepted step.
    """
    done = done or {}
    steps, friction = ramps(plan.scene), plan.friction is not None
    points = load_points(steps)
    runners: list[Runner] | None = None
    ramp_start: dict[str, float] = {}
    last: StepRecord | None = None
    for point in points:
        if point.fraction <= 1.0 / steps[point.ramp].increments and last is not None:
            ramp_start = start_of_ramp(last.scalars, steps[point.ramp - 1] if friction else None)
        if point.index in done:
            last = done[point.index]()
            continue
        if runners is None:
            runners = [_runner(plan, group) for group in plan.groups]
        if watcher is not None:
            watcher.step_started(point, len(points))
        step = steps[point.ramp]
        state = State(
            index=point.index,
            time=point.time,
            control=control_at(step, point.fraction, ramp_start) if plan.geometries else None,
            tangential=tangential_control_at(step, point.fraction, ramp_start) if friction else None,
            travel=travel_at(steps, point),
            previous=last,
            progress=None if watcher is None else watcher.iterated,
        )
        for runner in runners:
            runner(state)
        last = StepRecord(
            index=point.index,
            time=point.time,
            scalars=state.scalars,
            fields={name: values for name, values in state.fields.items() if name != "separation"},
            regions=state.regions,
            observed=state.observed,
        )
        yield last
        if watcher is not None:
            watcher.step_finished(last, len(points))


def _runner(plan: Plan, group: tuple[Block, ...]) -> Runner:
    """Runner of one block, or of several that are solved together."""
    if len(group) == 1:
        return build_runner(plan, group[0])
    from eigencontact.execution.coupled import CoupledRunner

    return CoupledRunner(plan, [(block, build_runner(plan, block)) for block in group])
