"""Routes through approximate half-spaces: image and pressure, and Fourier series over the window."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Protocol

import numpy as np

from eigencontact.convolution.pace import speed
from eigencontact.core.array_types import FloatArray
from eigencontact.core.parallel import working_threads
from eigencontact.execution.blocks.block import Cost
from eigencontact.execution.routes.route import CellRoute, HalfSpace
from eigencontact.model.installed import installed_influence
from eigencontact.model.regions import RegionLattice, surface_lattice
from eigencontact.model.sources import Source
from eigencontact.solvers.eigenstrain_periodic import PeriodicHalfSpace
from eigencontact.solvers.image_pressure import ImagePressure, reflected

__all__ = ["FieldInTime", "ImagePressureField", "Periodic"]


#: Additional waves in each direction, beyond those of the grid, for eigenstrain that is uniform in each cell.
_ALIASES = 2
#: Seconds per wave and layer or depth on one thread, and seconds per component, loaded cell and point.
_WAVE, _CELL = 2e-7, 1.5e-7


class Periodic(CellRoute):
    """Route by Fourier series over the window, for one box of cells; the field is periodic in the window."""

    @property
    def words(self) -> str:
        """See `Route.words`."""
        return f"{self.box.words} repeated with the window, Fourier series in the plane"

    @property
    def cost(self) -> Cost:
        """See `Route.cost`; the waves are computed for each time."""
        grid, layers, planes = self.half_space.grid, self.box.lattice.shape[0], self.lattice.depths.size
        waves, count = grid.ny * (grid.nx // 2 + 1), 3 if self.quantity == "displacement" else 6
        workers = working_threads(self.half_space.threads)
        seconds = waves * (2 * _ALIASES + 1) ** 2 * (2 * layers + 3 * planes) * _WAVE / workers
        seconds += 4e-8 * waves * (6 * layers + count * planes) + 1e-3
        return Cost(memory=16.0 * waves * (6 * layers + count * planes) * 3 + 4e6, seconds_per_step=seconds)

    @cached_property
    def _space(self) -> PeriodicHalfSpace:
        (first, _, _), (layers, _, _), (dz, _, _) = (
            self.box.lattice.first, self.box.lattice.shape, self.box.lattice.edges,
        )  # fmt: skip
        return PeriodicHalfSpace(
            grid=self.half_space.grid,
            interfaces=dz * (first + np.arange(layers + 1.0)),
            poisson_ratio=self.half_space.material.poisson_ratio,
            aliases=_ALIASES,
            threads=self.half_space.numerics.threads,
        )

    def field(self, eigenstrain: FloatArray) -> FloatArray:
        """See `Route.field`."""
        grid, cells = self.half_space.grid, self.box.lattice
        (_, row, column), (_, rows, columns) = cells.first, cells.shape
        window = np.zeros((*eigenstrain.shape[:2], *grid.shape))
        wrapped = np.zeros((*eigenstrain.shape[:2], grid.ny, columns))
        np.add.at(wrapped.swapaxes(0, 2), (row + np.arange(rows)) % grid.ny, eigenstrain.swapaxes(0, 2))
        np.add.at(window.swapaxes(0, 3), (column + np.arange(columns)) % grid.nx, wrapped.swapaxes(0, 3))
        lattice = self.lattice
        values = self._space.apply(
            window, self.quantity, depths=lattice.depths, target=lattice.target, origin=lattice.origin
        )
        values = values * (self.half_space.material.shear_modulus if self.quantity == "stress" else 1.0)
        return np.asarray(values[list(self.rows)])


class FieldInTime(Protocol):
    """Field of prescribed eigenstrain at the points of a lattice."""

    @property
    def cost(self) -> Cost:
        """Cost of the set-up, and of the field at one time."""
        ...

    def at(self, time: float) -> FloatArray:
        """Field at one time, ``(rows, *lattice.shape)``."""
        ...


class ImagePressureField:
    """Field at any time by full space, its mirror image, and the remaining pressure on the cells of the window.

    Parameters
    ----------
    half_space : HalfSpace
        Body; its surface is not used.
    find : callable
        Field of the same sources in full space, from a quantity and a lattice.
    """

    words = "full space twice (the image is its mirror), and the pressure that is left on the cells of the window"

    def __init__(
        self,
        half_space: HalfSpace,
        sources: Sequence[Source],
        quantity: str,
        lattice: RegionLattice,
        find: Callable[[str, RegionLattice], FieldInTime],
    ) -> None:
        self.half_space, self.sources, self.quantity, self.lattice = half_space, tuple(sources), quantity, lattice
        self._real, self._image = find(quantity, lattice), find(quantity, _mirrored(lattice))
        self._surface = find("stress", surface_lattice(half_space.grid))

    @property
    def cost(self) -> Cost:
        """Cost of the image pressure, summed at points or convolved on planes, and of the full-space fields."""
        grid, lattice, numerics = self.half_space.grid, self.lattice, self.half_space.numerics
        count, workers = 3 if self.quantity == "displacement" else 6, working_threads(self.half_space.threads)
        cells = grid.nx * grid.ny
        if lattice.points is not None:
            seconds = len(lattice.points) * cells * count * _CELL / workers
            pressure_cost = Cost(memory=8.0 * cells * count, seconds_per_step=seconds)
        else:
            ny, nx = lattice.target[0] + grid.ny, lattice.target[1] + grid.nx
            convolution_seconds = speed("double", numerics.threads).convolution(ny, nx)
            seconds = lattice.depths.size * count * (2.0 * convolution_seconds + _CELL * ny * nx)
            pressure_cost = Cost(memory=8.0 * count * ny * nx * 3, seconds_per_step=seconds)
        return pressure_cost + self._real.cost + self._image.cost + self._surface.cost

    @cached_property
    def _scheme(self) -> ImagePressure:
        kernel = installed_influence(self.half_space.registry, "p")
        return ImagePressure(
            grid=self.half_space.grid, kernel=kernel, material=self.half_space.material,
            threads=self.half_space.numerics.threads,
        )  # fmt: skip

    def at(self, time: float) -> FloatArray:
        """Field at one time, ``(3 or 6, *lattice.shape)``."""
        load, image = 2.0 * self._surface.at(time)[2, 0], self._image.at(time)
        if self.lattice.points is None:
            image = image[:, ::-1]
        out = self._real.at(time) + reflected(self.quantity, image)
        if self.lattice.points is None:
            self._scheme.add_pressure(out, self.quantity, load, self.lattice.origin, self.lattice.depths)
        else:
            self._scheme.add_pressure_at(out, self.quantity, load, self.lattice.flat_points())
        return out


def _mirrored(lattice: RegionLattice) -> RegionLattice:
    """Mirror images of points, planes in ascending order."""
    if lattice.points is not None:
        return replace(lattice, points=lattice.points * (1.0, 1.0, -1.0))
    return replace(lattice, depths=-lattice.depths[::-1])
