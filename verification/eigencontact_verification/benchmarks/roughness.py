"""A self-affine rough surface on a window of side 1, and the residual of any code's answer, taken from outside.

Units: lengths in sides of the window, pressures in contact moduli E*. Nothing of eigencontact is imported; a judge
shares no code with the judged.

References
----------
.. [1] B. N. J. Persson et al., J. Phys. Condens. Matter 17 (2005) R1, doi:10.1088/0953-8984/17/1/R01 (spectrum of
   self-affine roughness with roll-off and cut-off).
.. [2] B. N. J. Persson, J. Chem. Phys. 115 (2001) 3840 (area in contact against mean pressure: ``erf(√2 p / E* s)``
   with the root mean square slope s).
.. [3] K. L. Johnson, Contact Mechanics (Cambridge, 1985), ch. 13 (a wave of pressure p deflects 2 p / E* k).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.fft
from scipy.special import erfinv

from eigencontact_verification.benchmarks.measure import FloatArray, love_influence, wrapped_lags

__all__ = ["RoughProblem", "displacement", "residual"]


@dataclass(frozen=True, kw_only=True, slots=True)
class RoughProblem:
    """Self-affine surface with root mean square slope 1, pressed by the load that theory gives for a share of contact.

    Examples
    --------
    >>> problem = RoughProblem(n=32, periodic=True, share=0.1)
    >>> h = problem.separation()
    >>> float(h.min()), round(float(np.mean(np.gradient(h, axis=0)[1:-1] ** 2) ** 0.5 * 32), 1) > 0.5
    (0.0, True)
    """

    n: int  #: cells along each side
    periodic: bool
    share: float  #: of the area in contact, by theory
    hurst: float = 0.8
    roll_off: float = 1.0 / 8.0  #: longer waves have the amplitude of this wavelength [side]
    shortest: float = 8.0  #: shortest wavelength [cells]
    seed: int = 1

    @property
    def cell(self) -> float:
        """Edge of a cell [side]."""
        return 1.0 / self.n

    @property
    def mean_pressure(self) -> float:
        """Load over the window [E*]."""
        return float(erfinv(self.share) / np.sqrt(2.0))

    def separation(self) -> FloatArray:
        """Initial separation of the highest point from a plane, (n, n) [side]."""
        n = self.n
        waves = _waves(n)
        amplitude = np.maximum(waves, 1.0 / self.roll_off) ** -(1.0 + self.hurst)
        amplitude[(waves == 0) | (waves > n / self.shortest)] = 0.0
        spectrum = scipy.fft.rfft2(np.random.default_rng(self.seed).standard_normal((n, n)))
        spectrum *= amplitude
        heights: FloatArray = scipy.fft.irfft2(spectrum, s=(n, n))
        spectrum *= 2.0 * np.pi * waves
        # A slope has the power of its waves, whatever their direction: the norm of the spectrum times the wavenumber.
        slope = float(np.sqrt(np.mean(scipy.fft.irfft2(spectrum, s=(n, n)) ** 2)))
        return np.asarray((heights.max() - heights) / slope)


def _waves(n: int) -> FloatArray:
    """Waves over the window, (n, n // 2 + 1) [-]."""
    return np.asarray(np.hypot(np.fft.fftfreq(n, 1.0 / n)[:, None], np.fft.rfftfreq(n, 1.0 / n)[None, :]))


def displacement(problem: RoughProblem, pressure: FloatArray) -> FloatArray:
    """Displacement of a pressure, by a plain transform with exact coefficients, (n, n) [side].

    Of the periodic half-space without its mean; of the other one by the formula of Love, padded with zeros.
    """
    n = problem.n
    if problem.periodic:
        waves = _waves(n)
        waves[0, 0] = np.inf
        spectrum = scipy.fft.rfft2(pressure)
        spectrum /= np.pi * waves
        return np.asarray(scipy.fft.irfft2(spectrum, s=(n, n)))
    lags = wrapped_lags(n, problem.cell)
    spectrum = scipy.fft.rfft2(pressure, s=(2 * n, 2 * n))
    spectrum *= scipy.fft.rfft2(love_influence(lags[None, :], lags[:, None], 0.5 * problem.cell))
    return np.asarray(scipy.fft.irfft2(spectrum, s=(2 * n, 2 * n))[:n, :n])


def residual(problem: RoughProblem, separation: FloatArray, pressure: FloatArray) -> float:
    """Largest gap, open or overlapping, in contact, or overlap outside, over the largest deflection in contact.

    Parameters
    ----------
    separation : (n, n) array
        Of the problem [side].
    pressure : (n, n) array
        Any code's answer [E*], compression positive; a cell is loaded if its pressure is positive.

    Raises
    ------
    ValueError
        If the pressure has another shape, is not finite or carries nothing.
    """
    p = np.asarray(pressure, dtype=np.float64)
    if p.shape != separation.shape or not np.isfinite(p).all() or not (p > 0).any():
        raise ValueError(f"pressure must be finite, positive somewhere and of shape {separation.shape} (got {p.shape})")
    loaded = p > 0
    gap = displacement(problem, p)
    scale = float(gap[loaded].max())
    gap += separation
    gap -= gap[loaded].mean()
    return max(float(np.abs(gap[loaded]).max()), float(-gap[~loaded].min(initial=0.0))) / scale
