"""Stress below the surface from tractions on it, at chosen depths or points and nowhere else."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from eigencontact.convolution import Convolver, Layout, Spectrum
from eigencontact.convolution.backends import available_threads, in_parallel
from eigencontact.core.grid import Box, Grid
from eigencontact.core.tensors import COMPONENTS

__all__ = ["StressKernel", "SubsurfaceStress", "stress_at_points"]

FloatArray = NDArray[np.float64]


class StressKernel(Protocol):
    """Mandel stress of one uniformly loaded rectangle, per unit traction."""

    def parity(self, component: str) -> tuple[int, int]:
        """Parity (in y, in x)."""
        ...

    def table(
        self, components: list[str], x: FloatArray, y: FloatArray, z: float, half_widths: tuple[float, float]
    ) -> FloatArray:
        """Values on a lattice of offsets at one depth, ``(n, ny, nx)``."""
        ...

    def response(self, components: list[str], kx: FloatArray, ky: FloatArray, z: float) -> NDArray[np.complex128]:
        """Amplitudes for a traction wave at one depth, ``(n, nky, nkx)``."""
        ...


class SubsurfaceStress:
    """Stress on a lattice of target points at several depths, as a convolution whose spectra are made once.

    Parameters
    ----------
    grid : Grid
        Cells of the tractions.
    kernels : sequence of StressKernel
        One for each traction given to `apply`.
    source : Box
        Cells that may be loaded.
    target : (int, int)
        Target points along (y, x), of the pitch of the grid.
    origin : (float, float)
        Position of target (0, 0) relative to the grid's cell (0, 0), in cells along (y, x); need not be whole.
    depths : (nz,) [m]
        Depths of the target planes.
    periodic, precision, threads
        See `eigencontact.convolution`.

    Notes
    -----
    Memory of the spectra: six components, nz depths, a quarter of the padded box where targets lie on cell centres.
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
        periodic: bool = False,
        precision: str = "double",
        threads: int | None = None,
    ) -> None:
        self.grid, self.source, self.depths = grid, source, np.asarray(depths, dtype=float)
        whole = Box(0, grid.ny, 0, grid.nx)
        self._box = whole if periodic else source
        shift = (origin[0] - self._box.y0, origin[1] - self._box.x0)
        self._layout = Layout(self._box.shape, target, shift)
        self._crop = tuple(
            (np.arange(n) + int(np.floor(o))) % size if periodic else np.arange(n)
            for n, o, size in zip(target, origin, grid.shape, strict=True)
        )
        self._fraction = tuple(o - float(np.floor(o)) if periodic else 0.0 for o in origin)
        if periodic:
            self._layout = Layout(grid.shape, grid.shape, periodic=True)
        self._periodic, self._precision = periodic, precision
        self._convolver = Convolver(self._layout, precision=precision, threads=threads)
        self._threads = threads or available_threads()
        self._spectra: list[list[list[Spectrum]]] = [[] for _ in self.depths]
        in_parallel(self._threads, [partial(self._fill, k, list(kernels)) for k in range(self.depths.size)])

    def _fill(self, k: int, kernels: list[StressKernel]) -> None:
        """Spectra of one depth, ``[component][traction]``."""
        names = list(COMPONENTS)
        by_kernel = []
        for kernel in kernels:
            if self._periodic:
                ky, kx = self._layout.wavenumbers(self.grid.dy, self.grid.dx)
                values = kernel.response(names, kx[None, :], ky[:, None], float(self.depths[k]))
                by_kernel.append(
                    [
                        self._layout.spectrum_from_response(value, kernel.parity(name), precision=self._precision)
                        for name, value in zip(names, values, strict=True)
                    ]
                )
                continue
            dx, dy = self.grid.dx, self.grid.dy
            x, y = self._layout.lattice_x * dx, self._layout.lattice_y * dy
            tables = kernel.table(names, x, y, float(self.depths[k]), (0.5 * dx, 0.5 * dy))
            by_kernel.append(
                [
                    self._layout.spectrum(table, kernel.parity(name), precision=self._precision)
                    for name, table in zip(names, tables, strict=True)
                ]
            )
        self._spectra[k] = [list(row) for row in zip(*by_kernel, strict=True)]

    @property
    def nbytes(self) -> int:
        """Memory of the stored spectra."""
        return sum(s.nbytes for depth in self._spectra for row in depth for s in row)

    @property
    def kernels(self) -> int:
        """Number of spectra held."""
        return sum(len(row) for depth in self._spectra for row in depth)

    def covers(self, box: Box) -> bool:
        """Whether tractions on `box` can be handed to `apply`."""
        return self._box.covers(box)

    def apply(self, tractions: Sequence[FloatArray]) -> FloatArray:
        """Mandel stress of tractions on the whole grid, ``(6, nz, ty, tx)`` [Pa]."""
        sources = np.array([self._shifted(traction[self._box.slices]) for traction in tractions])
        flat = [row for depth in self._spectra for row in depth]
        values = self._convolver.apply(sources, flat)
        if self._periodic:
            values = values[:, self._crop[0]][:, :, self._crop[1]]
        stacked = values.reshape(self.depths.size, len(COMPONENTS), *values.shape[1:])
        return np.moveaxis(stacked, 1, 0)

    def _shifted(self, traction: FloatArray) -> FloatArray:
        """Periodic traction moved by the fraction of a cell by which targets lie off the cell centres."""
        if not any(self._fraction):
            return traction
        from scipy import fft

        ny, nx = traction.shape
        phase_y = fft.fftfreq(ny)[:, None] * self._fraction[0]
        phase_x = fft.rfftfreq(nx)[None, :] * self._fraction[1]
        waves = fft.rfft2(traction) * np.exp(2j * np.pi * (phase_y + phase_x))
        return np.asarray(fft.irfft2(waves, s=(ny, nx)))


def stress_at_points(
    grid: Grid,
    kernels: Sequence[StressKernel],
    tractions: Sequence[FloatArray],
    points: FloatArray,
    *,
    threads: int | None = None,
) -> FloatArray:
    """Mandel stress at scattered points by direct superposition of the loaded cells.

    Seen from a point the cells are a lattice, so neighbouring cells share their corners here too.

    Parameters
    ----------
    points : (n, 3)
        x, y and depth z [m].

    Returns
    -------
    (6, n)
        Stress [Pa].
    """
    points = np.asarray(points, dtype=float)
    out = np.zeros((len(COMPONENTS), len(points)))
    box = Box.around(np.any([traction != 0 for traction in tractions], axis=0))
    if box is None:
        return out
    y, x = grid.y[box.slices[0]], grid.x[box.slices[1]]
    half_widths = (0.5 * grid.dx, 0.5 * grid.dy)
    loads = [np.ascontiguousarray(traction[box.slices][::-1, ::-1]) for traction in tractions]

    def superpose(numbers: range) -> None:
        for number in numbers:
            px, py, pz = points[number]
            for kernel, load in zip(kernels, loads, strict=True):
                # Offsets (point minus cell) ascend when the cells are taken in descending order.
                table = kernel.table(list(COMPONENTS), px - x[::-1], py - y[::-1], float(pz), half_widths)
                out[:, number] += np.einsum("kij,ij->k", table, load)

    workers = threads or available_threads()
    in_parallel(workers, [partial(superpose, range(k, len(points), workers)) for k in range(workers)])
    return out
