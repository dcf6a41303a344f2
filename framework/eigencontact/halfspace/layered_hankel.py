"""Hankel transform on a logarithmic grid: radial functions of space from those of the wavenumber.

For h(k) = k R(k) the field ``g(r) = (1/2π) ∫ R(k) J_n(kr) k dk`` is a convolution of logarithms,

    r g(r) = (1/2π) ∫ h(k) W(kr) d(ln k),   W(x) = x J_n(x),

and the Mellin transform of W, ``2^(iω) Γ((n+1+iω)/2) / Γ((n+1-iω)/2)``, has modulus 1: one FFT each way, no noise is
amplified. With step Δ in ln k the error is exp(-πθ/Δ) where R is analytic in the sector |arg k| < θ. Damped
oscillation in space, as of a stiff layer on a soft ground, narrows the sector (a plate on a half-space: 60°) and needs
a smaller step, but no other treatment.

References
----------
A. J. S. Hamilton 2000, Uncorrelated modes of the non-linear power spectrum, Mon. Not. R. Astron. Soc. 312, 257-284,
doi:10.1046/j.1365-8711.2000.03071.x (FFTLog).
"""

from __future__ import annotations

from dataclasses import dataclass
from math import prod

import numpy as np
from numpy.typing import NDArray

__all__ = ["STENCIL", "Interpolator", "LogGrid", "interpolation_weights"]

FloatArray = NDArray[np.float64]

# Points of the local polynomial interpolation on uniform grids; even, so that a point lies in the middle interval.
STENCIL = 12
SCALES = [1.0 / prod(j - i for i in range(STENCIL) if i != j) for j in range(STENCIL)]


def interpolation_weights(t: FloatArray) -> tuple[NDArray[np.intp], FloatArray]:
    """Lagrange interpolation on the integers: first point of each stencil ``(...)`` and weights ``(STENCIL, ...)``."""
    first = np.floor(t).astype(np.intp) - (STENCIL // 2 - 1)
    offset = t - first
    weights = np.empty((STENCIL, *np.shape(t)))
    # The product of all factors but the own one: those before it, then those after it.
    product = np.ones(np.shape(t))
    for j in range(STENCIL):
        weights[j] = product * SCALES[j]
        product = product * (offset - j)
    product = np.ones(np.shape(t))
    for j in reversed(range(STENCIL)):
        weights[j] *= product
        product = product * (offset - j)
    return first, weights


@dataclass(frozen=True)
class LogGrid:
    """Wavenumbers and distances, equally spaced in their logarithm, for transforms of R(k) that decay with exp(-ks).

    Parameters
    ----------
    scale : float
        Length s [m].
    distance : float
        Largest distance that will be asked for [m].
    step : float
        Spacing of ln k [-].
    lowest, highest : float
        Smallest k times `distance` and largest k s [-]: h(k), which goes to 0 like k and then with exp(-ks), is taken
        as 0 outside.
    """

    scale: float
    distance: float
    step: float
    lowest: float = 1e-13
    highest: float = 60.0

    @property
    def wavenumbers(self) -> FloatArray:
        """k, ascending ``(n,)`` [rad/m]."""
        span = np.log(self.highest * max(self.distance / self.scale, 1.0) / self.lowest)
        count = int(np.ceil(span / self.step / 32)) * 32
        k: FloatArray = self.highest / self.scale * np.exp(-self.step * np.arange(count)[::-1])
        return k

    def transform(self, values: FloatArray, order: int) -> FloatArray:
        """Products r g(r) of h(k) ``(n,)`` at the distances ``exp((i - 1) step) / k_max``, i = 0, 1, ..., n - 1."""
        from scipy.special import loggamma

        count = values.size
        omega = 2 * np.pi * np.arange(count // 2 + 1) / (count * self.step)
        gamma = loggamma(0.5 * (order + 1 + 1j * omega))
        mellin = np.exp(1j * (omega * np.log(2.0) + 2 * gamma.imag))
        spectrum = np.fft.rfft(values) * mellin
        # The spectrum of a function of -ln r, hence the conjugate.
        return np.asarray(np.fft.irfft(spectrum.conj(), n=count)) / (2 * np.pi)

    def onto(self, r: FloatArray) -> Interpolator:
        """Prepare the transforms to distances r [m], 0 or at least 1 / k_max, ``(m,)``."""
        k = self.wavenumbers
        first, weights = interpolation_weights(np.log(np.where(r > 0, r, self.distance) * k[-1]) / self.step + 1.0)
        weights *= np.where(r > 0, 1.0 / np.where(r > 0, r, 1.0), 0.0)
        return Interpolator(self, k, r == 0, first, weights)


@dataclass(frozen=True)
class Interpolator:
    """Transforms at given distances; see `LogGrid.onto`."""

    grid: LogGrid
    k: FloatArray
    at_origin: NDArray[np.bool_]
    first: NDArray[np.intp]
    weights: FloatArray

    def __call__(self, values: FloatArray, order: int) -> FloatArray:
        """Field g(r), ``(m,)``, of h(k) ``(n,)``."""
        product = self.grid.transform(values, order)
        field: FloatArray = self.weights[0] * product[self.first]
        for j in range(1, STENCIL):
            field += self.weights[j] * product[self.first + j]
        if order == 0:
            field[self.at_origin] = float(np.sum(values * self.k)) * self.grid.step / (2 * np.pi)
        return field
