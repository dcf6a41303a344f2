"""Region of an inclusion as finite elements take it: without later inclusions, below the worn surface."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigencontact_verification.fem.model import Region

__all__ = ["ShapeRegion", "shapes_meet"]

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]
Triple = tuple[float, float, float]


@dataclass(frozen=True, kw_only=True, eq=False)
class ShapeRegion:
    """Region of a shape without later shapes, raised by the worn depth above it.

    A dataclass, because cases are sent to other processes and closures cannot be.

    Attributes
    ----------
    shape : object
        With ``contains(x, y, z)`` and ``bounds``.
    later : tuple of object
        Shapes that replace this shape where they overlap it.
    worn : (ny, nx) float64 or None
        Worn depth [m].
    edges : (x, y)
        Edges of the cells of `worn`.
    """

    shape: Any
    later: tuple[Any, ...] = ()
    worn: FloatArray | None = None
    edges: tuple[FloatArray, FloatArray] | None = None

    def __call__(self, x: FloatArray, y: FloatArray, z: FloatArray) -> BoolArray:
        """Whether points lie in the region."""
        x, y, z = np.broadcast_arrays(x, y, z)
        if self.worn is not None and self.edges is not None:
            column = np.clip(np.searchsorted(self.edges[0], x) - 1, 0, self.worn.shape[1] - 1)
            row = np.clip(np.searchsorted(self.edges[1], y) - 1, 0, self.worn.shape[0] - 1)
            z = z + self.worn[row, column]
        inside = np.asarray(self.shape.contains(x, y, z), dtype=bool)
        for shape in self.later:
            inside = inside & ~np.asarray(shape.contains(x, y, z), dtype=bool)
        return inside

    def with_eigenstrain(self, eigenstrain: FloatArray) -> Region:
        """Region of the finite elements with a uniform eigenstrain (3, 3)."""
        return Region(contains=self, bounds=self.bounds, eigenstrain=eigenstrain)

    @property
    def bounds(self) -> tuple[Triple, Triple]:
        """Box around the region, below the surface."""
        low, high = (tuple(float(value) for value in corner) for corner in self.shape.bounds)
        worn = 0.0 if self.worn is None else float(self.worn.max())
        top = max(low[2] - worn, 0.0)
        if top < 1e-9 * (high[2] - low[2]):
            top = 0.0
        return (low[0], low[1], top), (high[0], high[1], high[2])


def shapes_meet(first: Any, second: Any) -> bool:
    """Whether the boxes of two shapes overlap."""
    (first_low, first_high), (low, high) = first.bounds, second.bounds
    corners = zip(first_low, first_high, low, high, strict=True)
    return all(start < first_end and first_start < end for first_start, first_end, start, end in corners)
