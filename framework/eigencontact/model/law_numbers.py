"""Numbers of what bodies remember, by the names that their laws give them: largest values, volumes, integrals."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.quantities import Quantity
from eigencontact.plugin import ConstitutiveLaw

__all__ = ["measured", "named"]

FloatArray = NDArray[np.float64]


def named(laws: Iterable[ConstitutiveLaw]) -> dict[str, Quantity]:
    """Unit and meaning of every number of some laws, by name."""
    found = {}
    for law in laws:
        for variable in law.variables.values():
            if variable.largest:
                found[variable.largest] = Quantity(variable.unit, f"largest {variable.meaning}")
            if variable.extent:
                found[variable.extent] = Quantity("m3", f"volume with {variable.meaning}")
            if variable.total:
                name, unit = variable.total
                found[name] = Quantity(unit, f"{variable.meaning} of all bodies")
    return found


def measured(states: Iterable[tuple[ConstitutiveLaw, Mapping[str, FloatArray], float]]) -> dict[str, float]:
    """Numbers of laws, over all bodies.

    Parameters
    ----------
    states : iterable of (law, mapping of str to (components, n), float)
        What n cells of one law remember, and the volume of a cell [m^3].
    """
    found: dict[str, float] = {}
    for law, values, volume in states:
        for name, variable in law.variables.items():
            known = values[name]
            if variable.largest and known.size:
                found[variable.largest] = max(found.get(variable.largest, 0.0), float(known.max()))
            if variable.extent:
                filled = volume * float(np.count_nonzero(known.any(axis=0)))
                found[variable.extent] = found.get(variable.extent, 0.0) + filled
            if variable.total:
                found[variable.total[0]] = found.get(variable.total[0], 0.0) + volume * float(known.sum())
    return found
