"""Estimated size of a contact from a coarse solution."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["ContactEstimate"]


@dataclass(frozen=True, slots=True)
class ContactEstimate:
    """Bounding box of the contact [m], and its largest pressure [Pa]; the length of a line contact equals its width."""

    x0: float
    x1: float
    y0: float
    y1: float
    peak: float = 0.0

    @property
    def extent(self) -> tuple[float, float]:
        """Widths along x and y [m]."""
        return self.x1 - self.x0, self.y1 - self.y0

    def moved(self, by: tuple[float, float]) -> ContactEstimate:
        """Estimate shifted along x and y [m]."""
        x, y = by
        return ContactEstimate(self.x0 + x, self.x1 + x, self.y0 + y, self.y1 + y, self.peak)

    def join(self, estimate: ContactEstimate) -> ContactEstimate:
        """Smallest estimate that contains both."""
        return ContactEstimate(
            min(self.x0, estimate.x0),
            max(self.x1, estimate.x1),
            min(self.y0, estimate.y0),
            max(self.y1, estimate.y1),
            max(self.peak, estimate.peak),
        )
