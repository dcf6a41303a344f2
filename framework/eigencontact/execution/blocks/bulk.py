"""Block of the bulk stress: stores the prescribed bulk stress of each step for regions and fatigue."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from eigencontact.core.bulk import BULK_NAMES, IN_PLANE, bulk_of, in_plane_strain
from eigencontact.core.cautions import Caution
from eigencontact.core.numbers import Number
from eigencontact.core.units import readable
from eigencontact.execution.blocks.block import Stateless
from eigencontact.execution.blocks.step import Step
from eigencontact.model.bodies import without_layers
from eigencontact.model.model import Model
from eigencontact.scene.holding import held_bulk

__all__ = ["BulkStress"]

_NAME = "bulk-stress"
#: Strain beyond the small-strain assumption.
_LARGE = 0.1


class BulkStress(Stateless):
    """Bulk stress of both bodies, as scalars of the step."""

    name, settles = _NAME, True
    provides = frozenset({_NAME})
    requesters = dict.fromkeys((_NAME,), "[body1] or [body2] bulk-stress, or steps")
    numbers = tuple(
        Number(name=name, unit="Pa", meaning=f"bulk stress {component} of body {body}, by a load far away")
        for body, names in BULK_NAMES.items()
        for name, component in zip(names, IN_PLANE, strict=True)
    )

    def __init__(self, model: Model) -> None:
        at_rest = model.scene.bulk_at_rest
        self.numbers = tuple(number for number in BulkStress.numbers if number.name in at_rest)
        self._history = [at_rest, *held_bulk(model.scene.ramps, at_rest)]
        largest = {name: max((values[name] for values in self._history), key=abs) for name in at_rest}
        words = (f"{name.replace('_', '-')} up to {readable(value, 'Pa')}" for name, value in largest.items())
        self.reason = f"uniform stress by a load far away: {', '.join(words)}"

    def foreseen(self, model: Model) -> Iterator[Caution]:
        """See `Block.foreseen`: warns of large strains, for example by a wrong unit."""
        for body, material in enumerate(without_layers(model.bodies.solids), start=1):
            if material is None:
                continue
            strains = [in_plane_strain(bulk_of(values, body), material, model.grid) for values in self._history]
            largest = float(np.abs(strains).max())
            if largest > _LARGE:
                words = (
                    f"bulk stress strains body {body} by {100 * largest:.3g} %: strains are not small, as the theory "
                    "assumes; check the units of bulk stress and modulus"
                )
                yield Caution("small-strain", words)

    def advance(self, step: Step) -> None:
        """See `Running.advance`."""
        step.scalars |= step.bulk[1]
