"""Stress or displacement on a section along x or y: one row of target points at each depth.

Transforms run along the row only; across it the rows of the source are summed directly. Compared with transforms in
both directions (`eigencontact.solvers.subsurface`), the result is equally exact. The method stores half of the numbers,
or a quarter for a row midway between cells, and transforms each table in one direction only.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigencontact.convolution.layout import Axis
from eigencontact.convolution.spectrum import parity_transform
from eigencontact.core.array_types import FloatArray
from eigencontact.core.grid import Box, Grid
from eigencontact.core.parallel import available_threads, in_parallel
from eigencontact.solvers.subsurface import StressKernel, TableAt, all_tables, folded, mirrored

__all__ = ["SectionStress"]

#: Depths that `SectionStress.apply` transforms at once: more leave the cache, fewer wait for numpy's calls.
_AT_ONCE = 16


class SectionStress:
    """Stress or displacement on one row of points at several depths; kernels are sampled and transformed once.

    Parameters
    ----------
    grid, kernels, source, origin, depths, precision, threads
        See `eigencontact.solvers.subsurface.SubsurfaceStress`; the window is not periodic.
    target : (int, int)
        Target points along (y, x); one of the two is 1.
    """

    def __init__(
        self,
        grid: Grid,
        kernels: Sequence[StressKernel],
        *,
        source: Box,
        target: tuple[int, int],
        origin: tuple[float, float] = (0.0, 0.0),
        depths: FloatArray,
        precision: str = "double",
        threads: int | None = None,
    ) -> None:
        self.grid, self.source, self.depths = grid, source, np.asarray(depths, dtype=float)
        self._across = 0 if target[0] == 1 else 1
        row = 1 - self._across
        axes = [
            Axis.plan(n, t, o - first, periodic=False)
            for n, t, o, first in zip(source.shape, target, origin, (source.y0, source.x0), strict=True)
        ]
        self._row = axes[row]
        self._offsets = axes[self._across].origin + np.arange(1.0 - axes[self._across].sources, 1.0)
        self._images = mirrored(self._offsets)
        self._threads = threads or available_threads()
        self._names = tuple(kernels[0].components)
        self._parities = [[kernel.parity(name) for name in self._names] for kernel in kernels]
        x, y = (self._offsets, self._row.lattice) if self._across else (self._row.lattice, self._offsets)
        reach = max(float(np.abs(x).max()) * grid.dx, float(np.abs(y).max()) * grid.dy)
        prepared = all_tables(kernels, self.depths, grid.half_widths, reach, self._threads)
        #: Transformed kernels ``(depths, components, tractions, rows across, wavenumbers)``.
        shape = (self.depths.size, len(self._names), len(prepared), self._offsets.size - self._images, self._row.half)
        real_type, complex_type = ("f4", "c8") if precision == "single" else ("f8", "c16")
        self._kernels: NDArray[Any] = np.empty(shape, real_type if self._row.symmetric else complex_type)
        in_parallel(self._threads, [partial(self._fill, k, prepared) for k in range(self.depths.size)])
        #: Components that are not zero throughout: a line contact has four.
        self._present = np.flatnonzero(self._kernels.any(axis=(0, 2, 3, 4)))
        if self._present.size < len(self._names):
            self._kernels = self._kernels[:, self._present]

    def _fill(self, k: int, prepared: Sequence[TableAt]) -> None:
        """Sample and transform all components at one depth."""
        grid, row, offsets = self.grid, self._row, self._offsets[self._images :]
        x, y = (offsets, row.lattice) if self._across else (row.lattice, offsets)
        for t, tables in enumerate(prepared):
            for c, table in enumerate(tables(k, x * grid.dx, y * grid.dy)):
                values = table.T if self._across else table
                if row.symmetric:
                    self._kernels[k, c, t] = parity_transform(values, 1, self._parities[t][c][1 - self._across], 1)
                else:
                    self._kernels[k, c, t] = np.fft.rfft(row.scatter(values, 1), axis=1)

    @property
    def nbytes(self) -> int:
        """Memory of the transformed kernels."""
        return self._kernels.nbytes

    def covers(self, box: Box) -> bool:
        """Whether `apply` accepts tractions on `box`."""
        return self.source.covers(box)

    def apply(self, tractions: Sequence[FloatArray]) -> FloatArray:
        """Mandel stress of tractions on the whole grid, ``(6, nz, ty, tx)`` [Pa]; or displacement, ``(3, ...)`` [m]."""
        waves = self._waves([traction[None] for traction in tractions])[self._present, :, 0]
        components = [np.ascontiguousarray(component) for component in (waves.real, waves.imag)]
        row = self._row
        out = np.zeros((len(self._names), self.depths.size, row.targets))

        def superpose(layers: slice) -> None:
            real, imaginary = (np.einsum("zctrk,ctrk->czk", self._kernels[layers], spectrum) for spectrum in components)
            values = np.fft.irfft(real + 1j * imaginary, n=row.length, axis=2)
            out[self._present, layers] = values[..., row.target_start : row.target_start + row.targets]

        step = min(_AT_ONCE, -(-self.depths.size // self._threads))
        starts = range(0, self.depths.size, step)
        in_parallel(self._threads, [partial(superpose, slice(start, start + step)) for start in starts])
        return np.expand_dims(out, 2 + self._across)

    def of_steps(self, tractions: Sequence[FloatArray]) -> Callable[[NDArray[np.intp]], FloatArray]:
        """Stress of several load steps, at the depths where it is needed.

        Parameters
        ----------
        tractions : sequence of (steps, ny, nx)
            As of `apply`, of each step.

        Returns
        -------
        callable
            Returns the stress at some depths, by their indices ``(n,)``: ``(steps, 6, n, row)``; or displacement.
        """
        from eigencontact.solvers.section_loops import sums

        waves, row = np.ascontiguousarray(self._waves(tractions)[self._present]), self._row

        def at(layers: NDArray[np.intp]) -> FloatArray:
            kernels = self._kernels[layers]
            out = np.zeros((waves.shape[2], len(self._names), len(layers), row.targets))
            superposed = np.empty((waves.shape[2], len(layers), row.half), complex)
            for number, c in enumerate(self._present):
                sums(np.ascontiguousarray(kernels[:, number]), waves[number], superposed)
                values = np.fft.irfft(superposed, n=row.length, axis=2)
                out[:, c] = values[..., row.target_start : row.target_start + row.targets]
            return out

        return at

    def _waves(self, tractions: Sequence[FloatArray]) -> NDArray[np.complex128]:
        """Transformed tractions ``(components, tractions, steps, rows across, wavenumbers)``, with parities."""
        row, images = self._row, self._images
        where = (..., *self.source.slices)
        loads = np.array([np.moveaxis(traction[where], 1 + self._across, 1) for traction in tractions])
        loads = loads[:, :, ::-1]  # offsets (target minus source) ascend
        padded = np.zeros((*loads.shape[:3], row.length))
        padded[..., row.source_start : row.source_start + row.sources] = loads
        waves = np.fft.rfft(padded, axis=3)
        count = waves.shape[2] - images
        out = np.empty((len(self._names), *waves.shape[:2], count, waves.shape[3]), complex)
        for t, parities in enumerate(self._parities):
            for c, parity in enumerate(parities):
                out[c, t] = folded(waves[t], images, 1, parity[self._across])
                if row.symmetric and parity[1 - self._across] < 0:  # an odd sequence: -1j times its sine transform
                    out[c, t] *= -1j
        return out
