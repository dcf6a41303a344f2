"""The Hertz problem of the benchmarks, and one measure of any code's answer, taken from outside.

A code's own "tolerance 1e-6" may mean anything. Here every pressure field, whoever computed it, is judged by the same
few lines: the displacement of piecewise constant pressure by the exact kernel of Love, in double precision, by a plain
zero-padded convolution. Nothing of eigencontact is imported; a judge shares no code with the judged.

Units: lengths in contact radii a, pressures in contact moduli E* (the problem is linear in both), so a rigid
paraboloid of radius R = a indents by the approach 1.

References
----------
.. [1] A. E. H. Love, Phil. Trans. R. Soc. A 228 (1929) 377-420, doi:10.1098/rsta.1929.0009.
.. [2] K. L. Johnson, Contact Mechanics (Cambridge, 1985), eqs. (3.25) and (4.21)-(4.24).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy.fft
from numpy.typing import NDArray

__all__ = [
    "Convolution",
    "FloatArray",
    "HertzProblem",
    "Judgement",
    "corners",
    "judge",
    "largest_error",
    "love_influence",
    "wrapped_lags",
]

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True, slots=True)
class HertzProblem:
    """Rigid paraboloid on an elastic half-space, `n` x `n` square cells on a window of side 4 a.

    Examples
    --------
    >>> problem = HertzProblem(n=8)
    >>> problem.cell, problem.separation.shape, problem.axis[[0, -1]].tolist()
    (0.5, (8, 8), [-1.75, 1.75])
    """

    n: int  #: cells along each side
    side: float = 4.0  #: side of the window [a]
    load: float = 4.0 / 3.0  #: normal load [E* a^2]
    approach: float = 1.0  #: rigid-body approach by Hertz [a]
    peak: float = 2.0 / np.pi  #: peak pressure p0 by Hertz [E*]

    def __post_init__(self) -> None:
        if self.n < 1:
            raise ValueError(f"n must be at least 1 [cells] (got {self.n})")

    @property
    def cell(self) -> float:
        """Edge of a cell [a]."""
        return self.side / self.n

    @property
    def axis(self) -> FloatArray:
        """Cell centres along x and along y, (n,) [a]."""
        return (np.arange(self.n, dtype=np.float64) - 0.5 * (self.n - 1)) * self.cell

    @property
    def squared_radius(self) -> FloatArray:
        """r^2 at the cell centres, (n, n) [a^2]."""
        squares = self.axis**2
        return squares[:, None] + squares[None, :]

    @property
    def separation(self) -> FloatArray:
        """Initial separation h = r^2 / 2R with R = a, (n, n) [a]."""
        return 0.5 * self.squared_radius

    @property
    def pressure(self) -> FloatArray:
        """Hertz pressure p0 sqrt(1 - r^2) at the cell centres, (n, n) [E*]."""
        return self.peak * np.sqrt(np.maximum(1.0 - self.squared_radius, 0.0))


def largest_error(values: FloatArray, exact: FloatArray) -> float:
    """Largest difference of a field over its largest exact value.

    Raises
    ------
    ValueError
        If the field has another shape or is not finite.
    """
    if values.shape != exact.shape or not np.isfinite(values).all():
        raise ValueError(f"field must be finite and of shape {exact.shape} (got shape {values.shape})")
    return float(np.abs(values - exact).max() / np.abs(exact).max())


def love_influence(x: FloatArray, y: FloatArray, half_edge: float) -> FloatArray:
    """Normal surface displacement of unit pressure on a square, Love's closed form (Johnson eq. 3.25).

    Parameters
    ----------
    x, y : array, broadcastable
        Point minus centre of the square [length]; not on the lines through its edges.
    half_edge : float
        Half the edge of the square [length].

    Returns
    -------
    array
        Displacement into the body, for contact modulus E* = 1 [length].

    Examples
    --------
    The centre of a square of edge 2:

    >>> round(float(love_influence(np.array(0.0), np.array(0.0), 1.0)), 6)
    2.244399
    """
    return corners(lambda s, t: s * np.arcsinh(t / np.abs(s)) + t * np.arcsinh(s / np.abs(t)), x, y, half_edge) / np.pi


def corners(
    potential: Callable[[FloatArray, FloatArray], FloatArray], x: FloatArray, y: FloatArray, half_edge: float
) -> FloatArray:
    """Sum of a potential of the offsets of a corner over the corners of a square, signed."""
    left, right, low, high = x - half_edge, x + half_edge, y - half_edge, y + half_edge
    total = potential(right, high) - potential(right, low) - potential(left, high) + potential(left, low)
    return np.asarray(total)


def wrapped_lags(n: int, cell: float) -> FloatArray:
    """Lags 0 … n-1 and, wrapped round, -n … -1, times the cell; a cropped convolution never uses the lag -n."""
    return np.roll(np.arange(-n, n, dtype=np.float64), n) * cell


class Convolution:
    """Zero-padded convolution of an (n, n) field by plain scipy.fft: the judge's operator, and the unit of time.

    One call is a forward real transform on (2n, 2n), a product with a spectrum computed beforehand, an inverse
    transform and a crop.

    Parameters
    ----------
    problem : HertzProblem
        Supplies the cells.
    """

    def __init__(self, problem: HertzProblem) -> None:
        n = self.n = problem.n
        lags = wrapped_lags(n, problem.cell)
        kernel = love_influence(lags[None, :], lags[:, None], 0.5 * problem.cell)
        self.spectrum = scipy.fft.rfft2(kernel)

    def __call__(self, field: FloatArray, workers: int = 1) -> FloatArray:
        """Displacement of a pressure field, both (n, n)."""
        shape = (2 * self.n, 2 * self.n)
        spectrum = scipy.fft.rfft2(field, s=shape, workers=workers)
        spectrum *= self.spectrum
        whole: FloatArray = scipy.fft.irfft2(spectrum, s=shape, workers=workers)
        return whole[: self.n, : self.n]


@dataclass(frozen=True, kw_only=True, slots=True)
class Judgement:
    """Outside measure of one pressure field; all relative [-]."""

    gap: float  #: largest of the absolute gap in loaded cells and the penetration of unloaded ones, over the approach
    tension: float  #: largest negative pressure over p0; 0 where there is none
    load_error: float  #: load against Hertz, minus 1, as the next two
    peak_error: float  #: peak pressure
    radius_error: float  #: contact radius, of the circle of the loaded area
    pressure_error: float  #: L2 norm of the pressure minus Hertz, over the norm of Hertz


def judge(problem: HertzProblem, pressure: FloatArray) -> Judgement:
    """Measure a pressure field from outside.

    Parameters
    ----------
    problem : HertzProblem
        What was solved.
    pressure : (n, n) array
        Any code's answer [E*], compression positive.

    Notes
    -----
    With u the exact displacement of `pressure` and h the separation, the approach is the mean of u + h over the
    loaded cells and the gap is u + h minus the approach: zero where a cell carries load, positive where it does not.
    A cell is loaded if its pressure is positive.

    Raises
    ------
    ValueError
        If the field has another shape, is not finite, or carries no load: there is then nothing to judge.
    """
    p = np.asarray(pressure, dtype=np.float64)
    if p.shape != (problem.n, problem.n):
        raise ValueError(f"pressure must be of shape {(problem.n, problem.n)} (got {p.shape})")
    if not np.isfinite(p).all():
        raise ValueError("pressure must be finite (got nan or inf); the code did not solve the problem")
    loaded = p > 0
    if not loaded.any():
        raise ValueError("pressure must be positive somewhere (got none); compression is positive")
    total = Convolution(problem)(p) + problem.separation
    approach = float(total[loaded].mean())
    gap = total - approach
    hertz = problem.pressure
    return Judgement(
        gap=max(float(np.abs(gap[loaded]).max()), float(-gap[~loaded].min(initial=0.0))) / abs(approach),
        tension=max(0.0, -float(p.min())) / problem.peak,
        load_error=float(p.sum()) * problem.cell**2 / problem.load - 1.0,
        peak_error=float(p.max()) / problem.peak - 1.0,
        radius_error=float(np.sqrt(loaded.sum() * problem.cell**2 / np.pi)) - 1.0,
        pressure_error=float(np.linalg.norm(p - hertz) / np.linalg.norm(hertz)),
    )
