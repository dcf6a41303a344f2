"""The load history: ramps of a scene as a list of single controls."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from eigencontact.scene.schema import Step
from eigencontact.solvers.control import MODES, Control

__all__ = ["LoadPoint", "load_points"]


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


def control_at(step: Step, fraction: float, before: Mapping[str, float]) -> Control:
    """Control part-way along a ramp: linear from the state before it to the values of the step.

    What is controlled (load or approach, moment or tilt) is what the step gives; its start is the value that this
    quantity had, prescribed or not, at the end of the ramp before.
    """
    values: dict[str, float] = {}
    for displacement, force in MODES:
        for name in (force, displacement):
            target = getattr(step, name)
            if target is not None:
                begin = before.get(name, 0.0)
                values[name] = target if fraction == 1.0 else begin + fraction * (target - begin)
    return Control(**values)
