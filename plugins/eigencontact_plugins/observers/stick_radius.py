"""Observer of the stick zone: size, widths and distance from the centre of the contact."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from eigencontact.plugin import Observer, StepView, hook_for
from eigencontact_plugins.observers.friction_fields import friction_field

__all__ = ["StickRadius"]

#: Value of the field ``contact_zone`` in sticking cells (0 open, 1 slip).
_STICK = 2


@dataclass(frozen=True, kw_only=True)
class StickRadius(Observer):
    """Size and position of the stick zone.

    Notes
    -----
    The observer counts cells: each length has an error of about one cell; the error of the radius is smaller, because
    the errors along the border average out. The widths are those of the rectangle around the whole zone, for any shape
    and number of parts.
    """

    key: ClassVar[str] = "stick-radius"
    units: ClassVar[Mapping[str, str]] = {
        "radius": "m",
        "half_width_x": "m",
        "half_width_y": "m",
        "eccentricity": "m",
        "ratio": "1",
    }
    counted: ClassVar[Sequence[str]] = tuple(units)
    widths: ClassVar[Sequence[str]] = ("half_width_x", "half_width_y")

    def observe(self, step: StepView) -> Mapping[str, float]:
        """Numbers of the stick zone.

        Returns
        -------
        mapping of str to float
            ``radius`` of the circle of equal area, ``half_width_x``, ``half_width_y``, ``eccentricity``, the distance
            of its centre of area from that of the contact, and ``ratio``, its radius over that of the contact by the
            same method [-]. Lengths [m]; all are 0 without sticking cells.

        Raises
        ------
        SceneError
            The run has no friction.
        """
        zone = friction_field(self.key, step, "contact_zone")
        stick, contact = np.rint(zone) == _STICK, zone > 0
        cells = np.count_nonzero(stick)
        if cells == 0:
            return dict.fromkeys(self.units, 0.0)
        grid = step.grid
        y, x = grid.axes()
        columns, rows = np.flatnonzero(stick.any(axis=0)), np.flatnonzero(stick.any(axis=1))
        off_x, off_y = (
            np.mean(np.broadcast_to(at, grid.shape)[stick]) - np.mean(np.broadcast_to(at, grid.shape)[contact])
            for at in (x, y)
        )
        values = (
            np.sqrt(cells * grid.cell_area / np.pi),
            0.5 * grid.dx * (columns[-1] - columns[0] + 1),
            0.5 * grid.dy * (rows[-1] - rows[0] + 1),
            np.hypot(off_x, off_y),
            np.sqrt(cells / np.count_nonzero(contact)),
        )
        return {name: float(value) for name, value in zip(self.units, values, strict=True)}


eigencontact_register = hook_for(StickRadius)
