"""Sums over a volume by FFT: convolution and correlation along z, powers of the target's depth, fused.

The padded field never exists. Real transforms along x take the source's rows only; then each wavenumber kx is
finished by itself, in pieces that fit a cache: transform along y and z, sum kernels times sources, transform back along
z, weight with powers of the depth and crop, transform back along y and crop. Powers of the depth are combined before
the inverse transforms along y and x, which are therefore made once for each output. In a section, one row of cells
along y, pieces have many wavenumbers kx.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import partial

import numpy as np
from numpy.typing import ArrayLike

from eigencontact.convolution.backends import backend
from eigencontact.convolution.compiling import volumes_repay
from eigencontact.convolution.contraction import BlockContraction, CompiledContraction
from eigencontact.convolution.weighted_sums import WeightedSums
from eigencontact.core.array_types import Array
from eigencontact.core.parallel import available_threads, in_parallel
from eigencontact.errors import require

__all__ = ["VolumeConvolver"]

# Bytes of the kernels assembled for one piece, small enough for the second-level cache (measured optimum).
_PIECE_BYTES = 600_000


class VolumeConvolver:
    """Plans and buffers of one layout and one table of sums.

    Parameters
    ----------
    sums : WeightedSums
        Kernels and coefficients.
    depths : (tz,)
        What the powers in the table are powers of, for each target along z.
    threads : int, optional
        Cores to use; by default all this process may use.
    library : {"auto", "pyfftw", "scipy"}
        FFT library; ``"auto"`` takes pyFFTW where it is installed.
    loops : {"auto", "compiled", "numpy"}
        Who multiplies kernels and sources; ``"auto"`` takes numba where it is installed and repays its import.
    applications : float
        How often it will be applied, for ``"auto"``.

    Notes
    -----
    The precision is that of the kernels. One convolver must not be used from two threads at a time.
    """

    def __init__(
        self,
        sums: WeightedSums,
        depths: ArrayLike,
        *,
        threads: int | None = None,
        library: str = "auto",
        loops: str = "auto",
        applications: float = 10.0,
    ) -> None:
        require(threads is None or threads >= 1, "numerics", "threads", threads, "at least 1")
        layout = sums.kernels.layout
        self.layout, self.sums = layout, sums
        self.real = sums.kernels.values.dtype
        self.complex = np.complex128 if self.real == np.float64 else np.complex64
        depths = np.asarray(depths, dtype=float)
        rule = f"of shape {(layout.z.targets,)}, one for each target along z"
        require(depths.shape == (layout.z.targets,), "convolution", "depths", depths.shape, rule)
        self.depths = depths
        self.fft = backend(library)
        points = layout.x.length * layout.y.length * layout.z.length
        require(loops in ("auto", "compiled", "numpy"), "numerics", "loops", loops, "'auto', 'compiled' or 'numpy'")
        self.compiled = volumes_repay(points, applications) if loops == "auto" else loops == "compiled"
        self.threads = min(threads or available_threads(), max(1, points // 16_384))
        self._half: Array = np.empty(0, self.complex)
        self._workers: dict[tuple[int, ...], list[_Worker]] = {}

    @property
    def library(self) -> str:
        """FFT library in use."""
        return self.fft.name

    @property
    def nbytes(self) -> int:
        """Memory of the current buffers, without that of the kernels."""
        return int(self._half.nbytes) + sum(worker.nbytes for group in self._workers.values() for worker in group)

    def apply(self, sources: ArrayLike) -> Array:
        """Sum over the sources.

        Parameters
        ----------
        sources : (n_sources, nz, ny, nx)
            Source fields; those that are zero everywhere cost nothing.

        Returns
        -------
        (n_outputs, tz, ty, tx) array
            Fresh memory, of the precision of the kernels.
        """
        fields = np.asarray(sources)
        layout, count = self.layout, len(self.sums.outputs)
        expected = (len(self.sums.sources), *layout.source)
        require(fields.shape == expected, "convolution", "sources", fields.shape, f"of shape {expected}")
        fields = self.sums.merged(fields)
        active = tuple(k for k, field in enumerate(fields) if field.any())
        if not self.sums.rows_of(active):
            return np.zeros((count, *layout.target), self.real)
        targets: Array = np.empty((count, *layout.target), self.real)
        if active not in self._workers:
            form = _SectionWorker if layout.section else _Worker
            self._workers = {active: [form(self, active) for _ in range(self.threads)]}  # the last set is kept
        workers = self._workers[active]
        size = workers[0].half_shape
        if self._half.shape != size:
            self._half = self.fft.empty(size, self.complex)
        before, after = workers[0].views(self._half)
        forward, between, inverse = workers[0].tasks
        self._share(workers, forward, lambda w, k: w.forward_x(fields, k, before))
        self._share(workers, between, lambda w, k: w.wavenumber(k, before, after))
        self._share(workers, inverse, lambda w, k: w.inverse_x(k, after, targets))
        return targets

    def _share(self, workers: Sequence[_Worker], count: int, task: Callable[[_Worker, int], None]) -> None:
        """Perform `task` for the numbers below `count`; every worker performs the next open number."""
        numbers = iter(range(count))

        def work(worker: _Worker) -> None:
            for number in numbers:
                task(worker, number)

        in_parallel(self.threads, [partial(work, worker) for worker in workers])


class _Worker:
    """Buffers and plans of one thread."""

    def __init__(self, owner: VolumeConvolver, active: tuple[int, ...]) -> None:
        layout, sums, fft = owner.layout, owner.sums, owner.fft
        self._layout, self._sums, self._fft, self._active = layout, sums, fft, active
        self._complex, self._real = owner.complex, owner.real
        self._rows, self._outputs = len(sums.rows_of(active)), len(sums.outputs)
        self._buffers: list[Array] = []
        self._plan_x()
        self._plan_y()
        self._plan_z()
        form = CompiledContraction if owner.compiled else BlockContraction
        self._contraction = form(sums, active, owner.depths, self._size, self._complex)

    @property
    def nbytes(self) -> int:
        return sum(int(buffer.nbytes) for buffer in self._buffers) + self._contraction.nbytes

    @property
    def half_shape(self) -> tuple[int, int]:
        """Half-transformed sources or outputs of all wavenumbers kx; these take the place of those."""
        (nz, ny, _), (tz, ty, _) = self._layout.source, self._layout.target
        return self._layout.x.half, max(len(self._active) * nz * ny, self._outputs * tz * ty)

    def views(self, half: Array) -> tuple[Array, Array]:
        """Sources ``[kx, source, z, y]`` and outputs ``[kx, output, z, y]`` in this memory."""
        sources, outputs = (len(self._active), *self._layout.source[:2]), (self._outputs, *self._layout.target[:2])
        before, after = (half[:, : math.prod(shape)].reshape(-1, *shape) for shape in (sources, outputs))
        return before, after

    @property
    def tasks(self) -> tuple[int, int, int]:
        """Planes to transform along x, wavenumbers, and planes to transform back."""
        z = self._layout.z
        return len(self._active) * z.sources, self._layout.x.half, self._outputs * z.targets

    def _empty(self, *shape: int, real: bool = False) -> Array:
        array = self._fft.empty(shape, self._real if real else self._complex)
        array[:] = 0
        self._buffers.append(array)
        return array

    def _plan_x(self) -> None:
        layout = self._layout
        x, ny, ty = layout.x, layout.y.sources, layout.y.targets
        self._padded, self._halved = self._empty(ny, x.length, real=True), self._empty(ny, x.half)
        self._forward_x = self._fft.forward(self._padded, self._halved)
        self._unhalved, self._full = self._empty(ty, x.half), self._empty(ty, x.length, real=True)
        self._inverse_x = self._fft.inverse(self._unhalved, self._full)

    def _plan_y(self) -> None:
        # One column more than the transform repeats ky = 0 behind the last, so that -ky is a plain reversed slice.
        layout, n, m = self._layout, len(self._active), self._outputs
        y, nz, tz = layout.y, layout.z.sources, layout.z.targets
        self._padded_y, self._waves_y = self._empty(n, nz, y.length), self._empty(n, nz, y.length + 1)
        self._forward_y = self._fft.forward(self._padded_y, self._waves_y[..., : y.length])
        self._sum_y, self._back_y = self._empty(m, tz, y.length + 1), self._empty(m, tz, y.length)
        self._inverse_y = self._fft.inverse(self._sum_y[..., : y.length], self._back_y)

    def _plan_z(self) -> None:
        layout, n, rows, signs = self._layout, len(self._active), self._rows, self._layout.signs
        z, (_, ky, _) = layout.z, layout.spectrum_shape
        most = max(1, _PIECE_BYTES // (2 * rows * signs * z.length * np.dtype(self._complex).itemsize))
        self._size = size = -(-ky // -(-ky // most))
        self._pieces = [slice(k, min(k + size, ky)) for k in range(0, ky, size)]
        self._padded_z, self._waves_z = (self._empty(n, signs, size, z.length + more) for more in (0, 1))
        self._forward_z = self._fft.forward(self._padded_z, self._waves_z[..., : z.length])
        self._sum_z, self._back_z = (self._empty(rows, signs, size, z.length) for _ in range(2))
        self._inverse_z = self._fft.inverse(self._sum_z, self._back_z)

    def forward_x(self, fields: Array, number: int, half: Array) -> None:
        """Transform one plane of one source along x; ``half[kx, source, z, y]``."""
        place, k = divmod(number, self._layout.z.sources)
        x, source = self._layout.x, self._active[place]
        self._padded[:, x.source_start : x.source_start + x.sources] = fields[source, k]
        self._forward_x()
        if self._sums.turned(self._sums.sources[source]):
            np.multiply(self._halved.T, 1j, out=half[:, place, k])
        else:
            half[:, place, k] = self._halved.T

    def inverse_x(self, number: int, half: Array, targets: Array) -> None:
        """Transform one plane of one output back along x and crop it."""
        output, k = divmod(number, self._layout.z.targets)
        x = self._layout.x
        if self._sums.turned(self._sums.outputs[output]):
            np.multiply(half[:, output, k].T, 1j, out=self._unhalved)
        else:
            self._unhalved[:] = half[:, output, k].T
        self._inverse_x()
        targets[output, k] = self._full[:, x.target_start : x.target_start + x.targets]

    def wavenumber(self, kx: int, sources: Array, targets: Array) -> None:
        """Finish one kx: ``sources[kx, active, z, y]`` to ``targets[kx, output, z, y]``."""
        y = self._layout.y
        self._padded_y[..., y.source_start : y.source_start + y.sources] = sources[kx]
        self._forward_y()
        self._waves_y[..., -1] = self._waves_y[..., 0]
        for piece in self._pieces:
            self._spread(piece)
            self._along_z(kx, piece, self._sum_y)
        self._inverse_y()
        targets[kx] = self._back_y[..., y.target_start : y.target_start + y.targets]

    def _along_z(self, kx: int, piece: slice, out: Array) -> None:
        """Transform a piece along z, sum kernels times sources, transform back and collect into ``out[output, z]``."""
        self._forward_z()
        self._waves_z[..., -1] = self._waves_z[..., 0]
        self._contraction.multiply(self._waves_z, self._sums.kernels.values[kx], piece, self._sum_z)
        self._inverse_z()
        self._contraction.collect(self._back_z, piece, out)

    def _spread(self, piece: slice) -> None:
        """Rows along z of the wavenumbers ky of a piece, and of -ky."""
        z, length, n = self._layout.z, self._layout.y.length, piece.stop - piece.start
        rows = slice(z.source_start, z.source_start + z.sources)
        self._padded_z[:, 0, :n, rows] = self._waves_y[..., piece].transpose(0, 2, 1)
        if self._layout.signs == 1:
            return
        mirrored = self._waves_y[..., length - piece.stop + 1 : length - piece.start + 1][..., ::-1].transpose(0, 2, 1)
        for place, source in enumerate(self._active):
            if self._sums.sources[source][0] > 0:
                self._padded_z[place, 1, :n, rows] = mirrored[place]
            else:
                np.negative(mirrored[place], out=self._padded_z[place, 1, :n, rows])


class _SectionWorker(_Worker):
    """The same for a section: planes to transform have a row for each z, and pieces are wavenumbers kx."""

    def _plan_x(self) -> None:
        x, z = self._layout.x, self._layout.z
        self._padded, self._halved = self._empty(z.sources, x.length, real=True), self._empty(z.sources, x.half)
        self._forward_x = self._fft.forward(self._padded, self._halved)
        self._unhalved, self._full = self._empty(z.targets, x.half), self._empty(z.targets, x.length, real=True)
        self._inverse_x = self._fft.inverse(self._unhalved, self._full)

    def _plan_y(self) -> None:
        """Nothing: one row is its own transform."""

    @property
    def half_shape(self) -> tuple[int, int]:
        """Half-transformed sources and outputs of all wavenumbers kx, side by side."""
        z = self._layout.z
        return len(self._active) * z.sources + self._outputs * z.targets, self._layout.x.half

    def views(self, half: Array) -> tuple[Array, Array]:
        """Sources ``[source, kx, z]`` and outputs ``[output, z, kx]`` in this memory."""
        n, z = len(self._active), self._layout.z
        before, after = np.split(half, [n * z.sources])
        return before.reshape(n, -1, z.sources), after.reshape(-1, z.targets, self._layout.x.half)

    @property
    def tasks(self) -> tuple[int, int, int]:
        """Sources, pieces and outputs."""
        return len(self._active), len(self._pieces), self._outputs

    def forward_x(self, fields: Array, number: int, half: Array) -> None:
        """Transform one source along x; ``half[source, kx, z]``."""
        x, source = self._layout.x, self._active[number]
        self._padded[:, x.source_start : x.source_start + x.sources] = fields[source, :, 0]
        self._forward_x()
        np.multiply(self._halved.T, 1j if self._sums.turned(self._sums.sources[source]) else 1.0, out=half[number])

    def inverse_x(self, number: int, half: Array, targets: Array) -> None:
        """Transform one output back along x and crop it; ``half[output, z, kx]``."""
        x = self._layout.x
        np.multiply(half[number], 1j if self._sums.turned(self._sums.outputs[number]) else 1.0, out=self._unhalved)
        self._inverse_x()
        targets[number, :, 0] = self._full[:, x.target_start : x.target_start + x.targets]

    def wavenumber(self, number: int, sources: Array, targets: Array) -> None:
        """Finish one piece: ``sources[active, kx, z]`` to ``targets[output, z, kx]``."""
        z, piece = self._layout.z, self._pieces[number]
        rows = slice(z.source_start, z.source_start + z.sources)
        self._padded_z[:, 0, : piece.stop - piece.start, rows] = sources[:, piece]
        self._along_z(0, piece, targets)
