"""Observers: see every accepted step, and return numbers that are stored with it."""

from __future__ import annotations

import re
from collections.abc import Iterator

from eigencontact.errors import EigencontactError, PluginError
from eigencontact.execution.block import Block
from eigencontact.execution.step import Step
from eigencontact.model.model import Model
from eigencontact.plugin import StepView

__all__ = ["Observe", "observers_of"]


class Observe(Block):
    """One observer, which sees the surface fields that every run of this scene has."""

    def __init__(self, model: Model, number: int, seen: frozenset[str]) -> None:
        key, self._observer = model.observers[number]
        prefixes = [re.sub(r"\W", "_", observer.key) for _, observer in model.observers]
        self.name, self.why, self._key = f"observer-{number}-{key}", f"[[observers]] {key!r}", key
        self._prefix = prefixes[number] + (f"_{number + 1}" if prefixes.count(prefixes[number]) > 1 else "")
        self._grid, self.requires = model.grid, seen
        self.provides, self.wanted = frozenset({f"observed:{number}"}), {f"observed:{number}": f"[[observers]] {key!r}"}

    def advance(self, step: Step) -> None:
        """See `Block.advance`."""
        fields = {}
        for name, values in step.fields.items():
            view = values.view()
            view.flags.writeable = False
            fields[name] = view
        seen = StepView(index=step.index, grid=self._grid, fields=fields, scalars=dict(step.scalars))
        try:
            numbers = self._observer.observe(seen)
            step.observed |= {f"{self._prefix}_{name}": float(value) for name, value in numbers.items()}
        except EigencontactError:
            raise
        except Exception as problem:
            raise PluginError(
                f"observer {self._key!r} must return named numbers (got {type(problem).__name__}: {problem})"
            ) from problem


def observers_of(model: Model, seen: frozenset[str]) -> Iterator[Observe]:
    """Every observer of the scene; `seen` are the surface fields that it waits for."""
    for number in range(len(model.observers)):
        yield Observe(model, number, seen)
