"""Mean stress of cells next to the surface, because uniform shear on cells has infinite stress at their edges.

A step of the shear between two cells causes infinite stress along their edge at z = 0; the singularity is logarithmic
for any size of the step. The stress of the smooth shear that the cells approximate is close to the mean over each cell.
The program takes the mean of four points, a third of a cell from the centre along x and y: for equal steps in all
cells, as for a constant slope, the logarithms cancel. Under a Hertz pressure and 0.5 of it as shear these means
converge with second order (1e-4 of p0 inside 0.8 of the contact radius with 32 cells per radius; the values at the
centres have first order, 9e-3). Between the centres the means are interpolated linearly.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import product

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.array_types import FloatArray
from eigencontact.core.grid import Box, Grid
from eigencontact.solvers.subsurface import StressKernel, SubsurfaceStress, TableAt, stress_at_points, tables_at

__all__ = ["CellMeans", "MeansOnLattice", "depth_of_means", "means_at_points"]

#: Depth down to which means are used, in shorter edges of a cell. At this depth the logarithmic part is a tenth of its
#: value at a distance of 1 % of a cell from the edge; below it the effect of the steps falls by exp(-2 pi) per cell.
_SHALLOW = 0.25
#: Positions of the four points along an edge, from the centre, in half edges.
_PLACES = (-2.0 / 3.0, 2.0 / 3.0)


def depth_of_means(grid: Grid) -> float:
    """Depth above which the stress by tractions is a mean over cells [m]."""
    return _SHALLOW * min(grid.edges)


class CellMeans:
    """Coefficients of a kernel as means over the cell around each point; see `eigencontact.solvers.subsurface`."""

    def __init__(self, kernel: StressKernel) -> None:
        self._kernel = kernel
        self.components = kernel.components
        self.parity, self.response = kernel.parity, kernel.response  # waves are smooth: no means are necessary

    def table(
        self, components: list[str], x: FloatArray, y: FloatArray, z: float, half_widths: tuple[float, float]
    ) -> FloatArray:
        """Means on a lattice of offsets at one depth, ``(n, ny, nx)``."""
        reach = max(float(np.abs(x).max()), float(np.abs(y).max()))
        return self.at_depths(components, np.array([z]), half_widths, reach)(0, x, y)

    def at_depths(
        self, _components: list[str], depths: FloatArray, half_widths: tuple[float, float], reach: float
    ) -> TableAt:
        """Tables at several depths; see `HasDepths`."""
        # The field of strips is constant along them.
        across, along = ([place * half for place in _PLACES] if half < np.inf else [0.0] for half in half_widths)
        points = list(product(across, along))
        inner = tables_at(self._kernel, depths, half_widths, reach + max(*across, *along))
        return lambda number, x, y: np.mean([inner(number, x + i, y + j) for i, j in points], axis=0)

    def responses(
        self, components: list[str], kx: FloatArray, ky: FloatArray, depths: FloatArray
    ) -> Iterator[NDArray[np.complex128]]:
        """Amplitudes for a traction wave at some depths."""
        return (self.response(components, kx, ky, float(z)) for z in depths)


def _neighbours(places: FloatArray, first: float, pitch: float) -> tuple[NDArray[np.int64], FloatArray]:
    """Number of the last cell centre before each position, and the weight of the next one."""
    number = (places - first) / pitch
    nearest = np.round(number)
    number = np.where(np.abs(number - nearest) < 1e-9, nearest, number)
    before = np.floor(number)
    return before.astype(np.int64), number - before


class MeansOnLattice:
    """Stress by tractions on a lattice of points next to the surface.

    Parameters
    ----------
    kernels : sequence of StressKernel
        One for each traction given to `apply`.
    source : Box
        Cells that may be loaded.
    x, y : (tx,), (ty,) [m]
        Ascending points of any pitch, inside or outside the window.
    depths : (nz,) [m]
    """

    def __init__(
        self,
        grid: Grid,
        kernels: Sequence[StressKernel],
        *,
        source: Box,
        x: FloatArray,
        y: FloatArray,
        depths: FloatArray,
        precision: str = "double",
        threads: int | None = None,
    ) -> None:
        rows, self._row_share = _neighbours(y, float(grid.y[0]), grid.dy)
        columns, self._column_share = _neighbours(x, float(grid.x[0]), grid.dx)
        self._rows, self._columns = rows - rows[0], columns - columns[0]
        self._operator = SubsurfaceStress(
            grid,
            [CellMeans(kernel) for kernel in kernels],
            source=source,
            target=(int(self._rows[-1]) + 2, int(self._columns[-1]) + 2),
            origin=(float(rows[0]), float(columns[0])),
            depths=depths,
            precision=precision,
            threads=threads,
        )

    @property
    def nbytes(self) -> int:
        """Memory of the stored spectra."""
        return self._operator.nbytes

    def covers(self, box: Box) -> bool:
        """Whether `apply` accepts tractions on `box`."""
        return self._operator.covers(box)

    def apply(self, tractions: Sequence[FloatArray]) -> FloatArray:
        """Mandel stress of tractions on the whole grid, ``(6, nz, ty, tx)`` [Pa]."""
        cells = self._operator.apply(tractions)
        share = self._row_share[:, None]
        lines = (1.0 - share) * cells[:, :, self._rows] + share * cells[:, :, self._rows + 1]
        share = self._column_share
        return np.asarray((1.0 - share) * lines[..., self._columns] + share * lines[..., self._columns + 1])


def means_at_points(
    grid: Grid,
    kernels: Sequence[StressKernel],
    tractions: Sequence[FloatArray],
    points: FloatArray,
    *,
    threads: int | None = None,
) -> FloatArray:
    """Mandel stress at scattered points ``(n, 3)`` [m] next to the surface, ``(6, n)`` [Pa]."""
    columns, column_share = _neighbours(points[:, 0], float(grid.x[0]), grid.dx)
    rows, row_share = _neighbours(points[:, 1], float(grid.y[0]), grid.dy)
    out = np.zeros((6, len(points)))
    for i, j in product((0, 1), (0, 1)):
        weight = (column_share if i else 1.0 - column_share) * (row_share if j else 1.0 - row_share)
        felt = weight > 0
        if felt.any():
            x, y = grid.x[0] + (columns + i) * grid.dx, grid.y[0] + (rows + j) * grid.dy
            centres = np.column_stack([x, y, points[:, 2]])[felt]
            means = [CellMeans(kernel) for kernel in kernels]
            out[:, felt] += weight[felt] * stress_at_points(grid, means, tractions, centres, threads=threads)
    return out
