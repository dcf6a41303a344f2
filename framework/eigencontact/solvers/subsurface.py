"""Stress or displacement below the surface by tractions, at given depths or points."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import partial
from typing import Any, Protocol, TypeVar, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from eigencontact.convolution import Convolver, Layout, Spectrum
from eigencontact.core.array_types import FloatArray
from eigencontact.core.grid import Box, Grid
from eigencontact.core.parallel import available_threads, in_parallel

__all__ = [
    "HasDepths",
    "HasSums",
    "StressKernel",
    "SubsurfaceStress",
    "TableAt",
    "all_tables",
    "folded",
    "mirrored",
    "stress_at_points",
    "tables_at",
]

Result = TypeVar("Result")
#: Table at depth `number` on a lattice of offsets (x, y), ``(n, ny, nx)``.
TableAt = Callable[[int, FloatArray, FloatArray], FloatArray]
#: Sum of a load over such a lattice, ``(n,)``.
SumAt = Callable[[int, FloatArray, FloatArray], FloatArray]

# Number of points prepared together: large enough to share work, small enough for the cache.
_POINTS = 128
# Number of depths for waves prepared together. Waves at 8 depths of one coating take a sixth of the time of 8 single
# depths, and more depths save little.
_WAVES = 8


class StressKernel(Protocol):
    """Mandel stress of one uniformly loaded rectangle, or its displacement, per unit traction."""

    @property
    def components(self) -> Sequence[str]:
        """Components of the stress, or of the displacement."""

    def parity(self, component: str) -> tuple[int, int]:
        """Parity (in y, in x)."""

    def table(
        self, components: list[str], x: FloatArray, y: FloatArray, z: float, half_widths: tuple[float, float]
    ) -> FloatArray:
        """Values on a lattice of offsets at one depth, ``(n, ny, nx)``."""

    def response(self, components: list[str], kx: FloatArray, ky: FloatArray, z: float) -> NDArray[np.complex128]:
        """Amplitudes for a traction wave at one depth, ``(n, nky, nkx)``."""


@runtime_checkable
class HasDepths(Protocol):
    """Optional ability of a kernel with shared work between depths: tables and amplitudes at several depths."""

    def at_depths(
        self, components: list[str], depths: FloatArray, half_widths: tuple[float, float], reach: float
    ) -> TableAt:
        """Prepare tables at depths ``(nz,)`` for offsets up to `reach` [m]; the tables may be requested in threads."""

    def responses(
        self, components: list[str], kx: FloatArray, ky: FloatArray, depths: FloatArray
    ) -> Iterable[NDArray[np.complex128]]:
        """Amplitudes for a traction wave at depths ``(nz,)``, one after the other, ``(n, nky, nkx)`` each."""


@runtime_checkable
class HasSums(Protocol):
    """Optional ability of a kernel: sums of a load without a table."""

    def sums_at(
        self,
        components: list[str],
        depths: FloatArray,
        half_widths: tuple[float, float],
        reach: float,
        load: FloatArray,
    ) -> SumAt | None:
        """Prepare sums of a load ``(ny, nx)``, like `HasDepths.at_depths`; None if tables are as efficient."""


def tables_at(kernel: StressKernel, depths: FloatArray, half_widths: tuple[float, float], reach: float) -> TableAt:
    """Tables of all components at depths ``(nz,)`` for offsets up to `reach` [m]."""
    names = list(kernel.components)
    if isinstance(kernel, HasDepths):
        return kernel.at_depths(names, depths, half_widths, reach)
    return lambda number, x, y: kernel.table(names, x, y, float(depths[number]), half_widths)


def _sums_at(
    kernel: StressKernel, depths: FloatArray, half_widths: tuple[float, float], reach: float, load: FloatArray
) -> SumAt:
    """Sums of a load over tables of all components at depths ``(nz,)``."""
    names = list(kernel.components)
    sums = kernel.sums_at(names, depths, half_widths, reach, load) if isinstance(kernel, HasSums) else None
    if sums is not None:
        return sums
    table = tables_at(kernel, depths, half_widths, reach)
    parities = [kernel.parity(name) for name in names]

    def sum_at(number: int, x: FloatArray, y: FloatArray) -> FloatArray:
        left, below = mirrored(x), mirrored(y)
        folded_loads = {p: folded(folded(load, below, 0, p[0]), left, 1, p[1]) for p in parities}
        values = table(number, x[left:], y[below:])
        return np.array([np.einsum("ij,ij", value, folded_loads[p]) for value, p in zip(values, parities, strict=True)])

    return sum_at


def all_tables(
    kernels: Sequence[StressKernel], depths: FloatArray, half_widths: tuple[float, float], reach: float, threads: int
) -> list[TableAt]:
    """Tables of each kernel; the kernels are prepared in parallel."""
    return _side_by_side(threads, [partial(tables_at, kernel, depths, half_widths, reach) for kernel in kernels])


def _side_by_side(threads: int, makers: Sequence[Callable[[], Result]]) -> list[Result]:
    """Results of some functions, computed in parallel, in their order."""
    results: dict[int, Result] = {}

    def make(number: int) -> None:
        results[number] = makers[number]()

    in_parallel(threads, [partial(make, number) for number in range(len(makers))])
    return [results[number] for number in range(len(makers))]


def _responses(
    kernel: StressKernel, kx: FloatArray, ky: FloatArray, depths: FloatArray
) -> Iterable[NDArray[np.complex128]]:
    """Amplitudes of all components at some depths, one after the other."""
    names = list(kernel.components)
    if isinstance(kernel, HasDepths):
        return kernel.responses(names, kx, ky, depths)
    return (kernel.response(names, kx, ky, float(z)) for z in depths)


def mirrored(offsets: FloatArray) -> int:
    """Number of ascending offsets that are mirror images of others: half if symmetric about 0, otherwise none."""
    symmetric = offsets.size > 1 and np.abs(offsets + offsets[::-1]).max() <= 1e-12 * offsets[-1]
    return offsets.size // 2 if symmetric else 0


def _with_images(table: FloatArray, images: int, axis: int, sign: int) -> FloatArray:
    """Table extended by the mirror images of its last values, by their parity."""
    if not images:
        return table
    return np.concatenate([sign * np.flip(table.take(range(-images, 0), axis), axis), table], axis)


def folded(values: NDArray[Any], images: int, axis: int, sign: int) -> NDArray[Any]:
    """Values at the remaining offsets after addition of the mirror images, by their parity."""
    if not images:
        return values
    along = np.moveaxis(values, axis, 0)
    sums = along[images:].copy()
    sums[-images:] += sign * along[:images][::-1]
    return np.moveaxis(sums, 0, axis)


class SubsurfaceStress:
    """Stress or displacement on a lattice of points at several depths: a convolution with spectra computed once.

    Parameters
    ----------
    grid : Grid
        Cells of the tractions.
    kernels : sequence of StressKernel
        One for each traction given to `apply`, all of one quantity.
    source : Box
        Cells that may be loaded.
    target : (int, int)
        Number of target points along (y, x), with the pitch of the grid.
    origin : (float, float)
        Position of target (0, 0) relative to the grid's cell (0, 0), in cells along (y, x); any real numbers.
    depths : (nz,) [m]
        Depths of the target planes.
    periodic, precision, threads
        See `eigencontact.convolution`.

    Notes
    -----
    Memory of the spectra: six components, nz depths, and a quarter of the padded box if targets are at cell centres.
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
        window = Box(0, grid.ny, 0, grid.nx)
        self._box = window if periodic else source
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
        #: Spectra ``[depth][component][traction]``.
        self._names = tuple(kernels[0].components)
        self._spectra: list[list[list[Spectrum]]] = [[[] for _ in self._names] for _ in self.depths]
        in_parallel(self._threads, self._waves(list(kernels)) if periodic else self._coefficients(list(kernels)))

    def _waves(self, kernels: list[StressKernel]) -> list[Callable[[], None]]:
        """Tasks that compute the spectra of some depths each, from the response to waves."""
        ky, kx = self._layout.wavenumbers(self.grid.dy, self.grid.dx)
        count = self.depths.size
        block = max(1, min(_WAVES, -(-count // self._threads)))

        def fill(begin: int) -> None:
            depths = self.depths[begin : begin + block]
            for kernel in kernels:
                for k, values in enumerate(_responses(kernel, kx[None, :], ky[:, None], depths), begin):
                    for row, (name, value) in enumerate(zip(self._names, values, strict=True)):
                        parity = kernel.parity(name)
                        spectrum = self._layout.spectrum_from_response(value, parity, precision=self._precision)
                        self._spectra[k][row].append(spectrum)

        return [partial(fill, begin) for begin in range(0, count, block)]

    def _coefficients(self, kernels: list[StressKernel]) -> list[Callable[[], None]]:
        """Tasks that compute the spectra of one depth each, from tables of coefficients."""
        dx, dy = self.grid.dx, self.grid.dy
        x, y = self._layout.x.lattice * dx, self._layout.y.lattice * dy
        below, left = mirrored(y), mirrored(x)
        if 1 not in self.grid.bounded_axes:
            y = np.zeros_like(y)  # the field of strips is equal at all y
        reach = max(float(np.abs(x).max()), float(np.abs(y).max()))
        prepared = all_tables(kernels, self.depths, self.grid.half_widths, reach, self._threads)

        def fill(k: int) -> None:
            for kernel, tables in zip(kernels, prepared, strict=True):
                for row, (name, quadrant) in enumerate(zip(self._names, tables(k, x[left:], y[below:]), strict=True)):
                    parity = kernel.parity(name)
                    table = _with_images(_with_images(quadrant, below, 0, parity[0]), left, 1, parity[1])
                    spectrum = self._layout.spectrum(table, parity, precision=self._precision)
                    self._spectra[k][row].append(spectrum)

        return [partial(fill, k) for k in range(self.depths.size)]

    @property
    def nbytes(self) -> int:
        """Memory of the stored spectra."""
        return sum(s.nbytes for depth in self._spectra for row in depth for s in row)

    @property
    def kernels(self) -> int:
        """Number of stored spectra."""
        return sum(len(row) for depth in self._spectra for row in depth)

    def covers(self, box: Box) -> bool:
        """Whether `apply` accepts tractions on `box`."""
        return self._box.covers(box)

    def apply(self, tractions: Sequence[FloatArray]) -> FloatArray:
        """Mandel stress of tractions on the whole grid, ``(6, nz, ty, tx)`` [Pa]; or displacement, ``(3, ...)`` [m]."""
        sources = np.array([self._shifted(traction[self._box.slices]) for traction in tractions])
        flat = [row for depth in self._spectra for row in depth]
        values = self._convolver.apply(sources, flat)
        if self._periodic:
            values = values[:, self._crop[0]][:, :, self._crop[1]]
        stacked = values.reshape(self.depths.size, len(self._names), *values.shape[1:])
        return np.moveaxis(stacked, 1, 0)

    def _shifted(self, traction: FloatArray) -> FloatArray:
        """Periodic traction shifted by the offset of the targets from the cell centres."""
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
    """Mandel stress, or displacement, at scattered points by direct superposition of the loaded cells.

    The cells form a lattice as seen from a point, so neighbouring cells share their corners here as well.

    Parameters
    ----------
    points : (n, 3)
        x, y and depth z [m].

    Returns
    -------
    (6, n) or (3, n)
        Stress [Pa], or displacement [m].
    """
    points = np.asarray(points, dtype=float)
    out = np.zeros((len(kernels[0].components), len(points)))
    box = Box.around(np.any([traction != 0 for traction in tractions], axis=0))
    if box is None:
        return out
    # Offsets (point minus cell) ascend for cells in descending order.
    y, x = grid.y[box.slices[0]][::-1], grid.x[box.slices[1]][::-1]
    half_widths = grid.half_widths
    loads = [np.ascontiguousarray(traction[box.slices][::-1, ::-1]) for traction in tractions]
    workers = threads or available_threads()
    for begin in range(0, len(points), _POINTS):
        chunk = points[begin : begin + _POINTS]
        depths, place = np.unique(chunk[:, 2], return_inverse=True)
        reach = max(float(np.abs(chunk[:, 0, None] - x).max()), float(np.abs(chunk[:, 1, None] - y).max()))
        pairs = zip(kernels, loads, strict=True)
        sums = _side_by_side(
            workers, [partial(_sums_at, item, depths, half_widths, reach, load) for item, load in pairs]
        )

        def superpose(numbers: range) -> None:
            for number in numbers:
                px, py, _ = chunk[number]  # noqa: B023
                for sum_at in sums:  # noqa: B023
                    out[:, begin + number] += sum_at(int(place[number]), px - x, py - y)  # noqa: B023

        in_parallel(workers, [partial(superpose, range(k, len(chunk), workers)) for k in range(workers)])
    return out
