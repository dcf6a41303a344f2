"""Normal displacement of a pressure, as an operator between boxes of one grid."""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from eigencontact.convolution import Convolver, Layout, Spectrum
from eigencontact.core.array_types import FloatArray
from eigencontact.core.grid import Box, Grid
from eigencontact.solvers.solution import SolverOptions

__all__ = ["BoxOperator", "Coefficients", "Compliance", "layout_between", "offsets", "sampled"]

# Stored operators for each grid: the present and the previous box, each for the iteration and for the whole window.
_MAX_OPERATORS = 4
# Points of a transform from which on threads save time, for one source and one target.
_WORTH_THREADS = 200_000


class Coefficients(Protocol):
    """Influence coefficients of one response to one traction; those of the normal problem are even in x and y."""

    def table(self, x: FloatArray, y: FloatArray, half_widths: tuple[float, float]) -> FloatArray:
        """Response at offsets x, y [m] of a rectangle with half-widths under unit traction, ``(ny, nx)``."""

    def response(self, kx: FloatArray, ky: FloatArray) -> NDArray[np.complex128]:
        """Amplitude of the response to a unit traction wave, ``(nky, nkx)``; for periodic contact."""


def layout_between(source: Box, target: Box) -> Layout:
    """Layout of a convolution from one box of a grid to another."""
    return Layout(source.shape, target.shape, (target.y0 - source.y0, target.x0 - source.x0))


def offsets(layout: Layout) -> tuple[NDArray[np.int_], NDArray[np.int_]]:
    """Magnitudes of the offsets along y and x [cells]."""
    return np.abs(layout.y.lattice).astype(int), np.abs(layout.x.lattice).astype(int)


def sampled(coefficients: Coefficients, grid: Grid, ny: int, nx: int) -> FloatArray:
    """Coefficients at the offsets 0..ny-1, 0..nx-1 in cells."""
    x, y = np.arange(nx, dtype=np.float64) * grid.dx, np.arange(ny, dtype=np.float64) * grid.dy
    return coefficients.table(x, y, grid.half_widths)


class BoxOperator:
    """Displacement on a target box caused by pressure on a source box."""

    def __init__(self, convolver: Convolver, spectrum: Spectrum) -> None:
        self._convolver = convolver
        self.spectrum = spectrum

    def __call__(self, pressure: NDArray[Any]) -> NDArray[Any]:
        """Apply the operator to a pressure of the source box's shape."""
        return self._convolver.apply(pressure, self.spectrum)

    def energy(self, pressure: NDArray[Any]) -> float:
        """Sum of a pressure times its displacement, where source and target are one box."""
        return self._convolver.energy(pressure, self.spectrum)

    @property
    def convolutions(self) -> int:
        """Number of convolutions."""
        return self._convolver.count


class Compliance:
    """Normal compliance of a surface on one grid: a table of coefficients, and operators built from it on demand.

    Parameters
    ----------
    grid : Grid
        Cells.
    coefficients : Coefficients
        Source of the coefficients.
    options : SolverOptions
        Periodic window, precision and threads.

    Notes
    -----
    Coefficients are divided by ``unit`` (their largest value), so that single precision does not overflow or underflow
    for cells of a nanometre or a metre.
    """

    def __init__(self, grid: Grid, coefficients: Coefficients, options: SolverOptions) -> None:
        self.grid, self.options, self._coefficients = grid, options, coefficients
        self._table = np.empty((0, 0))
        self._whole: Spectrum | None = None
        self.unit = 1.0
        self._operators: dict[tuple[Box, Box], BoxOperator] = {}
        self._retired = 0
        if options.periodic:
            self._sample_periodic()

    @property
    def convolutions(self) -> int:
        """Number of convolutions on this grid."""
        return self._retired + sum(operator.convolutions for operator in self._operators.values())

    def table(self, ny: int, nx: int) -> FloatArray:
        """Coefficients at the offsets 0..ny-1, 0..nx-1 in cells, in units of ``unit``."""
        if self.options.periodic:
            indices = (np.arange(ny), np.arange(nx))
            wrap = [np.minimum(i % n, n - i % n) for i, n in zip(indices, self.grid.shape, strict=True)]
            return self._table[np.ix_(*wrap)]
        if self._table.shape[0] < ny or self._table.shape[1] < nx:
            rows, columns = max(ny, self._table.shape[0]), max(nx, self._table.shape[1])
            table = sampled(self._coefficients, self.grid, rows, columns)
            self.unit = float(table[0, 0])
            table /= self.unit
            self._table = table
        return self._table[:ny, :nx]

    def between(self, source: Box, target: Box) -> BoxOperator:
        """Operator from the pressure on one box to the displacement on another; the last few are cached."""
        if (source, target) not in self._operators:
            if len(self._operators) >= _MAX_OPERATORS:
                self._retired += self._operators.pop(next(iter(self._operators))).convolutions
            self._operators[source, target] = self._make(source, target)
        return self._operators[source, target]

    def _make(self, source: Box, target: Box) -> BoxOperator:
        window = Box(0, self.grid.ny, 0, self.grid.nx)
        if self._whole is not None and source == target == window:
            layout = Layout(window.shape, window.shape, periodic=True)
            return BoxOperator(self.convolver(layout), self._whole)
        layout = layout_between(source, target)
        y, x = offsets(layout)
        table = self.table(int(y.max()) + 1, int(x.max()) + 1)
        if not (layout.y.symmetric and layout.x.symmetric):
            table = table[np.ix_(y, x)]
        return BoxOperator(self.convolver(layout), layout.spectrum(table, (1, 1), precision=self.options.precision))

    def reserve(self, source: Box, target: Box) -> None:
        """Sample the coefficients of this pair of boxes and of smaller ones together."""
        if not self.options.periodic:
            y, x = offsets(layout_between(source, target))
            self.table(int(y.max()) + 1, int(x.max()) + 1)

    def convolver(self, layout: Layout) -> Convolver:
        """Convolver for one spectrum, with threads if they save time."""
        threads = self.options.threads if layout.y.length * layout.x.length >= _WORTH_THREADS else 1
        return Convolver(layout, precision=self.options.precision, threads=threads)

    def _sample_periodic(self) -> None:
        """Spectrum of the whole window, and the coefficients of one period."""
        from scipy import fft

        layout = Layout(self.grid.shape, self.grid.shape, periodic=True)
        ky, kx = layout.wavenumbers(self.grid.dy, self.grid.dx)
        response = self._coefficients.response(kx[None, :], ky[:, None])
        ny, nx = self.grid.shape
        rows = np.minimum(np.arange(ny), ny - np.arange(ny))
        full = fft.irfft2(response.real[rows], s=(ny, nx))
        self.unit = float(full[0, 0]) or 1.0
        self._table = full[: ny // 2 + 1, : nx // 2 + 1] / self.unit
        self._whole = layout.spectrum_from_response(response / self.unit, (1, 1), precision=self.options.precision)
