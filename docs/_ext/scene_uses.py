"""Tables and plugins that a bundled scene uses, for links between the gallery and the reference."""

from __future__ import annotations

import tomllib
from collections import defaultdict
from collections.abc import Iterator, Mapping
from functools import cache
from typing import Any

from eigencontact.listing import plugin_data
from eigencontact.scene.installed import installed_plugins
from eigencontact.scene.loader import bundled_names, bundled_text

#: Key of a scene whose table names a plugin by `type`, and the kind of that plugin.
KINDS = {
    "geometry": "geometry",
    "friction": "friction-law",
    "wear": "wear-law",
    "inclusions": "inclusion-shape",
    "eigenstrain": "eigenstrain-field",
    "material": "constitutive-law",
    "law": "constitutive-law",
    "laws": "constitutive-law",
    "hardening": "hardening-law",
    "back-stresses": "hardening-law",
    "damage": "damage-law",
    "medium": "layered-medium",
    "observers": "observer",
}


def plugin_target(kind: str, key: str) -> str:
    """Label of the section of a plugin on the page of plugins."""
    return f"plugin-{kind}-{key}"


def plugins_of(scene: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Kind and key of the plugins of a scene, in the order of its tables."""
    installed = {(entry["kind"], entry["type"]) for entry in plugin_data(installed_plugins())["plugins"]}
    named = ((KINDS[key], table["type"]) for key, table in _tables(scene) if key in KINDS and "type" in table)
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
