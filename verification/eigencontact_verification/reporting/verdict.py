"""Verdicts in words, with their marks: what every judgement of verification has in common."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

__all__ = ["MARKS", "WORDS", "Finding", "largest", "percent", "validated", "verdict_on", "word_of", "worst"]

#: Verdicts from worst to best; only the last is agreement. "failed": a solution is missing.
WORDS = ("disagrees", "failed", "inconclusive", "agrees")
MARKS = {"agrees": "✓", "inconclusive": "?", "failed": "!", "disagrees": "✗"}
#: Largest u_val of a comparison that agrees, as a part of the value: agreement within more says little.
_COARSE = 0.05


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


def verdict_on(error: float, uncertainty: float, tolerance: float, run_error: float | None) -> tuple[str, str]:
    """Verdict on an error at a tolerance; after ASME V&V 20 where the numerical error of the judged side is known.

    Examples
    --------
    >>> verdict_on(0.01, 0.005, 0.02, None)[1]
    'error and uncertainty are within the tolerance'
    >>> verdict_on(0.01, 0.003, 0.02, 0.004)[1]
    'model or implementation error E ± u_val = 1 % ± 0.5 %'
    """
    if run_error is None:
        return word_of(error, uncertainty, tolerance)
    return validated(error, math.hypot(run_error, uncertainty))


def validated(error: float, uncertainty: float) -> tuple[str, str]:
    """Verdict on a comparison error E with its uncertainty u_val, both parts of the value, and its reason.

    References
    ----------
    ASME V&V 20-2009, section 1-5: the error of the model lies in the interval E ± u_val.

    Examples
    --------
    >>> validated(-0.002, 0.01)
    ('agrees', 'agrees within u_val = 1 %')
    >>> validated(0.03, 0.01)
    ('disagrees', 'model or implementation error E ± u_val = 3 % ± 1 %')
    >>> validated(0.03, 0.2)
    ('inconclusive', 'inconclusive: u_val = 20 % is more than 5 % of the value')
    """
    if not (math.isfinite(error) and math.isfinite(uncertainty)):
        return "failed", "a value is not finite"
    width = f"u_val = {100 * uncertainty:.2g} %"
    if abs(error) > uncertainty:
        return "disagrees", f"model or implementation error E ± {width.replace('=', f'= {100 * error:.2g} % ±')}"
    if uncertainty > _COARSE:
        return "inconclusive", f"inconclusive: {width} is more than {100 * _COARSE:.2g} % of the value"
    return "agrees", f"agrees within {width}"


def worst(verdicts: Iterable[str]) -> str:
    """Worst of several verdicts; "failed" of none."""
    return min(verdicts, key=WORDS.index, default="failed")


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
