"""Block of the bulk stress: what each step prescribes of it, stored for regions and fatigue to read."""

from __future__ import annotations

from eigencontact.core.bulk import BULK_NAMES, IN_PLANE
from eigencontact.core.numbers import Number
from eigencontact.core.units import readable
from eigencontact.execution.blocks.block import Stateless
from eigencontact.execution.blocks.step import Step
from eigencontact.model.model import Model
from eigencontact.scene.holding import held_bulk

__all__ = ["BulkStress"]

_NAME = "bulk-stress"


class BulkStress(Stateless):
    """Bulk stress of both bodies, as scalars of the step."""

    name, settles = _NAME, True
    provides = frozenset({_NAME})
    wanted = dict.fromkeys((_NAME,), "[body1] or [body2] bulk-stress, or steps")
    numbers = tuple(
        Number(name=name, unit="Pa", meaning=f"bulk stress {component} of body {body}, by a load far away")
        for body, names in BULK_NAMES.items()
        for name, component in zip(names, IN_PLANE, strict=True)
    )

    def __init__(self, model: Model) -> None:
        at_rest = model.scene.bulk_at_rest
        self.numbers = tuple(number for number in BulkStress.numbers if number.name in at_rest)
        history = [at_rest, *held_bulk(model.scene.ramps, at_rest)]
        largest = {name: max((values[name] for values in history), key=abs) for name in at_rest}
        words = (f"{name.replace('_', '-')} up to {readable(value, 'Pa')}" for name, value in largest.items())
        self.why = f"uniform stress by a load far away: {', '.join(words)}"

    def advance(self, step: Step) -> None:
        """See `Running.advance`."""
        step.scalars |= step.bulk[1]
