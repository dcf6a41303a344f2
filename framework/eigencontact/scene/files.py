"""Data files of the components of a scene: absolute paths and list, by the annotations of their classes."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import fields, is_dataclass
from importlib.resources import files
from pathlib import Path
from typing import Any, Literal, get_args, get_origin

from eigencontact.core.held_arrays import PREFIX
from eigencontact.core.quantities import DataFile, FileMark
from eigencontact.errors import PluginError
from eigencontact.hooks.registry import Registry, annotations_of
from eigencontact.scene.components import kind_within
from eigencontact.scene.schema import Scene
from eigencontact.scene.table import ComponentTable, OfKind, Table

__all__ = ["anchored"]

#: What a file beside the bundled scenes begins with.
GALLERY = "gallery:"

Place = Callable[[str], str]


def anchored(scene: Scene, registry: Registry) -> tuple[Scene, tuple[Path, ...]]:
    """Scene with absolute paths of its data files, and these files.

    Parameters
    ----------
    scene : Scene
        A relative path in it counts from the folder of the scene's file; without one it stays as it is.
    registry : Registry
        Knows which fields of a component are files (`eigencontact.core.quantities.DataFile`).

    Returns
    -------
    Scene, tuple of Path
        The files in the order of the scene, each once, those of the gallery too; they need not exist.
    """
    folder, places = scene.folder, dict[Path, None]()

    def place(name: str) -> str:
        if name.startswith(GALLERY):
            places[Path(str(files("eigencontact") / "gallery")) / name.removeprefix(GALLERY)] = None
            return name
        if name.startswith(PREFIX):
            return name
        path = Path(name) if folder is None else folder / name
        places[path] = None
        return str(path)

    return _in_model(scene, registry, place), tuple(places)


def _in_model(model: Any, registry: Registry, place: Place) -> Any:
    """Copy a table of a scene with its file paths placed."""
    changes: dict[str, Any] = {}
    for name, item in type(model).model_fields.items():
        value = getattr(model, name)
        kind = next((mark.kind for mark in item.metadata if isinstance(mark, OfKind)), None)
        if kind is not None:
            changes[name] = _in_component(value, kind, registry, place)
        elif any(isinstance(mark, FileMark) for mark in item.metadata):
            changes[name] = place(value)
        elif get_args(item.annotation)[:1] == (DataFile,):
            changes[name] = [place(path) for path in value]
        elif isinstance(value, Table):
            changes[name] = _in_model(value, registry, place)
        elif isinstance(value, list) and value and isinstance(value[0], Table):
            changes[name] = [_in_model(table, registry, place) for table in value]
    if isinstance(model, ComponentTable) and model.model_extra:  # the fields of a component stand in the table itself
        table = _in_component({"type": model.type, **model.model_extra}, model.kind, registry, place)
        changes |= {key: table[key] for key in model.model_extra}
    return model.model_copy(update=changes)


def _in_component(value: Any, kind: str, registry: Registry, place: Place) -> Any:
    """Make paths absolute in tables of components; tables of unknown components remain for a later check."""
    if isinstance(value, list | tuple):
        return [_in_component(item, kind, registry, place) for item in value]
    key = value.get("type") if isinstance(value, Mapping) else None
    if not isinstance(key, str):
        return value
    try:
        component = registry.get(kind, key).component
    except PluginError:
        return value
    return _in_table(component, value, registry, place)


def _in_table(cls: type, table: Mapping[str, Any], registry: Registry, place: Place) -> dict[str, Any]:
    hints = annotations_of(cls)
    field_hints = {item.name: hints[item.name] for item in fields(cls)}
    return {
        name: _placed(field_hints[field], value, registry, place)
        if (field := name.replace("-", "_")) in field_hints
        else value
        for name, value in table.items()
    }


def _placed(hint: Any, value: Any, registry: Registry, place: Place) -> Any:
    """Place the files in the value of a field, in arrays item by item."""
    if any(isinstance(mark, FileMark) for mark in getattr(hint, "__metadata__", ())):
        return place(str(value)) if isinstance(value, str | Path) else value
    kind = kind_within(hint)
    if kind is not None and get_origin(hint) is dict and isinstance(value, Mapping):
        return {name: _in_component(table, kind.kind, registry, place) for name, table in value.items()}
    if kind is not None:
        return _in_component(value, kind.kind, registry, place)
    if isinstance(hint, type) and is_dataclass(hint):
        if isinstance(value, list | tuple):
            return [_placed(hint, item, registry, place) for item in value]
        return _in_table(hint, value, registry, place) if isinstance(value, Mapping) else value
    if get_origin(hint) is Literal:
        return value
    inner = [argument for argument in get_args(hint) if argument is not Ellipsis]
    if get_origin(hint) in (tuple, list) and isinstance(value, list | tuple):
        item_hints = inner if Ellipsis not in get_args(hint) and len(inner) == len(value) else inner[:1] * len(value)
        return [_placed(argument, item, registry, place) for argument, item in zip(item_hints, value, strict=True)]
    for argument in inner:  # of a union; at most one of its members fits the value
        value = _placed(argument, value, registry, place)
    return value
