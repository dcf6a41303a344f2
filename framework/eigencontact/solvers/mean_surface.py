r"""A contact and cells of eigenstrain below it, each seen by the other in the mean over a cell.

Betti's theorem joins the two: the mean displacement of a surface cell of area A by an eigenstrain ε* in a cell of
volume V, and the mean stress in that cell by a unit traction t on that of the surface, obey

    A ū_t = V σ̄_t : ε*.

With one table of coefficients for both, what the cells answer to the contact is a symmetric operator, and so is the
compliance of the surface that follows: positive for any inhomogeneity if the means are exact. With values in the
centres instead it is not, and a stiff coating at the surface lets the pressure alternate from cell to cell.

References
----------
E. Betti 1872, Nuovo Cimento 7, 69 (reciprocity); T. Mura 1987, Micromechanics of Defects in Solids, section 2.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from itertools import product

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eigencontact.convolution import Convolver, Layout, Spectrum
from eigencontact.convolution.backends import available_threads, in_parallel
from eigencontact.core.grid import Grid
from eigencontact.core.tensors import COMPONENTS
from eigencontact.errors import require
from eigencontact.solvers.cells import Cells, snapped
from eigencontact.solvers.subsurface import StressKernel

__all__ = ["MeanStressKernel", "MeanSurfaceDisplacement"]

FloatArray = NDArray[np.float64]

# Gauss points along each edge of a cell, and of those that touch the surface.
_POINTS, _FLUSH = 2, 3


@dataclass(frozen=True, slots=True)
class MeanStressKernel:
    """Stress coefficients averaged over cells around the points.

    Parameters
    ----------
    kernel : StressKernel
        Coefficients at points.
    height : float
        Of the cells [m]; along x and y they are as wide as the loaded rectangle.
    """

    kernel: StressKernel
    height: float

    def parity(self, component: str) -> tuple[int, int]:
        """Parity (in y, in x)."""
        return self.kernel.parity(component)

    def table(
        self, components: list[str], x: FloatArray, y: FloatArray, z: float, half_widths: tuple[float, float]
    ) -> FloatArray:
        """Means over the cells around a lattice of offsets, at one depth of their middles, ``(n, ny, nx)``."""
        count = _FLUSH if z < 0.75 * self.height else _POINTS
        points, weights = np.polynomial.legendre.leggauss(count)
        rule = list(zip(0.5 * points, 0.5 * weights, strict=True))
        out = np.zeros((len(components), y.size, x.size))
        for (k, of_z), (j, of_y), (i, of_x) in product(rule, repeat=3):
            at = x + 2.0 * i * half_widths[0], y + 2.0 * j * half_widths[1], z + k * self.height
            out += of_z * of_y * of_x * self.kernel.table(components, *at, half_widths)
        return out

    def response(self, components: list[str], kx: FloatArray, ky: FloatArray, z: float) -> NDArray[np.complex128]:
        """Amplitudes for a traction wave at one depth: those of the kernel, which has no cells here."""
        return self.kernel.response(components, kx, ky, z)


class MeanSurfaceDisplacement:
    """Mean displacement of the cells of the surface by the eigenstrain in a box of cells below, spectra made once.

    Parameters
    ----------
    grid : Grid
        Cells of the surface.
    kernels : sequence of MeanStressKernel
        One for each traction, whose direction is that of the displacement.
    source : Cells
        Cells that carry the eigenstrain, on columns of the grid.
    precision, threads
        See `eigencontact.convolution.Convolver`.
    """

    def __init__(
        self,
        grid: Grid,
        kernels: Sequence[MeanStressKernel],
        source: Cells,
        *,
        precision: str = "double",
        threads: int | None = None,
    ) -> None:
        same = np.allclose(source.pitch[:2], (grid.dx, grid.dy), rtol=1e-9, atol=0.0)
        require(same, "surface", "pitch of the cells", source.pitch[:2], f"that of the grid, {(grid.dx, grid.dy)} [m]")
        self.grid, self.source = grid, source
        origin = (
            snapped(float((grid.y[0] - source.first[1]) / grid.dy)),
            snapped(float((grid.x[0] - source.first[0]) / grid.dx)),
        )
        self._layout = Layout(source.shape[1:], grid.shape, origin)
        self._convolver = Convolver(self._layout, precision=precision, threads=threads)
        self._precision = precision
        nz = source.shape[0]
        #: Spectra ``[traction][layer][strain component]``.
        self._spectra: list[list[list[Spectrum]]] = [[[] for _ in range(nz)] for _ in kernels]
        tasks = [partial(self._fill, t, k, kernel) for t, kernel in enumerate(kernels) for k in range(nz)]
        in_parallel(threads or available_threads(), tasks)

    def _fill(self, traction: int, layer: int, kernel: MeanStressKernel) -> None:
        layout, (dx, dy, dz) = self._layout, self.source.pitch
        x, y, z = layout.lattice_x * dx, layout.lattice_y * dy, float(self.source.centres(2)[layer])
        tables = kernel.table(list(COMPONENTS), x, y, z, (0.5 * dx, 0.5 * dy))
        spectra = []
        for name, table in zip(COMPONENTS, tables, strict=True):
            even_y, even_x = kernel.parity(name)
            # Seen from the cell the surface lies the other way: minus the offset. V / A is the height.
            spectra.append(layout.spectrum(dz * even_y * even_x * table, (even_y, even_x), precision=self._precision))
        self._spectra[traction][layer] = spectra

    @property
    def nbytes(self) -> int:
        """Memory of the stored spectra."""
        return sum(s.nbytes for rows in self._spectra for row in rows for s in row)

    def apply(self, eigenstrain: ArrayLike) -> FloatArray:
        """Displacement [m] along the tractions from the Mandel eigenstrain ``(6, nz, ny, nx)``, ``(n, gy, gx)``."""
        strain = np.asarray(eigenstrain)
        expected = (6, *self.source.shape)
        require(strain.shape == expected, "surface", "eigenstrain", strain.shape, f"of shape {expected}")
        planes = strain.reshape(-1, *self.source.shape[1:])
        nz = self.source.shape[0]
        rows = [[row[n % nz][n // nz] for n in range(len(planes))] for row in self._spectra]
        return np.asarray(self._convolver.apply(planes, rows), dtype=float)
