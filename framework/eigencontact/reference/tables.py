"""All tables of a scene, by their place."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from eigencontact.errors import SceneError, nearest
from eigencontact.hooks.registry import Registry
from eigencontact.reference.docstrings import summary
from eigencontact.reference.forms import kinds_within
from eigencontact.reference.keys import Key, keys_of
from eigencontact.scene.schema import Scene
from eigencontact.scene.table import ComponentTable

__all__ = ["TableReference", "all_tables", "one_table"]


@dataclass(frozen=True, slots=True)
class TableReference:
    """One table of a scene.

    Attributes
    ----------
    place : str
        ``"numerics"``, ``"steps.impacts"``; empty for the scene itself.
    summary : str
        What the table is.
    keys : tuple of Key
        In the order of the scene.
    kind : str or None
        Kind of plugin whose fields are further keys: that which ``type`` names.
    plugins : tuple of (str, str)
        What ``type`` may name, with one line each.
    """

    place: str
    summary: str
    keys: tuple[Key, ...]
    kind: str | None
    plugins: tuple[tuple[str, str], ...]


def all_tables(registry: Registry) -> dict[str, TableReference]:
    """Tables of a scene by place, the scene itself first."""
    return {table.place: table for table in _walk(Scene, "", registry, frozenset())}


def one_table(registry: Registry, place: str) -> TableReference:
    """Table at a place.

    Raises
    ------
    SceneError
        A scene has no such table; names the nearest.
    """
    tables = all_tables(registry)
    name = place.strip("[] ").replace("_", "-")
    if name not in tables:
        names = [name for name in tables if name]
        raise SceneError(f"a scene has no table {place!r}; tables: {', '.join(names)}{nearest(name, names)}")
    return tables[name]


def _walk(cls: type, place: str, registry: Registry, above: frozenset[type]) -> Iterator[TableReference]:
    keys = tuple(keys_of(cls))
    kind = cls.kind if issubclass(cls, ComponentTable) else None
    yield TableReference(place, summary(cls), keys, kind, _plugins(registry, kind))
    for key in keys:
        inner = f"{place}.{key.name}".strip(".")
        kind = next(iter(kinds_within(key.form)), None)
        if kind is not None:
            yield TableReference(inner, key.meaning, (), kind, _plugins(registry, kind))
        elif key.table is not None and key.table not in above:
            yield from _walk(key.table, inner, registry, above | {cls, key.table})


def _plugins(registry: Registry, kind: str | None) -> tuple[tuple[str, str], ...]:
    entries = [] if kind is None else registry.of_kind(kind)
    return tuple((registry.spelling(entry), summary(entry.component)) for entry in entries)
