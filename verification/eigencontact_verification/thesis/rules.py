"""Numbers and trends of the rows of a study: the reductions that a rule names."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Any

from eigencontact.errors import SceneError
from eigencontact_verification.thesis.entries import Rule

__all__ = ["Row", "error_of", "number_of", "selected"]

#: How near a parameter must be to the one that a rule names.
NEAR = 1e-3


@dataclass(frozen=True)
class Row:
    """A variant of a study: its parameters, its numbers, and the errors that its run tells of them."""

    values: Mapping[str, Any]
    numbers: Mapping[str, float]
    errors: Mapping[str, float] = field(default_factory=dict)

    def shifted(self, name: str) -> Row:
        """The row with one number more by its error."""
        return replace(self, numbers={**self.numbers, name: self.numbers[name] + self.errors[name]})


def selected(rows: Iterable[Mapping[str, Any]], parameters: Mapping[str, Any]) -> list[Mapping[str, Any]]:
    """Rows of parameters that a rule names.

    Examples
    --------
    >>> selected([{"mu": 0.1}, {"mu": 0.2}, {"mu": 0.2, "rate": 2.0}], {"mu": [0.2, 0.3], "rate": "none"})
    [{'mu': 0.2}]
    """
    return [row for row in rows if all(_matches(row.get(name, "none"), value) for name, value in parameters.items())]


def number_of(rule: Rule, rows: Sequence[Row]) -> tuple[float | bool, str]:
    """Number of a rule, or whether its trend holds; and the numbers behind it in words.

    Raises
    ------
    SceneError
        Rows that the rule needs are missing, or are too many.
    """
    pairs = _read(rule, rows, rule.at)
    if rule.take == "at":
        return _single(pairs, rule, rule.at), ""
    if rule.take in ("ratio", "difference"):
        first, second = _single(pairs, rule, rule.at), _single(_read(rule, rows, rule.over), rule, rule.over)
        return first / second if rule.take == "ratio" else first - second, f"{first:.4g} and {second:.4g}"
    if len(pairs) < 2:
        raise SceneError(f"thesis: rule.at must leave two rows for {rule.take} (got {len(pairs)} for {dict(rule.at)})")
    ordered = sorted((values.get(rule.along, 0.0), number) for values, number in pairs)
    numbers = [number for _, number in ordered]
    numbers_in_words = ", ".join(f"{number:.4g}" for number in numbers)
    if rule.take in ("rising", "falling"):
        sign = 1 if rule.take == "rising" else -1
        return all(sign * (b - a) > 0 for a, b in pairwise(numbers)), numbers_in_words
    if rule.take == "place-of-max":
        return float(max(ordered, key=lambda first: first[1])[0]), numbers_in_words
    reductions: dict[str, Callable[[list[float]], float]] = {"max": max, "min": min, "spread": _spread}
    return reductions[rule.take](numbers), numbers_in_words


def error_of(rule: Rule, rows: Sequence[Row]) -> float | None:
    """Error of the number of a rule: what it changes by the error of each number behind it, in sum.

    None for a trend, and where a number behind it has no error.
    """
    value, _ = number_of(rule, rows)
    behind = [
        (n, name)
        for n, row in enumerate(rows)
        for name in dict.fromkeys((rule.read, rule.per))
        if name
        and any(selected([row.values], parameters) for parameters in (rule.at, *([rule.over] if rule.over else [])))
    ]
    if isinstance(value, bool) or any(name not in rows[n].errors for n, name in behind):
        return None
    shifted = ([*rows[:n], rows[n].shifted(name), *rows[n + 1 :]] for n, name in behind)
    return sum(abs(number_of(rule, shifted_rows)[0] - value) for shifted_rows in shifted)


def _spread(numbers: list[float]) -> float:
    return (max(numbers) - min(numbers)) * len(numbers) / abs(sum(numbers))


def _read(rule: Rule, rows: Sequence[Row], parameters: Mapping[str, Any]) -> list[tuple[Mapping[str, Any], float]]:
    numbers = []
    for row in rows:
        if selected([row.values], parameters):
            missing = next((name for name in (rule.read, rule.per) if name and name not in row.numbers), None)
            if missing is not None:
                raise SceneError(f"thesis: rule.read must be a number of {rule.study} (got {missing!r})")
            divisor = row.numbers[rule.per] if rule.per else 1.0
            numbers.append((row.values, row.numbers[rule.read] / divisor))
    return numbers


def _single(numbers: list[tuple[Mapping[str, Any], float]], rule: Rule, parameters: Mapping[str, Any]) -> float:
    if len(numbers) != 1:
        raise SceneError(
            f"thesis: a rule of {rule.study} must leave one row for {dict(parameters)} (got {len(numbers)})"
        )
    return numbers[0][1]


def _matches(value: Any, pattern: Any) -> bool:
    if isinstance(pattern, list):
        return any(_matches(value, item) for item in pattern)
    if isinstance(value, str) or isinstance(pattern, str):
        return bool(value == pattern)
    return bool(abs(value - pattern) <= NEAR * abs(pattern))
