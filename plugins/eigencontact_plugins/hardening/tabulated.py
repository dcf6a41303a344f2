"""Hardening by a measured curve."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from eigencontact.plugin import (
    DataFile,
    FloatArray,
    IsotropicHardening,
    Stress,
    hook_for,
    read_columns,
    require,
)

__all__ = ["Tabulated"]


@dataclass(frozen=True, kw_only=True)
class Tabulated(IsotropicHardening):
    """Flow stress by points of a curve: linear between points, constant after the last.

    Parameters
    ----------
    strain, stress : tuple of float, optional
        Equivalent plastic strain [-], from 0 upwards, and flow stress [Pa], positive.
    file : str, optional
        Text file of two columns, plastic strain [-] and flow stress [Pa], instead of the arrays.
    """

    key: ClassVar[str] = "tabulated"
    example: ClassVar[dict[str, Any]] = {"strain": [0, 0.01, 0.1], "stress": ["1 GPa", "1.2 GPa", "1.5 GPa"]}
    references: ClassVar[tuple[str, ...]] = ("elementary: linear interpolation",)

    strain: tuple[float, ...] = ()
    stress: tuple[Stress, ...] = ()
    file: DataFile | None = None

    def __post_init__(self) -> None:
        has_table = bool(self.strain or self.stress)
        require(has_table != (self.file is not None), self.key, "file", self.file, "given, or else strain and stress")
        strain, stress = self._curve
        name = "file" if self.file is not None else "strain"
        equal_sizes = strain.size == stress.size >= 2
        require(equal_sizes, self.key, name, (strain.size, stress.size), "at least two strains, and as many stresses")
        rising = bool(strain[0] == 0 and np.all(np.diff(strain) > 0) and np.isfinite(strain[-1]))
        require(rising, self.key, name, strain.tolist(), "plastic strains that ascend from 0 [-]")
        name = "file" if self.file is not None else "stress"
        good = bool(np.all((stress > 0) & (stress < np.inf)))
        require(good, self.key, name, stress.tolist(), "positive and finite [Pa]")

    @cached_property
    def _curve(self) -> tuple[FloatArray, FloatArray]:
        if self.file is None:
            return np.array(self.strain, dtype=float), np.array(self.stress, dtype=float)
        columns = read_columns(f"{self.key}.file", self.file, ("plastic-strain", "flow-stress"))
        return columns[0], columns[1]

    def flow_stress(self, p: FloatArray) -> tuple[FloatArray, FloatArray]:
        """See `IsotropicHardening.flow_stress`."""
        strain, stress = self._curve
        slopes = np.append(np.diff(stress) / np.diff(strain), 0.0)
        piece = np.searchsorted(strain, p, side="right") - 1
        return np.interp(p, strain, stress), slopes[piece]


eigencontact_register = hook_for(Tabulated)
