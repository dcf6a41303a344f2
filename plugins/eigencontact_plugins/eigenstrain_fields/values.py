"""What bundled eigenstrain fields share: spellings of a strain, and a history in time."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from eigencontact.plugin import EigenstrainField, real_points, require, to_mandel

__all__ = ["Direction", "Strain", "TimedField", "directed", "mandel_strain"]

FloatArray = NDArray[np.float64]
_Row = tuple[float, float, float]

#: One number (isotropic), three (xx, yy, zz), or a symmetric 3 x 3 matrix.
Strain = float | _Row | tuple[_Row, _Row, _Row]
#: How one number is spread over the components: all three alike, along the surface alone, or by three weights.
Direction = Literal["isotropic", "in-plane"] | _Row


def mandel_strain(key: str, field: str, value: Strain) -> FloatArray:
    """Mandel vector ``(6,)`` of a strain, refused unless finite and symmetric."""
    strain = np.asarray(value, dtype=float)
    rule = "a number, three numbers or a symmetric 3 x 3 matrix, finite [-]"
    require(strain.shape in ((), (3,), (3, 3)) and np.all(np.isfinite(strain)), key, field, value, rule)
    if strain.ndim < 2:
        strain = np.diag(np.broadcast_to(strain, 3))
    scale = float(np.abs(strain).max())
    require(np.all(np.abs(strain - strain.T) <= 1e-12 * scale), key, field, value, rule)
    xx, yy, zz, yz, xz, xy = (strain[i, j] for i, j in ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)))
    return to_mandel([xx, yy, zz, yz, xz, xy])


def directed(key: str, direction: Direction) -> FloatArray:
    """Mandel vector ``(6,)`` that one number of a profile multiplies."""
    named = {"isotropic": 1.0, "in-plane": (1.0, 1.0, 0.0)}
    if isinstance(direction, str):
        require(direction in named, key, "direction", direction, "'isotropic', 'in-plane' or three numbers")
        return mandel_strain(key, "direction", named[direction])  # type: ignore[arg-type]
    return mandel_strain(key, "direction", direction)


@dataclass(frozen=True, kw_only=True)
class TimedField(EigenstrainField):
    """An eigenstrain field times a factor that may change with time.

    Parameters
    ----------
    times, factors : tuple of float
        Points of the history: ascending times in load steps (1 ends the first), and the factor at each, linear between
        them and constant beyond. Without them the factor is 1.
    """

    times: tuple[float, ...] = ()
    factors: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        times, factors = np.asarray(self.times, dtype=float), np.asarray(self.factors, dtype=float)
        rule = "finite and ascending [load steps]"
        require(np.all(np.isfinite(times)) and np.all(np.diff(times) > 0), self.key, "times", self.times, rule)
        rule = f"{times.size} finite numbers, one for each of times"
        require(factors.shape == times.shape and np.all(np.isfinite(factors)), self.key, "factors", self.factors, rule)

    @property
    def varies(self) -> bool:
        """Whether the factor changes with time."""
        return len(set(self.factors)) > 1

    def factor(self, time: float) -> float:
        """Factor at a time in load steps."""
        return float(np.interp(time, self.times, self.factors)) if self.times else 1.0

    @abstractmethod
    def at(self, x: FloatArray, y: FloatArray, z: FloatArray) -> FloatArray:
        """Mandel eigenstrain at factor 1, of a shape that broadcasts to ``(6, ...)``."""

    def eigenstrain(self, x: FloatArray, y: FloatArray, z: FloatArray, time: float) -> FloatArray:
        """Mandel eigenstrain ``(6, ...)`` [-]; see `EigenstrainField`."""
        x, y, z = real_points(self.key, x, y, z)
        shape = np.broadcast_shapes(x.shape, y.shape, z.shape)
        value = self.at(x, y, z)
        return np.array(np.broadcast_to(self.factor(time) * value, (6, *shape)))
