"""Observers of a scene: what their numbers are called, and the regions that they ask for."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from eigencontact.core.numbers import Number
from eigencontact.errors import PluginError, SceneError
from eigencontact.plugin import Observer
from eigencontact.scene.schema import Scene, StressRequest

__all__ = ["Observing", "observing"]


@dataclass(frozen=True)
class Observing:
    """One observer.

    Attributes
    ----------
    key : str
        As the scene names it.
    observer : Observer
    prefix : str
        Its numbers are stored as ``<prefix>_<name>``; no other observer has the same.
    asked : mapping of str to StressRequest
        Regions that it asks for, by its own names.
    """

    key: str
    observer: Observer
    prefix: str
    asked: Mapping[str, StressRequest]

    @property
    def numbers(self) -> list[Number]:
        """Its numbers, by the names under which they are stored."""
        return [
            Number(
                name=f"{self.prefix}_{name}", unit=unit, meaning=f"{name} by observer {self.key!r}", headline=True,
                label=f"{self.key}: {name.replace('_', ' ')}",
            )
            for name, unit in self.observer.units.items()
        ]  # fmt: skip


def observing(scene: Scene, observers: Sequence[Observer]) -> tuple[Observing, ...]:
    """Observers of a scene, in its order.

    Raises
    ------
    PluginError
        An observer asks for a region that the scene cannot have.
    """
    plain = [re.sub(r"\W", "_", observer.key) for observer in observers]
    found = []
    for number, (table, observer) in enumerate(zip(scene.observers, observers, strict=True), 1):
        own = plain[number - 1]
        prefix = own + (f"_{number}" if plain.count(own) > 1 else "")
        key = str(table["type"])
        found.append(Observing(key=key, observer=observer, prefix=prefix, asked=_asked(scene, key, prefix, observer)))
    return tuple(found)


def _asked(scene: Scene, key: str, prefix: str, observer: Observer) -> dict[str, StressRequest]:
    """Regions of one observer, checked as those of a scene are."""
    if not observer.regions:
        return {}
    tables = [{**table, "name": f"{prefix}_{name}"} for name, table in observer.regions.items()]
    bare = scene.model_dump(by_alias=True, exclude_none=True, exclude={"observers", "stress"})
    try:
        checked = Scene(**bare, stress=tables).stress
    except SceneError as problem:
        raise PluginError(f"observer {key!r} must ask for regions that the scene can have (got: {problem})") from None
    return dict(zip(observer.regions, checked, strict=True))
