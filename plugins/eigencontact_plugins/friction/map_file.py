"""Map of the coefficient of friction, from a file."""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import NDArray

from eigencontact.plugin import FloatArray, GriddedData, SceneError, read_gridded

__all__ = ["map_at", "read_map"]


def map_at(data: GriddedData, x: FloatArray, y: FloatArray, method: Literal["linear", "nearest"]) -> FloatArray:
    """Coefficients ``(ny, nx)`` at points; NaN more than half a step outside the outermost points."""
    outside = _outside(data.axes[1], x) | _outside(data.axes[0], y)
    return np.where(outside, np.nan, data.at("coefficient", y, x, method=method))


def _outside(axis: FloatArray, values: FloatArray) -> NDArray[np.bool_]:
    """Whether coordinates are more than half a step outside an axis; round-off of a step counts as inside."""
    low, high = 0.5 * (1 + 1e-9) * (axis[1] - axis[0]), 0.5 * (1 + 1e-9) * (axis[-1] - axis[-2])
    return np.asarray((values < axis[0] - low) | (values > axis[-1] + high))


def read_map(where: str, file: str, unit: float) -> GriddedData:
    """Coefficients of a file, nonnegative, on (y, x).

    `where` names the law in messages, `unit` is metres per unit of the file's coordinates.
    """
    data = read_gridded(f"{where}.file", file, {"coefficient": "1"}, axes=("y", "x"), unit=unit)
    values = data.values["coefficient"]
    if values.min() < 0:
        reason = f"{int((values < 0).sum())} of {values.size} are negative, the smallest is {float(values.min())!r}"
        rule = "a map of coefficients that are zero or positive, and finite [-]"
        raise SceneError(f"{where}.file must be {rule} (got {file!r}); {reason}")
    return data
