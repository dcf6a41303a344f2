"""Reports of solvers: certificate of the solution, and history of the iterations."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, fields
from typing import Generic, TypeVar

__all__ = ["Certificate", "FrictionCertificate", "Progress", "SolveReport"]

#: Called during a solve with (text, residual, tolerance); must be fast.
Progress = Callable[[str, float, float], None]


@dataclass(frozen=True, kw_only=True, slots=True)
class Residuals:
    """Residuals of the conditions of a solution, computed on the whole window with a new convolution.

    Attributes
    ----------
    tolerance : float
        Bound of all residuals of a converged solve.
    """

    tolerance: float

    def _by_name(self) -> dict[str, float]:
        return {item.name: getattr(self, item.name) for item in fields(self) if item.name != "tolerance"}

    @property
    def worst(self) -> float:
        """Largest of the residuals."""
        return max(self._by_name().values())

    @property
    def holds(self) -> bool:
        """Whether every residual is within the tolerance (NaN is not)."""
        return self.worst <= self.tolerance

    def __str__(self) -> str:
        residuals = ", ".join(f"{name} {value:.1e}" for name, value in self._by_name().items())
        return f"{residuals} (tolerance {self.tolerance:.1e})"


@dataclass(frozen=True, kw_only=True, slots=True)
class Certificate(Residuals):
    """Residuals of the normal contact.

    Attributes
    ----------
    gap : float
        Largest gap, open or overlapping, in a loaded cell, relative to the largest deflection in contact, springs
        included. In uniform periodic contact, where that deflection is zero, the reference is the deflection of one
        cell by the prescribed load.
    penetration : float
        Largest overlap in an unloaded cell, relative to the same deflection.
    load : float
        Largest relative error of a prescribed force or moment (moments: relative to the load times the half window).
    """

    gap: float
    penetration: float
    load: float


@dataclass(frozen=True, kw_only=True, slots=True)
class FrictionCertificate(Residuals):
    """Residuals of friction.

    Attributes
    ----------
    bound : float
        Largest excess of a shear traction over its bound, relative to the largest bound.
    stick : float
        Largest slip in a sticking cell in the increment, relative to the largest tangential displacement in contact.
    alignment : float
        Largest part of the slip of a slipping cell across its traction, or in its direction, relative to the same
        displacement.
    load : float
        Largest error of a prescribed force or moment, relative to the friction limit for it.
    """

    bound: float
    stick: float
    alignment: float
    load: float


AnyResiduals = TypeVar("AnyResiduals", bound=Residuals)


@dataclass(slots=True)
class SolveReport(Generic[AnyResiduals]):
    """Course of a solve.

    Attributes
    ----------
    certificate : Residuals or None
        Certificate of the last iterate; None if the solve ended before.
    history : list of (cells, residual)
        One entry per iteration: number of cells of its grid, and its relative residual.
    convolutions : int
        Applications of the compliance on all grids; for friction, of shear tractions to tangential displacements.
    seconds : float
        Wall time.
    """

    certificate: AnyResiduals | None = None
    history: list[tuple[int, float]] = field(default_factory=list)
    convolutions: int = 0
    seconds: float = 0.0

    @property
    def iterations(self) -> int:
        """Number of iterations on all grids; for friction, Newton steps."""
        return len(self.history)
