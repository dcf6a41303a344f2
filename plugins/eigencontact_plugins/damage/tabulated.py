"""Damage by a measured curve."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from eigencontact.plugin import (
    DataFile,
    FloatArray,
    PlasticDamage,
    StrainDamage,
    hook_for,
    read_columns,
    require,
)

__all__ = ["TabulatedDamage"]


@dataclass(frozen=True, kw_only=True)
class TabulatedDamage(PlasticDamage, StrainDamage):
    """Damage by points of a curve over plastic strain, or over strain: linear between points, constant after the last.

    Parameters
    ----------
    strain, values : tuple of float, optional
        Equivalent plastic strain [-], or equivalent strain of a brittle material, ascending from 0, and D,
        non-decreasing from 0, below 1.
    file : str, optional
        Text file of two columns, strain and D, in place of the arrays.
    length : float, optional
        Radius of averaging [m]; see `DamageLaw`.
    """

    key: ClassVar[str] = "tabulated"
    example: ClassVar[dict[str, Any]] = {"strain": [0, 0.01, 0.1], "values": [0, 0.3, 0.4]}
    references: ClassVar[tuple[str, ...]] = ("elementary: linear interpolation",)

    strain: tuple[float, ...] = ()
    values: tuple[float, ...] = ()
    file: DataFile | None = None

    def __post_init__(self) -> None:
        has_table = bool(self.strain or self.values)
        require(has_table != (self.file is not None), self.key, "file", self.file, "given, or else strain and values")
        strain, values = self._curve
        name = "file" if self.file is not None else "strain"
        equal_sizes = strain.size == values.size >= 2
        require(equal_sizes, self.key, name, (strain.size, values.size), "at least two strains, and as many values")
        rising = bool(strain[0] == 0 and np.all(np.diff(strain) > 0) and np.isfinite(strain[-1]))
        require(rising, self.key, name, strain.tolist(), "strains that ascend from 0 [-]")
        name = "file" if self.file is not None else "values"
        good = bool(values[0] == 0 and np.all(np.diff(values) >= 0) and values[-1] < 1)
        require(good, self.key, name, values.tolist(), "damage from 0, never falling, below 1 [-]")

    @cached_property
    def _curve(self) -> tuple[FloatArray, FloatArray]:
        if self.file is None:
            return np.array(self.strain, dtype=float), np.array(self.values, dtype=float)
        columns = read_columns(f"{self.key}.file", self.file, ("strain", "damage"))
        return columns[0], columns[1]

    def damage(self, driven: FloatArray) -> tuple[FloatArray, FloatArray]:
        """See `DamageLaw.damage`."""
        strain, values = self._curve
        slopes = np.append(np.diff(values) / np.diff(strain), 0.0)
        return np.interp(driven, strain, values), slopes[np.searchsorted(strain, driven, side="right") - 1]


eigencontact_register = hook_for(TabulatedDamage)
