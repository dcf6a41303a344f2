"""Relative position of a box of source cells and a box of target points in space, and the kernels of the pair.

Along z a kernel depends either on the difference of target and source (convolution) or on their sum (correlation):
the response of the mirror image behind a plane depends on the sum. Both use the same transforms, because the spectrum
of the reversed source is the source's spectrum at the opposite wavenumber.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigencontact.convolution.layout import Axis
from eigencontact.convolution.spectrum import parity_transform
from eigencontact.core.array_types import FloatArray
from eigencontact.errors import require

__all__ = ["VolumeKernels", "VolumeLayout", "VolumeParity"]

#: Parity along (z, y, x): +1 even, -1 odd.
VolumeParity = tuple[int, int, int]


@dataclass(frozen=True)
class VolumeLayout:
    """Geometry of sums over a box of source cells at a box of target points of the same pitch.

    Parameters
    ----------
    source, target : (int, int, int)
        Cells along (z, y, x).
    origin : (float, float, float)
        Position of target (0, 0, 0) relative to source (0, 0, 0), in cells along (z, y, x). Need not be whole, which
        costs the parity along that axis; fractions along y or x make the stored spectra four times larger.

    Notes
    -----
    Tables of kernels and their spectra are indexed ``[x, y, z]``, z contiguous.
    """

    source: tuple[int, int, int]
    target: tuple[int, int, int]
    origin: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def _axis(self, axis: int) -> Axis:
        return Axis.plan(self.source[axis], self.target[axis], self.origin[axis], periodic=False)

    @cached_property
    def z(self) -> Axis:
        """Axis z."""
        return self._axis(0)

    @cached_property
    def y(self) -> Axis:
        """Axis y."""
        return self._axis(1)

    @cached_property
    def x(self) -> Axis:
        """Axis x."""
        return self._axis(2)

    @property
    def lattice_sum(self) -> FloatArray:
        """Sums of the indices of target and source along z, at which tables of correlations are sampled."""
        return np.arange(self.z.sources + self.z.targets - 1, dtype=np.float64)

    @cached_property
    def folded(self) -> bool:
        """Whether parities along x and y leave an octant of each spectrum."""
        return self.x.symmetric and self.y.symmetric

    @cached_property
    def section(self) -> bool:
        """Whether one row of cells along y leaves no wavenumber ky but zero."""
        return self.folded and self.y.length == 1

    @property
    def signs(self) -> int:
        """Signs of ky that are transformed together, because parity gives the spectra of both."""
        return 2 if self.folded and not self.section else 1

    @property
    def spectrum_shape(self) -> tuple[int, int, int]:
        """Number of stored wavenumbers of each spectrum, along (kx, ky, kz); in a section kx takes the place of ky."""
        if self.section:
            return 1, self.x.half, self.z.half
        if self.folded:
            return self.x.half, self.y.half, self.z.half
        return self.x.half, self.y.length, self.z.length


class VolumeKernels:
    """Spectra of several kernels of one layout, ``values[kx, kernel, part, ky, kz]``, parts real and imaginary.

    Where the layout is folded, a spectrum is ``1j**odd * (values[:, :, 0] + 1j * values[:, :, 1])`` with ``odd`` = 1
    if exactly one of the parities along x and y is odd; what multiplies ``1j**odd`` is the conjugate at -kz, and at -ky
    the same times the parity. In a section kx takes the place of ky, and the first axis has one entry.

    Parameters
    ----------
    layout : VolumeLayout
        Boxes and transform lengths.
    parities : sequence of (int, int, int)
        Of each kernel along (z, y, x); that along z is used by convolutions only. Along an axis without symmetry of
        the layout it is not used.
    correlations : sequence of bool
        Whether each kernel depends on the sum, not the difference, along z.
    precision : {"double", "single"}
        Storage; the transforms are done in double.
    """

    def __init__(
        self,
        layout: VolumeLayout,
        parities: Sequence[VolumeParity],
        correlations: Sequence[bool],
        *,
        precision: str = "double",
    ) -> None:
        require(precision in ("double", "single"), "numerics", "precision", precision, "'double' or 'single'")
        rule = f"as many as parities ({len(parities)})"
        require(len(parities) == len(correlations), "convolution", "correlations", len(correlations), rule)
        self.layout = layout
        self.parities, self.correlations = tuple(parities), tuple(correlations)
        kx, ky, kz = layout.spectrum_shape
        dtype = np.float64 if precision == "double" else np.float32
        self.values: NDArray[Any] = np.empty((kx, len(parities), 2, ky, kz), dtype)

    def __len__(self) -> int:
        return len(self.parities)

    @property
    def nbytes(self) -> int:
        """Memory of the spectra."""
        return int(self.values.nbytes)

    def fill(self, number: int, table: FloatArray, scale: float = 1.0) -> None:
        """Transform the table ``[x, y, z]`` of one kernel, sampled on the layout's lattice, and store the spectrum."""
        layout, parity, correlation = self.layout, self.parities[number], self.correlations[number]
        along_z = layout.lattice_sum if correlation else layout.z.lattice
        expected = (layout.x.lattice.size, layout.y.lattice.size, along_z.size)
        require(table.shape == expected, "convolution", "table", table.shape, f"of shape {expected}")
        points = layout.x.length * layout.y.length * layout.z.length
        factor = scale / points
        if layout.folded:
            odd = (parity[1] < 0) + (parity[2] < 0)
            factor = -factor if odd else factor
            values = parity_transform(parity_transform(table, 0, parity[2], 1), 1, parity[1], 1)
            spectrum = _along_z(layout, values, parity[0], correlation=correlation)
        else:
            spectrum = _full_transform(layout, table, parity, correlation=correlation)
        spectrum = spectrum.reshape(layout.spectrum_shape)
        out = self.values[:, number]
        np.multiply(spectrum.real, factor, out=out[:, 0], casting="same_kind")
        np.multiply(spectrum.imag, factor, out=out[:, 1], casting="same_kind")

    def turn(self, number: int, twin: int) -> None:
        """Store the spectrum of one kernel with x and y exchanged as that of another; the axes must be equal."""
        self.values[:, number] = self.values[:, twin].transpose(2, 1, 0, 3)


def _along_z(layout: VolumeLayout, values: FloatArray, parity: int, *, correlation: bool) -> NDArray[Any]:
    """Transform a table that is real in kx and ky along z; kz >= 0."""
    from scipy import fft

    if layout.z.symmetric and not correlation:
        half = parity_transform(values, 2, parity, 1)
        return half if parity > 0 else np.asarray(-1j * half)
    return np.asarray(fft.rfft(_ordered_z(layout, values, correlation=correlation), axis=2))


def _ordered_z(layout: VolumeLayout, values: FloatArray, *, correlation: bool) -> FloatArray:
    """Move samples along z into transform order, zeros between."""
    if not correlation:
        return np.asarray(layout.z.scatter(values, 2), dtype=float)
    out = np.zeros((*values.shape[:2], layout.z.length))
    # Source and target rows of the transform add up to the sum of their indices and this.
    start = (layout.z.source_start + layout.z.target_start) % layout.z.length
    first = min(values.shape[2], layout.z.length - start)
    out[:, :, start : start + first] = values[:, :, :first]
    out[:, :, : values.shape[2] - first] = values[:, :, first:]
    return out


def _full_transform(
    layout: VolumeLayout, table: FloatArray, parity: VolumeParity, *, correlation: bool
) -> NDArray[Any]:
    """Transform a table along all axes without parity; kx >= 0, all ky and kz."""
    from scipy import fft

    for axis, plan, sign in ((0, layout.x, parity[2]), (1, layout.y, parity[1])):
        table = _extended(table, axis, plan, sign) if plan.symmetric else np.asarray(plan.scatter(table, axis))
    if layout.z.symmetric and not correlation:
        table = _extended(table, 2, layout.z, parity[0])
    else:
        table = _ordered_z(layout, table, correlation=correlation)
    return np.asarray(fft.fft(fft.fft(fft.rfft(table, axis=0), axis=1, overwrite_x=True), axis=2, overwrite_x=True))


def _extended(table: FloatArray, axis: int, plan: Axis, sign: int) -> FloatArray:
    """Even or odd extension of offsets 0..F/2 along `axis` to the whole transform length."""
    rows = np.arange(plan.length)
    mirrored = rows > plan.length - rows
    out = np.take(table, np.minimum(rows, plan.length - rows), axis=axis)
    if sign < 0:
        weight = np.where(mirrored, -1.0, 1.0)
        weight[(2 * rows) % plan.length == 0] = 0.0
        out *= np.expand_dims(weight, tuple(k for k in range(3) if k != axis))
    return np.asarray(out)
