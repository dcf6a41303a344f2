"""What a step of a contact with friction prescribes, and what it keeps of the steps before."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from eigencontact.scene.schema import Step

__all__ = ["NORMAL_PAIRS", "TANGENTIAL_PAIRS", "held_steps"]

#: (force, displacement) of the rigid modes; a step gives one of each pair or none.
NORMAL_PAIRS = (("normal_load", "approach"), ("moment_x", "tilt_x"), ("moment_y", "tilt_y"))
TANGENTIAL_PAIRS = (
    ("tangential_load_x", "shift_x"),
    ("tangential_load_y", "shift_y"),
    ("torsion_moment", "twist"),
)


def held_steps(steps: Sequence[Step]) -> list[Step]:
    """Steps of a scene with friction, each with everything that is prescribed at its end.

    Of each pair a step that gives neither keeps what the last step gave that did: the same kind of control, held at its
    value. What no step has given yet stays None: a rigid displacement of 0.

    Examples
    --------
    >>> from eigencontact.scene.schema import Step
    >>> held = held_steps([Step(normal_load=1.0), Step(shift_x=1e-8), Step(tangential_load_x=0.0)])
    >>> [(step.normal_load, step.shift_x, step.tangential_load_x) for step in held]
    [(1.0, None, None), (1.0, 1e-08, None), (1.0, None, 0.0)]
    """
    kept: dict[str, float | None] = {}
    out = []
    for step in steps:
        for pair in (*NORMAL_PAIRS, *TANGENTIAL_PAIRS):
            values = {name: getattr(step, name) for name in pair}
            if any(value is not None for value in values.values()):
                kept |= values
        out.append(step.model_copy(update=kept))
    return out
