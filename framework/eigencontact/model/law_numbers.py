"""Result numbers of history variables, named by their laws: largest values, volumes, integrals."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np

from eigencontact.core.array_types import FloatArray
from eigencontact.core.numbers import Number, by_name
from eigencontact.plugin import ConstitutiveLaw

__all__ = ["measured", "numbers_of_laws"]


def numbers_of_laws(laws: Iterable[ConstitutiveLaw]) -> tuple[Number, ...]:
    """Numbers of some laws: largest values, volumes and integrals of their variables."""
    listed: list[Number] = []
    for variable in (variable for law in laws for variable in law.variables.values()):
        if variable.largest:
            listed.append(Number(name=variable.largest, unit=variable.unit, meaning=f"largest {variable.meaning}"))
        if variable.extent:
            listed.append(
                Number(
                    name=variable.extent,
                    unit="m3",
                    meaning=f"volume with {variable.meaning}",
                    in_line=f"area with {variable.meaning}",
                )
            )
        if variable.total:
            name, unit = variable.total
            listed.append(Number(name=name, unit=unit, meaning=f"{variable.meaning} of all bodies"))
    return tuple(by_name(listed).values())


def measured(
    states: Iterable[tuple[ConstitutiveLaw, Mapping[str, FloatArray], float, FloatArray | float]],
) -> dict[str, float]:
    """Numbers of laws, over all bodies.

    Parameters
    ----------
    states : iterable of (law, mapping of str to (components, n), float, (n,) or float)
        What n cells of one law remember, the volume of a cell [m^3], and the law's share of each cell.
    """
    numbers: dict[str, float] = {}
    for law, values, volume, share in states:
        for name, variable in law.variables.items():
            cells = values[name]
            if variable.largest and cells.size:
                numbers[variable.largest] = max(numbers.get(variable.largest, 0.0), float(cells.max()))
            if variable.extent:
                filled = volume * float(np.sum(share * cells.any(axis=0)))
                numbers[variable.extent] = numbers.get(variable.extent, 0.0) + filled
            if variable.total:
                numbers[variable.total[0]] = numbers.get(variable.total[0], 0.0) + volume * float((share * cells).sum())
    return numbers
