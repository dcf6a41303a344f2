"""Layer below a rectangle of the surface, of uniform or measured thickness."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from eigencontact.plugin import (
    TEXT_FILES,
    DataFile,
    FloatArray,
    InclusionShape,
    Length,
    SceneError,
    hook_for,
    read_arrays,
    real_points,
    require,
)

__all__ = ["Layer"]

Point = tuple[float, float, float]


@dataclass(frozen=True, kw_only=True)
class Layer(InclusionShape):
    """Layer between the depths `top` and `top` + thickness, below a rectangle.

    Parameters
    ----------
    size : (float, float)
        Full extent along x and y [m].
    thickness : float, optional
        Uniform thickness [m].
    file : str, optional
        Map of the thickness instead: ``.npy``, ``.npz`` (an array ``thickness``, or its only one) or text with one row
        of numbers per line (blanks, commas or semicolons). Rows run along y, columns along x; the outer rows and
        columns lie on the edges of the rectangle; bilinear between the points. Zero means no layer at this point.
    thickness_unit : float
        Metres per unit of the numbers in the file.
    center : (float, float)
        Middle of the rectangle (x, y) [m].
    top : float
        Depth of the upper face [m]; 0 is the surface.

    Notes
    -----
    The shape has no potentials: the framework divides it into cuboids with volume fractions. This is exact for a layer
    of uniform thickness with faces on faces of cells; otherwise use `cuboid`, the same region with potentials.
    """

    key: ClassVar[str] = "layer"
    example: ClassVar[dict[str, Any]] = {"size": ["10 um", "10 um"], "thickness": "2 um"}
    references: ClassVar[tuple[str, ...]] = ("S. Liu & Q. Wang 2005, J. Appl. Mech. 72, 871 (sum over cuboids)",)

    size: tuple[Length, Length]
    thickness: Length | None = None
    file: DataFile | None = None
    thickness_unit: Length = 1.0
    center: tuple[Length, Length] = (0.0, 0.0)
    top: Length = 0.0

    def __post_init__(self) -> None:
        good = len(self.size) == 2 and all(0 < extent < np.inf for extent in self.size)
        require(good, self.key, "size", self.size, "two positive, finite lengths (along x, y) [m]")
        good = len(self.center) == 2 and bool(np.isfinite(self.center).all())
        require(good, self.key, "center", self.center, "two finite lengths (x, y) [m]")
        require(0 <= self.top < np.inf, self.key, "top", self.top, "zero or positive and finite [m]")
        require(0 < self.thickness_unit < np.inf, self.key, "thickness_unit", self.thickness_unit, "positive [m]")
        if (self.thickness is None) == (self.file is None):
            sources = "neither" if self.file is None else "both"
            raise SceneError(
                f"{self.key} must have a thickness [m] or a file with a map of it (got {sources}); give one"
            )
        if self.thickness is not None:
            require(0 < self.thickness < np.inf, self.key, "thickness", self.thickness, "positive and finite [m]")
        _ = self._map  # read and check the file before the run

    @property
    def bounds(self) -> tuple[Point, Point]:
        """Corners of lowest and of highest coordinates [m]."""
        (x, y), (a, b) = self.center, self.size
        deepest = self.top + float(self._map.max())
        return (x - a / 2, y - b / 2, self.top), (x + a / 2, y + b / 2, deepest)

    def contains(self, x: FloatArray, y: FloatArray, z: FloatArray) -> NDArray[np.bool_]:
        """Whether points lie in the layer or on its boundary."""
        x, y, z = real_points(self.key, x, y, z)
        thickness, below = self.thickness_at(x, y), np.asarray(z, dtype=float) - self.top
        return np.asarray((thickness > 0) & (below >= 0) & (below <= thickness))

    def thickness_at(self, x: FloatArray, y: FloatArray) -> FloatArray:
        """Thickness [m] below points of the surface, 0 outside the rectangle; x, y broadcast."""
        rows, columns = self._map.shape
        across = (np.asarray(x, dtype=float) - self.center[0]) / self.size[0] + 0.5
        along = (np.asarray(y, dtype=float) - self.center[1]) / self.size[1] + 0.5
        within = (across >= 0) & (across <= 1) & (along >= 0) & (along <= 1)
        column, row = np.where(within, across, 0.0) * (columns - 1), np.where(within, along, 0.0) * (rows - 1)
        j, i = (np.minimum(t.astype(int), n - 2) for t, n in ((column, columns), (row, rows)))
        u, v = column - j, row - i
        nearer = self._map[i, j] * (1 - u) + self._map[i, j + 1] * u
        farther = self._map[i + 1, j] * (1 - u) + self._map[i + 1, j + 1] * u
        return np.where(within, nearer * (1 - v) + farther * v, 0.0)

    @cached_property
    def _map(self) -> FloatArray:
        """Thickness on a raster of at least 2 x 2 points [m]."""
        if self.thickness is not None:
            return np.full((2, 2), float(self.thickness))
        values = _read(str(self.file))
        rule = "a map of at least 2 x 2 numbers"
        require(
            values.ndim == 2 and min(values.shape) >= 2, self.key, "file", self.file, f"{rule}; it is {values.shape}"
        )
        good = bool(np.isfinite(values).all()) and values.min() >= 0 and values.max() > 0
        require(good, self.key, "file", self.file, "a map of finite thicknesses >= 0, some of them > 0")
        return values * self.thickness_unit


def _read(file: str) -> FloatArray:
    field, suffix = f"{Layer.key}.file", Path(file).suffix.lower()
    suffixes = (".npy", ".npz", *TEXT_FILES)
    require(suffix in suffixes, Layer.key, "file", file, f"a map of one of the types {', '.join(suffixes)}")
    if suffix not in TEXT_FILES:
        arrays = read_arrays(field, file)
        return arrays["thickness" if "thickness" in arrays else next(iter(arrays))]
    require(Path(file).is_file(), Layer.key, "file", file, "an existing file")
    try:
        rows = Path(file).read_text(encoding="utf-8").replace(",", " ").replace(";", " ").splitlines()
        return np.array([row.split() for row in rows if row.strip() and row.lstrip()[0] != "#"]).astype(float)
    except ValueError as problem:
        reason = (str(problem).strip().splitlines() or [type(problem).__name__])[0]
        raise SceneError(f"{field} must be a readable map of numbers (got {file!r}); {reason}") from problem


eigencontact_register = hook_for(Layer)
