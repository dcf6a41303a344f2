"""Eigenstrain tabulated over the depth."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Literal

import numpy as np

from eigencontact.plugin import FloatArray, Length, Row, TimedField, hook_for, mandel_strain, require

__all__ = ["DepthProfile"]


#: Distribution of one value over the components: equal, only along the surface, or by three weights.
Direction = Literal["isotropic", "in-plane"] | Row


@dataclass(frozen=True, kw_only=True)
class DepthProfile(TimedField):
    """Eigenstrain by depth, linear between the given depths and zero below the last.

    Parameters
    ----------
    depths : tuple of float
        Ascending depths [m]; the value is constant above the first.
    values : tuple of float
        Eigenstrain [-] at each depth, expansion positive.
    direction : "isotropic", "in-plane" or (xx, yy, zz)
        Tensor that the values multiply: isotropic, only x and y, or three weights.
    times, factors : tuple of float
        History; see `TimedField`.

    Examples
    --------
    >>> field = DepthProfile(depths=(0.0, 2.0), values=(4e-3, 0.0), direction="in-plane")
    >>> field.eigenstrain(np.zeros(1), np.zeros(1), np.ones(1), 1.0)[:3, 0].tolist()
    [0.002, 0.002, 0.0]
    """

    key: ClassVar[str] = "depth-profile"
    example: ClassVar[dict[str, Any]] = {"depths": [0.0, 2e-3], "values": [4e-3, 0.0]}
    references: ClassVar[tuple[str, ...]] = ("T. Mura, Micromechanics of Defects in Solids (1987), section 1",)

    depths: tuple[Length, ...]
    values: tuple[float, ...]
    direction: Direction = "isotropic"

    def __post_init__(self) -> None:
        super().__post_init__()
        depths, values = np.asarray(self.depths, dtype=float), np.asarray(self.values, dtype=float)
        good = depths.size > 0 and np.all(np.isfinite(depths)) and np.all(np.diff(depths) > 0)
        require(good, self.key, "depths", self.depths, "at least one, finite and ascending [m]")
        rule = f"{depths.size} finite numbers, one for each of depths [-]"
        require(values.shape == depths.shape and np.all(np.isfinite(values)), self.key, "values", self.values, rule)
        _directed(self.key, self.direction)

    def at(self, x: FloatArray, y: FloatArray, z: FloatArray) -> FloatArray:
        """Mandel eigenstrain at factor 1; see `TimedField`."""
        depth = np.broadcast_to(z, np.broadcast_shapes(x.shape, y.shape, z.shape))
        return np.multiply.outer(
            _directed(self.key, self.direction), np.interp(depth, self.depths, self.values, right=0.0)
        )


def _directed(key: str, direction: Direction) -> FloatArray:
    """Mandel vector ``(6,)`` for a unit value of a profile."""
    directions = {"isotropic": 1.0, "in-plane": (1.0, 1.0, 0.0)}
    if isinstance(direction, str):
        require(direction in directions, key, "direction", direction, "'isotropic', 'in-plane' or three numbers")
        return mandel_strain(key, "direction", directions[direction])  # type: ignore[arg-type]
    return mandel_strain(key, "direction", direction)


eigencontact_register = hook_for(DepthProfile)
