"""Coulomb friction with a coefficient that depends on position: phases, coatings, worn tracks, measured maps."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from eigencontact.plugin import (
    Angle,
    DataFile,
    FloatArray,
    FrictionLaw,
    FrictionState,
    GriddedData,
    Length,
    SceneError,
    hook_for,
    require,
)
from eigencontact_plugins.friction.coulomb import check_coefficient
from eigencontact_plugins.friction.map_file import map_at, read_map
from eigencontact_plugins.geometries.frame import body_axes, check_angle, check_center, check_length

__all__ = ["CoulombMap", "Region"]


@dataclass(frozen=True, kw_only=True)
class Region:
    """Region of the surface with its own coefficient: a rectangle by its size, or a circle by its radius.

    Parameters
    ----------
    coefficient : float
        Coefficient of friction [-].
    center : (float, float)
        Middle (x, y) [m].
    size : (float, float), optional
        Edges of a rectangle [m], along x and y before the rotation.
    angle : float
        Rotation of the rectangle [rad] from x towards y.
    radius : float, optional
        Radius of a circle [m].
    """

    coefficient: float
    center: tuple[Length, Length] = (0.0, 0.0)
    size: tuple[Length, Length] | None = None
    angle: Angle = 0.0
    radius: Length | None = None

    def check(self, where: str) -> None:
        """Refuse an invalid region; `where` is its name."""
        check_coefficient(where, "coefficient", self.coefficient)
        check_center(where, self.center)
        check_angle(where, self.angle)
        if (self.size is None) == (self.radius is None):
            extents = "neither" if self.size is None else "both"
            raise SceneError(f"{where} must have a size (a rectangle) or a radius (a circle) (got {extents})")
        if self.radius is not None:
            check_length(where, "radius", self.radius)
        if self.size is not None:
            good = len(self.size) == 2 and all(0 < edge < np.inf for edge in self.size)
            require(good, where, "size", self.size, "two positive and finite lengths")

    def contains(self, x: FloatArray, y: FloatArray) -> NDArray[np.bool_]:
        """Whether points [m] lie in the region or on its edge; x and y broadcast."""
        if self.radius is not None:
            dx, dy = body_axes(x, y, self.center)
            return np.asarray(dx**2 + dy**2 <= self.radius**2)
        assert self.size is not None
        along, across = body_axes(x, y, self.center, self.angle)
        return np.asarray((np.abs(along) <= 0.5 * self.size[0]) & (np.abs(across) <= 0.5 * self.size[1]))


@dataclass(frozen=True, kw_only=True)
class CoulombMap(FrictionLaw):
    """Coulomb friction with a coefficient that depends on position: from a file, in regions, or both.

    Parameters
    ----------
    coefficient : float, optional
        Coefficient [-] outside the map and the regions. Without it, the program refuses contact outside the map of a
        file.
    file : str, optional
        ``.npz`` with ``x`` (nx,), ``y`` (ny,), ascending, and ``coefficient`` (ny, nx); or text with columns
        x y coefficient, one row for each point of a lattice. Coordinates are those of the scene. Read once.
    lateral_unit : float
        Metres per unit of the coordinates in the file.
    interpolation : "linear" or "nearest"
        Interpolation between the points of the file; constant in its outermost half step.
    regions : tables, optional
        Rectangles and circles with a coefficient each, in place of the map; the last region that contains a point
        determines its coefficient. See `Region`.

    Notes
    -----
    A cell has the coefficient at its centre: the edge of a region is resolved to one cell.
    """

    key: ClassVar[str] = "coulomb-map"
    example: ClassVar[dict[str, Any]] = {"coefficient": 0.2, "regions": [{"radius": 1e-6, "coefficient": 0.6}]}
    references: ClassVar[tuple[str, ...]] = ("C. A. Coulomb 1785, Theorie des machines simples",)

    coefficient: float | None = None
    file: DataFile | None = None
    lateral_unit: Length = 1.0
    interpolation: Literal["linear", "nearest"] = "linear"
    regions: tuple[Region, ...] = ()

    def __post_init__(self) -> None:
        if self.coefficient is not None:
            check_coefficient(self.key, "coefficient", self.coefficient)
        check_length(self.key, "lateral_unit", self.lateral_unit)
        choices = ("linear", "nearest")
        require(self.interpolation in choices, self.key, "interpolation", self.interpolation, "'linear' or 'nearest'")
        for number, region in enumerate(self.regions):
            region.check(f"{self.key}.regions.{number}")
        if self.file is None:
            if not self.regions:
                raise SceneError(f'{self.key} must have a file or regions (got neither); or set type = "coulomb"')
            has_base = self.coefficient is not None
            require(has_base, self.key, "coefficient", None, "given without a file, for points outside the regions")
        _ = self._map  # read and check the file before the run

    @cached_property
    def _map(self) -> GriddedData | None:
        return None if self.file is None else read_map(self.key, self.file, self.lateral_unit)

    @cached_property
    def _last(self) -> dict[tuple[bytes, bytes], FloatArray]:
        """Coefficients at the last cell centres, which do not change during a run."""
        return {}

    def coefficients(self, x: FloatArray, y: FloatArray) -> FloatArray:
        """Coefficient [-] at points [m]; NaN without a coefficient; x and y broadcast."""
        shape = np.broadcast_shapes(np.shape(x), np.shape(y))
        base = np.nan if self.coefficient is None else self.coefficient
        out = np.full(shape, base)
        if self._map is not None:
            mapped = map_at(self._map, np.asarray(x, dtype=float), np.asarray(y, dtype=float), self.interpolation)
            out = np.where(np.isnan(mapped), base, mapped)
        for region in self.regions:
            out[region.contains(np.asarray(x), np.asarray(y))] = region.coefficient
        return out

    def shear_bound(self, state: FrictionState) -> FloatArray:
        """Shear bound [Pa]; see `FrictionLaw`.

        Raises
        ------
        SceneError
            There is contact outside the map, without a coefficient for it.
        """
        place = (state.x.tobytes(), state.y.tobytes())
        if place not in self._last:
            self._last.clear()
            self._last[place] = self.coefficients(state.x, state.y)
        values = self._last[place]
        uncovered = np.isnan(values) & (state.pressure > 0)
        if uncovered.any():
            assert self._map is not None
            row, column = np.argwhere(uncovered)[0]
            (y0, y1), (x0, x1) = (axis[[0, -1]] for axis in self._map.axes)
            raise SceneError(
                f"{self.key}.file must cover the contact (got {self.file!r} with x from {x0:.6g} to {x1:.6g} m, y from "
                f"{y0:.6g} to {y1:.6g} m, and contact at x = {float(state.x[0, column]):.6g} m, y = "
                f"{float(state.y[row, 0]):.6g} m); give coefficient for the surface outside the map"
            )
        return np.where(np.isnan(values), 0.0, values) * state.pressure


eigencontact_register = hook_for(CoulombMap)
