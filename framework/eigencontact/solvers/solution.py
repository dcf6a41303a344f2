"""Options and solution of a normal contact."""

from __future__ import annotations

from dataclasses import dataclass

from eigencontact.core.array_types import FloatArray
from eigencontact.solvers.report import Certificate, SolveReport

__all__ = ["NormalOptions", "NormalSolution", "SolverOptions"]


@dataclass(frozen=True, kw_only=True, slots=True)
class SolverOptions:
    """Options of the solution; the arguments of `solve` define the problem.

    Parameters
    ----------
    tolerance : float
        Bound on each residual of the certificate [-].
    max_iterations : int
        Largest number of iterations on the finest grid.
    precision : {"double", "single"}
        Arithmetic of the iteration. Single precision reaches tolerances down to about 1e-5.
    threads : int, optional
        Cores to use; all by default.
    periodic : bool
        Whether the window repeats in x and y.
    """

    tolerance: float = 1e-6
    max_iterations: int = 500
    precision: str = "double"
    threads: int | None = None
    periodic: bool = False


@dataclass(frozen=True, kw_only=True, slots=True)
class NormalOptions(SolverOptions):
    """Options of the normal contact; `allow_contact_at_edge` accepts contact at the edge of the window."""

    allow_contact_at_edge: bool = False


@dataclass(frozen=True, kw_only=True, slots=True)
class NormalSolution:
    """Converged normal contact.

    Attributes
    ----------
    pressure, gap, displacement : (ny, nx) float64
        p [Pa], g [m] (zero within the tolerance in loaded cells, springs included) and u_z [m], sum of both bodies,
        without springs.
    approach, tilt_x, tilt_y : float
        δ [m], φx, φy [rad].
    normal_load, moment_x, moment_y : float
        P [N], Mx, My [N m] of the pressure.
    report : SolveReport
        Certificate, history, numbers and time.
    """

    pressure: FloatArray
    gap: FloatArray
    displacement: FloatArray
    approach: float
    tilt_x: float
    tilt_y: float
    normal_load: float
    moment_x: float
    moment_y: float
    report: SolveReport[Certificate]
