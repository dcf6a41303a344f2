"""Observer of the plastic zone of a body: its extent and its strain."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np

from eigencontact.plugin import Observer, StepView, hook_for, require

__all__ = ["PlasticZone"]


@dataclass(frozen=True, kw_only=True)
class PlasticZone(Observer):
    """Size and position of the plastic zone of a body.

    Parameters
    ----------
    threshold : float
        Equivalent plastic strain beyond which a cell counts as plastic [-], zero or positive.
    body : {1, 2}
        Body with the plastic zone.

    Notes
    -----
    The numbers are ``max_strain`` at ``x``, ``y``, ``depth`` (centre of its cell); of all plastic cells the ``volume``,
    the depths ``shallowest`` and ``deepest`` of their faces and the largest distance of a centre from the z axis,
    ``radius``; and ``max_damage``. All are 0 without plastic strain.
    """

    key: ClassVar[str] = "plastic-zone"
    units: ClassVar[Mapping[str, str]] = {
        "max_strain": "1",
        "x": "m",
        "y": "m",
        "depth": "m",
        "volume": "m3",
        "deepest": "m",
        "shallowest": "m",
        "radius": "m",
        "max_damage": "1",
    }
    counted: ClassVar[Sequence[str]] = ("x", "y", "depth", "deepest", "shallowest", "radius")

    threshold: float = 1e-9
    body: Literal[1, 2] = 1

    def __post_init__(self) -> None:
        good = 0 <= self.threshold < np.inf
        require(good, self.key, "threshold", self.threshold, "zero or positive, and finite [-]")

    @property
    def remembered(self) -> Sequence[str]:  # type: ignore[override]
        """See `Observer`."""
        return (f"equivalent_plastic_strain_{self.body}",)

    def observe(self, step: StepView) -> Mapping[str, float]:
        """Numbers of the plastic zone; see the notes of the class."""
        record = step.history[f"equivalent_plastic_strain_{self.body}"]
        damage = step.history.get(f"damage_{self.body}")
        strain = record.values[0]
        out = dict.fromkeys(self.units, 0.0)
        if damage is not None:
            out["max_damage"] = float(damage.values.max())
        plastic = strain > self.threshold
        if not plastic.any():
            return out
        z, y, x = (record.coords[name] for name in "zyx")
        # A single layer begins at the surface, so its centre is half of its height; a single row is that of a line
        # contact.
        single = {"z": 2.0 * float(z[0]), "y": step.grid.dy, "x": step.grid.dx}
        dz, dy, dx = (
            float(axis[1] - axis[0]) if axis.size > 1 else single[name]
            for name, axis in zip("zyx", (z, y, x), strict=True)
        )
        k, j, i = np.unravel_index(int(strain.argmax()), strain.shape)
        layers, rows, columns = np.nonzero(plastic)
        return out | {
            "max_strain": float(strain.max()),
            "x": float(x[i]),
            "y": float(y[j]),
            "depth": float(z[k]),
            "volume": float(plastic.sum()) * dx * dy * dz,
            "shallowest": float(z[layers.min()]) - 0.5 * dz,
            "deepest": float(z[layers.max()]) + 0.5 * dz,
            "radius": float(np.hypot(x[columns], y[rows]).max()),
        }


eigencontact_register = hook_for(PlasticZone)
