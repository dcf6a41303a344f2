"""Scene tables to components: a table's keys are the fields of the plugin's dataclass."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import MISSING, fields, is_dataclass
from functools import cache
from types import UnionType
from typing import Annotated, Any, Union, get_args, get_origin

from eigencontact.errors import PluginError, SceneError, shown
from eigencontact.hooks.guard import plugin_code, reason_of
from eigencontact.hooks.registry import Entry, Registry, annotations_of
from eigencontact.plugin.component import Component
from eigencontact.scene.annotations import class_within
from eigencontact.scene.checks import only_numbers
from eigencontact.scene.messages import explain_error, refuse_unknown
from eigencontact.scene.plain import plain

__all__ = ["build_component", "build_components", "converted", "instantiate", "kind_within"]


def build_component(
    registry: Registry, kind: str, table: Mapping[str, Any], where: str, beside: Iterable[str] = ()
) -> Any:
    """Component of a scene table; ``type`` names the plugin. Keys `beside` its fields are already used.

    Raises
    ------
    SceneError, PluginError
        Naming the table, the field, the rule and the nearest valid choice.
    """
    parameters = dict(table)
    key = parameters.pop("type", None)
    if not isinstance(key, str) or not key:
        names = ", ".join(repr(entry.key) for entry in registry.of_kind(kind))
        raise SceneError(f"{where}.type must name a {kind} (got {key!r}); installed: {names}")
    return instantiate(registry, registry.get(kind, key, where=where), parameters, where, beside)


def build_components(registry: Registry, kind: str, tables: Sequence[Mapping[str, Any]], group: str) -> list[Any]:
    """Components of an array of tables; messages name the array, and the number of the table if there are several."""
    places = [group if len(tables) == 1 else f"{group}.{number}" for number in range(len(tables))]
    return [build_component(registry, kind, table, place) for table, place in zip(tables, places, strict=True)]


def instantiate(
    registry: Registry, entry: Entry, parameters: Mapping[str, Any], where: str, beside: Iterable[str] = ()
) -> Any:
    """Component of a registered class from named parameters, each converted to its annotated type."""
    values = converted(registry, entry, parameters, where, beside)
    failed = f"{where}: {entry.kind} {entry.key!r} of {entry.origin} failed with"
    try:
        with plugin_code(lambda problem: f"{failed} {reason_of(problem)}", passing=(SceneError,)):
            return entry.component(**values)
    except SceneError as problem:
        raise SceneError(_with_place(str(problem), entry, where)) from None


def _with_place(message: str, entry: Entry, where: str) -> str:
    """Message of a component with the place in the scene: ``geometry.half-angle`` instead of ``wedge.half_angle``."""
    if where == entry.key:  # made in Python, where fields have the names of the class
        return message
    path = re.match(rf"{re.escape(entry.key)}\.((\w+)[\w.]*)", message)  # of a field, or within one
    if path and path[2] in {item.name for item in fields(entry.component)}:
        return f"{where}.{path[1].replace('_', '-')}{message[path.end() :]}"
    return message if where in message or not re.search(r"\.\d+$", where) else f"{where}: {message}"


def converted(
    registry: Registry, entry: Entry, parameters: Mapping[str, Any], where: str, beside: Iterable[str] = ()
) -> dict[str, Any]:
    """Parameters with the names and types of a registered class, before the class checks them.

    A field whose annotation is a kind of plugin holds the table of a component of that kind.
    """
    cls = entry.component
    names = {item.name: item for item in fields(cls)}
    refuse_unknown(parameters, [*names, *beside], f"{where} ({entry.key})", f"plugins {registry.spelling(entry)}")
    values = {name.replace("-", "_"): value for name, value in parameters.items()}
    if len(values) < len(parameters):
        raise SceneError(f"{where} must give each key once (got {', '.join(parameters)}); '-' and '_' are one")
    for name, item in names.items():
        if name not in values and item.default is MISSING and item.default_factory is MISSING:
            raise SceneError(f"{where}.{name.replace('_', '-')} must be given ({entry.key} needs it)")
    try:
        adapters, hints = _adapters(cls), annotations_of(cls)
    except Exception as problem:
        raise PluginError(
            f"{where}: {entry.kind} {entry.key!r} of {entry.origin} must have fields that a table can hold "
            f"(got {type(problem).__name__}: {' '.join(str(problem).split())})"
        ) from problem
    out = {}
    for name, value in values.items():
        place = f"{where}.{name.replace('_', '-')}"
        kind = kind_within(hints[name])
        components = kind is not None and _parts(registry, kind, hints[name], value, place)
        out[name] = _convert(
            adapters[name], components or _with_field_names(hints[name], plain(value, place), place), place
        )
    return out


def kind_within(hint: Any) -> type[Component] | None:
    """Kind of plugin in an annotation such as ``tuple[HardeningLaw, ...]`` or ``HardeningLaw | None``."""
    kind: type[Component] | None = class_within(hint, lambda cls: issubclass(cls, Component))
    return kind


def _parts(registry: Registry, kind: type[Component], hint: Any, value: Any, where: str) -> Any:
    """Build the components of a field from one table, an array or named tables; keep components unchanged."""
    if get_origin(hint) is dict and isinstance(value, Mapping):
        return {name: _parts(registry, kind, kind, table, f"{where}.{name}") for name, table in value.items()}
    if isinstance(value, list | tuple):
        return tuple(_parts(registry, kind, kind, table, f"{where}.{number}") for number, table in enumerate(value))
    if get_origin(hint) in (list, tuple):
        return (_parts(registry, kind, kind, value, where),)
    if not isinstance(value, Mapping):
        return value
    component = build_component(registry, kind.kind, value, where)
    if not isinstance(component, kind):
        fit = [repr(entry.key) for entry in registry.of_kind(kind.kind) if issubclass(entry.component, kind)]
        raise SceneError(f"{where}.type must be one of {', '.join(fit)} (got {component.key!r})")
    return component


@cache
def _adapters(cls: type) -> dict[str, Any]:
    from pydantic import ConfigDict, TypeAdapter

    hints, config = annotations_of(cls), ConfigDict(arbitrary_types_allowed=True)
    return {
        item.name: TypeAdapter(_as_instances(hint), config=None if _table_class(hint) or is_dataclass(hint) else config)
        for item in fields(cls)
        for hint in [hints[item.name]]
    }


def _as_instances(hint: Any) -> Any:
    """Annotation that accepts components unchanged, because a component kind with fields is a dataclass."""
    from pydantic import InstanceOf

    mark: Any = InstanceOf
    if isinstance(hint, type) and issubclass(hint, Component):
        return Annotated[hint, mark()]
    if kind_within(hint) is None:
        return hint
    parts = tuple(map(_as_instances, get_args(hint)))
    return Union[parts] if get_origin(hint) in (Union, UnionType) else get_origin(hint)[parts]  # noqa: UP007


def _table_class(hint: Any) -> type | None:
    """Dataclass of the tables in an annotation such as ``tuple[Region, ...]``."""
    table: type | None = class_within(hint, lambda cls: is_dataclass(cls) and not issubclass(cls, Component))
    return table


def _with_field_names(hint: Any, value: Any, where: str) -> Any:
    """Rename the keys of tables in a field to the names of the class fields; refuse unknown keys.

    A single table stands for an array of one.
    """
    cls = _table_class(hint)
    if cls is None:
        try:
            only_numbers(hint, value)
        except ValueError as problem:
            raise SceneError(f"{where} must be {problem} (got {shown(value)})") from None
        return value
    if isinstance(value, list | tuple):
        return [_with_field_names(cls, item, f"{where}.{number}") for number, item in enumerate(value)]
    if not isinstance(value, Mapping):
        return value
    refuse_unknown(value, [item.name for item in fields(cls)], where)
    hints = annotations_of(cls)
    table = {
        field: _with_field_names(hints[field], entry, f"{where}.{name.replace('_', '-')}")
        for name, entry in value.items()
        for field in [name.replace("-", "_")]
    }
    return [table] if get_origin(hint) in (list, tuple) else table


def _convert(adapter: Any, value: Any, where: str) -> Any:
    from pydantic import ValidationError

    try:
        return adapter.validate_python(value)
    except ValidationError as problem:
        raise SceneError(explain_error(problem.errors()[0], where)) from None
