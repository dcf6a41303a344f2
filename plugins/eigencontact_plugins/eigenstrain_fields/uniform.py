"""Uniform eigenstrain."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from eigencontact.plugin import FloatArray, Strain, TimedField, hook_for, mandel_strain

__all__ = ["Uniform"]


@dataclass(frozen=True, kw_only=True)
class Uniform(TimedField):
    """Uniform eigenstrain; ``eigenstrain = 1e-3`` of an inclusion is a short form of it.

    Parameters
    ----------
    value : number, three numbers or 3 x 3 matrix
        Tensor components [-], expansion positive: one number is isotropic, three are (xx, yy, zz).
    times, factors : tuple of float
        History; see `TimedField`.

    Examples
    --------
    >>> Uniform(value=1e-3).eigenstrain(np.zeros(2), np.zeros(2), np.zeros(2), 1.0)[:4, 0].tolist()
    [0.001, 0.001, 0.001, 0.0]
    """

    key: ClassVar[str] = "uniform"
    example: ClassVar[dict[str, Any]] = {"value": 1e-3}
    uniform: ClassVar[bool] = True
    references: ClassVar[tuple[str, ...]] = ("T. Mura, Micromechanics of Defects in Solids (1987), section 1",)

    value: Strain

    def __post_init__(self) -> None:
        super().__post_init__()
        mandel_strain(self.key, "value", self.value)

    def at(self, x: FloatArray, y: FloatArray, z: FloatArray) -> FloatArray:
        """Mandel eigenstrain at factor 1; see `TimedField`."""
        point_axes = (1,) * len(np.broadcast_shapes(x.shape, y.shape, z.shape))
        return mandel_strain(self.key, "value", self.value).reshape(6, *point_axes)


eigencontact_register = hook_for(Uniform)
