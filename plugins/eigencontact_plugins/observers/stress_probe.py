"""Observer of the stress at points below the surface, in every step."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, Literal

import numpy as np

from eigencontact.plugin import Length, Observer, StepView, hook_for, require

__all__ = ["StressProbe"]


@dataclass(frozen=True, kw_only=True)
class StressProbe(Observer):
    """Scalar of the stress at points of a body.

    Parameters
    ----------
    points : tuple of (float, float, float)
        Points (x, y, z) [m], z into the body.
    quantity : {"von_mises", "tresca", "hydrostatic"}
        Scalar of the stress [Pa].
    body : {1, 2}
        Body with the points.

    Notes
    -----
    The numbers are ``<quantity>_1``, ``<quantity>_2`` ... in the order of the points, and ``largest``.
    """

    key: ClassVar[str] = "stress-probe"
    example: ClassVar[dict[str, Any]] = {"points": [[0.0, 0.0, 1e-6]]}

    points: tuple[tuple[Length, Length, Length], ...]
    quantity: Literal["von_mises", "tresca", "hydrostatic"] = "von_mises"
    body: Literal[1, 2] = 1

    def __post_init__(self) -> None:
        good = len(self.points) > 0 and all(len(p) == 3 and np.isfinite(p).all() and p[2] >= 0 for p in self.points)
        require(good, self.key, "points", self.points, "at least one point (x, y, z) of finite lengths, z >= 0 [m]")

    @property
    def units(self) -> Mapping[str, str]:
        """See `Observer.units`."""
        return dict.fromkeys([*self._names, "largest"], "Pa")

    @property
    def regions(self) -> Mapping[str, Mapping[str, Any]]:
        """See `Observer.regions`."""
        return {"points": {"shape": "points", "points": self.points, "body": self.body, "quantities": [self.quantity]}}

    def observe(self, step: StepView) -> Mapping[str, float]:
        """Values at the points [Pa], and ``largest``, the value of largest magnitude."""
        values = step.regions["points"].fields[self.quantity]
        return dict(zip(self._names, values, strict=True)) | {"largest": values[np.abs(values).argmax()]}

    @property
    def _names(self) -> list[str]:
        return [f"{self.quantity}_{number}" for number in range(1, len(self.points) + 1)]


eigencontact_register = hook_for(StressProbe)
