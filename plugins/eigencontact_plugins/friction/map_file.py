"""Map of the coefficient of friction, from a file."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from eigencontact.plugin import FloatArray, GriddedData, SceneError, read_gridded

__all__ = ["FrictionMap", "read_map"]


@dataclass(frozen=True, kw_only=True, eq=False)
class FrictionMap:
    """Coefficients at the points of a lattice.

    Attributes
    ----------
    data : GriddedData
        ``coefficient`` [-], zero or positive, on (y, x).
    """

    data: GriddedData

    @property
    def x(self) -> FloatArray:
        """Ascending coordinates [m]."""
        return self.data.axes[1]

    @property
    def y(self) -> FloatArray:
        """Ascending coordinates [m]."""
        return self.data.axes[0]

    def at(self, x: FloatArray, y: FloatArray, method: Literal["linear", "nearest"]) -> FloatArray:
        """Values ``(ny, nx)`` at points that broadcast; NaN further out than half a step from the outermost points."""
        outside = _outside(self.x, x) | _outside(self.y, y)
        return np.where(outside, np.nan, self.data.at("coefficient", y, x, method=method))


def _outside(axis: FloatArray, values: FloatArray) -> NDArray[np.bool_]:
    """Whether coordinates lie more than half a step outside an axis; round-off of a step counts as inside."""
    low, high = 0.5 * (1 + 1e-9) * (axis[1] - axis[0]), 0.5 * (1 + 1e-9) * (axis[-1] - axis[-2])
    return np.asarray((values < axis[0] - low) | (values > axis[-1] + high))


def read_map(where: str, file: str, unit: float) -> FrictionMap:
    """Map of a file; `where` names the law in messages, `unit` is metres per unit of the file's coordinates."""
    data = read_gridded(f"{where}.file", file, {"coefficient": "1"}, axes=("y", "x"), unit=unit)
    values = data.values["coefficient"]
    if values.min() < 0:
        reason = f"{int((values < 0).sum())} of {values.size} are negative, the smallest is {float(values.min())!r}"
        rule = "a map of coefficients that are zero or positive, and finite [-]"
        raise SceneError(f"{where}.file must be {rule} (got {file!r}); {reason}")
    return FrictionMap(data=data)
