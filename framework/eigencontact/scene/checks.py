"""Rules for single values of a scene; each raises ValueError with the rule in words."""

from __future__ import annotations

import unicodedata
from collections.abc import Callable
from math import isfinite
from typing import Any

from eigencontact.core.names import FOLDER_RULE, is_folder_name
from eigencontact.errors import SceneError

__all__ = [
    "at_least",
    "finite",
    "folder_name",
    "in_range",
    "non_negative",
    "one_or_many",
    "positive",
    "printable",
    "refuse_deep",
]

Check = Callable[[float], float]


def _check(rule: str, holds: Callable[[float], bool]) -> Check:
    def validate(value: float) -> float:
        if not holds(value):
            raise ValueError(rule)
        return value

    return validate


def positive(unit: str) -> Check:
    """Positive and finite."""
    return _check(f"positive and finite [{unit}]", lambda value: value > 0 and isfinite(value))


def non_negative(unit: str) -> Check:
    """Zero or positive, and finite."""
    return _check(f"zero or positive, and finite [{unit}]", lambda value: value >= 0 and isfinite(value))


def finite(unit: str) -> Check:
    """Not NaN, not infinite."""
    return _check(f"finite [{unit}]", isfinite)


def at_least(low: float) -> Callable[[Any], Any]:
    """`low` or more."""
    return _check(f"{low:g} or more", lambda value: low <= value and isfinite(value))


def in_range(low: float, high: float, unit: str, *, open_low: bool = False) -> Check:
    """Within an interval."""
    bracket = "(" if open_low else "["
    return _check(f"in {bracket}{low:g}, {high:g}] {unit}", lambda v: (low < v if open_low else low <= v) and v <= high)


def folder_name(value: str) -> str:
    """Name that is safe for a folder, or none."""
    if value and not is_folder_name(value):
        raise ValueError(FOLDER_RULE)
    return value


def printable(value: str) -> str:
    """Text without control characters: results, pictures and terminals cannot hold them."""
    if any(unicodedata.category(letter) == "Cc" and letter not in "\t\n\r" for letter in value):
        raise ValueError("text without control characters")
    return value


#: Tables and arrays of a scene nest no deeper than this; a matrix in a table in an array of tables is at six.
_DEEPEST = 32


def refuse_deep(data: Any) -> None:
    """Refuse tables nested so deep that nothing could read them, before anything tries to.

    Raises
    ------
    SceneError
        Naming the limit.
    """
    level = [data]
    for _ in range(_DEEPEST):
        level = [
            inner
            for item in level
            if isinstance(item, dict | list | tuple)
            for inner in (item.values() if isinstance(item, dict) else item)
            if isinstance(inner, dict | list | tuple)
        ]
        if not level:
            return
    raise SceneError(f"scene must be of tables and arrays nested at most {_DEEPEST} deep (got more)")


def one_or_many(value: Any) -> Any:
    """Let a single table stand for an array of one."""
    return [value] if isinstance(value, dict) else value
