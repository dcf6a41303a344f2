"""Packed spectra of influence coefficients without the parts that are redundant by parity."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.array_types import FloatArray
from eigencontact.core.parallel import available_threads

if TYPE_CHECKING:
    from eigencontact.convolution.layout import Axis

__all__ = ["Spectrum", "parity_transform", "transform_table"]

#: Tables of at most so many numbers are transformed by numpy, and scipy.fft, which takes a tenth of a second to import,
#: is not loaded for them; larger ones are worth its threads.
_SMALL = 2**17


@dataclass(frozen=True, slots=True)
class Spectrum:
    """Discrete Fourier transform of one influence coefficient, wavenumber kx first, ky contiguous.

    Attributes
    ----------
    values : (F_x//2+1, F_y//2+1) or (F_x//2+1, F_y) array
        Real where the parity makes the spectrum purely real or imaginary, else complex. The factor 1/(F_x F_y) of
        the inverse transform is included.
    sign_y : int
        Parity in y where only ky >= 0 is stored, 0 where all ky are.
    imaginary : bool
        The spectrum is ``1j * values``.
    """

    values: NDArray[Any]
    sign_y: int
    imaginary: bool

    @classmethod
    def pack(cls, values: NDArray[Any], points: int, sign_y: int, *, imaginary: bool, precision: str) -> Spectrum:
        """Normalise by the number of points of the transform, convert to a precision, make contiguous."""
        values = values * (1.0 / points)
        single = np.complex64 if np.iscomplexobj(values) else np.float32
        dtype = single if precision == "single" else values.dtype
        return cls(np.ascontiguousarray(values, dtype=dtype), sign_y, imaginary)

    @property
    def nbytes(self) -> int:
        """Memory of the stored values."""
        return int(self.values.nbytes)

    def multiply(self, field: NDArray[Any], columns: slice, out: NDArray[Any]) -> None:
        """Write ``spectrum * field`` into `out` for the wavenumbers ``kx`` in `columns`; ``field (n, F_y)``."""
        values = self.values[columns]
        if self.imaginary:
            values = 1j * values
        if self.sign_y == 0:
            np.multiply(field, values, out=out)
            return
        half, length = values.shape[1], field.shape[1]
        np.multiply(field[:, :half], values, out=out[:, :half])
        mirrored = values[:, length - half : 0 : -1]
        np.multiply(field[:, half:], mirrored if self.sign_y > 0 else -mirrored, out=out[:, half:])

    @property
    def packed(self) -> bool:
        """Whether only real numbers at ky >= 0 are stored."""
        return self.sign_y != 0 and not np.iscomplexobj(self.values)


def transform_table(
    y: Axis, x: Axis, table: FloatArray, parity: tuple[int, int], precision: str, scale: float
) -> Spectrum:
    """Spectrum of a coefficient table: cosine and sine transforms along axes with parity, else full transforms."""
    workers = available_threads()
    values: NDArray[Any] = table.T
    imaginary = False
    negative = False
    for axis, plan, sign in ((0, x, parity[1]), (1, y, parity[0])):
        if plan.symmetric:
            values = parity_transform(values, axis, sign, workers)
            if sign < 0:  # the transform of an odd sequence is -1j times its sine transform
                negative, imaginary = (not negative, True) if not imaginary else (negative, False)
        else:
            values = plan.scatter(values, axis)
            values = _transform(values, axis, workers)
    values = values * (-scale if negative else scale)
    sign_y = parity[0] if y.symmetric else 0
    if imaginary and np.iscomplexobj(values):
        values, imaginary = 1j * values, False

    return Spectrum.pack(values, y.length * x.length, sign_y, imaginary=imaginary, precision=precision)


def _transform(values: NDArray[Any], axis: int, workers: int) -> NDArray[Any]:
    """DFT along an axis: of real values along the first, where half of it is redundant, else of any."""
    if values.size <= _SMALL:
        return (np.fft.rfft if axis == 0 else np.fft.fft)(values, axis=axis)
    from scipy import fft

    return np.asarray((fft.rfft if axis == 0 else fft.fft)(values, axis=axis, workers=workers))


def parity_transform(table: NDArray[Any], axis: int, sign: int, workers: int) -> NDArray[Any]:
    """DFT of the even (or 1j times that of the odd) extension of offsets 0..F/2 along `axis`."""
    n = table.shape[axis]
    if sign > 0 and n == 1:
        return table
    if table.size <= _SMALL:
        return _by_extension(table, axis, sign)
    from scipy import fft

    if sign > 0:
        return np.asarray(fft.dct(table, type=1, axis=axis, workers=workers))
    out = np.zeros_like(table)
    if n > 2:
        inner = [slice(None)] * table.ndim
        inner[axis] = slice(1, -1)
        out[tuple(inner)] = fft.dst(table[tuple(inner)], type=1, axis=axis, workers=workers)
    return out


def _by_extension(table: NDArray[Any], axis: int, sign: int) -> NDArray[Any]:
    """`parity_transform` by the extension itself."""
    along = table.swapaxes(axis, -1)  # `np.moveaxis` takes longer than the transform of a small table
    n = along.shape[-1]
    extension = np.zeros((*along.shape[:-1], max(1, 2 * n - 2)), np.result_type(table, np.float64))
    first = 0 if sign > 0 else 1  # what is odd vanishes in the middle and at the end
    extension[..., first : n - first] = along[..., first : n - first]
    extension[..., n:] = sign * along[..., n - 2 : 0 : -1]
    if np.iscomplexobj(extension):
        values = np.fft.fft(extension)[..., :n]
        return (values if sign > 0 else 1j * values).swapaxes(axis, -1)
    values = np.fft.rfft(extension)
    return (values.real if sign > 0 else -values.imag).swapaxes(axis, -1)
