"""Observers: they compute numbers from every accepted step, and the results store these numbers."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Any

import numpy as np

from eigencontact.core.grid import Grid
from eigencontact.errors import PluginError
from eigencontact.execution.blocks.block import Block, Stateless
from eigencontact.execution.blocks.step import Step
from eigencontact.model.model import Model
from eigencontact.model.observing import Observing
from eigencontact.plugin import RegionView, RememberedView, StepView
from eigencontact.results.records import RegionRecord

__all__ = ["Observe", "observers_of"]


class Observe(Stateless):
    """Block of one observer, with the regions that it requests.

    Parameters
    ----------
    number : int
        Number among the observers of the scene.
    observing : Observing
    labels : iterable of str
        Regions of the scene.
    grid : Grid
    quantities : frozenset of str
        Quantities that the observer requires.
    """

    def __init__(
        self, number: int, observing: Observing, labels: Iterable[str], grid: Grid, quantities: frozenset[str]
    ) -> None:
        self.name, self.reason = f"observer-{number}-{observing.key}", f"[[observers]] {observing.key!r}"
        self._observer, self._prefix, self._key = observing.observer, observing.prefix, observing.key
        self._regions, self._grid = {label: label for label in labels}, grid
        self._regions |= {name: request.label for name, request in observing.regions.items()}
        regions = {f"stress:{label}" for label in self._regions.values()}
        self.requires = quantities | set(observing.observer.remembered) | regions
        self.provides, self.requesters = frozenset({f"observed:{number}"}), {f"observed:{number}": self.reason}

    def advance(self, step: Step) -> None:
        """See `Running.advance`."""
        view = StepView(
            index=step.index,
            grid=self._grid,
            fields=_read_only(step.fields),
            scalars=dict(step.scalars),
            regions=_Regions(self._regions, step.regions | step.looks),
            history={
                name: RememberedView(values=_view(item.values), coords=_read_only(item.coords), unit=item.unit)
                for name, item in step.history.items()
            },
        )
        numbers = self._observer.observe(view)
        try:
            step.observed |= {f"{self._prefix}_{name}": float(value) for name, value in numbers.items()}
        except (AttributeError, TypeError, ValueError) as problem:
            raise PluginError(
                f"observer {self._key!r} must return named numbers (got {type(problem).__name__}: {problem})"
            ) from problem


def observers_of(model: Model, quantities: frozenset[str]) -> Iterator[Block]:
    """All observers of the scene and their regions; `quantities` are the results that they need."""
    from eigencontact.execution.fields.regions import region_of

    labels = [request.label for request in model.cells.requests]
    for number, observing in enumerate(model.observers):
        for request in observing.regions.values():
            yield region_of(model, request, f"[[observers]] {observing.key!r}")
        yield Observe(number, observing, labels, model.grid, quantities)


class _Regions(Mapping[str, RegionView]):
    """Views of the regions of a step by the names of an observer; a region may be computed when it is read."""

    def __init__(
        self, labels: Mapping[str, str], records: Mapping[str, RegionRecord | Callable[[], RegionRecord]]
    ) -> None:
        self._labels, self._records = labels, records

    def __getitem__(self, name: str) -> RegionView:
        record = self._records[self._labels[name]]
        return _region(record() if callable(record) else record)

    def __iter__(self) -> Iterator[str]:
        return iter(self._labels)

    def __len__(self) -> int:
        return len(self._labels)


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
