"""Loading a scene: a TOML file, a bundled name, a mapping; with changes from the command line."""

from __future__ import annotations

import tomllib
from collections.abc import Iterable, Mapping
from importlib.resources import files
from os import PathLike
from pathlib import Path
from typing import Any

from eigencontact.core.names import to_folder_name
from eigencontact.errors import SceneError, nearest, shown
from eigencontact.scene.checks import refuse_deep
from eigencontact.scene.plain import plain
from eigencontact.scene.schema import Scene

__all__ = ["apply_changes", "bundled_names", "bundled_text", "load_scene_file", "put_values", "value_of_text"]

#: Forty names in one line hide what is wrong.
_LISTED = "`eigencontact gallery` lists the bundled scenes"


def bundled_names() -> list[str]:
    """Names of the bundled scenes."""
    folder = files("eigencontact") / "gallery"
    return sorted(item.name.removesuffix(".toml") for item in folder.iterdir() if item.name.endswith(".toml"))


def bundled_text(name: str) -> str:
    """TOML text of a bundled scene."""
    if name not in bundled_names():
        raise SceneError(f"unknown bundled scene {name!r}{nearest(name, bundled_names())}; {_LISTED}")
    return (files("eigencontact") / "gallery" / f"{name}.toml").read_text(encoding="utf-8")


def load_scene_file(source: str | Path, changes: Iterable[str] = ()) -> Scene:
    """Scene from a TOML file, whose folder its relative paths count from, or the name of a bundled scene.

    Parameters
    ----------
    source : str or Path
        Path of a TOML file, or a bundled scene's name.
    changes : iterable of str
        ``key=value`` with dotted keys, as ``--set`` of the command line gives them.

    Raises
    ------
    SceneError
        Missing or unreadable file, TOML that does not parse, or a scene that is refused.
    """
    if not isinstance(source, str | PathLike):
        raise SceneError(f"scene must be a TOML file, the name of a bundled scene, or its tables (got {shown(source)})")
    path = Path(source)
    if path.suffix == ".toml" or path.is_file():
        text, name, folder = _read(path), to_folder_name(path.stem), path.resolve().parent
    elif str(source) in bundled_names():
        text, name, folder = bundled_text(str(source)), str(source), None
    else:
        raise SceneError(
            f"scene must be a TOML file or the name of a bundled scene (got {str(source)!r}, and no such file)"
            f"{nearest(str(source), bundled_names())}; {_LISTED}"
        )
    try:
        data = tomllib.loads(text)
    except tomllib.TOMLDecodeError as problem:
        hint = f'; a scene names a plugin file, plugins = ["{path.name}"]' if path.suffix == ".py" else ""
        raise SceneError(f"{path} must be valid TOML: {problem}{hint}") from None
    except RecursionError:
        raise SceneError(f"{path} must be a scene (got tables or arrays nested hundreds deep)") from None
    return Scene(**{"name": name, **apply_changes(data, changes)}).within(folder)


def _read(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8")
    except FileNotFoundError:
        neighbours = sorted(item.name for item in path.parent.glob("*.toml")) if path.parent.is_dir() else []
        suggestion = nearest(path.name, neighbours) or nearest(path.stem, bundled_names())
        raise SceneError(f"scene file must exist (got {str(path)!r}){suggestion}; {_LISTED}") from None
    except (OSError, ValueError) as problem:  # ValueError: bytes that are no text, a path with a zero in it
        raise SceneError(f"scene file must be readable text (got {str(path)!r}): {problem}") from None


def apply_changes(data: Mapping[str, Any], changes: Iterable[str], option: str = "--set") -> dict[str, Any]:
    """Return the tables with ``key=value`` changes applied; `option` is the name of their option, for messages.

    A dotted key walks through tables; a number picks an entry of an array, and may be left out where there is one.

    Examples
    --------
    >>> apply_changes({"steps": [{"normal-load": 1.0}]}, ["steps.normal-load=2 N"])
    {'steps': [{'normal-load': '2 N'}]}
    """
    refuse_deep(data)
    out: dict[str, Any] = plain(data)
    for change in changes:
        key, equals, text = change.partition("=") if isinstance(change, str) else ("", "", "")
        if not equals or not key.strip():
            raise SceneError(
                f"{option} must be key=value with a dotted key, like body1.poisson-ratio=0.3 (got {change!r})"
            )
        _put(out, key, value_of_text(text.strip()), f"{option} {change!r}")
    return out


def put_values(data: Mapping[str, Any], values: Mapping[str, Any]) -> dict[str, Any]:
    """Return the tables with other values at dotted keys.

    Raises
    ------
    SceneError
        A key leads nowhere.

    Examples
    --------
    >>> put_values({"steps": [{"normal-load": 1.0}]}, {"steps.normal-load": "2 N"})
    {'steps': [{'normal-load': '2 N'}]}
    """
    from copy import deepcopy

    out = deepcopy(dict(data))
    for key, value in values.items():
        _put(out, key, value, f"vary.{key}")
    return out


def value_of_text(text: str) -> Any:
    """Value of a change: TOML if it parses, else plain text."""
    try:
        return tomllib.loads(f"value = {text}")["value"]
    except (tomllib.TOMLDecodeError, RecursionError):
        return text


def _put(table: Any, key: str, value: Any, change_text: str) -> None:
    path = [segment.strip() for segment in key.strip().split(".")]
    for position, segment in enumerate(path):
        last = position == len(path) - 1
        if isinstance(table, list):
            number = segment.isascii() and segment.isdigit()
            if not number and len(table) == 1:
                table = table[0]
            elif number and int(segment[:9]) < len(table):
                if last:
                    table[int(segment)] = value
                else:
                    table = table[int(segment)]
                continue
            else:
                choice = f"give a number from 0 to {len(table) - 1}" if table else "give all of it"
                place = ".".join(path[:position])
                raise SceneError(f"{change_text}: {place} is an array of {len(table)}; {choice} (got {segment!r})")
        if not isinstance(table, dict):
            raise SceneError(f"{change_text}: {'.'.join(path[:position])} is no table (got {table!r})")
        name = next(
            (table_key for table_key in table if table_key.replace("_", "-") == segment.replace("_", "-")), segment
        )
        if last:
            table[name] = value
        else:
            if isinstance(table.get(name), str):
                table[name] = {}
            table = table.setdefault(name, {})
