"""Rules for single values of a scene; each raises ValueError with the rule in words."""

from __future__ import annotations

import unicodedata
from collections.abc import Callable, Iterator
from math import isfinite
from typing import Any

import numpy as np

from eigencontact.core.names import FOLDER_RULE, is_folder_name
from eigencontact.core.quantities import Unit, unit_as_read
from eigencontact.core.units import LARGEST, NUMBER, SMALLEST
from eigencontact.errors import SceneError
from eigencontact.scene.annotations import parts_of

__all__ = [
    "BOUNDARY_OF_AXES",
    "at_least",
    "both_alike",
    "boundary_of_axes",
    "finite",
    "folder_name",
    "in_range",
    "non_negative",
    "one_or_many",
    "only_numbers",
    "positive",
    "printable",
    "refuse_deep",
]

Check = Callable[[float], float]


def _check(rule: str, holds: Callable[[float], bool], unit: str = "") -> Check:
    def validate(value: float) -> float:
        if not holds(value):
            raise ValueError(rule.replace(f"[{unit}]", f"[{unit_as_read(unit)}]"))
        return value

    return _with_rule(validate, rule)


def _with_rule(validate: Check, rule: str) -> Check:
    """Check with its rule as an attribute, for the reference of the scene."""
    validate.rule = rule  # type: ignore[attr-defined]
    return validate


def positive(unit: str) -> Check:
    """Positive and finite, of a size that can be reckoned with."""
    return _sized(unit, _check(f"positive and finite [{unit}]", lambda value: value > 0 and isfinite(value), unit))


def non_negative(unit: str) -> Check:
    """Zero or positive, and finite, of a size that can be reckoned with."""
    rule = f"zero or positive, and finite [{unit}]"
    return _sized(unit, _check(rule, lambda value: value >= 0 and isfinite(value), unit))


def finite(unit: str) -> Check:
    """Require a finite number within the range of computations; small numbers may result from rounding."""
    return _sized(unit, _check(f"finite [{unit}]", isfinite, unit), smallest=0.0)


def _sized(unit: str, check: Check, smallest: float = SMALLEST) -> Check:
    def validate(value: float) -> float:
        if check(value) and not smallest <= abs(value) <= LARGEST:
            raise ValueError(f"of a size between {smallest:g} and {LARGEST:g} [{unit_as_read(unit)}]")
        return value

    return _with_rule(validate, check.rule)  # type: ignore[attr-defined]


def at_least(low: float) -> Callable[[Any], Any]:
    """`low` or more."""
    return _check(f"{low:g} or more", lambda value: low <= value <= LARGEST)


def in_range(low: float, high: float, unit: str, *, open_low: bool = False) -> Check:
    """Within an interval."""
    bracket = "(" if open_low else "["
    return _check(f"in {bracket}{low:g}, {high:g}] {unit}", lambda v: (low < v if open_low else low <= v) and v <= high)


def folder_name(value: str) -> str:
    """Require a valid folder name, or an empty text."""
    if value and not is_folder_name(value):
        raise ValueError(FOLDER_RULE)
    return value


def printable(value: str) -> str:
    """Require text without control characters, which results, pictures and terminals cannot contain."""
    if any(unicodedata.category(letter) in ("Cc", "Cs") and letter not in "\t\n\r" for letter in value):
        raise ValueError("text without control characters")
    return value


def only_numbers(hint: Any, value: Any) -> None:
    """Refuse booleans, complex numbers and texts, which pydantic would convert to numbers.

    Text is a number only where it is written as one, or where the field has a unit, which then reads it.

    Parameters
    ----------
    hint : type or annotation
        Of the field.
    value : object
        One value, or arrays of them.

    Raises
    ------
    ValueError
        The rule.
    """
    elements = list(parts_of(hint))
    if not any(
        element in (int, float) or (isinstance(element, int) and not isinstance(element, bool)) for element in elements
    ):
        return
    choices = [element for element in elements if isinstance(element, str)]
    text_read = str in elements or any(isinstance(element, Unit) for element in elements)
    for item in _items(value):
        kind = getattr(getattr(item, "dtype", None), "kind", "")
        if isinstance(item, str):
            good = text_read or item in choices or bool(NUMBER.fullmatch(item.strip()))
        elif isinstance(item, bool) or kind == "b":
            good = bool in elements
        else:
            good = not (isinstance(item, complex) or kind == "c" or np.ma.is_masked(item))
        if not good:
            raise ValueError("a number")


def _items(value: Any) -> Iterator[Any]:
    """Single values of nested arrays; a numpy array counts as one value by its type."""
    if isinstance(value, list | tuple):
        for item in value:
            yield from _items(item)
    else:
        yield value


#: Tables and arrays of a scene nest no deeper than this; a matrix in a table in an array of tables is at six.
_DEEPEST = 32


def refuse_deep(data: Any) -> None:
    """Refuse tables that are nested too deeply.

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


def both_alike(value: Any) -> Any:
    """Convert a single value to a pair for both directions."""
    return [value, value] if isinstance(value, int | float | str) and not isinstance(value, bool) else value


#: Names of boundaries by those along the axes x and y.
BOUNDARY_OF_AXES = {
    ("non-periodic", "periodic"): "periodic-y",
    ("non-periodic", "non-periodic"): "non-periodic",
    ("periodic", "periodic"): "periodic",
}


def boundary_of_axes(value: Any) -> Any:
    """Name of the boundary along the axes x and y."""
    if not isinstance(value, list | tuple):
        return value
    if tuple(value) == ("periodic", "non-periodic"):
        raise ValueError("periodic along y where it is along one axis; turn the scene by 90 degrees")
    return BOUNDARY_OF_AXES.get(tuple(value), value)


def one_or_many(value: Any) -> Any:
    """Convert a single table to an array with one element."""
    return [value] if isinstance(value, dict) else value
