"""Boxes of equal cells in space, and their relative positions."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from eigencontact.core.array_types import FloatArray
from eigencontact.errors import require

__all__ = ["Cells", "offset_in_cells"]

Point = tuple[float, float, float]

# Distance in cells below which an offset counts as a multiple of half a cell.
_SNAP = 1e-9


@dataclass(frozen=True, kw_only=True)
class Cells:
    """A box of cells, or the lattice of their centres.

    Parameters
    ----------
    first : (float, float, float)
        Centre (x, y, z) of the first cell [m]; z into the body, surface z = 0.
    pitch : (float, float, float)
        Edges (dx, dy, dz) of a cell [m].
    shape : (int, int, int)
        Number of cells along (z, y, x), in the order of array indices.
    """

    first: Point
    pitch: Point
    shape: tuple[int, int, int]

    def __post_init__(self) -> None:
        require(np.isfinite(self.first).all(), "cells", "first", self.first, "finite [m]")
        require(all(0 < d < np.inf for d in self.pitch), "cells", "pitch", self.pitch, "positive and finite [m]")
        require(min(self.shape) >= 1, "cells", "shape", self.shape, "at least 1 cell each way")

    def centres(self, axis: int) -> FloatArray:
        """Centres along x, y or z (axis 0, 1, 2) [m]."""
        return np.asarray(self.first[axis] + np.arange(self.shape[2 - axis]) * self.pitch[axis])

    def window_cells(self, window: tuple[slice, slice, slice]) -> Cells:
        """Cells of a window along (z, y, x).

        Examples
        --------
        >>> box = Cells(first=(0.0, 0.0, 0.05), pitch=(0.1, 0.1, 0.1), shape=(4, 1, 8))
        >>> box.window_cells((slice(1, 3), slice(0, 1), slice(2, 6))).shape
        (2, 1, 4)
        """
        x, y, z = (float(self.centres(axis)[window[2 - axis].start]) for axis in range(3))
        k, j, i = (span.stop - span.start for span in window)
        return Cells(first=(x, y, z), pitch=self.pitch, shape=(k, j, i))

    @property
    def flush(self) -> bool:
        """Whether the upper face lies in the surface."""
        return abs(self.first[2] - 0.5 * self.pitch[2]) <= _SNAP * self.pitch[2]

    @property
    def points(self) -> int:
        """Number of cells."""
        nz, ny, nx = self.shape
        return nz * ny * nx


def offset_in_cells(source: Cells, target: Cells) -> tuple[float, float, float]:
    """Position of the first target relative to the first source along (z, y, x), in cells.

    Multiples of half a cell are exact.

    Examples
    --------
    >>> box = Cells(first=(0.0, 0.0, 0.05), pitch=(0.1, 0.1, 0.1), shape=(2, 2, 2))
    >>> points = Cells(first=(0.3, -0.1, 0.1), pitch=(0.1, 0.1, 0.1), shape=(2, 4, 4))
    >>> offset_in_cells(box, points)
    (0.5, -1.0, 3.0)
    """
    equal_pitch = np.allclose(source.pitch, target.pitch, rtol=1e-12, atol=0.0)
    require(equal_pitch, "cells", "pitch of targets", target.pitch, f"that of the sources, {source.pitch} [m]")
    offset = (np.array(target.first) - source.first) / source.pitch
    x, y, z = (snapped(float(value)) for value in offset)
    return z, y, x


def snapped(value: float) -> float:
    """The nearest multiple of a half if the value equals it within round-off, otherwise the value."""
    near = round(2.0 * value) / 2.0
    return near if abs(value - near) <= _SNAP * max(1.0, abs(value)) else value
