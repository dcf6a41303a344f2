"""Load history: the ramps and cycles of a scene as a sequence of controls."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from math import hypot

from eigencontact.core.bulk import NO_BULK
from eigencontact.execution.blocks.step import CyclePlace
from eigencontact.execution.blocks.surface import Slide
from eigencontact.scene.holding import held_bulk, held_steps, held_travel
from eigencontact.scene.spacing import normal_control, spaced_by_radius, start_of_normal
from eigencontact.scene.steps import Segment, Step, ramps_of, segments_of
from eigencontact.solvers.contact_growth import ContactGrowth
from eigencontact.solvers.control import MODES, Control
from eigencontact.solvers.tangential.control import MODES as TANGENTIAL_MODES
from eigencontact.solvers.tangential.control import TangentialControl

__all__ = ["LoadHistory", "LoadPoint", "control_at", "start_of_ramp", "tangential_control_at"]

#: Starts and ends of the increments as fractions of a ramp; None for equal increments.
Ends = tuple[float, ...] | None


@dataclass(frozen=True, slots=True)
class LoadPoint:
    """One increment.

    Attributes
    ----------
    index : int
        Number among the solved increments, from 1.
    time : float
        Position in the history with all cycles expanded: time 1 is the end of the first ramp.
    ramp, number : int
        Number of the ramp, where repetitions do not count, and number of the increment in it, from 1.
    fraction, before : float
        Fractions of the ramp at the end and at the start of the increment.
    segment : Segment
        Cycle or plain step that contains it.
    cycle : int
        Number of the repetition, from 1.
    skipped : int
        Number of skipped cycles between the previous point and this one.
    """

    index: int
    time: float
    ramp: int
    number: int
    before: float
    fraction: float
    segment: Segment
    cycle: int = 1
    skipped: int = 0

    @property
    def ends_cycle(self) -> bool:
        """Whether the point is the last of its cycle."""
        return self.fraction == 1.0 and self.ramp == self.segment.first + self.segment.ramps - 1


class LoadHistory:
    """Increments of a load history in order; the number of skipped cycles may depend on results.

    Parameters
    ----------
    steps : sequence of Step
        Steps of a scene.
    friction : bool
        Whether values without a prescription keep their value from earlier steps.
    growth : ContactGrowth, optional
        Growth of the contact radius; without it all increments are equal in the loads.
    bulk : mapping of str to float, optional
        Bulk stress before the first step [Pa], by name; zero if only steps prescribe it.
    """

    def __init__(
        self, steps: Sequence[Step], *, friction: bool, growth: ContactGrowth | None = None,
        bulk: Mapping[str, float] = NO_BULK,
    ) -> None:  # fmt: skip
        self._segments, ramps = segments_of(steps), ramps_of(steps)
        self._ramps = held_steps(ramps) if friction else ramps
        self._places = held_travel(ramps)
        self._bulk_at_rest, self._bulk = dict(bulk), held_bulk(ramps, bulk)
        graded = (frozenset[int](), frozenset[int]()) if growth is None else spaced_by_radius(steps, friction=friction)
        self._ends = _ends_of_increments(growth, self._ramps, graded[0])
        # From the second cycle on, values without a prescription keep their value from the end of the previous cycle.
        self._repeated: dict[int, tuple[Step, tuple[float, float], Ends, dict[str, float]]] = {}
        for segment in self._segments:
            cycle = ramps[segment.first : segment.first + segment.ramps]
            if segment.repeat > 1:
                twice = [*ramps[: segment.first], *cycle, *cycle]
                held_ramps, places = held_steps(twice) if friction else twice, held_travel(twice)
                ends = _ends_of_increments(growth, held_ramps, {place + len(cycle) for place in graded[1]})
                repeated = list(zip(held_ramps, places, ends, held_bulk(twice, bulk), strict=True))[-len(cycle) :]
                self._repeated |= dict(enumerate(repeated, segment.first))

    def after(self, point: LoadPoint | None, *, cycles: int = 1) -> LoadPoint | None:
        """Next increment; None at the end. `cycles` is the number of cycles that a finished cycle represents."""
        if point is None:
            return self._at(1, self._segments[0], 1, self._segments[0].first, 1, 0)
        segment = point.segment
        if point.number < self._ramps[point.ramp].increments:
            return self._at(point.index + 1, segment, point.cycle, point.ramp, point.number + 1, 0)
        if not point.ends_cycle:
            return self._at(point.index + 1, segment, point.cycle, point.ramp + 1, 1, 0)
        if point.cycle < segment.repeat:
            cycle = min(point.cycle + max(1, cycles), segment.repeat)
            return self._at(point.index + 1, segment, cycle, segment.first, 1, cycle - point.cycle - 1)
        place = self._segments.index(segment) + 1
        if place == len(self._segments):
            return None
        segment = self._segments[place]
        return self._at(point.index + 1, segment, 1, segment.first, 1, 0)

    def _at(self, index: int, segment: Segment, cycle: int, ramp: int, number: int, skipped: int) -> LoadPoint:
        count = self._ramps[ramp].increments
        ends = self._ends[ramp] if cycle == 1 else self._repeated[ramp][2]
        before, fraction = ((number - more) / count if ends is None else ends[number - more] for more in (1, 0))
        begin = sum(previous.ramps * previous.repeat for previous in self._segments[: self._segments.index(segment)])
        time = begin + (cycle - 1) * segment.ramps + (ramp - segment.first) + fraction
        return LoadPoint(index, float(time), ramp, number, before, fraction, segment, cycle, skipped)

    def ends_of_cycle_before(self, point: LoadPoint) -> list[LoadPoint]:
        """Ends of the ramps of the previous cycle, each reached in one increment.

        The first point counts the previous cycle and all cycles skipped before `point` as skipped. The list is empty if
        every ramp slides the whole contact: the contact then has no memory of earlier motion.
        """
        segment, ends = point.segment, list[LoadPoint]()
        places = range(segment.first, segment.first + segment.ramps)
        if all(self._ramps[place].slides for place in places):
            return []
        for place in places:
            last = self._at(point.index, segment, point.cycle - 1, place, self._ramps[place].increments, 0)
            ends.append(replace(last, skipped=point.skipped if place == segment.first else 0))
        return ends

    def begins_ramp(self, point: LoadPoint) -> bool:
        """Whether the point is the first increment of its ramp."""
        return point.number == 1

    def ramp(self, point: LoadPoint) -> Step:
        """Ramp of a point with all prescribed values at its end; with friction it includes values of earlier ramps."""
        return self._ramps[point.ramp] if point.cycle == 1 else self._repeated[point.ramp][0]

    def ramp_before(self, point: LoadPoint) -> Step | None:
        """Ramp before that of a point; None at the start."""
        segment = point.segment
        if point.ramp > segment.first:
            return self._ramps[point.ramp - 1] if point.cycle == 1 else self._repeated[point.ramp - 1][0]
        if point.cycle == 1:
            return self._ramps[point.ramp - 1] if point.ramp else None
        return self._repeated[self._before_again(point)][0]

    def cycle(self, point: LoadPoint) -> CyclePlace | None:
        """Position of a point in its cycle; None in a plain step."""
        segment = point.segment
        if not segment.cycle:
            return None
        begins = point.ramp == segment.first and (self.begins_ramp(point) or point.skipped > 0)
        return CyclePlace(
            number=point.cycle, skipped=point.skipped, repeats_after=segment.repeat - point.cycle, begins=begins,
            ends=point.ends_cycle,
        )  # fmt: skip

    def slide(self, point: LoadPoint, before: LoadPoint | None) -> Slide | None:
        """Sliding path of the whole contact, prescribed or by the motion of the geometry."""
        ramp = self.ramp(point)
        if ramp.sliding_distance is not None:
            along = (0.0, 1.0) if ramp.sliding_direction == "y" else (1.0, 0.0)
            even = (self._ends[point.ramp] if point.cycle == 1 else self._repeated[point.ramp][2]) is None
            share = 1.0 / ramp.increments if even else point.fraction - point.before
            return Slide(distance=ramp.sliding_distance * share, direction=along)
        if before is None:
            return None
        (x0, y0), (x1, y1) = self.travel(before), self.travel(point)
        distance = hypot(x1 - x0, y1 - y0)
        return Slide(distance=distance, direction=((x1 - x0) / distance, (y1 - y0) / distance)) if distance else None

    def travel(self, point: LoadPoint) -> tuple[float, float]:
        """Position (x, y) of the geometry [m] at a point; a ramp starts at the end of the previous one."""
        end = self._places[point.ramp] if point.cycle == 1 else self._repeated[point.ramp][1]
        if point.fraction == 1.0:
            return end
        if point.cycle > 1:
            start = self._repeated[self._before_again(point)][1]
        else:
            start = self._places[point.ramp - 1] if point.ramp else (0.0, 0.0)
        (x0, y0), (x1, y1) = start, end
        return x0 + point.fraction * (x1 - x0), y0 + point.fraction * (y1 - y0)

    def bulk(self, point: LoadPoint) -> dict[str, float]:
        """Bulk stress [Pa] at a point, by name; a ramp starts at the end of the previous one."""
        end = self._bulk[point.ramp] if point.cycle == 1 else self._repeated[point.ramp][3]
        if point.fraction == 1.0:
            return end
        if point.cycle > 1:
            start = self._repeated[self._before_again(point)][3]
        else:
            start = self._bulk[point.ramp - 1] if point.ramp else self._bulk_at_rest
        return {name: start[name] + point.fraction * (value - start[name]) for name, value in end.items()}

    @property
    def bulk_at_rest(self) -> dict[str, float]:
        """Bulk stress [Pa] before the first step, by name."""
        return self._bulk_at_rest

    @staticmethod
    def _before_again(point: LoadPoint) -> int:
        """Previous ramp of a point in a repeated cycle."""
        segment = point.segment
        return point.ramp - 1 if point.ramp > segment.first else segment.first + segment.ramps - 1


def _ends_of_increments(growth: ContactGrowth | None, ramps: Sequence[Step], graded: Collection[int]) -> list[Ends]:
    """Starts and ends of the increments of ramps, as fractions; None for increments equal in the loads."""
    out: list[Ends] = [None] * len(ramps)
    for place in graded:
        control = None if place >= len(ramps) else normal_control(ramps[place])
        if growth is not None and control is not None:
            begin = start_of_normal(ramps[place - 1] if place else None, control) or 0.0
            out[place] = (0.0, *growth.parts(control, begin, getattr(ramps[place], control), ramps[place].increments))
    return out


def start_of_ramp(scalars: Mapping[str, float], last: Step | None) -> dict[str, float]:
    """Start values of a ramp: those of the last step, or the prescribed values with friction.

    A solved load differs from the prescribed one by the tolerance; a constant load must not drift by that.

    Parameters
    ----------
    scalars : mapping of str to float
        Scalars of the last accepted step.
    last : Step or None
        Ramp of this step; None to take all values from the scalars.
    """
    names = [name for pair in (*MODES, *TANGENTIAL_MODES) for name in pair]
    prescribed = {} if last is None else {name: getattr(last, name) for name in names}
    return {**scalars, **{name: value for name, value in prescribed.items() if value is not None}}


def control_at(step: Step, fraction: float, before: Mapping[str, float]) -> Control:
    """Control within a ramp: linear between the start state and the prescribed values of the step.

    The step prescribes the controlled quantity (load or approach, moment or tilt). Its start value is the value of this
    quantity at the end of the previous ramp, prescribed or computed.
    """
    return Control(**_values(step, MODES, fraction, before))


def tangential_control_at(step: Step, fraction: float, before: Mapping[str, float]) -> TangentialControl:
    """Tangential control within a ramp; see `control_at`. A quantity without a prescription has zero displacement."""
    return TangentialControl(**_values(step, TANGENTIAL_MODES, fraction, before))


def _values(
    step: Step, modes: Sequence[tuple[str, str]], fraction: float, before: Mapping[str, float]
) -> dict[str, float]:
    values: dict[str, float] = {}
    for displacement, force in modes:
        for name in (force, displacement):
            target = getattr(step, name)
            if target is not None:
                begin = before.get(name, 0.0)
                values[name] = target if fraction == 1.0 else begin + fraction * (target - begin)
    return values
