"""Profile of a surface from a file, constant along y."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import ClassVar

import numpy as np

from eigencontact.plugin import (
    DataFile,
    FloatArray,
    Geometry,
    Grid,
    GriddedData,
    Length,
    SceneError,
    hook_for,
    read_gridded,
    require,
)  # fmt: skip
from eigencontact_plugins.geometries.frame import check_length

__all__ = ["Profile"]

#: Largest relative difference of a step from the mean that counts as even; text files round coordinates.
_EVEN = 1e-3


@dataclass(frozen=True, kw_only=True)
class Profile(Geometry):
    """Profile of heights over x, as of a stylus: separation max(height) - height, constant along y.

    Parameters
    ----------
    file : str
        Text with two columns, x and height, in rows of any order; or ``.npz`` or NetCDF with ascending ``x (n,)`` and
        ``height (n,)``. Heights are positive towards the other body.
    unit : float
        Metres in one unit of x: ``"1 mm"``; metres by default. NetCDF files have their own units.
    height_unit : float
        Metres in one unit of the heights; metres by default. Not for NetCDF files, which have their own units.
    center : float
        Coordinate x [m] of the point x = 0 of the file.

    Notes
    -----
    Heights are linear between the points and constant outside. The cells of an automatic grid are centred on the
    points, which must then have even steps. A kink between distant points causes a peak of the pressure: use points as
    close as the cells.
    """

    key: ClassVar[str] = "profile"
    larger_window: ClassVar[str] = "measure a longer profile"
    references: ClassVar[tuple[str, ...]] = ("linear interpolation of given heights: elementary",)

    file: DataFile
    unit: Length = 1.0
    height_unit: Length = 1.0
    center: Length = 0.0

    def __post_init__(self) -> None:
        for name in ("unit", "height_unit"):
            check_length(self.key, name, getattr(self, name))
        require(np.isfinite(self.center), self.key, "center", self.center, "finite [m]")
        if Path(self.file).suffix.lower() in (".nc", ".nc4", ".netcdf", ".h5", ".hdf5"):
            rule = "left out for a file of NetCDF, which tells the units of its variables"
            require(self.height_unit == 1.0, self.key, "height_unit", self.height_unit, rule)
        rule = "a profile of 3 points or more"
        points = self._data.shape[0]  # read and check the file before the run
        require(points >= 3, self.key, "file", f"{self.file!r} with {points} points", rule)

    @cached_property
    def _data(self) -> GriddedData:
        return read_gridded(f"{self.key}.file", self.file, {"height": "m"}, axes=("x",), unit=self.unit)

    def native_grid(self) -> Grid:
        """Grid with cells centred on the points, one row of squares."""
        x = self._data.axes[0]
        steps = np.diff(x)
        dx = float(x[-1] - x[0]) / steps.size
        if float(np.ptp(steps)) > _EVEN * dx:
            raise SceneError(
                f"{self.key}.file must have even steps along x with an automatic grid (got {self.file!r}, steps of "
                f"{steps.min():.6g} to {steps.max():.6g} m); give grid.cells and grid.size"
            )
        return Grid(nx=x.size, ny=1, dx=dx, dy=dx, center=(self.center + 0.5 * float(x[0] + x[-1]), 0.0))

    def separation(self, x: FloatArray, y: FloatArray) -> FloatArray:
        """Separation [m]; 0 at the highest point."""
        height = self._data.values["height"] * self.height_unit
        depth = np.interp(np.asarray(x, dtype=float) - self.center, self._data.axes[0], height.max() - height)
        return np.asarray(depth + 0.0 * np.asarray(y, dtype=float))


eigencontact_register = hook_for(Profile)
