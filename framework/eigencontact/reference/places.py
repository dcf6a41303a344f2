"""The key that a dotted place in a scene's tables means."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from eigencontact.errors import EigencontactError
from eigencontact.hooks.registry import Registry
from eigencontact.reference.forms import kinds_within
from eigencontact.reference.keys import Key, keys_of
from eigencontact.scene.schema import Scene
from eigencontact.scene.table import ComponentTable

__all__ = ["key_at"]


def key_at(registry: Registry, tables: Mapping[str, Any], place: str) -> Key | None:
    """Key at a path such as ``"geometry.0.radius"``; None for a path into an array or without a key.

    Parameters
    ----------
    registry : Registry
        Plugins whose parameters count.
    tables : mapping
        Tables of the scene, which name their plugins.
    place : str
        Dotted; the number of an array's only entry may be left out.
    """
    classes: list[type] = [Scene]
    value: Any = tables
    key: Key | None = None
    for word in place.split("."):
        if isinstance(value, list):
            number = int(word) if word.isdigit() else 0
            value = value[number] if number < len(value) else None
            if word.isdigit():
                continue
        if not isinstance(value, Mapping):
            return None
        name = word.replace("_", "-")
        key = next((candidate for cls in classes for candidate in keys_of(cls) if candidate.name == name), None)
        if key is None:
            return None
        value = value.get(name, value.get(word))
        classes = _classes(registry, key, value)
    return key


def _classes(registry: Registry, key: Key, value: Any) -> list[type]:
    """Classes whose fields are the keys of the table under a key."""
    kind = next(iter(kinds_within(key.form)), None)
    classes = [] if key.table is None else [key.table]
    if key.table is not None and issubclass(key.table, ComponentTable):
        kind = key.table.kind
    first = value[0] if isinstance(value, list) and value else value
    if kind is not None and isinstance(first, Mapping) and isinstance(first.get("type"), str):
        try:
            classes.append(registry.get(kind, first["type"]).component)
        except EigencontactError:
            return classes
    return classes
