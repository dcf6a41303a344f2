"""Warnings of a run or a plan, and effects that a plan leaves out."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["Caution", "LeftOut"]


@dataclass(frozen=True, slots=True)
class LeftOut:
    """An effect that this package could model and a run does not, and the reason."""

    effect: str
    reason: str


@dataclass(frozen=True, slots=True)
class Caution:
    """A warning about limited accuracy.

    Attributes
    ----------
    code : str
        Kind, for programs: ``"contact-cells"``.
    words : str
        One sentence for people, with its numbers.
    error : float or None
        Estimate of the relative error that it means, for what `words` name; None where there is none.
    number : str
        Name of a number of the run that converges more slowly than others; empty where there is none.
    order : float
        Order with which that number converges with the cells; 0 if it does not converge.

    Examples
    --------
    >>> Caution("contact-cells", "the contact has 4 cells a radius", 0.015).to_dict()
    {'code': 'contact-cells', 'words': 'the contact has 4 cells a radius', 'error': 0.015}
    """

    code: str
    words: str
    error: float | None = None
    number: str = ""
    order: float = 0.0

    def to_dict(self) -> dict[str, object]:
        """Plain data for JSON."""
        slow = {"number": self.number, "order": self.order} if self.number else {}
        return {"code": self.code, "words": self.words, "error": self.error, **slow}
