"""Tables and plugins that a bundled scene uses, for links between the gallery and the reference."""

from __future__ import annotations

import tomllib
from collections import defaultdict
from collections.abc import Iterator, Mapping
from functools import cache
from typing import Any

from eigencontact.listing import plugin_data
from eigencontact.reference.forms import kinds_within
from eigencontact.reference.keys import keys_of
from eigencontact.reference.tables import all_tables
from eigencontact.scene.installed import installed_plugins
from eigencontact.scene.loader import bundled_names, bundled_text


@cache
def kinds_by_key() -> dict[str, set[str]]:
    """Kinds of plugin that the table of a key may name by `type`, in scenes and in tables of plugins."""
    kinds: dict[str, set[str]] = defaultdict(set)
    for place, table in all_tables(installed_plugins()).items():
        if table.kind is not None:
            kinds[place.rpartition(".")[2]].add(table.kind)
    for entry in installed_plugins():
        for key in keys_of(entry.component):
            kinds[key.name].update(kinds_within(key.form))
    return kinds


def plugin_target(kind: str, key: str) -> str:
    """Label of the section of a plugin on the page of plugins."""
    return f"plugin-{kind}-{key}"


def plugins_of(scene: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Kind and key of the plugins of a scene, in the order of its tables."""
    installed = {(entry["kind"], entry["type"]) for entry in plugin_data(installed_plugins())["plugins"]}
    named = (
        (kind, table["type"])
        for key, table in _tables(scene)
        if "type" in table
        for kind in sorted(kinds_by_key().get(key, ()))
    )
    return list(dict.fromkeys(pair for pair in named if pair in installed))


def _tables(table: Mapping[str, Any]) -> Iterator[tuple[str, Mapping[str, Any]]]:
    for key, value in table.items():
        for entry in value if isinstance(value, list) else [value]:
            if isinstance(entry, Mapping):
                yield key, entry
                yield from _tables(entry)


@cache
def scenes_by_plugin() -> dict[tuple[str, str], list[str]]:
    """Names of the bundled scenes that use a plugin."""
    users: dict[tuple[str, str], list[str]] = defaultdict(list)
    for name in bundled_names():
        for plugin in plugins_of(tomllib.loads(bundled_text(name))):
            users[plugin].append(name)
    return users
