"""Observer of a fretting loop: load and displacement along one direction, and the friction work so far."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np

from eigencontact.plugin import Angle, Observer, StepView, hook_for, require
from eigencontact_plugins.observers.friction_fields import friction_field

__all__ = ["FrettingLoop"]


@dataclass(frozen=True, kw_only=True)
class FrettingLoop(Observer):
    """Point of the fretting loop for each step.

    Parameters
    ----------
    motion : {"shift", "twist"}
        Loop of the tangential load over the shift, or of the torsion moment over the twist.
    angle : float
        Direction of the shift in the plane [rad], 0 along x, positive from x to y; not for the twist.

    Notes
    -----
    Each number depends only on its step, so that a resumed run repeats it. The area of the loop, its amplitudes and the
    energy ratio of a closed cycle need the history: `eigencontact.results.cycles` computes them from stored results.

    The load (or moment) is the integral of the shear field over the contact, and therefore checks the prescribed value.
    """

    key: ClassVar[str] = "fretting-loop"
    summed: ClassVar[Sequence[str]] = ("dissipated_energy",)
    references: ClassVar[tuple[str, ...]] = (
        "S. Fouvry, P. Kapsa, L. Vincent, Analysis of sliding behaviour for fretting loadings, Wear 185 (1995) 35-46",
    )

    motion: Literal["shift", "twist"] = "shift"
    angle: Angle = 0.0

    def __post_init__(self) -> None:
        require(self.motion in ("shift", "twist"), self.key, "motion", self.motion, "'shift' or 'twist'")
        require(np.isfinite(self.angle), self.key, "angle", self.angle, "finite [rad]")
        require(self.motion == "shift" or self.angle == 0, self.key, "angle", self.angle, "0 for motion = 'twist'")

    @property
    def units(self) -> Mapping[str, str]:
        """See `Observer.units`."""
        of_motion = {"moment": "N m", "twist": "rad"} if self.motion == "twist" else {"load": "N", "shift": "m"}
        return {**of_motion, "load_ratio": "1", "dissipated_energy": "J"}

    def observe(self, step: StepView) -> Mapping[str, float]:
        """Numbers of one point of the loop.

        Returns
        -------
        mapping of str to float
            ``load`` [N] and ``shift`` [m] along the direction, or ``moment`` [N m] and ``twist`` [rad];
            ``load_ratio``, the load over the normal load [-] (0 without a normal load; for a moment: over the normal
            load times the contact radius); ``dissipated_energy`` [J], cumulative.

        Raises
        ------
        SceneError
            The run has no friction.
        """
        cell = step.grid.cell_area
        zero = np.zeros(step.grid.shape)
        q_x, q_y = (step.fields.get(f"shear_{axis}", zero) for axis in "xy")
        energy = float(np.sum(friction_field(self.key, step, "dissipated_energy_density"))) * cell
        if self.motion == "twist":
            y, x = step.grid.axes()
            moment = float(np.sum(x * q_y - y * q_x)) * cell
            arm = step.scalars["normal_load"] * step.scalars["contact_radius"]
            numbers = {"moment": moment, "twist": step.scalars.get("twist", 0.0), "load_ratio": _ratio(moment, arm)}
        else:
            along = np.cos(self.angle), np.sin(self.angle)
            load = float(along[0] * np.sum(q_x) + along[1] * np.sum(q_y)) * cell
            shift = sum(
                cosine * step.scalars.get(f"shift_{axis}", 0.0) for cosine, axis in zip(along, "xy", strict=True)
            )
            ratio = _ratio(load, step.scalars["normal_load"])
            numbers = {"load": load, "shift": float(shift), "load_ratio": ratio}
        return {**numbers, "dissipated_energy": energy}


def _ratio(value: float, of: float) -> float:
    return value / of if of > 0 else 0.0


eigencontact_register = hook_for(FrettingLoop)
