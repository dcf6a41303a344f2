"""Hankel transform on a logarithmic grid: radial functions of space from functions of the wavenumber.

For h(k) = k R(k) the field ``g(r) = (1/2π) ∫ R(k) J_n(kr) k dk`` is a convolution of logarithms,

    r g(r) = (1/2π) ∫ h(k) W(kr) d(ln k),   W(x) = x J_n(x),

and the Mellin transform of W, ``2^(iω) Γ((n+1+iω)/2) / Γ((n+1-iω)/2)``, has modulus 1: no noise is amplified. One FFT
gives the spectrum of h, and the Fourier series of r g is summed at the distances that are asked for, for all functions
in one product of matrices. With step Δ in ln k the error is exp(-πθ/Δ) where R is analytic in the sector |arg k| < θ.
Damped oscillation in space, as of a stiff layer on a soft ground, narrows the sector (a plate on a half-space: 60°) and
needs a smaller step, but no other treatment.

References
----------
A. J. S. Hamilton 2000, Uncorrelated modes of the non-linear power spectrum, Mon. Not. R. Astron. Soc. 312, 257-284,
doi:10.1046/j.1365-8711.2000.03071.x (FFTLog).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.array_types import FloatArray
from eigencontact.core.products import product

__all__ = ["LogGrid"]

# Up to this distance, in parts of s, the integral itself is summed: what vanishes on the axis keeps its digits, and the
# waves that count turn slowly enough for the grid.
CLOSE = 0.5
# Distances whose waves are held at once.
BLOCK = 4096


@dataclass(frozen=True)
class LogGrid:
    """Wavenumbers, equally spaced in their logarithm, for transforms of R(k) that decay with exp(-ks).

    Parameters
    ----------
    scale : float
        Length s [m].
    distance : float
        Largest length that counts [m].
    step : float
        Spacing of ln k [-].
    lowest, highest : float
        Smallest k times `distance` and largest k s [-]: h(k), which goes to 0 like k and then with exp(-ks), is taken
        as 0 outside.
    """

    scale: float
    distance: float
    step: float
    lowest: float
    highest: float

    @cached_property
    def wavenumbers(self) -> FloatArray:
        """k, descending ``(n,)``, n even [rad/m]."""
        from scipy.fft import next_fast_len

        span = np.log(self.highest * max(self.distance / self.scale, 1.0) / self.lowest)
        count = 2 * next_fast_len(int(np.ceil(span / self.step / 2)), real=True)
        k: FloatArray = self.highest / self.scale * np.exp(-self.step * np.arange(count))
        return k

    def fields(self, responses: Sequence[FloatArray], orders: Sequence[int], r: FloatArray) -> list[FloatArray]:
        """Fields g at distances r ``(m,)`` > 0 [m], ``(nz, m)`` each, of responses R ``(nz, n)`` and their orders."""
        from scipy import fft, special

        k = self.wavenumbers
        if r.max() <= CLOSE * self.scale:
            shares, kr = k**2 * (self.step / (2 * np.pi)), np.outer(k, r)
            pairs = zip(responses, orders, strict=True)
            return [product(response * shares, special.jv(order, kr)) for response, order in pairs]
        omega = 2 * np.pi / (k.size * self.step) * np.arange(k.size // 2 + 1, dtype=np.float64)
        spectra = []
        for response, order in zip(responses, orders, strict=True):
            # Seen from the largest k downwards, hence the conjugate; the ends of the spectrum count once.
            spectrum = fft.rfft(response * k, axis=-1) * _mellin(omega, order).conj()
            spectrum[:, 1:-1] *= 2
            spectra.append(np.concatenate([spectrum.real, -spectrum.imag], axis=1))
        series = np.concatenate(spectra)
        stacked = np.empty((len(series), r.size))
        for begin in range(0, r.size, BLOCK):
            distances = r[begin : begin + BLOCK]
            waves = _waves(omega[1], omega.size, np.log(distances * k[0]))
            stacked[:, begin : begin + BLOCK] = product(series, waves) / (2 * np.pi * k.size * distances)
        return np.split(stacked, np.cumsum([len(response) for response in responses])[:-1])


def _waves(step: float, count: int, x: FloatArray) -> FloatArray:
    """Cosines of 0, 1, ..., count - 1 times ``step x``, then their sines, ``(2 count, m)``.

    Those of sums of a few and of many steps are products, a fifth of the time of as many cosines and sines.
    """
    block = int(np.ceil(np.sqrt(count)))
    low = np.outer(step * np.arange(block), x)
    high = np.outer(step * block * np.arange(-(-count // block)), x)[:, None]
    cos, sin, high_cos, high_sin = np.cos(low), np.sin(low), np.cos(high), np.sin(high)
    turned = np.array([high_cos * cos - high_sin * sin, high_sin * cos + high_cos * sin])
    return turned.reshape(2, -1, x.size)[:, :count].reshape(2 * count, x.size)


def _mellin(omega: FloatArray, order: int) -> NDArray[np.complex128]:
    """Mellin transform of x J_n(x) at iω."""
    from scipy.special import loggamma

    gamma = loggamma(0.5 * (order + 1 + 1j * omega))
    return np.asarray(np.exp(1j * (omega * np.log(2.0) + 2 * gamma.imag)))
