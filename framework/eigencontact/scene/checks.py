"""Rules for single values of a scene; each raises ValueError with the rule in words."""

from __future__ import annotations

from collections.abc import Callable
from math import isfinite
from typing import Any

__all__ = ["at_least", "finite", "in_range", "non_negative", "one_or_many", "positive"]

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


def one_or_many(value: Any) -> Any:
    """Let a single table stand for an array of one."""
    return [value] if isinstance(value, dict) else value
