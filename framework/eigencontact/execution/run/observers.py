"""Observers: see every accepted step, and return numbers that are stored with it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from eigencontact.errors import PluginError
from eigencontact.execution.blocks.block import Block, Stateless
from eigencontact.execution.blocks.step import Step
from eigencontact.model.model import Model
from eigencontact.plugin import RegionView, RememberedView, StepView
from eigencontact.results.records import RegionRecord

__all__ = ["Observe", "observers_of"]


class Observe(Stateless):
    """One observer, which sees what every run of this scene has, and the regions that it asks for."""

    def __init__(self, model: Model, number: int, seen: frozenset[str]) -> None:
        one = model.observers[number]
        self.name, self.why, self._key = f"observer-{number}-{one.key}", f"[[observers]] {one.key!r}", one.key
        self._observer, self._prefix, self._grid = one.observer, one.prefix, model.grid
        self._regions = {request.label: request.label for request in model.requests}
        self._regions |= {name: request.label for name, request in one.asked.items()}
        self.requires = seen | set(one.observer.remembered) | {f"stress:{label}" for label in self._regions.values()}
        self.provides, self.wanted = frozenset({f"observed:{number}"}), {f"observed:{number}": self.why}

    def advance(self, step: Step) -> None:
        """See `Running.advance`."""
        known = step.regions | step.looks
        seen = StepView(
            index=step.index,
            grid=self._grid,
            fields=_read_only(step.fields),
            scalars=dict(step.scalars),
            regions={name: _region(known[label]) for name, label in self._regions.items()},
            history={
                name: RememberedView(values=_view(item.values), coords=_read_only(item.coords), unit=item.unit)
                for name, item in step.history.items()
            },
        )
        numbers = self._observer.observe(seen)
        try:
            step.observed |= {f"{self._prefix}_{name}": float(value) for name, value in numbers.items()}
        except (AttributeError, TypeError, ValueError) as problem:
            raise PluginError(
                f"observer {self._key!r} must return named numbers (got {type(problem).__name__}: {problem})"
            ) from problem


def observers_of(model: Model, seen: frozenset[str]) -> Iterator[Block]:
    """Every observer of the scene, and the regions that they ask for; `seen` are the results that they wait for."""
    from eigencontact.execution.fields.regions import Region

    for number, one in enumerate(model.observers):
        for request in one.asked.values():
            yield Region(model, request, f"[[observers]] {one.key!r}")
        yield Observe(model, number, seen)


def _region(record: RegionRecord) -> RegionView:
    return RegionView(dims=record.dims, coords=_read_only(record.coords), fields=_read_only(record.fields))


def _read_only(arrays: Mapping[str, Any]) -> dict[str, Any]:
    return {name: _view(values) for name, values in arrays.items()}


def _view(values: Any) -> Any:
    if not isinstance(values, np.ndarray):
        return values
    view = values.view()
    view.flags.writeable = False
    return view
