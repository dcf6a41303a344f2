"""Approximate inverse of a compliance on a box: the inverse of its optimal circulant, by one small unpadded FFT.

T. Chan's optimal circulant keeps the positive definiteness of the Toeplitz compliance, and needs nothing but the
coefficients: layered and coated bodies get the same preconditioner as the homogeneous half-space. The use of a
circulant (there: of the half-space response) for contact is due to E. A. H. Vollebregt, J. Tribol. 136 (2014).
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigencontact.convolution import Convolver, Layout, Spectrum
from eigencontact.convolution.layout import fast_even
from eigencontact.core.grid import Box
from eigencontact.solvers.operator import Compliance

__all__ = ["Preconditioner", "circulant_inverse"]


class Preconditioner:
    """Maps a gap residual on a box to a pressure correction, in units of the compliance."""

    def __init__(self, convolver: Convolver, spectrum: Spectrum) -> None:
        self._convolver = convolver
        self._spectrum = spectrum

    def __call__(self, residual: NDArray[Any]) -> NDArray[Any]:
        """Apply to a residual that is zero at cells not loaded."""
        return self._convolver.apply(residual, self._spectrum)


def circulant_inverse(compliance: Compliance, box: Box) -> Preconditioner:
    """Return a function that maps a gap residual on `box` to a pressure correction (in units of the compliance)."""
    from scipy import fft

    lengths = (fast_even(box.shape[0]), fast_even(box.shape[1]))
    table = compliance.table(lengths[0] + 1, lengths[1] + 1)
    for axis, length in enumerate(lengths):
        offset = np.arange(length // 2 + 1).reshape((-1, 1) if axis == 0 else (1, -1))
        near = np.take(table, np.arange(length // 2 + 1), axis=axis)
        far = np.take(table, length - np.arange(length // 2 + 1), axis=axis)
        table = ((length - offset) * near + offset * far) / length
    spectrum = table
    for axis, length in enumerate(lengths):
        if length > 1:
            spectrum = fft.dct(spectrum, type=1, axis=axis)
    # Positive in exact arithmetic; the floor guards round-off. A periodic compliance has no mean response: its uniform
    # wave is treated like the longest one, the most compliant.
    top = float(spectrum.max())
    if spectrum[0, 0] <= 1e-6 * top or top <= 0:
        spectrum[0, 0] = top if top > 0 else 1.0
    inverse = 1.0 / np.maximum(spectrum, 1e-6 * float(spectrum[0, 0]))
    layout = Layout(box.shape, box.shape, periodic=True, lengths=lengths)
    packed = Spectrum.pack(inverse.T, lengths[0] * lengths[1], 1, imaginary=False, precision=compliance.precision)
    convolver = Convolver(layout, precision=compliance.precision, threads=compliance.threads)
    return Preconditioner(convolver, packed)
