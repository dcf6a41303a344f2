"""The convolution itself: real transforms of the rows that hold something, then cache-sized batches of columns.

Of the zero-padded (F_y, F_x) domain only the source's rows are transformed along x, and only the target's rows are
transformed back. Columns are gathered in batches small enough to stay in cache; each batch is transformed along y,
multiplied by the packed spectrum and transformed back at once, so the padded complex field never exists in memory.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eigencontact.convolution.backends import Plan, available_threads, backend, in_parallel
from eigencontact.convolution.layout import Layout
from eigencontact.convolution.spectrum import Spectrum
from eigencontact.errors import require

__all__ = ["Convolver"]

# Bytes of one batch of columns: three of them (in, transformed, out) and the spectrum stay in a 1 MiB cache.
_BATCH_BYTES = 262_144


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

    Notes
    -----
    One convolver must not be used from two threads at a time: its buffers are its own.
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
    ) -> None:
        require(precision in ("double", "single"), "numerics", "precision", precision, "'double' or 'single'")
        require(threads is None or threads >= 1, "numerics", "threads", threads, "at least 1")
        self.layout = layout
        self.precision = precision
        self.count = 0
        self._real = np.float64 if precision == "double" else np.float32
        self._complex = np.complex128 if precision == "double" else np.complex64
        self._fft = backend(library, effort)
        y, x = layout.y, layout.x
        points = x.length * y.length
        self.threads = min(threads or available_threads(), max(1, points // 16_384))
        self._columns = _blocks(x.half, max(1, _BATCH_BYTES // (16 * y.length)))
        self._forward_rows: list[tuple[NDArray[Any], NDArray[Any], list[Plan]]] = []
        self._inverse_rows: list[tuple[NDArray[Any], NDArray[Any], list[Plan]]] = []
        self._workers = [_Worker(self, len(self._columns)) for _ in range(self.threads)]

    @property
    def library(self) -> str:
        """FFT library in use."""
        return self._fft.name

    @property
    def nbytes(self) -> int:
        """Memory of buffers held now."""
        rows = (a.nbytes + b.nbytes for a, b, _ in self._forward_rows + self._inverse_rows)
        return sum(rows) + sum(worker.nbytes for worker in self._workers)

    def apply(
        self, sources: ArrayLike, kernels: Spectrum | Sequence[Sequence[Spectrum | None]]
    ) -> NDArray[Any]:
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
            return self._apply(np.asarray(sources)[None], [[kernels]])[0]
        return self._apply(np.asarray(sources), kernels)

    def _apply(self, sources: NDArray[Any], kernels: Sequence[Sequence[Spectrum | None]]) -> NDArray[Any]:
        expected = (sources.shape[0], *self.layout.source)
        require(sources.shape == expected, "convolution", "sources", sources.shape, f"of shape {expected}")
        n, widths = len(sources), [len(row) for row in kernels]
        require(set(widths) <= {n}, "convolution", "kernels", widths, f"rows of {n} kernels, one for each source")
        for kernel in (kernel for row in kernels for kernel in row if kernel is not None):
            shape = (self.layout.x.half, self.layout.y.half if kernel.sign_y else self.layout.y.length)
            require(
                kernel.values.shape == shape,
                "convolution",
                "kernels",
                kernel.values.shape,
                f"of this convolver's layout, with spectra of shape {shape}",
            )
        self.count += sum(kernel is not None for row in kernels for kernel in row)
        rows = [self._rows_forward(index, field) for index, field in enumerate(sources)]
        targets = np.empty((len(kernels), *self.layout.target), self._real)
        together = 6  # targets whose half-transformed rows are held at a time
        for first in range(0, len(kernels), together):
            group = kernels[first : first + together]
            half = [self._inverse_buffers(index)[0] for index in range(len(group))]
            in_parallel(
                self.threads,
                [
                    partial(worker.run, self._columns[number :: self.threads], rows, group, half)
                    for number, worker in enumerate(self._workers)
                ],
            )
            for index in range(len(group)):
                _, full, plans = self._inverse_buffers(index)
                in_parallel(self.threads, plans)
                start = self.layout.x.target_start
                targets[first + index] = full[:, start : start + self.layout.target[1]]
        return targets

    def _rows_forward(self, index: int, field: NDArray[Any]) -> NDArray[Any]:
        """Transform the rows of one source along x."""
        x = self.layout.x
        while len(self._forward_rows) <= index:
            padded = self._fft.empty((self.layout.source[0], x.length), self._real)
            half = self._fft.empty((self.layout.source[0], x.half), self._complex)
            self._forward_rows.append((padded, half, self._split(self._fft.real_forward, padded, half)))
        padded, half, plans = self._forward_rows[index]
        padded[:, x.source_start : x.source_start + self.layout.source[1]] = field
        in_parallel(self.threads, plans)
        return half

    def _inverse_buffers(self, index: int) -> tuple[NDArray[Any], NDArray[Any], list[Plan]]:
        x = self.layout.x
        while len(self._inverse_rows) <= index:
            half = self._fft.empty((self.layout.target[0], x.half), self._complex)
            full = self._fft.empty((self.layout.target[0], x.length), self._real)
            self._inverse_rows.append((half, full, self._split(self._fft.real_inverse, half, full)))
        return self._inverse_rows[index]

    def _split(
        self, plan: Callable[[NDArray[Any], NDArray[Any]], Plan], source: NDArray[Any], target: NDArray[Any]
    ) -> list[Plan]:
        rows = _blocks(len(source), -(-len(source) // self.threads))
        return [plan(source[block], target[block]) for block in rows]


class _Worker:
    """Buffers and plans with which one thread transforms batches of columns."""

    def __init__(self, owner: Convolver, batches: int) -> None:
        layout, fft = owner.layout, owner._fft  # noqa: SLF001 - a part of its owner, apart for the thread's sake
        self._layout = layout
        self._make = partial(fft.empty, dtype=owner._complex)  # noqa: SLF001
        self._fft = fft
        columns = owner._columns[0]  # noqa: SLF001
        self._shape = (columns.stop - columns.start, layout.y.length)
        self._sources: list[tuple[NDArray[Any], NDArray[Any], Plan]] = []
        self._product = self._make(self._shape)
        self._sum = self._make(self._shape)
        self._back = self._make(self._shape)
        self._inverse = fft.inverse(self._sum, self._back)

    @property
    def nbytes(self) -> int:
        return (3 + 2 * len(self._sources)) * int(self._product.nbytes)

    def run(
        self,
        batches: Sequence[slice],
        sources: Sequence[NDArray[Any]],
        kernels: Sequence[Sequence[Spectrum | None]],
        targets: Sequence[NDArray[Any]],
    ) -> None:
        y = self._layout.y
        source_rows = slice(y.source_start, y.source_start + y.sources)
        target_rows = slice(y.target_start, y.target_start + y.targets)
        while len(self._sources) < len(sources):
            padded, spectrum = self._make(self._shape), self._make(self._shape)
            self._sources.append((padded, spectrum, self._fft.forward(padded, spectrum)))
        for columns in batches:
            n = columns.stop - columns.start
            for field, (padded, _, forward) in zip(sources, self._sources, strict=False):
                padded[:n, source_rows] = field[:, columns].T
                forward()
            for row, target in zip(kernels, targets, strict=True):
                out = self._sum[:n]
                first = True
                for kernel, (_, spectrum, _) in zip(row, self._sources, strict=False):
                    if kernel is None:
                        continue
                    kernel.multiply(spectrum[:n], columns, out if first else self._product[:n])
                    if not first:
                        out += self._product[:n]
                    first = False
                if first:
                    out[:] = 0.0
                self._inverse()
                target[:, columns] = self._back[:n, target_rows].T


def _blocks(total: int, size: int) -> list[slice]:
    return [slice(start, min(start + size, total)) for start in range(0, total, size)]
