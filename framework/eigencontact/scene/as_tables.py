"""Conversion of components in place of tables of a scene to tables."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from math import inf
from typing import Any

from pydantic import BaseModel

from eigencontact.plugin.component import Component
from eigencontact.scene.annotations import class_within
from eigencontact.scene.plain import plain
from eigencontact.scene.table import ComponentTable, OfKind

__all__ = ["table_of", "with_tables"]

#: Keys of a table that may hold a component.
_NESTED = ("type", "eigenstrain", "material", "value")


def with_tables(model: type[BaseModel], data: Mapping[str, Any]) -> dict[str, Any]:
    """Data of a model with tables in place of components, in the fields of plugins."""
    out = dict(data)
    for name, field in model.model_fields.items():
        if name in out and (
            any(isinstance(mark, OfKind) for mark in field.metadata)
            or class_within(field.annotation, lambda cls: issubclass(cls, ComponentTable))
        ):
            value = out[name]
            out[name] = [table_of(item) for item in value] if isinstance(value, list | tuple) else table_of(value)
    return out


def table_of(item: Any) -> Any:
    """Table of a component, or of a table that has one as its ``type`` or its ``eigenstrain``."""
    if is_dataclass(item) and not isinstance(item, type):
        values = {field.name: getattr(item, field.name) for field in fields(item)}
        table = {name: table_of(value) for name, value in values.items() if value is not None}
        return {"type": _type_of(item), **table} if isinstance(item, Component) else table
    if isinstance(item, list | tuple) and any(map(is_dataclass, item)):
        return [table_of(member) for member in item]
    if isinstance(item, float) and item == inf:
        return "infinite"  # as scenes write it: tables hold finite numbers
    if not isinstance(item, dict):
        return plain(item)
    out = {key: table_of(value) if key in _NESTED else value for key, value in item.items()}
    return out if not isinstance(out.get("type"), dict) else {**out, **out["type"]}


def _type_of(component: Component) -> str:
    """Name of the class of a component in a scene."""
    from eigencontact.scene.installed import installed_plugins

    registry = installed_plugins()
    entry = next((entry for entry in registry if entry.component is type(component)), None)
    return str(getattr(component, "key", "")) if entry is None else registry.spelling(entry)
