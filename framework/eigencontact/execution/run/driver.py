"""Run a plan through its load history; each accepted step is yielded at once."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Protocol

from eigencontact.core.bulk import recorded_bulk
from eigencontact.core.stopwatch import Stopwatch
from eigencontact.errors import DomainTooSmall
from eigencontact.execution.blocks.block import Block, Run, Running
from eigencontact.execution.blocks.step import Step
from eigencontact.execution.blocks.surface import Surface
from eigencontact.execution.run.loading import (
    LoadHistory,
    LoadPoint,
    control_at,
    start_of_ramp,
    tangential_control_at,
)
from eigencontact.results.records import StepRecord
from eigencontact.scene.schema import Scene
from eigencontact.scene.step_messages import keys_of_scene
from eigencontact.scene.steps import Step as Ramp
from eigencontact.solvers.contact_growth import ContactGrowth

__all__ = ["Watcher", "drive"]


class Watcher(Protocol):
    """Observer of the progress of a run; its methods must be fast.

    Optional methods: ``step_took(seconds)`` receives the time [s] of each block by name before `step_finished`;
    ``announced(text)`` receives messages about work before and after the load steps.
    """

    def step_started(self, point: LoadPoint, total: int) -> None:
        """Call before a load step is solved."""
        ...

    def iterated(self, text: str, residual: float, tolerance: float) -> None:
        """Call at each iteration of a solver."""
        ...

    def step_finished(self, record: StepRecord, total: int) -> None:
        """Call after a load step is accepted."""
        ...


class _Plan(Protocol):
    """Parts of a plan for a run; see `eigencontact.planning.plan.Plan`."""

    @property
    def scene(self) -> Scene: ...
    @property
    def steps(self) -> int: ...
    @property
    def growth(self) -> ContactGrowth | None: ...
    @property
    def blocks(self) -> Sequence[Block]: ...


def drive(
    plan: _Plan,
    *,
    watcher: Watcher | None = None,
    stopwatch: Stopwatch | None = None,
    stored_steps: Mapping[int, Callable[[], StepRecord]] | None = None,
) -> Iterator[StepRecord]:
    """Solve the load steps of a plan in order.

    Parameters
    ----------
    plan : Plan
        Plan with the blocks.
    watcher : Watcher, optional
        Receives the progress of the run.
    stopwatch : Stopwatch, optional
        Receives the time of each block by its name, and the set-up time before the first step as ``set-up``.
    stored_steps : mapping of int to callable
        Stored steps by number. The driver calls the function of a step to read it, and does not yield the step again.

    Yields
    ------
    StepRecord
        Each newly accepted step.
    """
    stored_steps, course = stored_steps or {}, _Course(plan, watcher, stopwatch or Stopwatch())
    last: StepRecord | None = None
    before: LoadPoint | None = None
    while (point := course.history.after(before, cycles=_cycles_of(last, plan.blocks))) is not None:
        if point.index in stored_steps:
            course.passes(point, last)
            last, before = stored_steps[point.index](), point
            continue
        course.start()
        total = max(plan.steps, point.index)
        if watcher is not None:
            watcher.step_started(point, total)
        with keys_of_scene(plan.scene.steps, point.ramp, point.index):
            point, last = course.settled(point, last)
            course.passes(point, last)
            step = course.step(point, before, last)
            elapsed = course.advance(step)
        last, before = step.record(), point
        yield last
        report_times = getattr(watcher, "step_took", None)
        if report_times is not None:
            report_times(elapsed)
        if watcher is not None:
            watcher.step_finished(last, total)


class _Course:
    """Sequence of the steps of a plan.

    Attributes
    ----------
    history : LoadHistory
    """

    def __init__(self, plan: _Plan, watcher: Watcher | None, stopwatch: Stopwatch) -> None:
        self._plan, self._watcher, self._stopwatch = plan, watcher, stopwatch
        self._friction, self._contact = plan.scene.friction is not None, bool(plan.scene.geometry)
        self.history = LoadHistory(
            plan.scene.steps, friction=self._friction, growth=plan.growth, bulk=plan.scene.bulk_at_rest
        )
        self._running: list[tuple[Block, Running]] = []
        self._ramp_start: dict[str, float] = {}

    def start(self) -> None:
        """Start the blocks before the first solved step."""
        if not self._running:
            with self._stopwatch.on("set-up"):
                run = Run()
                self._running = [(block, run.started(block.start)) for block in self._plan.blocks]

    def advance(self, step: Step, *, settling: bool = False) -> dict[str, float]:
        """Advance all blocks by a step, or only those that take part in settling; returns the time of each [s]."""
        elapsed = dict[str, float]()
        for block, running in self._running:
            if settling and not block.settles:
                continue
            before = self._stopwatch.seconds.get(block.name, 0.0)
            with self._stopwatch.on(block.name):
                try:
                    running.advance(step)
                except DomainTooSmall as problem:
                    problem.step = step
                    raise
            elapsed[block.name] = self._stopwatch.seconds[block.name] - before
        return elapsed

    def passes(self, point: LoadPoint, last: StepRecord | None) -> None:
        """Store the start values of a ramp at its first point; `last` is the previous step."""
        if last is not None and self.history.begins_ramp(point):
            self._ramp_start = start_of_ramp(last.scalars, self._previous_ramp(point))

    def _previous_ramp(self, point: LoadPoint) -> Ramp | None:
        return self.history.ramp_before(point) if self._friction else None

    def step(self, point: LoadPoint, before: LoadPoint | None, last: StepRecord | None) -> Step:
        """Next step to compute."""
        ramp, begin = self.history.ramp(point), self._ramp_start
        return Step(
            index=point.index,
            time=point.time,
            control=control_at(ramp, point.fraction, begin) if self._contact else None,
            tangential=tangential_control_at(ramp, point.fraction, begin) if self._friction else None,
            travel=self.history.travel(point),
            bulk=(self.history.bulk_at_rest if last is None else recorded_bulk(last.scalars), self.history.bulk(point)),
            cycle=self.history.cycle(point),
            surface=Surface(slide=self.history.slide(point, before)),
            previous=last,
            progress=None if self._watcher is None else self._watcher.iterated,
        )

    def settled(self, point: LoadPoint, last: StepRecord | None) -> tuple[LoadPoint, StepRecord | None]:
        """Point without cycles to skip before it, and the state at the end of the last skipped cycle.

        The surfaces move by the wear of all skipped cycles at once. The transition to the new contact state causes slip
        that is not part of a regular cycle. The last skipped cycle is therefore solved with one increment per ramp, and
        not counted.
        """
        ends = self.history.ends_of_cycle_before(point) if point.skipped else []
        if last is None or not ends:
            return point, last
        fields = {name for block in self._plan.blocks for name in block.accumulated}
        counts = {name: last.fields[name] for name in fields}
        for ramp_end in ends:
            self.passes(ramp_end, last)
            step = self.step(ramp_end, None, last)
            assert step.cycle is not None
            step.cycle = replace(step.cycle, settling=True)
            self.advance(step, settling=True)
            last = step.record()
        last.fields.update(counts)
        return replace(point, skipped=0), replace(last, index=point.index - 1)


def _cycles_of(last: StepRecord | None, blocks: Sequence[Block]) -> int:
    """Number of cycles that the last step represents."""
    return 1 if last is None else max((block.cycles_of(last) for block in blocks), default=1)
