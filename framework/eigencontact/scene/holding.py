"""Prescribed and held loads and motions of the steps of a contact with friction."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from eigencontact.core.bulk import NO_BULK
from eigencontact.core.rigid_modes import NORMAL_MODES, TANGENTIAL_MODES

if TYPE_CHECKING:
    from eigencontact.scene.schema import Step

__all__ = ["TRAVEL", "held_bulk", "held_steps", "held_travel"]

#: Place of the geometry along x and y.
TRAVEL = ("travel_x", "travel_y")


def held_steps(steps: Sequence[Step]) -> list[Step]:
    """Steps of a scene with friction, each with all prescribed values at its end.

    Of each pair a step that gives neither keeps what the last step gave that did: the same kind of control, held at its
    value. What no step has given yet stays None: a rigid displacement of 0.

    Examples
    --------
    >>> from eigencontact.scene.schema import Step
    >>> held = held_steps([Step(normal_load=1.0), Step(shift_x=1e-8), Step(tangential_load_x=0.0)])
    >>> [(step.normal_load, step.shift_x, step.tangential_load_x) for step in held]
    [(1.0, None, None), (1.0, 1e-08, None), (1.0, None, 0.0)]
    """
    prescribed: dict[str, float | None] = {}
    out = []
    for step in steps:
        for mode in (*NORMAL_MODES, *TANGENTIAL_MODES):
            values = {name: getattr(step, name) for name in mode}
            if any(value is not None for value in values.values()):
                prescribed |= values
        out.append(step.model_copy(update=prescribed))
    return out


def held_travel(steps: Sequence[Step]) -> list[tuple[float, float]]:
    """Position (x, y) of the geometry [m] at the end of each step; it keeps its last value if a step omits it.

    Examples
    --------
    >>> from eigencontact.scene.schema import Step
    >>> held_travel([Step(normal_load=1.0), Step(normal_load=1.0, travel_x=2e-6), Step(normal_load=0.5)])
    [(0.0, 0.0), (2e-06, 0.0), (2e-06, 0.0)]
    """
    places = [(0.0, 0.0)]
    for step in steps:
        target = (step.travel_x, step.travel_y)
        x, y = (old if new is None else new for old, new in zip(places[-1], target, strict=True))
        places.append((x, y))
    return places[1:]


def held_bulk(steps: Sequence[Step], start: Mapping[str, float] = NO_BULK) -> list[dict[str, float]]:
    """Bulk stress [Pa] at the end of each step, by name; it keeps its last value if a step omits it.

    Examples
    --------
    >>> from eigencontact.scene.schema import Step
    >>> stretched = held_bulk([Step(normal_load=1.0), Step(bulk_stress_xx=1e8)], {"bulk_stress_yy": 2e7})
    >>> stretched[0], stretched[1]
    ({'bulk_stress_yy': 20000000.0}, {'bulk_stress_yy': 20000000.0, 'bulk_stress_xx': 100000000.0})
    """
    values = [dict(start)]
    for step in steps:
        values.append({**values[-1], **step.bulk})
    return values[1:]
