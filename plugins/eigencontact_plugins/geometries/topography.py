"""Measured surface as the rough side of a contact."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar, Literal

import numpy as np

from eigencontact.plugin import DataFile, FloatArray, Geometry, Grid, Length, Lengths, SceneError, hook_for, require
from eigencontact_plugins.geometries.frame import body_axes, check_center, check_length
from eigencontact_plugins.geometries.measurement import Measurement, read_measurement
from eigencontact_plugins.geometries.repair import fitted_plane, harmonic_fill

__all__ = ["Topography"]


#: Continuation of an array beyond its ends, for `scipy.ndimage.map_coordinates`.
_MODES = {"far": "nearest", "mirror": "reflect", "repeat": "grid-wrap"}


@dataclass(frozen=True, kw_only=True)
class Topography(Geometry):
    """Measured surface: separation max(height) - height, with heights positive towards the other body.

    Parameters
    ----------
    file : str
        Text with a matrix (one row for each y) or with three columns x y z on a regular raster, with blanks, tabs,
        commas or semicolons between the numbers; ``.npy``; ``.npz`` (one array of any name, or ``heights``; optional
        numbers ``dx``, ``dy``); or a format of an instrument (``pip install eigencontact[topography]``: Gwyddion,
        Bruker, Zygo, Keyence, Digital Surf, X3P, SDF ...). ``gallery:NAME`` is a file of the bundled gallery.
    spacing : (float, float), optional
        Distance of the points along x and y [m]; required if the file does not contain it, otherwise it must agree with
        the file. A text file has lines like ``width: 64 um`` (and ``height``) or ``dx: 0.5 um`` above its numbers.
    height_unit : float, optional
        Metres per unit of the heights, ``"1 um"``; required if the file does not contain it. A text file has lines like
        ``units: um`` or ``height unit: nm``. An archive with ``dx`` is in metres by default.
    lateral_unit : float, optional
        Metres per unit of the coordinates, or of ``dx``, ``dy``; required if neither the file nor ``spacing`` contains
        it.
    missing : "error", "far" or "interpolate"
        Points without height (NaN, masked, no row): an error; no contact; or interpolation by the harmonic function
        between the neighbouring points (it adds no summit).
    invert : bool
        Reverse the sign of the heights, for a mould or a replica.
    detrend : "none" or "plane"
        Subtract the least-squares plane first.
    center : (float, float)
        Position of the centre of the measured window (x, y) [m]; coordinates in the file define only distances.
    outside : "far", "mirror" or "repeat"
        Surface outside the measured window: far away, without contact; mirrored at the edges, for a larger window of
        the contact (``grid``); or repeated, with a step at the edge if the ends differ.

    Notes
    -----
    The surface is exact at the measured points, bilinear between them, and constant in the outer half cell of the
    window. *Far* (outside the window, and next to missing points) means a separation that exceeds all others by the
    diagonal of the window: finite, and out of reach. The file is read once.
    """

    key: ClassVar[str] = "topography"
    example: ClassVar[dict[str, Any]] = {"file": "gallery:rough_surface.npz"}
    references: ClassVar[tuple[str, ...]] = ("bilinear interpolation of measured heights: elementary",)
    larger_window: ClassVar[str] = "measure a larger patch or let it go on (outside = 'mirror', and a larger grid)"

    file: DataFile
    spacing: Lengths | None = None
    height_unit: Length | None = None
    lateral_unit: Length | None = None
    missing: Literal["error", "far", "interpolate"] = "error"
    invert: bool = False
    detrend: Literal["none", "plane"] = "none"
    center: tuple[Length, Length] = (0.0, 0.0)
    outside: Literal["far", "mirror", "repeat"] = "far"

    def __post_init__(self) -> None:
        if self.spacing is not None:
            usable = len(self.spacing) == 2 and all(0 < step < np.inf for step in self.spacing)
            require(usable, self.key, "spacing", self.spacing, "two positive and finite lengths (dx, dy)")
        for name in ("height_unit", "lateral_unit"):
            if getattr(self, name) is not None:
                check_length(self.key, name, getattr(self, name))
        choices = "'error', 'far' or 'interpolate'"
        require(self.missing in ("error", "far", "interpolate"), self.key, "missing", self.missing, choices)
        require(self.detrend in ("none", "plane"), self.key, "detrend", self.detrend, "'none' or 'plane'")
        check_center(self.key, self.center)
        require(self.outside in _MODES, self.key, "outside", self.outside, "'far', 'mirror' or 'repeat'")
        _ = self._surface  # read and check the file before the run

    def native_grid(self) -> Grid:
        """Grid with cells centred on the measured points."""
        return self._surface[0]

    def separation(self, x: FloatArray, y: FloatArray) -> FloatArray:
        """Separation [m]; see the notes of the class."""
        from scipy.ndimage import map_coordinates

        grid, surface, absent, far = self._surface
        along, across = body_axes(x, y, self.center)
        # Positions in cells, rounded to 1e-9, so that measured points are exact on any grid through them.
        column = np.round(along / grid.dx + 0.5 * (grid.nx - 1), 9)
        row = np.round(across / grid.dy + 0.5 * (grid.ny - 1), 9)
        position = np.atleast_2d(np.broadcast_arrays(row, column)).reshape(2, -1)
        mode = _MODES[self.outside]
        value = map_coordinates(surface, position, order=1, mode=mode).reshape(np.broadcast(row, column).shape)
        out = (column < -0.5) | (column > grid.nx - 0.5) | (row < -0.5) | (row > grid.ny - 0.5)
        out &= self.outside == "far"
        if absent is not None:
            out |= map_coordinates(absent, position, order=1, mode=mode).reshape(out.shape) > 0
        return np.where(out, far, value)

    @cached_property
    def _surface(self) -> tuple[Grid, FloatArray, FloatArray | None, float]:
        """Grid, separation at its points, 1.0 at points that remain missing (or None), and the far separation."""
        measurement = read_measurement(self.file)
        dx, dy, height_unit = self._lengths(measurement)
        height = measurement.heights * height_unit
        if self.detrend == "plane":
            height = height - fitted_plane(height)
        if self.invert:
            height = -height
        surface = np.nanmax(height) - height
        absent = np.isnan(surface)
        if absent.any() and self.missing == "error":
            raise SceneError(
                f"{self.key}.file must be without missing points (got {self.file!r} with {absent.sum()} of"
                f" {absent.size} missing); set missing = 'far' (no contact there) or 'interpolate' (filled from their"
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

    def _lengths(self, measurement: Measurement) -> tuple[float, float, float]:
        """Distance of the points along x and y, and unit of the heights [m]: from the file or from the fields."""
        height_unit = self._unit("height_unit", measurement.height_unit, fixed=measurement.fixed)
        lateral_unit = self._unit("lateral_unit", measurement.lateral_unit, fixed=measurement.fixed)
        silent = {
            "spacing": self.spacing is None and measurement.spacing is None,
            "lateral_unit": self.spacing is None and measurement.spacing is not None and lateral_unit is None,
            "height_unit": height_unit is None,
        }
        if any(silent.values()):
            missing = [name for name, asks in silent.items() if asks]
            subject = " or ".join(_SILENT[name][0] for name in missing)
            example = ", ".join(f"{name.replace('_', '-')} = {_SILENT[name][1]}" for name in missing)
            raise SceneError(
                f"{self.key}.{' and '.join(missing)} must be given (got None): {self.file!r} does not state {subject}; "
                f"for example {example}"
            )
        assert height_unit is not None
        spacing = measurement.spacing
        if spacing is None:
            assert self.spacing is not None
            return (*self.spacing, height_unit)
        if lateral_unit is None:  # for coordinates in an unknown unit only the ratio is used
            assert self.spacing is not None
            lateral_unit = self.spacing[0] / spacing[0]
        dx, dy = spacing[0] * lateral_unit, spacing[1] * lateral_unit
        rule = f"positive and finite in {self.file!r}, as dx and dy"
        require(0 < dx < np.inf and 0 < dy < np.inf, self.key, "spacing", (dx, dy), rule)
        agrees = self.spacing is None or np.allclose(self.spacing, (dx, dy), rtol=1e-3, atol=0)
        rule = f"that of the file, ({dx:.6g}, {dy:.6g}) m, or left out"
        require(agrees, self.key, "spacing", self.spacing, rule)
        return dx, dy, height_unit

    def _unit(self, name: str, file_unit: float | None, *, fixed: bool) -> float | None:
        """Unit of the field, or otherwise of the file."""
        unit: float | None = getattr(self, name)
        if unit is None:
            return file_unit
        agrees = file_unit is None or not fixed or np.isclose(unit, file_unit, rtol=1e-9, atol=0)
        require(agrees, self.key, name, unit, f"left out: {self.file!r} carries its own units")
        return unit


#: Information missing in a file, by the field for it; and an example.
_SILENT = {
    "spacing": ("the distance of its points", '"0.5 um"'),
    "lateral_unit": ("the unit of its coordinates", '"1 um"'),
    "height_unit": ("the unit of its heights", '"1 nm"'),
}


eigencontact_register = hook_for(Topography)
