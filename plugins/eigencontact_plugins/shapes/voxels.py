"""Voxels of one number in a three-dimensional image: a grain, a phase, a pore."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from eigencontact.plugin import (
    DataFile,
    FloatArray,
    InclusionShape,
    Length,
    Place,
    hook_for,
    read_arrays,
    real_points,
    require,
)

__all__ = ["VoxelShape"]

Point = tuple[float, float, float]


@dataclass(frozen=True, kw_only=True)
class VoxelShape(InclusionShape):
    """Region of the voxels with one number in an array of integers, such as a segmented image.

    Parameters
    ----------
    file : str
        ``.npy``, ``.npz`` or NetCDF with an array ``labels (nz, ny, nx)``, or its only one: z points into the body.
    spacing : (float, float, float)
        Edges (dx, dy, dz) of a voxel [m].
    origin : (float, float, float)
        Corner of lowest x, y and z of the first voxel [m].
    value : int
        Number of the voxels in the region.

    Notes
    -----
    The shape has no potentials: the framework divides it into cells. This is exact if faces of cells and voxels
    coincide; other cells have volume fractions.
    """

    key: ClassVar[str] = "voxels"
    references: ClassVar[tuple[str, ...]] = ("S. Liu & Q. Wang 2005, J. Appl. Mech. 72, 871 (sum over cuboids)",)

    file: DataFile
    spacing: tuple[Length, Length, Length]
    origin: Place = (0.0, 0.0, 0.0)
    value: int = 1

    def __post_init__(self) -> None:
        good = len(self.spacing) == 3 and all(0 < edge < np.inf for edge in self.spacing)
        require(good, self.key, "spacing", self.spacing, "three positive, finite lengths (dx, dy, dz) [m]")
        good = len(self.origin) == 3 and bool(np.isfinite(self.origin).all())
        require(good, self.key, "origin", self.origin, "three finite lengths (x, y, z) [m]")
        _ = self._filled  # read and check the file before the run

    @cached_property
    def _filled(self) -> tuple[tuple[int, int, int], NDArray[np.bool_]]:
        """Indices (z, y, x) of the first voxel of the box around the region, and the filled voxels of the box."""
        arrays = read_arrays(f"{self.key}.file", self.file)
        rule = "a file with an array of whole numbers of three dimensions, labels (nz, ny, nx)"
        require("labels" in arrays or len(arrays) == 1, self.key, "file", self.file, rule)
        labels = arrays["labels" if "labels" in arrays else next(iter(arrays))]
        require(labels.ndim == 3 and bool(np.all(labels == np.round(labels))), self.key, "file", self.file, rule)
        filled = labels == self.value
        if not filled.any():
            numbers = np.unique(labels).astype(int).tolist()
            listed = ", ".join(map(str, numbers[:12])) + (" ..." if len(numbers) > 12 else "")
            require(False, self.key, "value", self.value, f"the number of at least one voxel, {listed}")
        box = []
        for axis in range(3):
            planes = np.flatnonzero(filled.any(axis=tuple({0, 1, 2} - {axis})))
            box.append(slice(int(planes[0]), int(planes[-1]) + 1))
        return (box[0].start, box[1].start, box[2].start), filled[tuple(box)].copy()

    @property
    def bounds(self) -> tuple[Point, Point]:
        """Corners of lowest and of highest coordinates [m]."""
        first, filled = self._filled
        low = np.array(self.origin) + np.array(first[::-1]) * self.spacing
        high = np.array(self.origin) + (np.array(first[::-1]) + filled.shape[::-1]) * self.spacing
        return tuple(low.tolist()), tuple(high.tolist())

    def contains(self, x: FloatArray, y: FloatArray, z: FloatArray) -> NDArray[np.bool_]:
        """Whether points lie in a voxel of the region; a boundary belongs to the voxel of higher coordinates."""
        (low, _), filled = self.bounds, self._filled[1]
        points = zip(real_points(self.key, x, y, z), low, self.spacing, filled.shape[::-1], strict=True)
        numbers, inside = [], np.array(True)
        for coordinate, begin, edge, count in points:
            number = np.floor((np.asarray(coordinate) - begin) / edge)
            inside = inside & (number >= 0) & (number < count)
            numbers.append(np.clip(number, 0, count - 1).astype(int))
        return np.asarray(inside & filled[numbers[2], numbers[1], numbers[0]])

    def volume_fractions(self, low: Point, edges: Point, shape: tuple[int, int, int]) -> FloatArray:
        """See `HasVolumeFractions`: exact, because overlaps of boxes are products of overlaps along the axes."""
        begin, fractions = self.bounds[0], self._filled[1].astype(float)
        for axis in range(3):  # x, y, z; arrays are (z, y, x)
            place = 2 - axis
            cells = low[axis] + np.arange(shape[place] + 1) * edges[axis]
            voxels = begin[axis] + np.arange(fractions.shape[place] + 1) * self.spacing[axis]
            shared = np.minimum(cells[1:, None], voxels[None, 1:]) - np.maximum(cells[:-1, None], voxels[None, :-1])
            share = np.clip(shared / edges[axis], 0.0, 1.0)
            fractions = np.moveaxis(np.tensordot(share, fractions, axes=(1, place)), 0, place)
        nearly = np.round(fractions)  # faces that coincide within round-off give no slivers
        return np.clip(np.where(np.abs(fractions - nearly) < 1e-9, nearly, fractions), 0.0, 1.0)


eigencontact_register = hook_for(VoxelShape)
