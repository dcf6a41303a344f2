"""What the results of a run say of the bodies below surfaces that have worn."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from eigencontact.core.cautions import Caution
from eigencontact.core.units import readable
from eigencontact.model.model import Model
from eigencontact.model.resolution import percent
from eigencontact.model.sources import Inhomogeneity
from eigencontact.results.records import StepRecord

__all__ = ["worn_bodies"]

#: Error by layers that are taken as uniform, from which on it is told.
_UNEVEN = 0.01
#: Difference of the pressure after a slide from that found on the way, from which on it is told.
_LAGS = 0.03
#: Part of its depth by which a region may stay behind.
_STAYS = 0.05


def worn_bodies(model: Model, last: StepRecord, history: Sequence[Mapping[str, float]]) -> Iterator[Caution]:
    """Warnings of layers that have worn unevenly, and of regions that do not rise with what wears off above them."""
    error = max((row.get("layer_error") or 0.0 for row in history), default=0.0)
    if error >= _UNEVEN:
        words = (
            "layers that wear are taken as thick as their mean in the contact: the answer of the most and of the least "
            f"worn column differs from that by {percent(error)}; describe them by cells to see it"
        )
        yield Caution("worn-layers", words, error)
    lag = last.scalars.get("wear_lag", 0.0)
    if lag >= _LAGS:
        words = (
            f"what lies in the bodies answers when a slide is done: the pressure that wore in the last step differs by "
            f"{percent(lag)} from that found then; give more increments"
        )
        yield Caution("worn-increments", words, lag)
    yield from _left_behind(model, last)


def _left_behind(model: Model, last: StepRecord) -> Iterator[Caution]:
    """The first region that stays where it was: all but those of linear laws in cells do."""
    for source in model.sources:
        worn = last.fields.get(f"worn_depth_{source.body}")
        rises = isinstance(source, Inhomogeneity) and source.lattice is not None and source.law.linear
        if worn is None or rises:
            continue
        lost, depth = float(worn.max()), source.shape.bounds[1][2]
        if lost > _STAYS * depth:
            words = (
                f"body {source.body} has lost up to {readable(lost, 'm')}, and {source.name!r}, which reaches down to "
                f"{readable(depth, 'm')}, stays where it was: eigenstrain, whole inclusions and what laws remember do "
                "not rise with what wears off above them"
            )
            yield Caution("worn-regions", words, lost / depth)
            return
