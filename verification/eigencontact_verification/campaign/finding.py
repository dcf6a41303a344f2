"""What a campaign finds at a point of its map, and the verdict at a stated tolerance."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from eigencontact_verification.campaign.runs import Point
from eigencontact_verification.crosscheck.judge import WORDS

__all__ = ["Finding", "Judged", "word_of", "worst"]


@dataclass(frozen=True, kw_only=True)
class Finding:
    """Verdict on one quantity at one point.

    Attributes
    ----------
    quantity : str
    word : str
        "agrees": error and uncertainty together are within the tolerance; "disagrees": the error is beyond it even less
        the uncertainty; "inconclusive": between; "failed": no numbers.
    reason : str
        Why.
    tolerance : float
        See `word`.
    claimed : bool
        Whether agreement is claimed here.
    error, uncertainty : float or None
        Largest |model - reference| and largest u_ref, parts of the scale.
    value, reference, scale : float or None
        Of a single number: that of the model and that of the reference; what errors are parts of.
    """

    quantity: str
    word: str
    reason: str
    tolerance: float
    claimed: bool
    error: float | None = None
    uncertainty: float | None = None
    value: float | None = None
    reference: float | None = None
    scale: float | None = None


@dataclass(frozen=True, kw_only=True, eq=False)
class Judged:
    """A point with its verdicts, and what they cost.

    Attributes
    ----------
    point : Point
    findings : tuple of Finding
        By quantity.
    reference_seconds : float or None
        Wall time of the finest solution of the reference [s].
    all_seconds : float or None
        Of all its solutions: what an answer with its own error costs.
    reference_memory : int or None
        Largest memory of these [byte].
    gaps : tuple of str
        What cannot be judged, with the reasons.
    """

    point: Point
    findings: tuple[Finding, ...]
    reference_seconds: float | None = None
    all_seconds: float | None = None
    reference_memory: int | None = None
    gaps: tuple[str, ...] = ()

    @property
    def word(self) -> str:
        """Worst verdict."""
        return worst(one.word for one in self.findings)

    @property
    def error(self) -> float | None:
        """Largest error of all quantities."""
        known = [one.error for one in self.findings if one.error is not None]
        return max(known) if known else None

    @property
    def breaks_claim(self) -> bool:
        """Whether it disagrees, or has no numbers, where agreement is claimed."""
        return any(one.claimed and one.word in ("disagrees", "failed") for one in self.findings)


def word_of(error: float, uncertainty: float, tolerance: float) -> tuple[str, str]:
    """Verdict and its reason.

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
    found: Sequence[str] = list(words)
    return min(found, key=WORDS.index) if found else "failed"
