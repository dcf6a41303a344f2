"""The reference of a scene for a terminal and for a page."""

from __future__ import annotations

import json
import textwrap
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from eigencontact.reference.tables import TableReference

__all__ = ["as_data", "as_markdown", "key_lines", "overview", "table_text"]


def overview(tables: Mapping[str, TableReference], width: int = 100) -> str:
    """Keys of the scene, then a list of all tables."""
    lines = [*_table_lines(tables[""], width), "", "Tables:"]
    names = max(map(len, tables))
    for place, table in tables.items():
        if place:
            head = f"  {place:<{names}}  "
            lines.append(head + textwrap.shorten(_plain(table.summary), width - len(head), placeholder=" …"))
    lines += ["", "`eigencontact schema TABLE` prints the keys of one; `eigencontact plugins KEY` those of a plugin."]
    return "\n".join(lines)


def table_text(table: TableReference, width: int = 100) -> str:
    """Keys of one table with meaning, unit, choices and default."""
    return "\n".join(_table_lines(table, width))


def _table_lines(table: TableReference, width: int) -> Iterator[str]:
    yield from textwrap.wrap(f"[{table.place or 'scene'}]  {_plain(table.summary)}", width, subsequent_indent="    ")
    for key in table.keys:
        yield ""
        yield from key_lines(key.to_dict(), width)
    if table.plugins:
        yield ""
        yield f"  type names a plugin ({table.kind}), whose parameters are further keys:"
        names = max(len(name) for name, _ in table.plugins)
        for name, line in table.plugins:
            head = f"    {name:<{names}}  "
            yield from textwrap.wrap(_plain(line), width, initial_indent=head, subsequent_indent=" " * len(head))


def key_lines(key: Mapping[str, Any], width: int = 100, indent: str = "  ") -> Iterator[str]:
    """Lines of one key, from plain data: valid values and default, then the meaning."""
    inner, default = indent + "    ", _default(key)
    head = f"{indent}{key['name']}: {key['takes']}" + (f"; {default}" if default else "")
    yield from textwrap.wrap(head, width, subsequent_indent=inner)
    yield from textwrap.wrap(_plain(key["meaning"]), width, initial_indent=inner, subsequent_indent=inner)


def _default(key: Mapping[str, Any]) -> str:
    if key["required"]:
        return "required"
    return "" if key["default"] in (None, "", [], [None]) else f"default {json.dumps(key['default'])}"


def _plain(text: str) -> str:
    """Docstring's words without the marks of reStructuredText."""
    return text.replace("``", "").replace("`", "")


def as_markdown(tables: Iterable[TableReference]) -> str:
    """The whole reference as a page: a heading and a table of keys for each table of the scene."""
    return "\n\n".join(map(_section, tables)) + "\n"


def _section(table: TableReference) -> str:
    lines = [f"## {f'`[{table.place}]`' if table.place else 'The scene'}", "", table.summary.replace("``", "`")]
    if table.keys:
        lines += ["", "| key | takes | default | meaning |", "|---|---|---|---|"]
        for key in table.keys:
            cells = _cell(key.valid_values), _cell(_shown(key.to_dict())), _cell(key.meaning)
            lines.append(f"| `{key.name}` | {' | '.join(cells)} |")
    if table.plugins:
        lines += ["", f"`type` names a plugin ({table.kind}), whose parameters are further keys:", ""]
        lines += [f"- `{name}`: {line.replace('``', '`')}" for name, line in table.plugins]
    return "\n".join(lines)


def _shown(key: Mapping[str, Any]) -> str:
    return "*required*" if key["required"] else _default(key).removeprefix("default ")


def _cell(text: str) -> str:
    return text.replace("``", "`").replace("|", "\\|")


def as_data(tables: Mapping[str, TableReference]) -> dict[str, Any]:
    """Plain data of all tables by place."""
    return {
        place: {
            "summary": table.summary,
            "keys": [key.to_dict() for key in table.keys],
            "kind": table.kind,
            "plugins": dict(table.plugins),
        }
        for place, table in tables.items()
    }
