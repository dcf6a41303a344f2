r"""Mean stress in cells by tractions on the surface, and mean surface displacement by eigenstrain in the cells.

Betti's theorem relates both. The mean displacement ū_t of a surface cell of area A by an eigenstrain ε* in a cell of
volume V, and the mean stress σ̄_t in that cell by a unit traction t on the surface cell, satisfy

    A ū_t = V σ̄_t : ε*.

Both use one table of coefficients. The response of the cells to the contact is therefore a symmetric operator, and so
is the compliance of the surface; with exact means the compliance is positive for any inhomogeneity. With values at the
centres it is not, and a stiff coating at the surface then lets the pressure alternate from cell to cell.

References
----------
E. Betti 1872, Nuovo Cimento 7, 69 (reciprocity); T. Mura 1987, Micromechanics of Defects in Solids, section 2.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from eigencontact.convolution import Convolver, Layout
from eigencontact.core.array_types import FloatArray
from eigencontact.core.grid import Grid
from eigencontact.core.parallel import available_threads, in_parallel
from eigencontact.core.tensors import COMPONENTS
from eigencontact.errors import require
from eigencontact.solvers.cells import Cells, snapped
from eigencontact.solvers.subsurface import StressKernel

__all__ = ["MeanStressKernel", "SurfaceAndCells"]

# Gauss points along each edge of a cell.
_POINTS = 2
# Gauss points along each edge of a cell that touches the surface.
_FLUSH = 3


class MeanStressKernel:
    """Stress coefficients averaged over cells around the points.

    Parameters
    ----------
    kernel : StressKernel
        Coefficients at points.
    height : float
        Height of the cells [m]; their widths along x and y equal those of the loaded rectangle.
    """

    def __init__(self, kernel: StressKernel, height: float) -> None:
        self._kernel, self._height, self.components = kernel, height, kernel.components
        self.parity, self.response = kernel.parity, kernel.response  # waves have no cells for a mean

    def table(
        self, components: list[str], x: FloatArray, y: FloatArray, z: float, half_widths: tuple[float, float]
    ) -> FloatArray:
        """Means over the cells around a lattice of offsets, with their centres at one depth, ``(n, ny, nx)``."""
        count = _FLUSH if z < 0.75 * self._height else _POINTS
        points, weights = np.polynomial.legendre.leggauss(count)
        rule = list(zip(0.5 * points, 0.5 * weights, strict=True))
        dx, dy = (2.0 * half if half < np.inf else 0.0 for half in half_widths)
        out = np.zeros((len(components), y.size, x.size))
        # The stress under strips is constant along them.
        for (k, of_z), (j, of_y), (i, of_x) in product(rule, rule if dy else [(0.0, 1.0)], rule):
            at = x + i * dx, y + j * dy, z + k * self._height
            out += of_z * of_y * of_x * self._kernel.table(components, *at, half_widths)
        return out


class SurfaceAndCells:
    """Cells of the surface and a box of cells below them: means in each by loads in the other.

    Both directions share one table of coefficients, and one set of spectra if the box is near the middle of the grid.

    Parameters
    ----------
    grid : Grid
        Cells of the surface.
    kernels : sequence of MeanStressKernel
        One kernel for each traction; the displacement has the same direction.
    directions : str
        Direction of each kernel, out of ``"xyz"``.
    cells : Cells
        Cells of the box.
    precision, threads, applications
        See `eigencontact.convolution.Convolver`.
    """

    def __init__(
        self,
        grid: Grid,
        kernels: Sequence[MeanStressKernel],
        directions: str,
        cells: Cells,
        *,
        precision: str = "double",
        threads: int | None = None,
        applications: float = 10.0,
    ) -> None:
        equal_pitch = np.allclose(cells.pitch[:2], (grid.dx, grid.dy), rtol=1e-9, atol=0.0)
        require(
            equal_pitch, "surface", "pitch of the cells", cells.pitch[:2], f"that of the grid, {(grid.dx, grid.dy)} [m]"
        )
        self.grid, self.cells, self._directions, self._precision = grid, cells, directions, precision
        origin = (
            snapped(float((cells.first[1] - grid.y[0]) / grid.dy)),
            snapped(float((cells.first[0] - grid.x[0]) / grid.dx)),
        )
        self._down = Layout(grid.shape, cells.shape[1:], origin)
        self._up = Layout(cells.shape[1:], grid.shape, (-origin[0], -origin[1]))
        axes = ((self._down.y, self._up.y), (self._down.x, self._up.x))
        self._shared = all(down.symmetric and up.symmetric and down.length == up.length for down, up in axes)
        ways = (self._down, self._up)
        self._convolvers = [
            Convolver(layout, precision=precision, threads=threads, applications=applications) for layout in ways
        ]
        #: Spectra ``[layer][strain component][traction]`` for each of the two directions.
        self._spectra: tuple[list[Any], list[Any]] = tuple(  # type: ignore[assignment]
            [[[None] * len(kernels) for _ in COMPONENTS] for _ in range(cells.shape[0])] for _ in "du"
        )
        tasks = [partial(self._fill, t, k, kernel) for t, kernel in enumerate(kernels) for k in range(cells.shape[0])]
        in_parallel(threads or available_threads(), tasks)
        #: Components ``(6, nz)`` of each layer that displace the surface.
        self._acting = np.array([[any(s is not None for s in row) for row in layer] for layer in self._spectra[1]]).T

    def _fill(self, traction: int, layer: int, kernel: MeanStressKernel) -> None:
        (dx, dy, _), z = self.cells.pitch, float(self.cells.centres(2)[layer])
        x, y = self._down.x.lattice * dx, self._down.y.lattice * dy
        tables = kernel.table(list(COMPONENTS), x, y, z, self.grid.half_widths)
        for row, (name, table) in enumerate(zip(COMPONENTS, tables, strict=True)):
            if not table.any():  # components without effect in a line contact
                continue
            parity = kernel.parity(name)
            down = self._down.spectrum(table, parity, precision=self._precision)
            self._spectra[0][layer][row][traction] = self._spectra[1][layer][row][traction] = down
            if not self._shared:
                # From the cell to the surface the offsets have the opposite sign: they are reversed, or mirrored by
                # parity.
                turned = table if self._up.y.symmetric else parity[0] * table[::-1]
                turned = turned if self._up.x.symmetric else parity[1] * turned[:, ::-1]
                self._spectra[1][layer][row][traction] = self._up.spectrum(turned, parity, precision=self._precision)

    @property
    def nbytes(self) -> int:
        """Memory of the stored spectra."""
        ways = self._spectra[:1] if self._shared else self._spectra
        return sum(s.nbytes for direction in ways for layer in direction for row in layer for s in row if s is not None)

    def stress(self, tractions: Sequence[FloatArray], layers: slice = slice(None)) -> FloatArray:
        """Mean Mandel stress [Pa] in the cells, ``(6, nz, ny, nx)``, by tractions on the grid, in their order.

        Layers by default are all.
        """
        rows = [row for layer in self._spectra[0][layers] for row in layer]
        values = self._convolvers[0].apply(np.asarray(tractions), rows)
        stacked = values.reshape(-1, len(COMPONENTS), *values.shape[1:])
        return np.asarray(np.moveaxis(stacked, 1, 0), dtype=float)

    def displacement(self, eigenstrain: ArrayLike) -> FloatArray:
        """Mean displacement [m] along the tractions by the Mandel eigenstrain ``(6, nz, ny, nx)``, ``(n, gy, gx)``."""
        strain = np.asarray(eigenstrain, dtype=float)
        expected = (6, *self.cells.shape)
        require(strain.shape == expected, "surface", "eigenstrain", strain.shape, f"of shape {expected}")
        # Layers with zero components, for example below a plastic zone, are not transformed.
        present = np.argwhere(strain.any(axis=(2, 3)) & self._acting)
        planes = np.array([_mirrored(COMPONENTS[row]) * strain[row, layer] for row, layer in present])
        directions = range(len(self._directions))
        rows = [[self._spectra[1][layer][row][traction] for row, layer in present] for traction in directions]
        if not len(present):
            return np.zeros((len(self._directions), *self.grid.shape))
        values = np.asarray(self._convolvers[1].apply(planes, rows), dtype=float)
        # V / A is the height of the cells.
        height = self.cells.pitch[2] * np.array([_mirrored(direction) for direction in self._directions])
        return np.asarray(height[:, None, None] * values)


def _mirrored(indices: str) -> float:
    """Sign of a component after a half turn about z."""
    return (-1.0) ** (indices.count("x") + indices.count("y"))
