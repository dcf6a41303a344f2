"""FFT convolution on a plane: real transforms of the nonzero rows, then batches of columns that fit into the cache.

Of the zero-padded (F_y, F_x) domain only the source's rows are transformed along x, and only the target's rows are
transformed back. Rows and columns are gathered in batches small enough to stay in cache; each batch of columns is
transformed along y, multiplied by the packed spectrum and transformed back at once. Neither the padded real field nor
the padded complex field ever exists in memory.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np
from numpy.typing import ArrayLike

from eigencontact.convolution.backends import backend
from eigencontact.convolution.compiling import planes_repay
from eigencontact.convolution.layout import Layout
from eigencontact.convolution.plane_worker import Kernels, PlaneWorker, blocks_of
from eigencontact.convolution.rows import Rows, all_identical
from eigencontact.convolution.spectrum import Spectrum
from eigencontact.core.array_types import Array
from eigencontact.core.parallel import available_threads, in_parallel
from eigencontact.errors import require

__all__ = ["Convolver"]

# Bytes of one batch, small enough to stay in cache while it is filled, transformed and emptied (measured optimum).
_BATCH_BYTES = 524_288
# Columns of a batch at least, where they are long: rows lie far apart in memory, and what is near is used together.
_FEWEST_COLUMNS = 16
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
        self._workers: list[PlaneWorker] = []
        if self._rows is not None:
            return
        # Equal batches, an even number where one is not enough, whatever the threads: they do not change the answer.
        batches = -(-16 * x.half * y.length // max(_BATCH_BYTES, 16 * y.length * _FEWEST_COLUMNS))
        batches += batches % 2 if batches > 1 else 0
        columns = blocks_of(x.half, -(-x.half // batches))
        batch_rows = max(1, _BATCH_BYTES // (8 * x.length))
        self._workers = [
            PlaneWorker(layout, self._fft, (self._real, self._complex), columns, batch_rows, (k, self.threads))
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
        self._run_tasks([partial(worker.rows_forward, source[None], half) for worker in self._workers])
        sums: dict[int, float] = {}
        self._run_tasks([partial(worker.energy, kernel, half[0], sums) for worker in self._workers])
        return sum(sums[first] for first in sorted(sums))  # in this order whatever the threads

    def _apply(self, sources: Array, kernels: Kernels) -> Array:
        expected = (sources.shape[0], *self.layout.source)
        require(sources.shape == expected, "convolution", "sources", sources.shape, f"of shape {expected}")
        n, widths = len(sources), [len(row) for row in kernels]
        require(set(widths) <= {n}, "convolution", "kernels", widths, f"rows of {n} kernels, one for each source")
        flat = [kernel for row in kernels for kernel in row]
        if not all_identical(flat, self._checked[0]):
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
        self._run_tasks([partial(worker.rows_forward, sources, half) for worker in self._workers])
        for number, group in enumerate(groups):
            into = targets[_TOGETHER * number :]
            self._run_tasks([partial(w.columns, len(sources), group, half, half[first_output:]) for w in self._workers])
            self._run_tasks([partial(w.rows_inverse, len(group), half[first_output:], into) for w in self._workers])
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
        self._run_tasks([partial(worker.add_up, sources, kernels) for worker in workers])
        totals = workers[0].totals[: len(kernels)]
        for summand in workers[1:]:
            totals += summand.totals[: len(kernels)]
        half = self._buffers(len(kernels))
        self._run_tasks([partial(worker.columns_inverse, totals, half) for worker in self._workers])
        self._run_tasks([partial(worker.rows_inverse, len(kernels), half, targets) for worker in self._workers])
        return targets

    def _run_tasks(self, tasks: list[Callable[[], None]]) -> None:
        in_parallel(self.threads, tasks)

    def _buffers(self, count: int) -> list[Array]:
        """Half-transformed rows: places along y, wavenumbers along x."""
        rows = max(self.layout.source[0], self.layout.target[0])
        while len(self._half) < count:
            self._half.append(self._fft.empty((rows, self.layout.x.half), self._complex))
        return self._half
