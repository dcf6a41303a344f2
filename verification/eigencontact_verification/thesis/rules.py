"""Numbers and trends of the rows of a study: the reductions that a rule names."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from itertools import pairwise
from typing import Any

from eigencontact.errors import SceneError
from eigencontact_verification.thesis.entries import Rule

__all__ = ["Row", "number_of", "selected"]

#: Parameters and numbers of a variant.
Row = tuple[Mapping[str, Any], Mapping[str, float]]
#: How near a parameter must be to the one that a rule names.
NEAR = 1e-3


def selected(rows: Iterable[Mapping[str, Any]], wanted: Mapping[str, Any]) -> list[Mapping[str, Any]]:
    """Rows of parameters that a rule names.

    Examples
    --------
    >>> selected([{"mu": 0.1}, {"mu": 0.2}, {"mu": 0.2, "rate": 2.0}], {"mu": [0.2, 0.3], "rate": "none"})
    [{'mu': 0.2}]
    """
    return [row for row in rows if all(_matches(row.get(name, "none"), value) for name, value in wanted.items())]


def number_of(rule: Rule, rows: Sequence[Row]) -> tuple[float | bool, str]:
    """Number of a rule, or whether its trend holds; and the numbers behind it in words.

    Raises
    ------
    SceneError
        Rows that the rule needs are missing, or are too many.
    """
    here = _read(rule, rows, rule.at)
    if rule.take == "at":
        return _one(here, rule, rule.at), ""
    if rule.take in ("ratio", "difference"):
        one, other = _one(here, rule, rule.at), _one(_read(rule, rows, rule.over), rule, rule.over)
        return one / other if rule.take == "ratio" else one - other, f"{one:.4g} and {other:.4g}"
    if len(here) < 2:
        raise SceneError(f"thesis: rule.at must leave two rows for {rule.take} (got {len(here)} for {dict(rule.at)})")
    ordered = sorted((values.get(rule.along, 0.0), number) for values, number in here)
    numbers = [number for _, number in ordered]
    words = ", ".join(f"{number:.4g}" for number in numbers)
    if rule.take in ("rising", "falling"):
        sign = 1 if rule.take == "rising" else -1
        return all(sign * (b - a) > 0 for a, b in pairwise(numbers)), words
    if rule.take == "place-of-max":
        return float(max(ordered, key=lambda one: one[1])[0]), words
    reductions: dict[str, Callable[[list[float]], float]] = {"max": max, "min": min, "spread": _spread}
    return reductions[rule.take](numbers), words


def _spread(numbers: list[float]) -> float:
    return (max(numbers) - min(numbers)) * len(numbers) / abs(sum(numbers))


def _read(rule: Rule, rows: Sequence[Row], wanted: Mapping[str, Any]) -> list[tuple[Mapping[str, Any], float]]:
    found = []
    for values, numbers in rows:
        if selected([values], wanted):
            missing = next((name for name in (rule.read, rule.per) if name and name not in numbers), None)
            if missing is not None:
                raise SceneError(f"thesis: rule.read must be a number of {rule.study} (got {missing!r})")
            found.append((values, numbers[rule.read] / (numbers[rule.per] if rule.per else 1.0)))
    return found


def _one(found: list[tuple[Mapping[str, Any], float]], rule: Rule, wanted: Mapping[str, Any]) -> float:
    if len(found) != 1:
        raise SceneError(f"thesis: a rule of {rule.study} must leave one row for {dict(wanted)} (got {len(found)})")
    return found[0][1]


def _matches(value: Any, wanted: Any) -> bool:
    if isinstance(wanted, list):
        return any(_matches(value, one) for one in wanted)
    if isinstance(value, str) or isinstance(wanted, str):
        return bool(value == wanted)
    return bool(abs(value - wanted) <= NEAR * abs(wanted))
