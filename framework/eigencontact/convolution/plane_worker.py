"""Share of one thread in a convolution on a plane: batches of rows and columns, their plans and buffers."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any

import numpy as np

from eigencontact.convolution.backends import Backend, Plan
from eigencontact.convolution.layout import Layout
from eigencontact.convolution.spectrum import Spectrum
from eigencontact.core.array_types import Array

__all__ = ["Kernels", "PlaneWorker", "blocks_of"]

Kernels = Sequence[Sequence[Spectrum | None]]

# Rows that are turned into columns at a time.
_TURNED = 512


class PlaneWorker:
    """Buffers and plans of one thread for its share of rows and columns."""

    def __init__(
        self,
        layout: Layout,
        fft: Backend,
        dtypes: tuple[Any, Any],
        columns: list[slice],
        batch_rows: int,
        share: tuple[int, int],
    ) -> None:
        number, threads = share
        y, x = layout.y, layout.x
        self._layout, self._fft, self._complex = layout, fft, dtypes[1]
        self._share = slice(number, None, threads)
        self._rows_of_source, self._all_columns = blocks_of(y.sources, batch_rows), columns
        self._source_rows = self._rows_of_source[self._share]
        self._target_rows = blocks_of(y.targets, batch_rows)[self._share]
        self._columns = columns[self._share]
        # Zero outside the source's columns, and kept so: real transforms do not destroy their input.
        self._padded = fft.empty((min(batch_rows, y.sources), x.length), dtypes[0])
        self._padded[:] = 0
        self._full = fft.empty((min(batch_rows, y.targets), x.length), dtypes[0])
        self._shape = (columns[0].stop - columns[0].start, y.length)
        self._forward_plans: dict[tuple[int, int], Plan] = {}
        self._inverse_plans: dict[tuple[int, int], Plan] = {}
        self._sources: list[tuple[Array, Array, Plan]] = []
        self._sums: list[Array] = []
        #: Spectra of the targets as far as this thread has added them up, and the rows of the source at hand.
        self.totals = np.empty((0, x.half, y.length), self._complex)
        self._rows = np.empty((0, x.half), self._complex)
        #: Compiled loop that adds a packed spectrum times a field, once there is enough to do for it.
        self.add_packed: Callable[..., None] | None = None
        self._product = self._sum = self._back = np.empty((0, 0))
        self._inverse: Plan | None = None

    @property
    def nbytes(self) -> int:
        """Memory of the buffers of this thread."""
        columns = sum(a.nbytes + b.nbytes for a, b, _ in self._sources)
        arrays = (self._padded, self._full, self._product, self._sum, self._back, *self._sums, self.totals, self._rows)
        return int(columns + sum(array.nbytes for array in arrays))

    def rows_forward(self, sources: Array, half: Sequence[Array]) -> None:
        """Transform this thread's rows of the sources along x."""
        for field, into in zip(sources, half, strict=False):
            self._forward(field, into, self._source_rows)

    def _forward(self, field: Array, half: Array, blocks: Sequence[slice]) -> None:
        start = self._layout.x.source_start
        for rows in blocks:
            n = rows.stop - rows.start
            key = (id(half), rows.start)
            if key not in self._forward_plans:
                self._forward_plans[key] = self._fft.forward(self._padded[:n], half[rows])
            self._padded[:n, start : start + self._layout.source[1]] = field[rows]
            self._forward_plans[key]()

    def add_up(self, sources: Array, kernels: Kernels) -> None:
        """Transform this thread's share of the sources and add them, times their kernels, to `totals`."""
        x, y = self._layout.x, self._layout.y
        self._prepare(1, 1)
        if len(self.totals) < len(kernels):
            self.totals = np.empty((len(kernels), x.half, y.length), self._complex)
            self._rows = self._fft.empty((y.sources, x.half), self._complex)
        self.totals[:] = 0.0
        for number in range(len(sources))[self._share]:
            self._forward(sources[number], self._rows, self._rows_of_source)
            row = [kernels_of_target[number] for kernels_of_target in kernels]
            for columns in self._all_columns:
                self._add(self._rows, row, columns, self.totals[:, columns])

    def columns_inverse(self, totals: Array, targets: Sequence[Array]) -> None:
        """Transform this thread's columns of summed spectra back along y."""
        self._prepare(1, 1)
        for columns in self._columns:
            for total, target in zip(totals, targets, strict=False):
                self._sum[: columns.stop - columns.start] = total[columns]
                self._transform_back(target, columns)

    def _transform_back(self, target: Array, columns: slice) -> None:
        y = self._layout.y
        assert self._inverse is not None
        self._inverse()
        rows = slice(y.target_start, y.target_start + y.targets)
        target[: y.targets, columns] = self._back[: columns.stop - columns.start, rows].T

    def columns(self, count: int, kernels: Kernels, sources: Sequence[Array], targets: Sequence[Array]) -> None:
        """Transform this thread's columns along y, apply the kernels, transform back."""
        y = self._layout.y
        source_rows = slice(y.source_start, y.source_start + y.sources)
        # Spectra of few sources are kept for all targets; of many sources each is added to all targets at once.
        gather = count > len(kernels)
        self._prepare(1 if gather else count, len(kernels) if gather else 0)
        for columns in self._columns:
            n = columns.stop - columns.start
            if gather:
                self._gather(sources[:count], kernels, columns)
            for number, field in enumerate(() if gather else sources[:count]):
                padded, _, forward = self._sources[number]
                _turn(field[: y.sources, columns], padded[:n, source_rows])
                forward()
            for number, (row, target) in enumerate(zip(kernels, targets, strict=False)):
                if gather:
                    self._sum[:] = self._sums[number]
                else:
                    self._combine(row, columns, n)
                self._transform_back(target, columns)

    def energy(self, kernel: Spectrum, source: Array, sums: dict[int, float]) -> None:
        """Share of this thread in `Convolver.energy`: a sum for each of its batches of columns."""
        x, y = self._layout.x, self._layout.y
        self._prepare(1, 0)
        padded, spectrum, forward = self._sources[0]
        for columns in self._columns:
            n = columns.stop - columns.start
            _turn(source[: y.sources, columns], padded[:n, y.source_start : y.source_start + y.sources])
            forward()
            waves = spectrum[:n]
            squares = np.square(waves.real, out=waves.real)
            squares += np.square(waves.imag, out=waves.imag)
            mirrored = y.length - y.half
            squares[:, 1 : mirrored + 1] += squares[:, : y.half - 1 : -1]
            by_column = np.einsum("ij,ij->i", squares[:, : y.half], kernel.values[columns])
            once = {0, x.length // 2} if x.length % 2 == 0 else {0}  # all other columns stand for -kx too
            single = sum(float(by_column[k - columns.start]) for k in once if columns.start <= k < columns.stop)
            sums[columns.start] = 2.0 * float(by_column.sum()) - single

    def _gather(self, sources: Sequence[Array], kernels: Kernels, columns: slice) -> None:
        """Sums of all targets, source by source; without keeping the spectra of the sources."""
        n = columns.stop - columns.start
        for total in self._sums:
            total[:n] = 0.0
        for number, field in enumerate(sources):
            self._add(field, [row[number] for row in kernels], columns, [total[:n] for total in self._sums])

    def _add(self, field: Array, kernels: Sequence[Spectrum | None], columns: slice, totals: Iterable[Array]) -> None:
        """Transform some columns of one source along y, and add their products with a kernel to each target sum."""
        n, y = columns.stop - columns.start, self._layout.y
        padded, spectrum, forward = self._sources[0]
        _turn(field[: y.sources, columns], padded[:n, y.source_start : y.source_start + y.sources])
        forward()
        for total, kernel in zip(totals, kernels, strict=False):
            if kernel is None:
                continue
            if self.add_packed and kernel.packed:
                first, sign = columns.start, float(kernel.sign_y)
                self.add_packed(total, spectrum[:n], kernel.values, first, sign, kernel.imaginary)
            else:
                kernel.multiply(spectrum[:n], columns, self._product[:n])
                np.add(total, self._product[:n], out=total)

    def _combine(self, row: Sequence[Spectrum | None], columns: slice, n: int) -> None:
        """Sum of the sources' spectra times their kernels."""
        out, first = self._sum[:n], True
        for kernel, (_, spectrum, _) in zip(row, self._sources, strict=False):
            if kernel is None:
                continue
            kernel.multiply(spectrum[:n], columns, out if first else self._product[:n])
            if not first:
                out += self._product[:n]
            first = False
        if first:
            out[:] = 0.0

    def _prepare(self, count: int, sums: int) -> None:
        """Make the buffers and plans of the columns, once."""

        def empty() -> Array:
            return self._fft.empty(self._shape, self._complex)

        if self._inverse is None:
            self._sum, self._back = empty(), empty()
            self._sum[:] = 0  # the last batch may be short, and what lies beyond it is transformed all the same
            self._inverse = self._fft.inverse(self._sum, self._back)
        while len(self._sums) < sums:
            self._sums.append(np.zeros(self._shape, self._complex))
        if (count > 1 or sums) and self._product.size == 0:
            self._product = empty()
        while len(self._sources) < count:
            padded, spectrum = empty(), empty()
            padded[:] = 0
            self._sources.append((padded, spectrum, self._fft.forward(padded, spectrum)))

    def rows_inverse(self, count: int, half: Sequence[Array], targets: Array) -> None:
        """Transform the rows of this thread back and crop them to the target's columns."""
        start = self._layout.x.target_start
        inner = slice(start, start + self._layout.target[1])
        for index in range(count):
            for rows in self._target_rows:
                n = rows.stop - rows.start
                key = (id(half[index]), rows.start)
                if key not in self._inverse_plans:
                    self._inverse_plans[key] = self._fft.inverse(half[index][rows], self._full[:n])
                self._inverse_plans[key]()
                targets[index, rows] = self._full[:n, inner]


def blocks_of(total: int, size: int) -> list[slice]:
    """Slices of at most `size` that cover `total` elements."""
    return [slice(start, min(start + size, total)) for start in range(0, total, size)]


def _turn(rows: Array, columns: Array) -> None:
    """Transpose rows to columns, in groups of rows that fit into the cache."""
    for first in range(0, len(rows), _TURNED):
        columns[:, first : first + _TURNED] = rows[first : first + _TURNED].T
