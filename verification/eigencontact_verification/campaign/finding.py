"""What a campaign finds at a point of its map, and the verdict at a stated tolerance."""

from __future__ import annotations

from dataclasses import dataclass

from eigencontact_verification.campaign.runs import Point
from eigencontact_verification.reporting.verdict import Finding, largest, worst

__all__ = ["Judged", "MapFinding"]


@dataclass(frozen=True, kw_only=True)
class MapFinding(Finding):
    """Verdict on one quantity at one point.

    Attributes
    ----------
    tolerance : float
        See `eigencontact_verification.reporting.verdict.word_of`.
    claimed : bool
        Whether agreement is claimed here.
    error : float or None
        Largest |model - reference|, as `uncertainty` a part of the scale.
    value, reference : float or None
        Of a single number: that of the model and that of the reference.
    """

    tolerance: float
    claimed: bool
    error: float | None = None
    value: float | None = None
    reference: float | None = None


@dataclass(frozen=True, kw_only=True, eq=False)
class Judged:
    """A point with its verdicts, and what they cost.

    Attributes
    ----------
    point : Point
    findings : tuple of MapFinding
        By quantity.
    reference_seconds : float or None
        Wall time of the finest solution of the reference [s].
    all_seconds : float or None
        Of all its solutions: what an answer with its own error costs.
    reference_memory : float or None
        Largest memory of these [byte].
    gaps : tuple of str
        What cannot be judged, with the reasons.
    """

    point: Point
    findings: tuple[MapFinding, ...]
    reference_seconds: float | None = None
    all_seconds: float | None = None
    reference_memory: float | None = None
    gaps: tuple[str, ...] = ()

    @property
    def word(self) -> str:
        """Worst verdict."""
        return worst(one.word for one in self.findings)

    @property
    def error(self) -> float | None:
        """Largest error of all quantities."""
        return largest(one.error for one in self.findings)

    @property
    def breaks_claim(self) -> bool:
        """Whether it disagrees, or has no numbers, where agreement is claimed."""
        return any(one.claimed and one.word in ("disagrees", "failed") for one in self.findings)
