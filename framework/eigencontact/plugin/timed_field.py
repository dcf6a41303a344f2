"""Base of eigenstrain fields that follow a history in time, and the spellings of a strain in a table."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass

import numpy as np

from eigencontact.core.arrays import FloatArray, real_points
from eigencontact.core.rotation import Row
from eigencontact.core.tensors import to_mandel
from eigencontact.errors import require
from eigencontact.plugin.inclusion import EigenstrainField

__all__ = ["Strain", "TimedField", "mandel_strain"]


#: Annotation of a field that holds a strain: one number (isotropic), three (xx, yy, zz), or a symmetric 3 x 3 matrix.
Strain = float | Row | tuple[Row, Row, Row]


def mandel_strain(key: str, field: str, value: Strain) -> FloatArray:
    """Mandel vector ``(6,)`` of a strain, refused unless finite and symmetric; `key` and `field` are for the message.

    Examples
    --------
    >>> mandel_strain("swelling", "value", 1e-3).tolist()
    [0.001, 0.001, 0.001, 0.0, 0.0, 0.0]
    """
    strain = np.asarray(value, dtype=float)
    rule = "a number, three numbers or a symmetric 3 x 3 matrix, finite [-]"
    require(strain.shape in ((), (3,), (3, 3)) and np.all(np.isfinite(strain)), key, field, value, rule)
    if strain.ndim < 2:
        strain = np.diag(np.broadcast_to(strain, 3))
    scale = float(np.abs(strain).max())
    require(np.all(np.abs(strain - strain.T) <= 1e-12 * scale), key, field, value, rule)
    xx, yy, zz, yz, xz, xy = (strain[i, j] for i, j in ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)))
    return to_mandel([xx, yy, zz, yz, xz, xy])


@dataclass(frozen=True, kw_only=True)
class TimedField(EigenstrainField):
    """Eigenstrain field times a factor that may change with time: derive from it and write `at`.

    A class that has a ``__post_init__`` of its own calls ``super().__post_init__()`` in it.

    Parameters
    ----------
    times, factors : tuple of float
        Points of the history: ascending times in load steps (1 ends the first), and the factor at each, linear between
        them and constant beyond. Without them the factor is 1.

    Examples
    --------
    >>> class Heat(TimedField):
    ...     key = "heat"
    ...     def at(self, x, y, z):
    ...         return np.array([1e-3] * 3 + [0.0] * 3).reshape(6, *(1,) * np.ndim(z))
    >>> Heat(times=(0.0, 2.0), factors=(0.0, 1.0)).eigenstrain(0.0, 0.0, np.ones(1), 1.0)[:, 0].tolist()
    [0.0005, 0.0005, 0.0005, 0.0, 0.0, 0.0]
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
