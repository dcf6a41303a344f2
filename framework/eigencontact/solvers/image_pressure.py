"""Approximate half-space: full space, plus the mirror image, minus their pressure on the surface.

In an infinite body the eigenstrain and its image ``s_i s_j e_ij``, s = (1, 1, -1), cause no shear on the plane z = 0,
but twice the normal traction of the eigenstrain alone. That traction is sampled at the cell centres and removed by the
exact field of uniformly loaded cells. The method is a reference for comparison with the half-space theorem. Its errors
are the sampling near the surface and the missing pressure outside the window.

The field of the image is the mirrored field of the source, ``u_i(x, y, z) -> s_i u_i(x, y, -z)``, so only fields of the
source in full space are needed.

References
----------
Y. P. Chiu 1978, J. Appl. Mech. 45, 302 (image and residual traction); C. Jacq, D. Nélias, G. Lormand, D. Girodin 2002,
doi:10.1115/1.1467920 (the scheme, for plastic strain).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Protocol

import numpy as np

from eigencontact.convolution import Convolver, Layout
from eigencontact.core.array_types import FloatArray
from eigencontact.core.grid import Grid
from eigencontact.core.material import Material
from eigencontact.core.parallel import available_threads, in_parallel
from eigencontact.core.symmetry import parity
from eigencontact.core.tensors import COMPONENTS
from eigencontact.errors import require
from eigencontact.halfspace.potentials import HasCornerPotentials
from eigencontact.halfspace.theorem import QUANTITIES
from eigencontact.solvers.cells import Cells, offset_in_cells
from eigencontact.solvers.eigenstrain import VolumeField

__all__ = ["ImagePressure", "ImagePressureVolume", "PressureKernel", "reflected"]

Points = tuple[FloatArray, FloatArray, FloatArray]

_AXES = ("x", "y", "z")
#: Sign of each component under reflection in the surface: displacement, and Mandel tensors.
_SIGNS = {
    "displacement": np.array([1.0, 1.0, -1.0]),
    "strain": np.array([1.0, 1.0, 1.0, -1.0, -1.0, 1.0]),
    "stress": np.array([1.0, 1.0, 1.0, -1.0, -1.0, 1.0]),
}


class PressureKernel(Protocol):
    """Field of a uniform pressure on a rectangle of the surface: surface influence of ``"p"``."""

    def sample(
        self,
        quantity: str,
        components: Sequence[str],
        x: FloatArray,
        y: FloatArray,
        z: float,
        half_widths: tuple[float, float],
        material: Material,
    ) -> FloatArray:
        """Displacement or Mandel stress per unit pressure on a lattice of offsets, ``(n, ny, nx)``."""


def reflected(quantity: str, field: FloatArray) -> FloatArray:
    """Components ``(3 or 6, ...)`` after reflection in z = 0; the caller reflects the points."""
    return np.asarray(_SIGNS[quantity].reshape(-1, *(1,) * (field.ndim - 1)) * field)


@dataclass(frozen=True, kw_only=True, slots=True)
class ImagePressure:
    """Field of the pressure that removes the doubled normal traction of source and image.

    Parameters
    ----------
    grid : Grid
        Cells of the surface that carry the pressure; the traction outside them is not removed.
    kernel : PressureKernel
        Field of one loaded cell.
    material : Material
        The body.
    threads : int, optional
        Cores to use; by default all cores available to this process.
    """

    grid: Grid
    kernel: PressureKernel
    material: Material
    threads: int | None = None

    def _names(self, quantity: str) -> list[str]:
        rule = f"one of {', '.join(map(repr, QUANTITIES))}"
        require(quantity in QUANTITIES, "image-pressure", "quantity", quantity, rule)
        return list(_AXES if quantity == "displacement" else COMPONENTS)

    def add_pressure_at(self, out: FloatArray, quantity: str, load: FloatArray, points: Points) -> None:
        """Add the field of the pressure ``(ny, nx)`` to ``(3 or 6, n)`` at scattered points, cell by cell."""
        if not load.any():
            return
        grid, widths = self.grid, self.grid.half_widths
        turned, names = load[::-1, ::-1], self._names(quantity)
        x, y, z = points

        def superpose(numbers: range) -> None:
            for n in numbers:
                # Offsets (point minus cell) ascend for cells in descending order.
                dx, dy, depth = x[n] - grid.x[::-1], y[n] - grid.y[::-1], abs(float(z[n]))
                table = self.kernel.sample(_kernel_of(quantity), names, dx, dy, depth, widths, self.material)
                out[:, n] += self._as(quantity, np.einsum("kij,ij->k", table, turned))

        workers = self.threads or available_threads()
        in_parallel(workers, [partial(superpose, range(k, x.size, workers)) for k in range(workers)])

    def add_pressure(
        self, out: FloatArray, quantity: str, load: FloatArray, origin: tuple[float, float], depths: FloatArray
    ) -> None:
        """Add the field of the pressure ``(ny, nx)`` to ``(3 or 6, nz, ty, tx)``, one plane at a time."""
        if not load.any():
            return
        grid, names = self.grid, self._names(quantity)
        layout = Layout(grid.shape, (out.shape[2], out.shape[3]), origin)
        convolver = Convolver(layout, threads=self.threads)
        x, y, widths = layout.x.lattice * grid.dx, layout.y.lattice * grid.dy, grid.half_widths
        for k, depth in enumerate(depths):
            tables = self.kernel.sample(_kernel_of(quantity), names, x, y, abs(float(depth)), widths, self.material)
            unit = float(np.abs(tables).max())
            spectra = [
                [layout.spectrum(table, parity(name, "z"), scale=1.0 / unit)]
                for name, table in zip(names, tables, strict=True)
            ]
            out[:, k] += self._as(quantity, unit * convolver.apply(load[None], spectra))

    def _as(self, quantity: str, values: FloatArray) -> FloatArray:
        """Strain from stress by Hooke's law if strain is requested: the part of the pressure is elastic."""
        if quantity != "strain":
            return values
        nu, mu = self.material.poisson_ratio, self.material.shear_modulus
        strain = values / (2.0 * mu)
        strain[:3] -= nu / (1.0 + nu) * strain[:3].sum(axis=0)
        return strain


def _kernel_of(quantity: str) -> str:
    return "displacement" if quantity == "displacement" else "stress"


class ImagePressureVolume:
    """Image-pressure method for eigenstrain that is uniform in each cell of a box, at the points of a lattice.

    Parameters
    ----------
    scheme : ImagePressure
        Surface, loaded cell and body.
    cell : HasCornerPotentials
        Shape of the cells: the cuboid.
    source, target : Cells
        Cells with eigenstrain, and points in z >= 0; the points are columns of the scheme's grid, or points between
        them.
    quantity : {"displacement", "strain", "stress"}
        Result of `apply`.

    Notes
    -----
    It has three operators in full space: for the points, for their mirror images, and for the traction on the surface.
    """

    def __init__(
        self, scheme: ImagePressure, cell: HasCornerPotentials, source: Cells, target: Cells, *, quantity: str
    ) -> None:
        top = target.first[2]
        at_surface = source.flush and abs(top) <= 1e-9 * target.pitch[2]
        rule = "below the surface where cells reach it and strain is asked for"
        require(not (at_surface and quantity == "strain"), "image-pressure", "first target depth", top, rule)
        require(top >= -1e-9 * target.pitch[2], "image-pressure", "first target depth", top, "0 or more [m]")
        body, grid = scheme.material, scheme.grid
        mirrored = replace(target, first=(*target.first[:2], -float(target.centres(2)[-1])))
        surface = Cells(first=(float(grid.x[0]), float(grid.y[0]), 0.0), pitch=source.pitch, shape=(1, *grid.shape))

        def full_space(points: Cells, name: str) -> VolumeField:
            return VolumeField(
                cell, source, points, poisson_ratio=body.poisson_ratio, quantity=name, space="full",
                shear_modulus=body.shear_modulus, threads=scheme.threads,
            )  # fmt: skip

        self._scheme, self._quantity, self._target = scheme, quantity, target
        self._here, self._image = full_space(target, quantity), full_space(mirrored, quantity)
        self._traction = full_space(surface, "stress")
        _, y, x = offset_in_cells(surface, target)
        self._origin = y, x

    @property
    def nbytes(self) -> int:
        """Memory of spectra and buffers."""
        return self._here.nbytes + self._image.nbytes + self._traction.nbytes

    def apply(self, eigenstrain: FloatArray) -> FloatArray:
        """Field of the Mandel eigenstrain ``(6, nz, ny, nx)`` [-], ``(3 or 6, tz, ty, tx)``."""
        load = np.asarray(2.0 * self._traction.apply(eigenstrain)[2, 0])
        out = np.asarray(self._here.apply(eigenstrain), dtype=float)
        out += reflected(self._quantity, np.asarray(self._image.apply(eigenstrain))[:, ::-1])
        self._scheme.add_pressure(out, self._quantity, load, self._origin, self._target.centres(2))
        return out
