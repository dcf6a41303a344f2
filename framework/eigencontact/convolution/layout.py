"""Relative positions of source and target cells, and the transform lengths that follow."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, cached_property
from math import floor
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigencontact.convolution.spectrum import Spectrum, parity_transform, transform_table
from eigencontact.core.array_types import FloatArray
from eigencontact.errors import require

__all__ = ["Axis", "Layout", "fast_even"]

# A target far beside its source would need a long even transform; past this factor the parity is given up instead.
_PARITY_WASTE = 1.6


@dataclass(frozen=True)
class Axis:
    """One axis of a convolution: `sources` and `targets` cells of equal pitch, target 0 at `origin` (in cells).

    Attributes
    ----------
    length : int
        Transform length F.
    symmetric : bool
        True where the coefficients are sampled on offsets 0..F/2 only and mirrored by their parity.
    """

    sources: int
    targets: int
    origin: float
    periodic: bool
    length: int
    symmetric: bool

    @classmethod
    def plan(cls, sources: int, targets: int, origin: float, *, periodic: bool, length: int | None = None) -> Axis:
        """Choose the transform length and whether parity can be used."""
        require(sources >= 1, "convolution", "source", sources, "at least 1 cell")
        require(targets >= 1, "convolution", "target", targets, "at least 1 cell")
        on_lattice = origin == floor(origin)
        if periodic:
            require(targets == sources, "convolution", "target", targets, "the source's size where periodic")
            require(on_lattice, "convolution", "origin", origin, "a whole number of cells where periodic")
            return cls(sources, targets, origin, periodic=True, length=length or sources, symmetric=True)
        span = sources + targets - 1
        reach = max(abs(floor(origin) - (sources - 1)), abs(floor(origin) + targets - 1))
        symmetric = on_lattice and 2 * reach + 1 <= max(_PARITY_WASTE * span, 8)
        least_length = max(span, 2 * reach + 1) if symmetric else span
        return cls(sources, targets, origin, periodic=False, length=fast_even(least_length), symmetric=symmetric)

    @cached_property
    def half(self) -> int:
        """Number of distinct non-negative wavenumbers, F//2 + 1."""
        return self.length // 2 + 1

    @cached_property
    def source_start(self) -> int:
        """Row of the transform with the start of the source."""
        return max(0, -floor(self.origin)) if self.symmetric and not self.periodic else 0

    @cached_property
    def target_start(self) -> int:
        """Row of the transform with the start of the target."""
        return max(0, floor(self.origin)) if self.symmetric and not self.periodic else 0

    @cached_property
    def lattice(self) -> FloatArray:
        """Offsets (target minus source, in cells, ascending) of the samples of a kernel table."""
        if self.symmetric:
            return np.arange(self.half, dtype=float)
        return self.origin + np.arange(-(self.sources - 1), self.targets, dtype=float)

    def scatter(self, table: NDArray[np.generic], axis: int) -> NDArray[np.generic]:
        """Move a table of ascending offsets into transform order along `axis` (axes without parity only)."""
        shape = list(table.shape)
        shape[axis] = self.length
        out = np.zeros(shape, table.dtype)
        source, target = table.swapaxes(axis, 0), out.swapaxes(axis, 0)  # `np.moveaxis` takes longer than the copy
        before = self.sources - 1
        target[: self.targets] = source[before:]
        if before:
            target[-before:] = source[:before]
        return out


@cache
def fast_even(n: int) -> int:
    """Even length >= n, at most 8 % longer, with the fastest transform in FFTW (1 stays 1: no padding).

    Factors 2, 5 and 7 are cheapest; each 3, 11 or 13 costs about 8 % (measured on lengths from 520 to 2260).
    """
    if n <= 1:
        return 1
    best, price = 0, float("inf")
    for length in range(n + n % 2, max(int(1.08 * n), n + 8) + 1, 2):
        cofactor, cost = length, float(length)
        for factor, surcharge in ((2, 1.0), (5, 1.0), (7, 1.0), (3, 1.08), (11, 1.08), (13, 1.08)):
            while cofactor % factor == 0:
                cofactor //= factor
                cost *= surcharge
        if cofactor == 1 and cost < price:
            best, price = length, cost
    if best:
        return best
    from scipy.fft import next_fast_len

    return 2 * int(next_fast_len((n + 1) // 2))


@dataclass(frozen=True)
class Layout:
    """Geometry of a convolution from a box of source cells to a box of target points of the same pitch.

    Parameters
    ----------
    source, target : (int, int)
        Cells along (y, x).
    origin : (float, float)
        Position of target (0, 0) relative to source (0, 0), in cells along (y, x). Need not be whole: targets may
        lie between cell centres, which costs the parity along that axis.
    periodic : bool
        Circular convolution on the source box; kernels are then given by their spectrum.
    lengths : (int, int), optional
        Periods of a circular convolution where they are longer than the box (a circulant preconditioner may pad to
        a fast length).
    """

    source: tuple[int, int]
    target: tuple[int, int]
    origin: tuple[float, float] = (0.0, 0.0)
    periodic: bool = False
    lengths: tuple[int, int] | None = None

    @cached_property
    def y(self) -> Axis:
        """Axis y."""
        length = self.lengths[0] if self.lengths else None
        return Axis.plan(self.source[0], self.target[0], self.origin[0], periodic=self.periodic, length=length)

    @cached_property
    def x(self) -> Axis:
        """Axis x."""
        length = self.lengths[1] if self.lengths else None
        return Axis.plan(self.source[1], self.target[1], self.origin[1], periodic=self.periodic, length=length)

    def spectrum(
        self, table: FloatArray, parity: tuple[int, int], *, precision: str = "double", scale: float = 1.0
    ) -> Spectrum:
        """Transform a table of influence coefficients, sampled on the lattice, into a packed spectrum.

        Parameters
        ----------
        table : (len(lattice_y), len(lattice_x)) float64
            Coefficients; along a symmetric axis only the offsets 0..F/2 are given.
        parity : (int, int)
            +1 even, -1 odd, along (y, x); used along symmetric axes only.
        precision : {"double", "single"}
            Storage of the spectrum; the transform itself is done in double.
        scale : float
            Factor on the coefficients.
        """
        rule = "False where a table is given; a periodic kernel is given by its response (spectrum_from_response)"
        require(not self.periodic, "convolution", "periodic", self.periodic, rule)
        expected = (self.y.lattice.size, self.x.lattice.size)
        require(table.shape == expected, "convolution", "table", table.shape, f"of shape {expected}")
        return transform_table(self.y, self.x, table, parity, precision, scale)

    def spectra(self, tables: FloatArray, parity: tuple[int, int], *, precision: str = "double") -> list[Spectrum]:
        """Spectra of tables ``(n, len(lattice_y), len(lattice_x))`` of one parity, transformed together.

        See `spectrum`. Small tables take a fraction of the time that each of them takes alone.
        """
        values: NDArray[Any] = tables.transpose(0, 2, 1)
        turns = 0  # powers of -1j: the transform of an odd sequence is -1j times its sine transform
        for axis, plan, sign in ((1, self.x, parity[1]), (2, self.y, parity[0])):
            if plan.symmetric:
                values, turns = parity_transform(values, axis, sign, 1), turns + (sign < 0)
            else:
                transform = np.fft.fft if np.iscomplexobj(values) or axis == 2 else np.fft.rfft
                values = transform(plan.scatter(values, axis), axis=axis)
        imaginary = turns == 1 and not np.iscomplexobj(values)
        factor = {0: 1.0, 1: -1.0 if imaginary else -1j, 2: -1.0}[turns]
        sign_y = parity[0] if self.y.symmetric else 0
        packed = Spectrum.pack(
            factor * values, self.y.length * self.x.length, sign_y, imaginary=imaginary, precision=precision
        )
        return [Spectrum(row, sign_y, imaginary) for row in packed.values]

    def wavenumbers(self, dy: float, dx: float) -> tuple[FloatArray, FloatArray]:
        """Wavenumbers (ky of shape (F_y//2+1,), kx of shape (F_x//2+1,)) of a periodic layout [1/m]."""
        ky = 2.0 * np.pi * np.arange(self.y.half, dtype=np.float64) / (self.y.length * dy)
        kx = 2.0 * np.pi * np.arange(self.x.half, dtype=np.float64) / (self.x.length * dx)
        return ky, kx

    def spectrum_from_response(
        self, response: NDArray[np.complex128], parity: tuple[int, int], *, precision: str = "double"
    ) -> Spectrum:
        """Pack the wavenumber response ``(F_y//2+1, F_x//2+1)`` of a periodic layout into a spectrum."""
        values = np.array(response.T)
        for axis, (size, sign) in enumerate(((self.x.length, parity[1]), (self.y.length, parity[0]))):
            if sign < 0 and size % 2 == 0:  # an odd response has no Nyquist term
                np.moveaxis(values, axis, 0)[-1] = 0.0
        imaginary = parity[0] * parity[1] < 0
        packed = values.imag if imaginary else values.real
        return Spectrum.pack(packed, self.y.length * self.x.length, parity[0], imaginary=imaginary, precision=precision)
