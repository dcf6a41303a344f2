"""Approximate inverse of a compliance on a box: the inverse of its optimal circulant, by one small unpadded FFT.

T. Chan's optimal circulant preserves the positive definiteness of the Toeplitz compliance, and requires only the
coefficients. Layered and coated bodies therefore have the same preconditioner as the homogeneous half-space. E. A. H.
Vollebregt, J. Tribol. 136 (2014), introduced a circulant (of the half-space response) for contact.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np

from eigencontact.convolution import Layout, Spectrum
from eigencontact.convolution.layout import fast_even
from eigencontact.convolution.spectrum import parity_transform
from eigencontact.core.array_types import Array, FloatArray
from eigencontact.core.grid import Box
from eigencontact.solvers.operator import BoxOperator, Compliance

__all__ = ["Circulant", "SpringPreconditioner"]

# Largest ratio of the stiffest to the most compliant cell, springs included, for which one inverse is used for all
# cells.
_ALIKE = 10.0
# Largest ratio of neighbouring inverses if there are several.
_APART = 100.0


class Circulant:
    """Optimal circulant of a compliance on a box.

    Attributes
    ----------
    spectrum : (ny // 2 + 1, nx // 2 + 1) float64
        Eigenvalues in units of the compliance, positive.
    """

    def __init__(self, compliance: Compliance, box: Box) -> None:
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
                spectrum = parity_transform(spectrum, axis, 1, 1)
        # Positive in exact arithmetic; the lower limit guards against round-off. A periodic compliance has no mean
        # response: its uniform wave has the value of the longest, most compliant wave.
        top = float(spectrum.max())
        if spectrum[0, 0] <= 1e-6 * top or top <= 0:
            spectrum[0, 0] = top if top > 0 else 1.0
        self.spectrum: FloatArray = np.maximum(spectrum, 1e-6 * float(spectrum[0, 0]))
        layout = Layout(box.shape, box.shape, periodic=True, lengths=lengths)
        self._precision = compliance.options.precision
        self._cells = lengths[0] * lengths[1]
        self._convolver = compliance.convolver(layout)

    @cached_property
    def inverse(self) -> BoxOperator:
        """Inverse of the circulant: gap residual on the box to a pressure correction."""
        return self.shifted(0.0)

    def shifted(self, spring: float) -> BoxOperator:
        """Inverse of the circulant plus a uniform spring."""
        return self._operator(1.0 / (self.spectrum + spring))

    @cached_property
    def forward(self) -> BoxOperator:
        """The circulant itself: pressure to displacement, and energy, with the error of the circulant."""
        return self._operator(self.spectrum)

    def _operator(self, spectrum: FloatArray) -> BoxOperator:
        packed = Spectrum.pack(spectrum.T, self._cells, 1, imaginary=False, precision=self._precision)
        return BoxOperator(self._convolver, packed)

    @property
    def middle(self) -> float:
        """Geometric mean of the largest and the smallest eigenvalue."""
        return float(np.sqrt(self.spectrum.min() * self.spectrum.max()))


class SpringPreconditioner:
    """Inverse of a circulant plus springs that vary from cell to cell: interpolation between a few uniform springs.

    ``z = Σ √θj (C + kj)⁻¹ √θj r`` with weights θj(k) that interpolate ``1/(s + k)`` linearly in ``1/(s0 + k)``, with
    the smallest eigenvalue s0. This is exact for s = s0 and nearly exact for s far above k, hence for every wave if k
    varies slowly. For springs far above the largest eigenvalue a diagonal remains, which is exact as well. The operator
    is symmetric and positive definite.

    Parameters
    ----------
    circulant : Circulant
        Circulant of the compliance.
    springs : (ny, nx) float64
        Springs on the box, in units of the compliance, nonnegative.

    Notes
    -----
    Waves over cells of different θ lose their coherence. For springs that jump between neighbouring cells, a single
    mean spring is better up to a ratio of about ten; beyond that, such springs take up to three times the iterations.
    """

    def __init__(self, circulant: Circulant, springs: FloatArray) -> None:
        least, most = float(circulant.spectrum.min()), float(circulant.spectrum.max())
        low = least + float(springs.min())
        high = max(low, min(least + float(springs.max()), least + most))
        if high <= _ALIKE * low:
            middle = circulant.middle
            mean = 1.0 / float(np.mean(1.0 / (middle + springs)))
            weights, nodes = [mean / (middle + springs)], [max(mean - middle, 0.0)]
        else:
            count = 2 + int(np.log(high / low) / np.log(_APART))
            stiffness = 1.0 / np.geomspace(high, low, count)
            at = 1.0 / (least + springs)
            weights = [np.interp(at, stiffness, unit) for unit in np.eye(count)]
            weights[0] = np.where(at < stiffness[0], at / stiffness[0], weights[0])
            nodes = list(np.maximum(1.0 / stiffness - least, 0.0))
        self._parts = [(np.sqrt(w), circulant.shifted(k)) for w, k in zip(weights, nodes, strict=True)]

    def __call__(self, residual: Array) -> Array:
        """Pressure correction for a gap residual that is zero at unloaded cells."""
        total = np.zeros_like(residual)
        for weight, inverse in self._parts:
            share = weight.astype(residual.dtype)
            total += share * inverse(share * residual)
        return total
