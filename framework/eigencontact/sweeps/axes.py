"""Axis of a sweep: a key of the scene and its values."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import isfinite
from typing import Any

import numpy as np

from eigencontact.core.units import NUMBER
from eigencontact.errors import SceneError, shown
from eigencontact.scene.loader import value_of_text

__all__ = ["Axis", "axes_of", "axis_of_text"]

_RULE = "key=a,b,c or key=from:to:n or key=from:to:n:log"
_MOST = 100_000


@dataclass(frozen=True, slots=True)
class Axis:
    """Key of the scene, dotted as in ``--set``, and its values as in a scene."""

    key: str
    values: tuple[Any, ...]

    @property
    def name(self) -> str:
        """Name of the coordinate: the key with ``_`` for characters that names cannot contain."""
        return re.sub(r"\W+", "_", self.key).strip("_")


def axis_of_text(text: str) -> Axis:
    """Axis of ``key=a,b,c`` or ``key=from:to:n[:log]``; values may carry units.

    Raises
    ------
    SceneError
        The rule that the text breaks.

    Examples
    --------
    >>> axis_of_text("geometry.radius=1 mm:3 mm:3").values
    ('1 mm', '2 mm', '3 mm')
    >>> axis_of_text("friction.coefficient=0.001:0.1:3:log").values
    (0.001, 0.01, 0.1)
    """
    key, equals, listed = text.partition("=")
    if not equals or not key.strip() or not listed.strip():
        raise SceneError(f"--vary must be {_RULE} (got {text!r})")
    key = key.strip()
    pieces = [piece.strip() for piece in listed.split(":")]
    if 3 <= len(pieces) <= 4 and all(NUMBER.match(piece) for piece in pieces[:2]):
        if pieces[3:] not in ([], ["log"]):
            raise SceneError(f"--vary {key} must be from:to:n or from:to:n:log (got {listed!r})")
        return Axis(key, _between(key, pieces[0], pieces[1], value_of_text(pieces[2]), log=len(pieces) == 4))
    return _checked(key, [value_of_text(piece) for piece in _split(listed)])


def axes_of(vary: Mapping[str, Any] | Sequence[str]) -> list[Axis]:
    """Axes of a table, whose values are arrays or tables with from, to, count and log; or of texts.

    Raises
    ------
    SceneError
        Nothing to vary, a key twice, no values; neither a table nor texts.
    """
    if isinstance(vary, Mapping):
        axes = [_of_table(str(key), value) for key, value in vary.items()]
    elif isinstance(vary, str) or not isinstance(vary, Sequence) or not all(isinstance(text, str) for text in vary):
        raise SceneError(f"vary must be a table of values by key, or an array of texts {_RULE} (got {shown(vary)})")
    else:
        axes = [axis_of_text(text) for text in vary]
    if not axes:
        raise SceneError(f"sweep must vary something: {_RULE}")
    names = [axis.name for axis in axes]
    duplicate = next((axis.key for axis in axes if names.count(axis.name) > 1), None)
    if duplicate is not None:
        raise SceneError(f"sweep must vary each key once (got {duplicate!r} twice)")
    return axes


def _of_table(key: str, value: Any) -> Axis:
    if isinstance(value, Mapping):
        unknown = sorted(set(value) - {"from", "to", "count", "log"})
        if unknown or not {"from", "to", "count"} <= set(value):
            raise SceneError(f"vary.{key} must be an array, or a table of from, to, count and log (got {shown(value)})")
        ends = str(value["from"]), str(value["to"])
        if not isinstance(log := value.get("log", False), bool):
            raise SceneError(f"vary.{key}.log must be true or false (got {shown(log)})")
        return Axis(key, _between(key, *ends, value["count"], log=log))
    if isinstance(value, np.ndarray) and value.ndim:
        value = list(value)
    if isinstance(value, str) or not isinstance(value, Sequence):
        raise SceneError(f"vary.{key} must be an array of values (got {shown(value)})")
    return _checked(key, [item.tolist() if isinstance(item, np.ndarray | np.generic) else item for item in value])


def _checked(key: str, values: list[Any]) -> Axis:
    if not values:
        raise SceneError(f"vary.{key} must have at least one value (got none)")
    duplicate = next((value for k, value in enumerate(values) if value in values[:k]), None)
    if duplicate is not None:
        raise SceneError(f"vary.{key} must have each value once (got {shown(duplicate)} twice)")
    return Axis(key, tuple(values))


def _between(key: str, first: str, last: str, count: Any, *, log: bool) -> tuple[Any, ...]:
    """Values spaced evenly, or by ratio, to six digits; with the unit that both ends have."""
    (low, unit), (high, last_unit) = _number(key, first), _number(key, last)
    if unit != last_unit:
        raise SceneError(f"vary.{key} must have one unit at both ends (got {first!r} and {last!r})")
    if isinstance(count, bool) or not isinstance(count, int) or not 2 <= count <= _MOST:
        raise SceneError(f"vary.{key} must have 2 to {_MOST} values (got {shown(count)})")
    if log and not (low > 0 and high > 0):
        raise SceneError(f"vary.{key} must lie above 0 to be spaced by logarithms (got {first!r} to {last!r})")
    numbers = np.geomspace(low, high, count) if log else np.linspace(low, high, count)
    rounded = [low, *(float(f"{number:.6g}") for number in numbers[1:-1]), high]
    are_whole = not unit and all(re.fullmatch(r"[+-]?\d+", text.strip()) for text in (first, last))
    plain: list[Any] = (
        [int(number) for number in rounded] if are_whole and all(number.is_integer() for number in rounded) else rounded
    )
    return _checked(key, [f"{number:.15g} {unit}" for number in plain] if unit else plain).values


def _number(key: str, text: str) -> tuple[float, str]:
    match = NUMBER.match(text.strip())
    if match is None or not isfinite(float(match[0])):
        raise SceneError(f"vary.{key} must go from a number to a number (got {text!r})")
    return float(match[0]), text.strip()[match.end() :].strip()


def _split(text: str) -> list[str]:
    """Parts between commas outside brackets, braces and quotes."""
    pieces, depth, quote = [""], 0, ""
    for letter in text:
        if quote:
            quote = "" if letter == quote else quote
        elif letter in "\"'":
            quote = letter
        depth += 0 if quote else (letter in "[{") - (letter in "]}")
        if letter == "," and not depth and not quote:
            pieces.append("")
        else:
            pieces[-1] += letter
    return [piece.strip() for piece in pieces if piece.strip()]
