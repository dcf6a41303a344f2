"""Report of the tangential solver."""

from __future__ import annotations

from dataclasses import dataclass, field

__all__ = ["FrictionCertificate", "TangentialReport"]


@dataclass(frozen=True, kw_only=True, slots=True)
class FrictionCertificate:
    """Residuals of the friction conditions, checked with a convolution of their own on the whole window.

    Attributes
    ----------
    bound : float
        Largest excess of a shear traction over its bound, relative to the largest bound.
    stick : float
        Largest slip of a sticking cell in the increment, relative to the largest tangential displacement in contact.
    alignment : float
        Largest part of the slip of a slipping cell across its traction, or along it, relative to the same.
    load : float
        Largest error of a prescribed force or moment, relative to what friction could carry of it.
    tolerance : float
        Bound that all four meet when the solve is converged.
    """

    bound: float
    stick: float
    alignment: float
    load: float
    tolerance: float

    @property
    def worst(self) -> float:
        """Largest of the residuals."""
        return max(self.bound, self.stick, self.alignment, self.load)

    @property
    def holds(self) -> bool:
        """Whether every residual is within the tolerance (NaN is not)."""
        return self.worst <= self.tolerance

    def __str__(self) -> str:
        return (
            f"bound {self.bound:.1e}, stick {self.stick:.1e}, alignment {self.alignment:.1e}, load {self.load:.1e} "
            f"(tolerance {self.tolerance:.1e})"
        )


@dataclass(slots=True)
class TangentialReport:
    """Course of a solve.

    Attributes
    ----------
    certificate : FrictionCertificate or None
        Of the last iterate; None if it never got that far.
    history : list of (cells, residual)
        One entry per Newton step.
    convolutions : int
        Applications of the tangential operator: shear tractions to the displacements along the surface.
    seconds : float
        Wall time.
    """

    certificate: FrictionCertificate | None = None
    history: list[tuple[int, float]] = field(default_factory=list)
    convolutions: int = 0
    seconds: float = 0.0

    @property
    def iterations(self) -> int:
        """Newton steps."""
        return len(self.history)
