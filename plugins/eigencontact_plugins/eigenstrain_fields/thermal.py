"""Thermal expansion for a temperature that decreases with depth."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, ClassVar

import numpy as np

from eigencontact.plugin import FloatArray, Length, TimedField, Unit, hook_for, require

__all__ = ["Thermal"]


@dataclass(frozen=True, kw_only=True)
class Thermal(TimedField):
    """Thermal expansion alpha dT exp(-z/d), equal in all directions.

    Parameters
    ----------
    expansion : float
        Linear coefficient of thermal expansion alpha [1/K].
    temperature : float
        Rise of the temperature at the surface dT [K]; negative for cooling. Give a plain number or kelvin.
    decay_depth : float
        d [m], depth at which the temperature rise is 1/e of that at the surface; by default the rise is uniform.
    times, factors : tuple of float
        History of the temperature; see `TimedField`.

    Notes
    -----
    The exponential is the profile of heating by light, a beam or a quasi-stationary heat flow. For other profiles use
    ``depth-profile`` with alpha dT at depths.

    Examples
    --------
    >>> Thermal(expansion=1e-5, temperature=100.0).eigenstrain(np.zeros(1), np.zeros(1), np.ones(1), 1.0)[0].tolist()
    [0.001]
    """

    key: ClassVar[str] = "thermal"
    example: ClassVar[dict[str, Any]] = {"expansion": 1e-5, "temperature": 100.0}
    references: ClassVar[tuple[str, ...]] = (
        "W. Nowacki, Thermoelasticity (1986), section 1",
        "T. Mura, Micromechanics of Defects in Solids (1987), section 1",
    )

    expansion: Annotated[float, Unit("1/K", "an expansion per kelvin")]
    temperature: Annotated[float, Unit("K", "a difference of temperatures")]
    decay_depth: Length = float("inf")

    def __post_init__(self) -> None:
        super().__post_init__()
        require(np.isfinite(self.expansion), self.key, "expansion", self.expansion, "finite [1/K]")
        require(np.isfinite(self.temperature), self.key, "temperature", self.temperature, "finite [K]")
        require(self.decay_depth > 0, self.key, "decay_depth", self.decay_depth, "positive [m]")

    @property
    def uniform(self) -> bool:  # type: ignore[override]
        """Whether the temperature is equal at all depths."""
        return bool(np.isinf(self.decay_depth))

    def at(self, x: FloatArray, y: FloatArray, z: FloatArray) -> FloatArray:
        """Mandel eigenstrain at factor 1; see `TimedField`."""
        depth = np.broadcast_to(z, np.broadcast_shapes(x.shape, y.shape, z.shape))
        strain = self.expansion * self.temperature * np.exp(-depth / self.decay_depth)
        return np.asarray(np.multiply.outer(np.array([1.0, 1.0, 1.0, 0.0, 0.0, 0.0]), strain))


eigencontact_register = hook_for(Thermal)
