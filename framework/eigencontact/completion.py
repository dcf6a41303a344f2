"""Shell completion of scenes, plugins, tables and kinds, without slow imports.

Keys of plugins and tables of a scene are read from the text of their modules; a test compares both with what is
installed.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from importlib.metadata import EntryPoint, entry_points
from importlib.resources import files
from importlib.util import find_spec
from pathlib import Path

from eigencontact.skeleton import TEMPLATES

__all__ = ["bundled", "kinds", "plugin_keys", "results", "scenes", "tables"]

_GALLERY = files("eigencontact") / "gallery"
_KEY = re.compile(r"""^    key(?:: ClassVar\[str\])? = ["']([^"'\n]+)["']""", re.MULTILINE)


#: Class with its base, and a field of it with its annotation, in the modules of the scene.
_CLASS = re.compile(r"^class (\w+)\(([\w, ]+)\):(.*?)(?=^\S|\Z)", re.MULTILINE | re.DOTALL)
_FIELD = re.compile(r"^    (\w+): (.+)", re.MULTILINE)


def bundled(incomplete: str) -> list[str]:
    """Bundled scenes that begin so."""
    names = (item.name for item in _GALLERY.iterdir())
    return _beginning((name.removesuffix(".toml") for name in names if name.endswith(".toml")), incomplete)


def scenes(incomplete: str) -> list[str]:
    """Bundled scenes, folders and TOML files that begin so."""
    return [*bundled(incomplete), *_paths(incomplete, ".toml")]


def results(incomplete: str) -> list[str]:
    """Folders and NetCDF files that begin so."""
    return _paths(incomplete, ".nc")


def tables(incomplete: str) -> list[str]:
    """Tables of a scene that begin so."""
    modules = sorted((files("eigencontact") / "scene").iterdir(), key=lambda item: item.name)
    texts = "\n".join(item.read_text(encoding="utf-8") for item in modules if item.name.endswith(".py"))
    own_fields = {
        name: (re.findall(r"\w+", bases), _FIELD.findall(body)) for name, bases, body in _CLASS.findall(texts)
    }
    classes = {
        name: [*fields, *(item for base in bases if base in own_fields for item in own_fields[base][1])]
        for name, (bases, fields) in own_fields.items()
    }
    return _beginning(_tables_of("Scene", "", classes, frozenset()), incomplete)


def _tables_of(
    name: str, place: str, classes: Mapping[str, list[tuple[str, str]]], above: frozenset[str]
) -> Iterator[str]:
    """Keys of the tables in a table: fields that hold one of the classes, or a plugin (`OfKind`)."""
    for field, annotation in classes[name]:
        inner = f"{place}.{field.replace('_', '-')}".strip(".")
        table = next((word for word in re.findall(r"\w+", annotation) if word in classes and word != "OfKind"), None)
        if "OfKind(" in annotation:
            yield inner
        elif table is not None and table not in above | {name}:
            yield inner
            yield from _tables_of(table, inner, classes, above | {name})


def kinds(incomplete: str) -> list[str]:
    """Kinds of plugin that can be begun from a template."""
    return _beginning(TEMPLATES, incomplete)


def plugin_keys(incomplete: str) -> list[str]:
    """Keys of installed plugins with a prefix, if their modules define them as plain text."""
    keys = set[str]()
    for point in entry_points(group="eigencontact"):
        keys.update(_KEY.findall(_text(point)))
    return _beginning(keys, incomplete)


def _text(point: EntryPoint) -> str:
    """Source of the module of an entry point; empty if it cannot be found (other commands report this)."""
    try:
        spec = find_spec(point.module)
        if spec is None or spec.origin is None:
            return ""
        return Path(spec.origin).read_text(encoding="utf-8")
    except Exception:  # noqa: BLE001 - a stranger's package may raise anything at import
        return ""


def _beginning(names: Iterable[str], incomplete: str) -> list[str]:
    return sorted(name for name in names if name.startswith(incomplete))


def _paths(incomplete: str, ending: str) -> list[str]:
    """Folders, and files with an extension, that match typed text."""
    folder, _, begin = incomplete.rpartition("/")
    place = Path(f"{folder}/" if folder or incomplete.startswith("/") else ".").expanduser()
    prefix = incomplete[: len(incomplete) - len(begin)]
    try:
        items = sorted(item for item in place.iterdir() if item.name.startswith(begin) and item.name[0] != ".")
        return [
            f"{prefix}{item.name}{'/' if item.is_dir() else ''}"
            for item in items
            if item.is_dir() or item.suffix == ending
        ]
    except OSError:
        return []
