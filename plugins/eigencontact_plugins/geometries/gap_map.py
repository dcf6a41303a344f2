"""Separation from values at the points of a raster."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np

from eigencontact.plugin import DataFile, FloatArray, Geometry, Grid, GriddedData, hook_for, read_gridded, require

__all__ = ["GapMap"]


#: Largest relative difference between steps of an axis that counts as even.
_EVEN = 1e-6


@dataclass(frozen=True, kw_only=True)
class GapMap(Geometry):
    """Separation of two surfaces at the points of a regular raster, with a datum of its own.

    The separation is exact at the points of the raster, which are the cells of an automatic grid. It is bilinear
    between the points, and constant outside. The approach is relative to a separation of 0, independent of the first
    contact.

    Parameters
    ----------
    file : str
        ``.npz`` or NetCDF with ascending, even ``y (ny,)`` and ``x (nx,)`` [m] and ``gap (ny, nx)`` [m]; text with
        columns x, y, gap (`eigencontact.plugin.read_gridded`).
    """

    key: ClassVar[str] = "gap-map"
    references: ClassVar[tuple[str, ...]] = ("bilinear interpolation of given numbers: elementary",)

    file: DataFile

    def __post_init__(self) -> None:
        rule = "a raster of equal steps along x, and along y"
        for axis in self._data.axes:  # read and check the file before the run
            steps = np.diff(axis)
            require(float(np.ptp(steps)) <= _EVEN * float(steps.mean()), self.key, "file", self.file, rule)

    @cached_property
    def _data(self) -> GriddedData:
        return read_gridded(f"{self.key}.file", self.file, {"gap": "m"}, axes=("y", "x"))

    def native_grid(self) -> Grid:
        """Grid with cells centred on the points."""
        (dy, cy), (dx, cx) = (
            (float(axis[-1] - axis[0]) / (axis.size - 1), 0.5 * float(axis[0] + axis[-1])) for axis in self._data.axes
        )
        ny, nx = self._data.shape
        return Grid(nx=nx, ny=ny, dx=dx, dy=dy, center=(cx, cy))

    def separation(self, x: FloatArray, y: FloatArray) -> FloatArray:
        """Separation [m]."""
        (rows, columns), grid = self._data.axes, self.native_grid()
        on_raster = (
            (x.shape, y.shape) == ((1, columns.size), (rows.size, 1))
            and np.abs(x[0] - columns).max() <= 1e-9 * grid.dx
            and np.abs(y[:, 0] - rows).max() <= 1e-9 * grid.dy
        )
        return self._data.values["gap"] if on_raster else self._data.at("gap", y, x)


eigencontact_register = hook_for(GapMap)
