"""Findings of a campaign at a point of its map, and the verdict at a stated tolerance."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

from eigencontact_verification.campaign.runs import Point
from eigencontact_verification.reporting.verdict import Finding, largest, percent, worst

__all__ = ["JudgedPoint", "MapFinding"]


@dataclass(frozen=True, kw_only=True)
class MapFinding(Finding):
    """Verdict on one quantity at one point."""

    tolerance: float  #: see `eigencontact_verification.reporting.verdict.verdict_on`
    claimed: bool  #: whether agreement is claimed here
    error: float | None = None  #: largest |model - reference|, as `uncertainty` a part of the scale
    value: float | None = None  #: number of the model, where the quantity is a single number
    reference: float | None = None  #: number of the reference likewise
    run_error: float | None = None  #: numerical error of the model by its error bars, u_SA; a part of the scale

    @property
    def numbers(self) -> str:
        """Error and uncertainty in per cent."""
        return f"{percent(self.error)} ± {percent(self.uncertainty)}"

    def to_dict(self) -> dict[str, Any]:
        """Table for JSON; the numerical error of the model is stored as ``own``."""
        return {{"run_error": "own"}.get(name, name): value for name, value in asdict(self).items()}


@dataclass(frozen=True, kw_only=True, eq=False)
class JudgedPoint:
    """A point with its verdicts, and the cost of the reference."""

    point: Point
    findings: tuple[MapFinding, ...]  #: one for each quantity
    reference_seconds: float | None = None  #: wall time of the finest solution of the reference [s]
    all_seconds: float | None = None  #: wall time of all its solutions, which its own error needs [s]
    reference_memory: float | None = None  #: largest memory of these solutions [byte]
    gaps: tuple[str, ...] = ()  #: fields that cannot be judged, with the reasons

    @property
    def word(self) -> str:
        """Worst verdict."""
        return worst(finding.word for finding in self.findings)

    @property
    def error(self) -> float | None:
        """Largest error of all quantities."""
        return largest(finding.error for finding in self.findings)

    @property
    def breaks_claim(self) -> bool:
        """Whether it disagrees, or has no numbers, where agreement is claimed."""
        return any(finding.claimed and finding.word in ("disagrees", "failed") for finding in self.findings)
