"""Installed plugins, bundled scenes and the disk cache, as data and as text."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

from eigencontact.errors import PluginError, ResultsError, SceneError
from eigencontact.hooks.registry import Entry, Registry
from eigencontact.reference.keys import keys_of
from eigencontact.reference.text import key_lines

__all__ = ["cache_data", "cache_text", "file_data", "gallery_data", "plugin_data", "plugin_text"]


def gallery_data() -> dict[str, str]:
    """Names and titles of the bundled scenes."""
    import tomllib

    from eigencontact.scene.loader import bundled_names, bundled_text

    return {name: str(tomllib.loads(bundled_text(name)).get("title", "")) for name in bundled_names()}


def cache_data(*, clear: bool = False, limit: str | None = None) -> dict[str, Any]:
    """Tables on disk, after all are removed (`clear`), or bounded by a size from now on (`limit`, as ``"2 GB"``).

    Raises
    ------
    SceneError
        A limit that is no size, or none to set as tables are turned off.
    ResultsError
        The folder cannot be written.
    """
    from eigencontact.core.table_cache import VARIABLE, table_cache
    from eigencontact.core.units import parse_quantity

    tables = table_cache()
    if tables is None:
        if limit is not None:
            raise SceneError(f"{VARIABLE} must name a folder for a limit to be set (got 'off'); unset it")
        return {"folder": None, "entries": 0, "bytes": 0, "limit": 0}
    if clear:
        tables.clear()
    if limit is not None:
        try:
            tables.set_limit(int(parse_quantity(limit, "B", "a size")))
        except ValueError as problem:
            raise SceneError(f"--limit must be {problem} (got {limit!r})") from None
        except OSError as problem:
            raise ResultsError(f"the cache in {tables.folder} must be writable (got {problem})") from problem
    entries = tables.entries()
    size = sum(entry.size for entry in entries)
    return {"folder": str(tables.folder), "entries": len(entries), "bytes": size, "limit": tables.limit}


def cache_text(data: dict[str, Any]) -> str:
    """Text of `cache_data` in one line."""
    from eigencontact.core.units import readable

    if data["folder"] is None:
        return "tables are not kept on disk"
    size, limit = readable(data["bytes"], "B"), readable(data["limit"], "B")
    return f"{data['entries']} tables, {size} of at most {limit}, in {data['folder']}"


def plugin_data(registry: Registry, key: str | None = None) -> dict[str, Any]:
    """Installed plugins (all, or those of one key) and broken ones, as plain data; ``type`` is the value in a scene.

    Raises
    ------
    PluginError
        No plugin has this key; names the nearest, and broken plugins.
    """
    entries = list(registry) if key is None else registry.named(key)
    if not entries:
        raise PluginError(registry.unknown(str(key)))
    return _data(registry, entries)


def file_data(registry: Registry, path: Path) -> dict[str, Any]:
    """Plugins of a single file, as plain data.

    Raises
    ------
    PluginError
        A file that cannot be used; says which line of it, and why.
    """
    from eigencontact.hooks.files import with_files

    installed = {(entry.full_key, entry.kind) for entry in registry}
    wider = with_files(registry, [path])
    return _data(wider, [entry for entry in wider if (entry.full_key, entry.kind) not in installed])


def _data(registry: Registry, entries: Iterable[Entry]) -> dict[str, Any]:
    broken = [{"name": b.name, "package": b.package, "reason": b.reason} for b in registry.broken]
    plugins = []
    for entry in entries:
        try:
            plugins.append(_entry(entry, registry.spelling(entry)))
        except Exception as problem:  # noqa: BLE001 - a stranger's class may answer with anything
            reason = f"it cannot be described: {type(problem).__name__}: {problem}"
            broken.append({"name": entry.key, "package": entry.origin, "reason": reason})
    return {"plugins": plugins, "broken": broken}


def _entry(entry: Entry, spelling: str) -> dict[str, Any]:
    cls = entry.component
    keys = list(keys_of(cls))
    return {
        "kind": entry.kind,
        "key": entry.key,
        "type": spelling,
        "package": entry.package,
        "version": entry.version,
        "summary": (cls.__doc__ or "").strip().split("\n")[0],
        "doc": cls.__doc__ or "",
        "parameters": [key.to_dict() for key in keys],
        "tables": {
            key.name: [table_key.to_dict() for table_key in keys_of(key.table)] for key in keys if key.table is not None
        },
        "references": [str(source) for source in getattr(cls, "references", ())],
    }


def plugin_text(data: dict[str, Any], *, detailed: bool) -> str:
    """Lines for the terminal."""
    lines: list[str] = []
    kind = ""
    for entry in data["plugins"]:
        if entry["kind"] != kind:
            kind = entry["kind"]
            lines += ["", kind] if lines else [kind]
        lines.append(f"  {entry['type']:<16} {entry['summary']}  ({entry['package']} {entry['version']})")
        if detailed:
            lines += _parameters(entry["parameters"], "    ")
            for name, keys in entry["tables"].items():
                lines += [f"    in each table of {name}:", *_parameters(keys, "      ")]
            lines += ["    sources:", *(f"      {source}" for source in entry["references"])]
    if data["broken"]:
        lines += ["", "broken, and why"]
        lines += [f"  {item['name']} of {item['package']}: {item['reason']}" for item in data["broken"]]
    return "\n".join(lines)


def _parameters(keys: Iterable[dict[str, Any]], indent: str) -> list[str]:
    return [line for key in keys for line in key_lines(key, indent=indent)]
