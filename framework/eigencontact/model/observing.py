"""Observers of a scene, the names of their numbers, and their regions."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass

from eigencontact.core.numbers import Number
from eigencontact.errors import PluginError, SceneError
from eigencontact.hooks.registry import Registry
from eigencontact.plugin import Observer
from eigencontact.scene.components import build_components
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
    regions : mapping of str to StressRequest
        Regions that it asks for, by its own names.
    """

    key: str
    observer: Observer
    prefix: str
    regions: Mapping[str, StressRequest]

    @property
    def numbers(self) -> list[Number]:
        """Numbers of the observer by the names of storage."""
        return [
            Number(
                name=f"{self.prefix}_{name}", unit=unit, meaning=f"{name} by observer {self.key!r}", headline=True,
                label=f"{self.key}: {name.replace('_', ' ')}", scatters=name in self.observer.counted,
                of_widths=name in self.observer.widths, summed=name in self.observer.summed,
            )
            for name, unit in self.observer.units.items()
        ]  # fmt: skip


def observing(scene: Scene, registry: Registry) -> tuple[Observing, ...]:
    """Observers of a scene, in its order.

    Raises
    ------
    SceneError, PluginError
        An observer that is refused, or one that asks for a region that the scene cannot have.
    """
    observers: list[Observer] = build_components(registry, "observer", scene.observers, "observers")
    names, observing = [re.sub(r"\W", "_", observer.key) for observer in observers], []
    for number, (table, observer, name) in enumerate(zip(scene.observers, observers, names, strict=True), 1):
        prefix = name + (f"_{number}" if names.count(name) > 1 else "")
        key = str(table["type"])
        regions = _regions(scene, key, prefix, observer)
        observing.append(Observing(key=key, observer=observer, prefix=prefix, regions=regions))
    return tuple(observing)


def _regions(scene: Scene, key: str, prefix: str, observer: Observer) -> dict[str, StressRequest]:
    """Regions of one observer, checked like those of a scene."""
    if not observer.regions:
        return {}
    tables = [{**table, "name": f"{prefix}_{name}"} for name, table in observer.regions.items()]
    bare = scene.model_dump(by_alias=True, exclude_none=True, exclude={"observers", "stress", "fatigue"})
    try:
        checked = Scene(**bare, stress=tables).stress
    except SceneError as problem:
        raise PluginError(f"observer {key!r} must ask for regions that the scene can have (got: {problem})") from None
    return dict(zip(observer.regions, checked, strict=True))
