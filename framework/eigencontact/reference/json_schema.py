"""JSON Schema of a scene, for completion and checks in TOML editors."""

from __future__ import annotations

from typing import Any, get_type_hints

from eigencontact.core.places import place_field
from eigencontact.hooks.registry import Registry
from eigencontact.reference.docstrings import summary
from eigencontact.reference.forms import form_of, kinds_within
from eigencontact.reference.keys import Key, keys_of
from eigencontact.scene.accuracy import Accuracy
from eigencontact.scene.schema import Scene
from eigencontact.scene.table import ComponentTable

__all__ = ["json_schema"]


def json_schema(registry: Registry) -> dict[str, Any]:
    """JSON Schema (draft 2020-12) of a scene with the installed plugins.

    Returns
    -------
    dict
        The scene's own keys, and ``$defs``: each class of tables, each kind of plugin, each plugin.
    """
    definitions = _Definitions(registry)
    scene = definitions.table(Scene)
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "Scene of eigencontact",
        **scene,
        "$defs": definitions.definitions,
    }


class _Definitions:
    """Definitions that a scene refers to, each made once."""

    def __init__(self, registry: Registry) -> None:
        self.registry = registry
        self.definitions: dict[str, Any] = {}

    def table(self, cls: type, beside: dict[str, Any] | None = None) -> dict[str, Any]:
        """Object with the keys of a class, and additional keys."""
        keys = list(keys_of(cls))
        for key in keys:
            self._define(key)
        properties = {key.name: _property(key) for key in keys}
        return {
            "type": "object",
            "description": summary(cls),
            "properties": {**(beside or {}), **properties},
            "required": [*(["type"] if beside else []), *(key.name for key in keys if key.required)],
            "additionalProperties": _further(cls),
        }

    def _define(self, key: Key) -> None:
        """Make the definition of a key."""
        for kind in kinds_within(key.form):
            if kind not in self.definitions:
                self.definitions[kind] = {}  # a plugin may hold others of its kind
                self.definitions[kind] = {"anyOf": [self._plugin(entry) for entry in self.registry.of_kind(kind)]}
        cls = key.table
        if cls is None or cls.__name__ in self.definitions:
            return
        self.definitions[cls.__name__] = {}
        self.definitions[cls.__name__] = self._with_plugins(cls) if issubclass(cls, ComponentTable) else self.table(cls)

    def _with_plugins(self, cls: type[ComponentTable]) -> dict[str, Any]:
        """Table of a plugin with its keys and those of the scene: one for each plugin of the kind."""
        table_form = self.table(cls)
        further = {name: form for name, form in table_form["properties"].items() if name != "type"}
        required = [name for name in table_form["required"] if name != "type"]
        choices = []
        for entry in self.registry.of_kind(cls.kind):
            table = self._plugin(entry, further)
            place = place_field(entry.component) if "centers" in further else None  # centers take its place
            table["required"] = [name for name in dict.fromkeys([*table["required"], *required]) if name != place]
            choices.append(table)
        return {"anyOf": choices}

    def _plugin(self, entry: Any, beside: dict[str, Any] | None = None) -> dict[str, Any]:
        type_form = {"type": {"const": self.registry.spelling(entry), "description": summary(entry.component)}}
        return self.table(entry.component, {**type_form, **(beside or {})})


def _further(cls: type) -> bool | dict[str, Any]:
    """Form of keys that a class does not declare; False if it accepts none."""
    extra = get_type_hints(cls, include_extras=True).get("__pydantic_extra__") if issubclass(cls, Accuracy) else None
    return False if extra is None else dict(_clean(form_of(extra)["additionalProperties"]))


def _property(key: Key) -> dict[str, Any]:
    default = {} if key.default in (None, "", [], [None]) else {"default": key.default}
    return {"description": f"{key.meaning} ({key.valid_values})".strip(), **_clean(key.form), **default}


def _clean(form: Any) -> Any:
    """Form for editors, without keys that are not in JSON Schema."""
    if isinstance(form, dict):
        return {name: _clean(value) for name, value in form.items() if not name.startswith("x-")}
    return [_clean(item) for item in form] if isinstance(form, list) else form
