"""Driving a plan through its load history; each accepted step is handed on at once."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Protocol

from eigencontact.execution.block import Block
from eigencontact.execution.loading import (
    LoadHistory,
    LoadPoint,
    control_at,
    start_of_ramp,
    tangential_control_at,
)
from eigencontact.execution.step import Step
from eigencontact.results.records import StepRecord
from eigencontact.scene.schema import Scene

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


class Drivable(Protocol):
    """What is driven: a plan."""

    @property
    def scene(self) -> Scene:
        """With the load history."""
        ...

    @property
    def steps(self) -> int:
        """Number of load steps, by estimate where cycles are skipped."""
        ...

    @property
    def blocks(self) -> Sequence[Block]:
        """In order of execution."""
        ...


def drive(
    plan: Drivable,
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
    friction, contact = plan.scene.friction is not None, bool(plan.scene.geometry)
    history, total = LoadHistory(plan.scene.steps, friction=friction), plan.steps
    started = False
    ramp_start: dict[str, float] = {}
    last: StepRecord | None = None
    before: LoadPoint | None = None
    while (point := history.after(before, cycles=_stands_for(last))) is not None:
        if history.begins_ramp(point) and last is not None:
            ramp_start = start_of_ramp(last.scalars, history.ramp_before(point) if friction else None)
        if point.index in done:
            last, before = done[point.index](), point
            continue
        if not started:
            for block in plan.blocks:
                block.start()
            started = True
        if watcher is not None:
            watcher.step_started(point, max(total, point.index))
        ramp = history.ramp(point)
        step = Step(
            index=point.index,
            time=point.time,
            control=control_at(ramp, point.fraction, ramp_start) if contact else None,
            tangential=tangential_control_at(ramp, point.fraction, ramp_start) if friction else None,
            travel=history.travel(point),
            cycle=history.cycle(point),
            slide=history.slide(point, before),
            previous=last,
            progress=None if watcher is None else watcher.iterated,
        )
        for block in plan.blocks:
            block.advance(step)
        last, before = step.record(), point
        yield last
        if watcher is not None:
            watcher.step_finished(last, max(total, point.index))


def _stands_for(last: StepRecord | None) -> int:
    """Cycles that the last one stands for, where it has been decided."""
    return 1 if last is None else int(last.scalars.get("jump_cycles", 1.0))
