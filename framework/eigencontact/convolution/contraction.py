"""Products of kernels and sources at every wavenumber, and powers of depth: in numpy or in compiled loops."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from eigencontact.convolution.weighted_sums import WeightedSums
from eigencontact.core.array_types import Array

__all__ = ["BlockContraction", "CompiledContraction"]


class _Contraction:
    """Common data of both contractions: coefficients, weights of the depths, signs at -ky."""

    def __init__(self, sums: WeightedSums, active: Sequence[int], depths: Array, size: int, dtype: Any) -> None:
        layout = sums.kernels.layout
        self._sums, self._size, self._dtype = sums, size, np.dtype(dtype)
        self._real = sums.kernels.values.dtype
        # Folded: at each kz >= 0 the values there and the conjugates of those at -kz; kernels multiply both alike.
        self._halves, self._signs, self._kz = (2 if layout.folded else 1), layout.signs, layout.spectrum_shape[2]
        self._matrices = sums.matrices(active)
        self._flips = np.array([parity[0] for parity in sums.outputs], self._real)
        self._first, self._targets = layout.z.target_start, layout.z.targets
        products = [
            (output, number, factor * depths**power)
            for number, row in enumerate(sums.rows_of(active))
            for output, power, factor in row.into
        ]
        products.sort(key=lambda item: item[:2])
        self._starts = np.searchsorted([output for output, *_ in products], np.arange(len(sums.outputs) + 1))
        self._rows = np.array([row for _, row, _ in products])
        self._weights = np.array([weight for *_, weight in products], self._real)
        self._buffers: list[Array] = []

    @property
    def nbytes(self) -> int:
        return sum(int(buffer.nbytes) for buffer in self._buffers)

    def _empty(self, *shape: int, dtype: Any = None) -> Array:
        self._buffers.append(np.zeros(shape, dtype or self._dtype))
        return self._buffers[-1]


class BlockContraction(_Contraction):
    """Kernels assembled by one sparse matrix product, then one multiplication and one sum for each row."""

    def __init__(self, sums: WeightedSums, active: Sequence[int], depths: Array, size: int, dtype: Any) -> None:
        super().__init__(sums, active, depths, size, dtype)
        from scipy.sparse import csr_array

        n, halves, signs, kz = len(active), self._halves, self._signs, self._kz
        # Sparse, as most entries are zero, and as the threads of a dense product would spin beside ours.
        self._matrix = csr_array(np.concatenate([matrix for *_, matrix in self._matrices]).astype(self._real))
        self._columns = self._empty(2 * n, halves, signs, size, kz)
        self._product = self._empty(max(last - first for first, last, _ in self._matrices), halves, signs, size, kz)
        self._lower = self._empty(signs, size, kz)
        self._assembled = self._empty(self._matrix.shape[0], 1, 1, size, kz)
        self._sum, self._term = self._empty(signs, size, self._targets), self._empty(signs, size, self._targets)

    def multiply(self, waves: Array, kernels: Array, piece: slice, out: Array) -> None:
        """Sum kernels times sources of one piece.

        Parameters
        ----------
        waves : (n, signs, size, Fz + 1) complex
            Spectra of the sources; the value at kz = 0 is repeated behind the last.
        kernels : (n_kernels, 2, ky, kz)
            Real and imaginary parts.
        piece : slice
            Wavenumbers ky of the piece.
        out : (rows, signs, size, Fz) complex
            The answer.
        """
        n, size, kz = len(waves), piece.stop - piece.start, self._kz
        columns, mirrored = self._columns, waves[..., ::-1][..., :kz]
        np.copyto(columns[:n, 0], waves[..., :kz])
        np.copyto(columns[n:, 0], mirrored)
        if self._halves == 2:
            np.conjugate(mirrored, out=columns[:n, 1])
            np.conjugate(waves[..., :kz], out=columns[n:, 1])
        for component, values in enumerate((self._assembled.real, self._assembled.imag)):
            combined = self._matrix @ kernels[:, component, piece].reshape(len(kernels), -1)
            values[..., :size, :] = combined.reshape(-1, 1, 1, size, kz)
        upper, position = slice(1, out.shape[-1] - kz + 1), 0
        for row, (first, last, matrix) in enumerate(self._matrices):
            weights = self._assembled[position : position + len(matrix), :, :, :size]
            position += len(matrix)
            product = self._product[: last - first, :, :, :size]
            np.multiply(weights, columns[first:last, :, :, :size], out=product)
            np.add.reduce(product[:, 0], axis=0, out=out[row, :, :size, :kz])
            if self._halves == 2:
                lower = self._lower[:, :size]
                np.add.reduce(product[:, 1], axis=0, out=lower)
                np.conjugate(lower[..., upper], out=out[row, :, :size, : kz - 1 : -1])

    def collect(self, back: Array, piece: slice, out: Array) -> None:
        """Crop ``back (rows, signs, size, Fz)`` along z, combine the powers, place into ``out (n, tz, Fy + 1)``."""
        rows, size, last = slice(self._first, self._first + self._targets), piece.stop - piece.start, out.shape[2] - 1
        for output, flip in enumerate(self._flips):
            self._sum[:] = 0
            for number in range(self._starts[output], self._starts[output + 1]):
                self._sum += np.multiply(back[self._rows[number], ..., rows], self._weights[number], out=self._term)
            out[output, :, piece] = self._sum[0, :size].T
            if self._signs == 2:
                mirrored = out[output, :, last - piece.stop + 1 : last - piece.start + 1][..., ::-1]
                np.multiply(self._sum[1, :size].T, flip, out=mirrored)


class CompiledContraction(_Contraction):
    """Contraction in compiled loops over blocks that fit into the first-level cache."""

    def __init__(self, sums: WeightedSums, active: Sequence[int], depths: Array, size: int, dtype: Any) -> None:
        super().__init__(sums, active, depths, size, dtype)
        from eigencontact.convolution import compiled

        entries, terms = [0], [0]
        columns: list[int] = []
        numbers: list[int] = []
        coefficients: list[float] = []
        for first, last, matrix in self._matrices:
            # The columns of a group are neighbours; where they would pass the last one, some before are taken at zero.
            count = -(-(last - first) // compiled.GROUP) * compiled.GROUP
            begin = min(first, max(0, 2 * len(active) - count))
            for column in range(begin, begin + count):
                row = matrix[column - first] if first <= column < last else np.zeros(matrix.shape[1])
                used = np.flatnonzero(row)
                columns.append(column)
                numbers.extend(used)
                coefficients.extend(row[used])
                terms.append(len(numbers))
            entries.append(len(columns))
        self._tables = [np.array(table, np.int64) for table in (entries, columns, terms, numbers)]
        self._tables.append(np.array(coefficients, self._real))
        pairs, values, rows_in_cache = 2 * self._signs, size * self._kz, max(2 * len(active), *columns) + 1
        self._work = [
            self._empty(pairs, rows_in_cache, 2, values, dtype=self._real),
            self._empty(compiled.GROUP, 2, values, dtype=self._real),
            self._empty(pairs, 2, values, dtype=self._real),
        ]
        self._depth = self._empty(self._targets)
        self._contract, self._collect = compiled.contract, compiled.collect

    def multiply(self, waves: Array, kernels: Array, piece: slice, out: Array) -> None:
        """See `BlockContraction.multiply`."""
        flat = kernels.reshape(len(kernels), 2, -1)
        size = piece.stop - piece.start
        self._contract(waves, flat, piece.start * self._kz, *self._tables, out, *self._work, size)

    def collect(self, back: Array, piece: slice, out: Array) -> None:
        """See `BlockContraction.collect`."""
        self._collect(
            back, self._starts, self._rows, self._weights, self._flips, self._first, piece.start,
            piece.stop - piece.start, self._depth, out,
        )  # fmt: skip
