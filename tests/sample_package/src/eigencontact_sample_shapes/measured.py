"""Eigenstrain measured at some depths, as a table of a stranger's own kind of file."""

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import ClassVar

import numpy as np

from eigencontact.plugin import DataFile, EigenstrainField, SceneError, hookimpl, require


@dataclass(frozen=True, kw_only=True)
class Measured(EigenstrainField):
    """Isotropic eigenstrain of two columns of text, depth [m] and strain [-]; linear between them, constant beyond.

    Parameters
    ----------
    measurement : str
        The file. `DataFile` makes a relative path count from the scene, and a changed file another scene.
    factor : float
        The strain is multiplied by it [-].
    """

    key: ClassVar[str] = "measured"
    references: ClassVar[tuple[str, ...]] = ("elementary: linear interpolation",)

    measurement: DataFile
    factor: float = 1.0

    def __post_init__(self):
        require(np.isfinite(self.factor), self.key, "factor", self.factor, "finite [-]")
        _ = self._table

    @cached_property
    def _table(self):
        try:
            depth, strain = np.loadtxt(self.measurement, unpack=True, ndmin=2)
        except (OSError, ValueError) as problem:
            raise SceneError(
                f"{self.key}.measurement must be a file of two columns, depth and strain (got {self.measurement!r}); "
                f"{problem}"
            ) from problem
        good = np.isfinite(strain).all() and np.isfinite(depth).all() and (np.diff(depth) > 0).all()
        require(good, self.key, "measurement", Path(self.measurement).name, "of finite numbers at ascending depths")
        return depth, strain

    def eigenstrain(self, x, y, z, time):  # noqa: ARG002
        """Mandel eigenstrain ``(6, ...)``."""
        out = np.zeros((6, *np.broadcast_shapes(np.shape(x), np.shape(y), np.shape(z))))
        out[:3] = self.factor * np.interp(z, *self._table)
        return out


@hookimpl
def eigencontact_register():
    """Register the field."""
    return [Measured]
