"""Increments of ramps: even in the loads, or even in the contact radius where the contact grows."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

from eigencontact.core.rigid_modes import NORMAL_MODES, TANGENTIAL_MODES, RigidMode
from eigencontact.scene.holding import held_bulk, held_steps, held_travel
from eigencontact.scene.steps import Step, ramps_of, segments_of

__all__ = ["normal_control", "spaced_by_radius", "start_of_normal"]


def spaced_by_radius(steps: Sequence[Step], *, friction: bool) -> tuple[frozenset[int], frozenset[int]]:
    """Ramps of `ramps_of` whose increments are even in the contact radius, by the scene or by default.

    The default depends on the path of a ramp alone: with friction, increments are even in the radius where the contact
    grows and nothing else moves. It does not depend on what was loaded before, or on how the scene writes the ramp.

    Parameters
    ----------
    steps : sequence of Step
        As of a scene.
    friction : bool
        Whether the contact has friction.

    Returns
    -------
    first, repeated : frozenset of int
        Those of the first pass through all ramps, and of the later passes through cycles, which start elsewhere.

    Examples
    --------
    >>> loading, unloading = Step(normal_load=1.0, increments=20), Step(normal_load=0.0, increments=20)
    >>> spaced_by_radius([loading, Step(shift_x=1e-6, increments=8), unloading, loading], friction=True)[0]
    frozenset({0, 3})
    >>> spaced_by_radius([loading], friction=False)[0]
    frozenset()
    """
    ramps, segments, repeated = ramps_of(steps), segments_of(steps), set[int]()
    first = _even_in_radius(ramps, friction=friction)
    for segment in segments:
        places = range(segment.first, segment.first + segment.ramps)
        if segment.repeat > 1:
            graded = _even_in_radius([*ramps[: places.stop], *ramps[places.start : places.stop]], friction=friction)
            repeated |= {place for place in places if place + segment.ramps in graded}
    return frozenset(first), frozenset(repeated)


def _even_in_radius(ramps: Sequence[Step], *, friction: bool) -> set[int]:
    held_ramps, places = held_steps(ramps), [(0.0, 0.0), *held_travel(ramps)]
    bulk = [{}, *held_bulk(ramps)]
    return {
        number
        for number, ramp in enumerate(ramps)
        if ramp.increments > 1
        and ramp.spacing != "even"
        and (
            ramp.spacing == "radius"
            or (
                friction
                and ramp.sliding_distance is None
                and places[number] == places[number + 1]
                and bulk[number] == bulk[number + 1]
                and _grows_alone(held_ramps[number - 1] if number else None, held_ramps[number])
            )
        )
    }


def _grows_alone(before: Step | None, ramp: Step) -> bool:
    """Whether only the normal load or approach increases between held steps."""
    control = normal_control(ramp)
    start = None if control is None else start_of_normal(before, control)
    if control is None or start is None or getattr(ramp, control) <= start:
        return False
    return all(_rests(before, ramp, mode) for mode in (*NORMAL_MODES[1:], *TANGENTIAL_MODES))


def _rests(before: Step | None, ramp: Step, mode: RigidMode) -> bool:
    """Whether a ramp leaves a load or motion unchanged; a motion without an earlier value is 0."""
    force, motion = (getattr(ramp, name) for name in (mode.force, mode.displacement))
    if before is None:  # nothing is loaded, nothing has moved
        return not force and not motion
    old_force, old_motion = (getattr(before, name) for name in (mode.force, mode.displacement))
    if force is None and old_force is None:
        return bool((motion or 0.0) == (old_motion or 0.0))
    return bool(force == old_force)


def normal_control(ramp: Step) -> Literal["normal_load", "approach"] | None:
    """Control of a held step: load or approach."""
    if ramp.normal_load is not None:
        return "normal_load"
    return None if ramp.approach is None else "approach"


def start_of_normal(before: Step | None, control: Literal["normal_load", "approach"]) -> float | None:
    """Load [N] or approach [m] at the start of a ramp after a held step; None if it follows from a solution.

    A step that ends without contact, by the other control, is a start at 0.
    """
    if before is None or (previous_control := normal_control(before)) is None:
        return 0.0
    value: float = getattr(before, previous_control)
    return value if previous_control == control else 0.0 if value <= 0.0 else None
