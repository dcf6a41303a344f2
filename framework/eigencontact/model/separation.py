"""The initial gap: the sum of the geometries of a scene."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from eigencontact.errors import EigencontactError, PluginError
from eigencontact.plugin import Geometry

__all__ = ["sum_separations"]

FloatArray = NDArray[np.float64]


def sum_separations(geometries: Sequence[Geometry], x: FloatArray, y: FloatArray) -> FloatArray:
    """Sum of separations at points that broadcast [m].

    Raises
    ------
    PluginError
        A geometry that fails, or answers with another shape; it is named.
    """
    shape = np.broadcast_shapes(x.shape, y.shape)
    total = np.zeros(shape)
    for geometry in geometries:
        try:
            total += geometry.separation(x, y)
        except EigencontactError:
            raise
        except Exception as problem:
            raise PluginError(
                f"geometry {geometry.key!r} must return numbers that broadcast to shape {shape} "
                f"(got {type(problem).__name__}: {problem})"
            ) from problem
    return total
