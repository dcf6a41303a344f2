"""The load history: ramps of a scene as a list of single controls."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from eigencontact.scene.holding import held_steps, held_travel
from eigencontact.scene.schema import Scene, Step
from eigencontact.solvers.control import MODES, Control
from eigencontact.solvers.tangential.control import MODES as TANGENTIAL_MODES
from eigencontact.solvers.tangential.control import TangentialControl

__all__ = ["LoadPoint", "control_at", "load_points", "ramps", "start_of_ramp", "tangential_control_at", "travel_at"]


@dataclass(frozen=True, slots=True)
class LoadPoint:
    """One increment: its number from 1, its place in the history, and where in its ramp it lies."""

    index: int
    time: float
    ramp: int
    fraction: float


def load_points(steps: Sequence[Step]) -> list[LoadPoint]:
    """Increments of all ramps in order."""
    points: list[LoadPoint] = []
    for ramp, step in enumerate(steps):
        for increment in range(1, step.increments + 1):
            fraction = increment / step.increments
            points.append(LoadPoint(len(points) + 1, ramp + fraction, ramp, fraction))
    return points


def ramps(scene: Scene) -> list[Step]:
    """Steps of a scene with all that is prescribed at their ends: with friction, what earlier steps left as it is."""
    return held_steps(scene.steps) if scene.friction is not None else list(scene.steps)


def start_of_ramp(scalars: Mapping[str, float], last: Step | None) -> dict[str, float]:
    """Values that a ramp starts from: those of the last step, or what was prescribed of it where there was friction.

    A solved load differs from the prescribed one by the tolerance; a load that is held shall not.

    Parameters
    ----------
    scalars : mapping of str to float
        Of the last accepted step.
    last : Step or None
        Its ramp; None to take all values as they came out.
    """
    names = [name for pair in (*MODES, *TANGENTIAL_MODES) for name in pair]
    told = {} if last is None else {name: getattr(last, name) for name in names}
    return {**scalars, **{name: value for name, value in told.items() if value is not None}}


def control_at(step: Step, fraction: float, before: Mapping[str, float]) -> Control:
    """Control part-way along a ramp: linear from the state before it to the values of the step.

    What is controlled (load or approach, moment or tilt) is what the step gives; its start is the value that this
    quantity had, prescribed or not, at the end of the ramp before.
    """
    return Control(**_values(step, MODES, fraction, before))


def tangential_control_at(step: Step, fraction: float, before: Mapping[str, float]) -> TangentialControl:
    """Control along the surface part-way along a ramp; see `control_at`. What is not given stays at a motion of 0."""
    return TangentialControl(**_values(step, TANGENTIAL_MODES, fraction, before))


def travel_at(steps: Sequence[Step], point: LoadPoint) -> tuple[float, float]:
    """Place (x, y) of the geometry [m] part-way along a ramp, which starts where the last one ended."""
    ends = [(0.0, 0.0), *held_travel(steps[: point.ramp + 1])][-2:]
    if point.fraction == 1.0:
        return ends[1]
    (x0, y0), (x1, y1) = ends
    return x0 + point.fraction * (x1 - x0), y0 + point.fraction * (y1 - y0)


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
