"""Report of a solver: a certificate of its solution, and the history of its iterations."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

__all__ = ["Certificate", "Progress", "SolveReport"]

#: Called now and then with (text, residual, tolerance); must be quick.
Progress = Callable[[str, float, float], None]


@dataclass(frozen=True, kw_only=True, slots=True)
class Certificate:
    """Residuals of the contact conditions, checked on the whole window with a fresh convolution.

    Attributes
    ----------
    gap : float
        Largest gap, open or overlapping, at a loaded cell, relative to the largest deflection in contact, springs
        included (in uniform periodic contact, where that is zero, to what the prescribed load does to one cell).
    penetration : float
        Largest overlap at an unloaded cell, relative to the same.
    load : float
        Largest error of a prescribed force or moment, relative to it (a moment: to the load times the half window).
    tolerance : float
        Bound that all three meet when the solve is converged.
    """

    gap: float
    penetration: float
    load: float
    tolerance: float

    @property
    def worst(self) -> float:
        """Largest of the residuals."""
        return max(self.gap, self.penetration, self.load)

    @property
    def holds(self) -> bool:
        """Whether every residual is within the tolerance (NaN is not)."""
        return self.worst <= self.tolerance

    def __str__(self) -> str:
        return (
            f"gap {self.gap:.1e}, penetration {self.penetration:.1e}, load {self.load:.1e} "
            f"(tolerance {self.tolerance:.1e})"
        )


@dataclass(slots=True)
class SolveReport:
    """Course of a solve.

    Attributes
    ----------
    certificate : Certificate or None
        Of the last iterate; None if it never got that far.
    history : list of (cells, residual)
        One entry per iteration: cells of the grid it ran on, and its relative residual.
    convolutions : int
        Applications of the compliance on all grids.
    seconds : float
        Wall time.
    """

    certificate: Certificate | None = None
    history: list[tuple[int, float]] = field(default_factory=list)
    convolutions: int = 0
    seconds: float = 0.0

    @property
    def iterations(self) -> int:
        """Iterations on all grids."""
        return len(self.history)
