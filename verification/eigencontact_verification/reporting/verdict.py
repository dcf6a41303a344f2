"""Verdicts in words, with their marks: what every judgement of verification has in common."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

__all__ = ["MARKS", "WORDS", "Finding", "largest", "percent", "word_of", "worst"]

#: Verdicts from worst to best; only the last is agreement. "failed": a solution is missing.
WORDS = ("disagrees", "failed", "inconclusive", "agrees")
MARKS = {"agrees": "✓", "inconclusive": "?", "failed": "!", "disagrees": "✗"}


@dataclass(frozen=True, kw_only=True)
class Finding:
    """Verdict on one quantity.

    Attributes
    ----------
    quantity : str
        Name of what is compared.
    word : str
        One of `WORDS`.
    reason : str
        Reason of the verdict.
    uncertainty : float or None
        Largest uncertainty of the reference, as a part of `scale`.
    scale : float or None
        Largest value of the field that is judged, in its unit.
    """

    quantity: str
    word: str
    reason: str
    uncertainty: float | None = None
    scale: float | None = None


def word_of(error: float, uncertainty: float, tolerance: float) -> tuple[str, str]:
    """Verdict on an error at a tolerance, and its reason.

    Examples
    --------
    >>> word_of(0.01, 0.005, 0.02)[0], word_of(0.018, 0.005, 0.02)[0], word_of(0.03, 0.005, 0.02)[0]
    ('agrees', 'inconclusive', 'disagrees')
    """
    if not (math.isfinite(error) and math.isfinite(uncertainty)):
        return "failed", "a value is not finite"
    if error + uncertainty <= tolerance:
        return "agrees", "error and uncertainty are within the tolerance"
    if error - uncertainty > tolerance:
        return "disagrees", "the error exceeds the tolerance by more than the uncertainty"
    return "inconclusive", "the uncertainty of the reference reaches across the tolerance"


def worst(words: Iterable[str]) -> str:
    """Worst of several verdicts; "failed" of none."""
    return min(words, key=WORDS.index, default="failed")


def largest(values: Iterable[float | None]) -> float | None:
    """Largest of the numbers that are known; None of none."""
    return max((value for value in values if value is not None), default=None)


def percent(value: float | None) -> str:
    """Part in per cent, two digits.

    Examples
    --------
    >>> percent(0.01234), percent(1.5), percent(None)
    ('1.2 %', '150 %', '–')
    """
    if value is None:
        return "–"
    number = float(f"{100 * value:.2g}")
    if 0.0 < number < 0.01:
        return "<0.01 %"
    return f"{number:g} %"
