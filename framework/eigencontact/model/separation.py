"""The initial gap: the sum of the geometries of a scene."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.arrays import real_answer
from eigencontact.plugin import Geometry

__all__ = ["sum_separations"]

FloatArray = NDArray[np.float64]


def sum_separations(geometries: Sequence[Geometry], x: FloatArray, y: FloatArray) -> FloatArray:
    """Sum of separations at points that broadcast [m].

    Raises
    ------
    PluginError
        A geometry that answers with anything but real numbers of this shape; it is named.
    """
    shape = np.broadcast_shapes(x.shape, y.shape)
    total = np.zeros(shape)
    for geometry in geometries:
        total += real_answer(geometry.separation(x, y), f"separation of geometry {geometry.key!r}", shape)
    return total
