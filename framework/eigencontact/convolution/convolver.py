"""FFT convolution on a plane: real transforms of the nonzero rows, then batches of columns that fit into the cache.

Of the zero-padded (F_y, F_x) domain only the source's rows are transformed along x, and only the target's rows are
transformed back. Rows and columns are gathered in batches small enough to stay in cache; each batch of columns is
transformed along y, multiplied by the packed spectrum and transformed back at once. Neither the padded real field nor
the padded complex field ever exists in memory.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from eigencontact.convolution.backends import Backend, Plan, backend
from eigencontact.convolution.compiling import planes_repay
from eigencontact.convolution.layout import Layout
from eigencontact.convolution.rows import Rows, same
from eigencontact.convolution.spectrum import Spectrum
from eigencontact.core.array_types import Array
from eigencontact.core.parallel import available_threads, in_parallel
from eigencontact.errors import require

__all__ = ["Convolver"]

Kernels = Sequence[Sequence[Spectrum | None]]

# Bytes of one batch, small enough to stay in cache while it is filled, transformed and emptied (measured optimum).
_BATCH_BYTES = 524_288
# Columns of a batch at least, where they are long: rows lie far apart in memory, and what is near is used together.
_FEWEST_COLUMNS = 16
# Rows that are turned into columns at a time.
_TURNED = 512
# Targets whose half-transformed rows are held at a time.
_TOGETHER = 6
# Bytes of a spectrum up to which many sources are summed plane by plane, without keeping their half-transformed rows.
_SMALL_PLANE = 4 * _BATCH_BYTES


class Convolver:
    """Plans and buffers for convolutions of one layout; kernels are handed to `apply`.

    Parameters
    ----------
    layout : Layout
        Boxes and padding.
    precision : {"double", "single"}
        Arithmetic of the transforms. Single halves time and memory; its price is a relative error near 1e-7 of the
        largest value.
    threads : int, optional
        Cores to use; by default all this process may use.
    library : {"auto", "pyfftw", "scipy"}
        FFT library; ``"auto"`` takes pyFFTW where it is installed.
    effort : {"estimate", "measure"}
        FFTW planning effort.
    applications : float
        How often it will be applied; where many sources are summed, compiled loops repay their import after some.

    Notes
    -----
    One convolver must not be used from two threads at a time: its buffers are its own.
    The number of threads does not change a result, save for rounding where many sources are summed on a small plane.
    ``count`` is the number of (source, target) convolutions done so far.
    """

    def __init__(
        self,
        layout: Layout,
        *,
        precision: str = "double",
        threads: int | None = None,
        library: str = "auto",
        effort: str = "estimate",
        applications: float = 10.0,
    ) -> None:
        require(precision in ("double", "single"), "numerics", "precision", precision, "'double' or 'single'")
        require(threads is None or threads >= 1, "numerics", "threads", threads, "at least 1")
        self.layout = layout
        self.precision = precision
        self.count, self._applications = 0, applications
        self._real = np.float64 if precision == "double" else np.float32
        self._complex = np.complex128 if precision == "double" else np.complex64
        self._fft = backend(library, effort)
        y, x = layout.y, layout.x
        self.threads = min(threads or available_threads(), max(1, x.length * y.length // 16_384))
        self._rows = Rows(layout, self._fft, (self._real, self._complex)) if y.length == 1 else None
        #: Kernels that were found to be of this layout, and how many of them there are.
        self._checked: tuple[list[Spectrum | None], int] = [], 0
        self._half: list[Array] = []
        self._workers: list[_Worker] = []
        if self._rows is not None:
            return
        # Equal batches, an even number where one is not enough, whatever the threads: they do not change the answer.
        batches = -(-16 * x.half * y.length // max(_BATCH_BYTES, 16 * y.length * _FEWEST_COLUMNS))
        batches += batches % 2 if batches > 1 else 0
        columns = _blocks(x.half, -(-x.half // batches))
        batch_rows = max(1, _BATCH_BYTES // (8 * x.length))
        self._workers = [
            _Worker(layout, self._fft, (self._real, self._complex), columns, batch_rows, (k, self.threads))
            for k in range(self.threads)
        ]

    @property
    def library(self) -> str:
        """FFT library in use."""
        return self._fft.name

    @property
    def nbytes(self) -> int:
        """Memory of the current buffers."""
        rows = 0 if self._rows is None else self._rows.nbytes
        return rows + sum(int(half.nbytes) for half in self._half) + sum(worker.nbytes for worker in self._workers)

    def apply(self, sources: ArrayLike, kernels: Spectrum | Kernels) -> Array:
        """Convolve sources with a matrix of kernels: ``target[i] = sum_j kernels[i][j] * source[j]``.

        Parameters
        ----------
        sources : (ny, nx) or (n_sources, ny, nx)
            Source fields.
        kernels : Spectrum, or rows of Spectrum or None
            One kernel for one source and one target, or a matrix of them; None stands for zero.

        Returns
        -------
        (ty, tx) or (n_targets, ty, tx) array
            Fresh memory, of the precision of the convolver.
        """
        if isinstance(kernels, Spectrum):
            return np.asarray(self._apply(np.asarray(sources)[None], [[kernels]])[0])
        return self._apply(np.asarray(sources), kernels)

    def energy(self, source: Array, kernel: Spectrum) -> float:
        """Sum of a source times its own convolution, at half the cost of a convolution.

        Parameters
        ----------
        source : (ny, nx) array
            Source field; the targets must be the same cells.
        kernel : Spectrum
            Real and even in x and y.
        """
        if self._rows is not None:
            return self._rows.energy(source, kernel)
        half = self._buffers(1)
        self._all([partial(worker.rows_forward, source[None], half) for worker in self._workers])
        sums: dict[int, float] = {}
        self._all([partial(worker.energy, kernel, half[0], sums) for worker in self._workers])
        return sum(sums[first] for first in sorted(sums))  # in this order whatever the threads

    def _apply(self, sources: Array, kernels: Kernels) -> Array:
        expected = (sources.shape[0], *self.layout.source)
        require(sources.shape == expected, "convolution", "sources", sources.shape, f"of shape {expected}")
        n, widths = len(sources), [len(row) for row in kernels]
        require(set(widths) <= {n}, "convolution", "kernels", widths, f"rows of {n} kernels, one for each source")
        flat = [kernel for row in kernels for kernel in row]
        if not same(flat, self._checked[0]):
            self._check(flat)
        self.count += self._checked[1]
        targets = np.empty((len(kernels), *self.layout.target), self._real)
        if self._rows is not None:
            self._rows.apply(sources, flat, targets)
            return targets
        if len(sources) > len(kernels):
            self._compile(len(sources) * len(kernels))
        if len(sources) > len(kernels) and 16 * self.layout.x.half * self.layout.y.length <= _SMALL_PLANE:
            return self._sum_planes(sources, kernels, targets)
        groups = [kernels[first : first + _TOGETHER] for first in range(0, len(kernels), _TOGETHER)]
        # The half-transformed rows of targets take the place of those of the sources, unless these are needed again.
        first_output = len(sources) if len(groups) > 1 else 0
        half = self._buffers(max(len(sources), first_output + max(map(len, groups), default=0)))
        self._all([partial(worker.rows_forward, sources, half) for worker in self._workers])
        for number, group in enumerate(groups):
            into = targets[_TOGETHER * number :]
            self._all([partial(w.columns, len(sources), group, half, half[first_output:]) for w in self._workers])
            self._all([partial(w.rows_inverse, len(group), half[first_output:], into) for w in self._workers])
        return targets

    def _check(self, kernels: list[Spectrum | None]) -> None:
        """Refuse kernels of another layout."""
        present = [kernel for kernel in kernels if kernel is not None]
        for kernel in present:
            shape = (self.layout.x.half, self.layout.y.half if kernel.sign_y else self.layout.y.length)
            require(
                kernel.values.shape == shape,
                "convolution",
                "kernels",
                kernel.values.shape,
                f"of this convolver's layout, with spectra of shape {shape}",
            )
        self._checked = kernels, len(present)

    def _compile(self, pairs: int) -> None:
        """Load the compiled loop where this many pairs repay its import."""
        if planes_repay(pairs, pairs * self.layout.y.length * self.layout.x.half, self._applications):
            from eigencontact.convolution.compiled import add_packed

            for worker in self._workers:
                worker.add_packed = add_packed

    def _sum_planes(self, sources: Array, kernels: Kernels, targets: Array) -> Array:
        """Convolution of many sources on a small plane, with target sums in the cache: each thread sums its share."""
        workers = self._workers[: len(sources)]
        self._all([partial(worker.add_up, sources, kernels) for worker in workers])
        totals = workers[0].totals[: len(kernels)]
        for summand in workers[1:]:
            totals += summand.totals[: len(kernels)]
        half = self._buffers(len(kernels))
        self._all([partial(worker.columns_inverse, totals, half) for worker in self._workers])
        self._all([partial(worker.rows_inverse, len(kernels), half, targets) for worker in self._workers])
        return targets

    def _all(self, tasks: list[Callable[[], None]]) -> None:
        in_parallel(self.threads, tasks)

    def _buffers(self, count: int) -> list[Array]:
        """Half-transformed rows: places along y, wavenumbers along x."""
        rows = max(self.layout.source[0], self.layout.target[0])
        while len(self._half) < count:
            self._half.append(self._fft.empty((rows, self.layout.x.half), self._complex))
        return self._half


class _Worker:
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
        self._rows_of_source, self._all_columns = _blocks(y.sources, batch_rows), columns
        self._source_rows = self._rows_of_source[self._share]
        self._target_rows = _blocks(y.targets, batch_rows)[self._share]
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


def _blocks(total: int, size: int) -> list[slice]:
    return [slice(start, min(start + size, total)) for start in range(0, total, size)]


def _turn(rows: Array, columns: Array) -> None:
    """Transpose rows to columns, in groups of rows that fit into the cache."""
    for first in range(0, len(rows), _TURNED):
        columns[:, first : first + _TURNED] = rows[first : first + _TURNED].T
