"""Common text of the pictures of friction: zones and their colours, driving loads, titles."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact.results.course import driven_motions
from eigencontact.viz.style import instant, scale_for

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from eigencontact.results.stored import Results

__all__ = ["MODES", "ZONES", "ZONE_COLOURS", "driven", "friction_heading", "history_of"]

#: Values of the field ``contact_zone`` are positions in these.
ZONES = ("open", "slip", "stick")
#: Grey, and light tints of orange and blue that the colour-blind tell apart.
ZONE_COLOURS = ("#EDEDED", "#F5C26B", "#8DBFE0")
#: By direction: load, displacement, units of both, words for both.
MODES = {
    "x": ("tangential_load_x", "shift_x", ("N", "m"), ("Tangential load $Q_x$", "Shift $\\delta_x$")),
    "y": ("tangential_load_y", "shift_y", ("N", "m"), ("Tangential load $Q_y$", "Shift $\\delta_y$")),
    "twist": ("torsion_moment", "twist", ("N m", "rad"), ("Torsion moment $M_z$", "Twist $\\varphi_z$")),
}


def history_of(dataset: Results) -> dict[str, NDArray[Any]]:
    """Scalars of all steps by name."""
    scalars = (name for name, variable in dataset.data_vars.items() if variable.dims == ("step",))
    return {str(name): np.asarray(dataset[name].values, dtype=float) for name in scalars}


def driven(dataset: Results) -> list[str]:
    """Driven motions among ``x``, ``y`` and ``twist``; by-products of other loads do not count."""
    return driven_motions(history_of(dataset))


def friction_heading(dataset: Results, step: int, subject: str) -> str:
    """Title of a picture: its subject, the normal load, and the tangential load or torsion moment."""
    loads_in_title = [("normal_load", "P", "N")]
    loads = driven(dataset)
    if set(loads) & {"x", "y"}:
        loads_in_title.append(("tangential_load", "Q", "N"))
    if "twist" in loads:
        loads_in_title.append(("torsion_moment", "M", "N m"))
    entries = []
    for name, symbol, unit in loads_in_title:
        values = np.asarray(dataset[name].values, dtype=float)
        value = float(values[step]) if abs(values[step]) > 1e-9 * np.abs(values).max() else 0.0
        entries.append(f"{symbol} = {scale_for([value], unit).text(value)}")
    return f"{subject} at {', '.join(entries)}{instant(dataset, step)}"
