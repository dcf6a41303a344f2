"""Equivalent eigenstrain of inhomogeneities, in cells or uniform in each: GMRES with a certificate."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from time import perf_counter
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from eigencontact.core.array_types import FloatArray
from eigencontact.core.material import Material
from eigencontact.core.products import norm_of
from eigencontact.errors import NotConverged, require
from eigencontact.solvers.gmres import gmres
from eigencontact.solvers.report import Progress

__all__ = ["EquivalentInclusions", "InclusionReport", "InclusionSystem"]


@dataclass(slots=True)
class InclusionReport:
    """Course of a solve.

    Attributes
    ----------
    residual : float
        Certificate from a new application of the operator: root mean square over the inhomogeneous cells or the
        inclusions. The values are the corrections of the eigenstrain that each would need by itself, relative to the
        strain σ / 2 μ_m of the load.
    tolerance : float
        Bound of the residual.
    history : list of float
        Relative residual after each iteration.
    applications : int
        Number of applications of the operator.
    seconds, operator_seconds : float
        Wall time of the solve, and the part of the operator.
    """

    residual: float = np.inf
    tolerance: float = 0.0
    history: list[float] = field(default_factory=list)
    applications: int = 0
    seconds: float = 0.0
    operator_seconds: float = 0.0

    @property
    def iterations(self) -> int:
        """Number of iterations."""
        return len(self.history)

    @property
    def holds(self) -> bool:
        """Whether the certificate is within the tolerance (NaN is not)."""
        return self.residual <= self.tolerance


@dataclass(frozen=True, slots=True)
class EquivalentInclusions:
    """Equivalent eigenstrain and total stress: of a box ``(nz, ny, nx)`` of cells, or of ``(n,)`` inclusions.

    Attributes
    ----------
    eigenstrain : (6, ...)
        ε* [-], prestrain included. In a body of the matrix alone it causes the same fields as the inhomogeneities.
        `eigencontact.halfspace.cloud.field_of_cloud` computes the fields of inclusions.
    stress : (6, ...)
        Total stress σ_0 + A ε* [Pa], as the mean over each inclusion.
    report : InclusionReport
        Certificate and history.
    """

    eigenstrain: FloatArray
    stress: FloatArray
    report: InclusionReport


class InclusionSystem(ABC):
    """Linear system of one arrangement of inhomogeneities, for any number of loads.

    Fields have the shape ``(6, ...)``. Unknowns ``(6, n)`` are the eigenstrain in addition to the prestrain, by the
    difference of the constants.
    """

    #: Defaults of `solve`.
    tolerance: ClassVar[float]
    max_iterations: ClassVar[int]
    #: Number of stored vectors of unknowns.
    restart: ClassVar[int]

    matrix: Material
    shape: tuple[int, ...]
    _report: InclusionReport

    @abstractmethod
    def _stress_of(self, eigenstrain: FloatArray) -> FloatArray:
        """Stress field [Pa] of an eigenstrain field."""

    @abstractmethod
    def _residual(self, x: FloatArray, stress: FloatArray) -> FloatArray:
        """Residual of each condition, as the eigenstrain that removes it; `stress` [Pa] is ``(6, n)``."""

    def _shift(self, prestrain: FloatArray) -> FloatArray | float:  # noqa: ARG002 - for derived classes
        """Contribution of a prestrain field to the conditions."""
        return 0.0

    def _unknowns(self, values: FloatArray) -> FloatArray:
        """Values of a field in the inhomogeneities, ``(6, n)``."""
        return values

    def _spread(self, x: FloatArray) -> FloatArray:
        """Field of unknowns."""
        return x

    def solve(
        self,
        applied_stress: ArrayLike,
        prestrain: ArrayLike | None = None,
        *,
        start: ArrayLike | None = None,
        tolerance: float | None = None,
        max_iterations: int | None = None,
        progress: Progress | None = None,
    ) -> EquivalentInclusions:
        """Solve for the eigenstrain under a load.

        Parameters
        ----------
        applied_stress : (6, ...)
            Stress σ_0 [Pa] by the load in the matrix without inhomogeneities; for inclusions the mean over each.
        prestrain : (6, ...), optional
            Prescribed eigenstrain ε_p, also in the matrix.
        start : (6, ...), optional
            Start for the eigenstrain ε*, for example the solution of a similar load.
        tolerance : float, optional
            Bound of ``InclusionReport.residual``.
        max_iterations : int, optional
            Largest number of iterations.
        progress : callable, optional
            Called after each iteration.

        Raises
        ------
        NotConverged
            The exception has the report.
        """
        began = perf_counter()
        bound = self.tolerance if tolerance is None else tolerance
        self._report = report = InclusionReport(tolerance=bound)
        applied = self._field("applied_stress", applied_stress)
        fixed = np.zeros_like(applied) if prestrain is None else self._field("prestrain", prestrain)
        load = self._unknowns(applied + self._apply(fixed))
        shift = self._shift(fixed)
        size = norm_of(load) / (2.0 * self.matrix.shear_modulus)
        equivalent = np.zeros_like(load) if start is None else self._unknowns(self._field("start", start) - fixed)

        def watch(norm: float) -> None:
            report.history.append(norm / size)
            if progress is not None:
                progress("equivalent inclusions", norm / size, bound)

        if size > 0.0:
            equivalent = equivalent + gmres(
                lambda x: -self._residual(x.reshape(6, -1), self._stress_by(x.reshape(6, -1))).ravel(),
                (self._residual(equivalent, load + self._stress_by(equivalent)) + shift).ravel(),
                bound=0.9 * bound * size,
                max_iterations=self.max_iterations if max_iterations is None else max_iterations,
                restart=self.restart,
                watch=watch,
            ).reshape(6, -1)
        eigenstrain = fixed + self._spread(equivalent)
        stress = applied + self._apply(eigenstrain)
        residual = norm_of(self._residual(equivalent, self._unknowns(stress)) + shift)
        report.residual = residual / size if size > 0.0 else 0.0
        report.seconds = perf_counter() - began
        if not report.holds:
            raise NotConverged(
                f"equivalent inclusions: residual {report.residual:.1e} after {report.iterations} iterations "
                f"(tolerance {bound:.1e}); allow more iterations or a larger tolerance",
                report,
            )
        return EquivalentInclusions(eigenstrain, stress, report)

    def _stress_by(self, x: FloatArray) -> FloatArray:
        """Stress [Pa] in the inhomogeneities, ``(6, n)``, by the unknowns."""
        return self._unknowns(self._apply(self._spread(x)))

    def _apply(self, eigenstrain: FloatArray) -> FloatArray:
        """Stress field of an eigenstrain field, counted and timed."""
        if not eigenstrain.any():
            return np.zeros_like(eigenstrain)
        began = perf_counter()
        stress = self._stress_of(eigenstrain)
        self._report.applications += 1
        self._report.operator_seconds += perf_counter() - began
        return stress

    def _field(self, name: str, values: ArrayLike) -> FloatArray:
        out = np.asarray(values, dtype=float)
        expected = (6, *self.shape)
        require(out.shape == expected, "inclusions", name, out.shape, f"of shape {expected}")
        require(bool(np.isfinite(out).all()), "inclusions", name, "NaN or infinity", "finite")
        return out
