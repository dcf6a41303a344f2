"""Eigenstrain on a regular lattice, read from a file."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import ClassVar

import numpy as np

from eigencontact.plugin import (
    DataFile,
    FloatArray,
    GriddedData,
    TimedField,
    hook_for,
    read_gridded,
    to_mandel,
)

__all__ = ["FromFile"]


@dataclass(frozen=True, kw_only=True)
class FromFile(TimedField):
    """Eigenstrain at the points of a lattice from a file, linear between them and zero outside.

    Parameters
    ----------
    file : str
        ``.npz``, or NetCDF, with ``x``, ``y``, ``z`` [m], ascending, and ``eigenstrain`` [-]: tensor components xx, yy,
        zz, yz, xz, xy ``(6, nz, ny, nx)``, or one isotropic value ``(nz, ny, nx)``; or text with columns x y z and the
        isotropic value. See `eigencontact.plugin.read_gridded`.
    variable : str
        Name of the eigenstrain in the file.
    times, factors : tuple of float
        History; see `TimedField`.
    """

    key: ClassVar[str] = "from-file"
    references: ClassVar[tuple[str, ...]] = ("T. Mura, Micromechanics of Defects in Solids (1987), section 1",)

    file: DataFile
    variable: str = "eigenstrain"

    def __post_init__(self) -> None:
        super().__post_init__()
        _ = self._data  # read and check the file before the run

    @cached_property
    def _data(self) -> GriddedData:
        """Mandel values ``(6, nz, ny, nx)``."""
        data = read_gridded(f"{self.key}.file", self.file, {self.variable: "1"}, components={self.variable: 6})
        values = data.values[self.variable]
        plain = values if values.ndim == 4 else np.multiply.outer(np.array([1.0, 1, 1, 0, 0, 0]), values)
        return replace(data, values={self.variable: to_mandel(plain)})

    def at(self, x: FloatArray, y: FloatArray, z: FloatArray) -> FloatArray:
        """Mandel eigenstrain at factor 1; see `TimedField`."""
        return self._data.at(self.variable, z, y, x, outside="zero")


eigencontact_register = hook_for(FromFile)
