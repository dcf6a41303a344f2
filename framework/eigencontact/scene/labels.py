"""Labels of tables of a scene in messages: the name, or the number of a table without a name."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Any

from eigencontact.errors import PlanError, PluginError, SceneError

__all__ = ["labelled", "labels_in_messages", "ordinal"]

#: Arrays of tables that may have a name, and what one of them is called.
_SINGULAR = {"stress": "stress", "inclusions": "inclusion", "eigenstrain": "eigenstrain", "layers": "layer"}
#: Layers stand in the medium of a body, or behind the key of the medium's plugin.
_PLACE = re.compile(
    r"(?<![\w.-])(?:(?:(?P<body>body[12])\.medium\.|[\w-]+\.)(?=layers\.))?"
    rf"(?P<group>{'|'.join(_SINGULAR)})\.(?P<number>\d+)(?!\w)(?P<rest>(?:\.[\w-]*\w)*)"
)
_ORDINALS = ("first", "second", "third", "fourth", "fifth", "sixth", "seventh", "eighth", "ninth", "tenth")


def ordinal(number: int) -> str:
    """Place in an array, counted from 0, as people count.

    Examples
    --------
    >>> ordinal(0), ordinal(10), ordinal(21), ordinal(112)
    ('first', '11th', '22nd', '113th')
    """
    if number < len(_ORDINALS):
        return _ORDINALS[number]
    last = 0 if (number + 1) // 10 % 10 == 1 else (number + 1) % 10
    return f"{number + 1}{ {1: 'st', 2: 'nd', 3: 'rd'}.get(last, 'th') }"


def labelled(text: str, scene: Any) -> str:
    """Message with the name of each table in place of its dotted path; a table without a name has its number.

    Parameters
    ----------
    text : str
        The message.
    scene : Scene or mapping
        What it is about, with the tables ``stress``, ``inclusions``, ``eigenstrain`` and layers of a body's medium.

    Examples
    --------
    >>> tables = {"stress": [{"shape": "plane"}, {"name": "axis"}]}
    >>> labelled("stress.1.count must be 2 or more (got 1)", tables)
    "count of stress 'axis' (second) must be 2 or more (got 1)"
    >>> labelled("stress.0.normal must be one of 'x', 'y' or 'z' (got 'w')", tables)
    "stress.0.normal must be one of 'x', 'y' or 'z' (got 'w')"
    """

    def named(match: re.Match[str]) -> str:
        number = int(match["number"])
        name = _name(scene, match["group"], number, text)
        if not name:
            return match[0]
        body = f" of {match['body']}" if match["body"] else ""
        label = f"{_SINGULAR[match['group']]} {name!r} ({ordinal(number)}){body}"
        return f"{match['rest'][1:]} of {label}" if match["rest"] else label

    return _PLACE.sub(named, text)


@contextmanager
def labels_in_messages(scene: Any) -> Iterator[None]:
    """Add the names of tables of a scene to errors raised within the block; see `labelled`."""
    try:
        yield
    except (SceneError, PluginError, PlanError) as problem:
        problem.args = (labelled(str(problem), scene), *problem.args[1:])
        raise


def _name(scene: Any, group: str, number: int, text: str) -> str:
    if group == "layers":
        bodies = [name for name in ("body1", "body2") if name in text] or ["body1", "body2"]
        tables = [_get(_get(_get(scene, body), "medium"), "layers") for body in bodies]
    else:
        tables = [_get(scene, group)]
    names = [_get(table[number], "name") for table in tables if isinstance(table, list | tuple) and number < len(table)]
    return names[0] if len(names) == 1 and isinstance(names[0], str) else ""


def _get(table: Any, name: str) -> Any:
    return table.get(name) if isinstance(table, Mapping) else getattr(table, name, None)
