"""A measured surface as the rough side of a contact."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from eigencontact.plugin import DataFile, Geometry, Grid, Length, SceneError, hookimpl, require
from eigencontact_plugins.geometries.frame import body_axes, check_center, check_length
from eigencontact_plugins.geometries.measurement import Measurement, read_measurement
from eigencontact_plugins.geometries.repair import fitted_plane, harmonic_fill

if TYPE_CHECKING:
    from collections.abc import Iterable

__all__ = ["Topography"]

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class Topography(Geometry):
    """Separation max(height) - height of a measured surface; heights positive towards the other body.

    Parameters
    ----------
    file : str
        ``.npy`` or ``.npz`` (2-D array ``heights`` with rows along y; optional numbers ``dx``, ``dy``), text with three
        columns x y z on a regular raster (rows in any order, ``#`` comments), or a format that SurfaceTopography reads
        (``pip install eigencontact[topography]``). ``gallery:NAME`` is a file of the bundled gallery. Read once.
    spacing : (float, float), optional
        Distance of the points along x and y [m]; needed where the file does not tell, and must agree where it does.
    height_unit, lateral_unit : float
        Metres per unit of the heights, of the coordinates or ``dx``, ``dy``, in a file without units.
    missing : "error", "far" or "interpolate"
        Points without height (NaN, masked, no row): refuse; never touch; or fill by the harmonic function that joins
        their neighbours (it adds no summit).
    invert : bool
        Turn the heights over, for a mould or a replica.
    detrend : "none" or "plane"
        Subtract the plane of least squares first.
    center : (float, float)
        Where the middle of the measured window lies (x, y) [m]; coordinates in the file only give distances.

    Notes
    -----
    Exact at the measured points, bilinear between them, constant in the outer half cell of the window. *Far* (outside
    the window, and wherever a missing point takes part) means larger than any other separation by the diagonal of the
    window: finite, and out of reach.
    """

    key: ClassVar[str] = "topography"

    file: DataFile
    spacing: tuple[Length, Length] | None = None
    height_unit: Length = 1.0
    lateral_unit: Length = 1.0
    missing: Literal["error", "far", "interpolate"] = "error"
    invert: bool = False
    detrend: Literal["none", "plane"] = "none"
    center: tuple[Length, Length] = (0.0, 0.0)

    def __post_init__(self) -> None:
        if self.spacing is not None:
            usable = len(self.spacing) == 2 and all(0 < step < np.inf for step in self.spacing)
            require(usable, self.key, "spacing", self.spacing, "two positive and finite lengths (dx, dy)")
        check_length(self.key, "height_unit", self.height_unit)
        check_length(self.key, "lateral_unit", self.lateral_unit)
        choices = "'error', 'far' or 'interpolate'"
        require(self.missing in ("error", "far", "interpolate"), self.key, "missing", self.missing, choices)
        require(self.detrend in ("none", "plane"), self.key, "detrend", self.detrend, "'none' or 'plane'")
        check_center(self.key, self.center)
        _ = self._surface  # read and checked now, not in the middle of a run

    def native_grid(self) -> Grid:
        """Grid whose cells are centred on the measured points."""
        return self._surface[0]

    def separation(self, x: FloatArray, y: FloatArray) -> FloatArray:
        """Separation [m]; see the notes of the class."""
        from scipy.ndimage import map_coordinates

        grid, surface, absent, far = self._surface
        along, across = body_axes(x, y, self.center)
        # positions in cells, rounded to 1e-9 so that measured points come out exact on any grid through them
        column = np.round(along / grid.dx + 0.5 * (grid.nx - 1), 9)
        row = np.round(across / grid.dy + 0.5 * (grid.ny - 1), 9)
        position = np.atleast_2d(np.broadcast_arrays(row, column)).reshape(2, -1)
        value = map_coordinates(surface, position, order=1, mode="nearest").reshape(np.broadcast(row, column).shape)
        out = (column < -0.5) | (column > grid.nx - 0.5) | (row < -0.5) | (row > grid.ny - 0.5)
        if absent is not None:
            out |= map_coordinates(absent, position, order=1, mode="nearest").reshape(out.shape) > 0
        return np.where(out, far, value)

    @cached_property
    def _surface(self) -> tuple[Grid, FloatArray, FloatArray | None, float]:
        """Grid, separation at its points, 1.0 where a point is missing and stays so (or None), the far separation."""
        measurement = read_measurement(self.file)
        dx, dy = self._steps(measurement)
        height = measurement.heights * (1.0 if measurement.in_metres else self.height_unit)
        if self.detrend == "plane":
            height = height - fitted_plane(height)
        if self.invert:
            height = -height
        surface = np.nanmax(height) - height
        absent = np.isnan(surface)
        if absent.any() and self.missing == "error":
            raise SceneError(
                f"{self.key}.file must be without missing points (got {self.file!r} with {absent.sum()} of"
                f" {absent.size} missing); set missing = 'far' (they never touch) or 'interpolate' (filled from their"
                " neighbours)"
            )
        if absent.any() and self.missing == "interpolate":
            surface = harmonic_fill(surface, dx, dy)
            absent = np.zeros_like(absent)
        ny, nx = surface.shape
        grid = Grid(nx=nx, ny=ny, dx=dx, dy=dy, center=(float(self.center[0]), float(self.center[1])))
        far = float(np.nanmax(surface) + np.hypot(*grid.size))
        surface = np.where(absent, far, surface)
        surface.flags.writeable = False
        return grid, surface, absent.astype(float) if absent.any() else None, far

    def _steps(self, measurement: Measurement) -> tuple[float, float]:
        """Distance of the points [m], from the file or the field."""
        if measurement.in_metres:
            rule = f"left out: {self.file!r} carries its own units"
            require(self.height_unit == 1.0, self.key, "height_unit", self.height_unit, rule)
            require(self.lateral_unit == 1.0, self.key, "lateral_unit", self.lateral_unit, rule)
        if measurement.spacing is None:
            if self.spacing is None:
                rule = f"two lengths (dx, dy) [m], as {self.file!r} does not tell the distance of its points"
                raise SceneError(f"{self.key}.spacing must be {rule} (got None)")
            return self.spacing
        unit = 1.0 if measurement.in_metres else self.lateral_unit
        dx, dy = measurement.spacing[0] * unit, measurement.spacing[1] * unit
        rule = f"positive and finite in {self.file!r}, as dx and dy"
        require(0 < dx < np.inf and 0 < dy < np.inf, self.key, "spacing", (dx, dy), rule)
        agrees = self.spacing is None or np.allclose(self.spacing, (dx, dy), rtol=1e-3, atol=0)
        rule = f"that of the file, ({dx:.6g}, {dy:.6g}) m, or left out"
        require(agrees, self.key, "spacing", self.spacing, rule)
        return dx, dy


@hookimpl
def eigencontact_register() -> Iterable[type[Geometry]]:
    """Register the measured surface."""
    return [Topography]
