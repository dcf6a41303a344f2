"""Error of the contact pressure by the polynomial degree of whole inhomogeneities, estimated from two lower degrees."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from eigencontact.core.array_types import FloatArray
from eigencontact.core.numbers import Number
from eigencontact.execution.blocks.contact import Contact
from eigencontact.execution.blocks.step import Step
from eigencontact.execution.interiors.interior import Interior

__all__ = ["PRESSURE_ERROR", "pressure_error"]

PRESSURE_ERROR = Number(
    name="degree_pressure_error", unit="Pa", role="error", over="max", estimates="max_pressure",
    meaning="estimated error of the contact pressure by the degree of whole inhomogeneities",
)  # fmt: skip

#: Cells next to the edge of the contact that the estimate leaves out: a moved edge would dominate it.
_EDGE = 2


def pressure_error(contact: Contact, interiors: Sequence[Interior], step: Step, displacement_z: FloatArray) -> float:
    """Estimated error [Pa] of the pressure of a solved step; `displacement_z` is that by the interiors [m].

    A degree lower by one, and by two, changes the surface displacement by an interior, and therefore the pressure. The
    estimate neglects the effect of this pressure on the interior. It is the largest change by the last degree, or half
    of the change by the degree before if that is larger; it represents all higher degrees.
    """
    from scipy.ndimage import binary_erosion

    assert step.surface.separation is not None
    assert step.control is not None
    pressure = step.fields["pressure"]
    loaded = binary_erosion(pressure > 0.0, iterations=_EDGE)
    moved, total = step.surface.separation + displacement_z, 0.0
    for interior in interiors:
        factor, changes = interior.normal_displacement_by_less()
        pressures = [pressure]
        for change in changes:
            pressures.append(contact.pressed(step.control, moved + change, step.fields, None, pressures[-1]))
        steps = [float(np.abs(second - first)[loaded].max(initial=0.0)) for first, second in pairwise(pressures)]
        if steps:
            total += factor * max(steps[0], 0.5 * steps[1])
    return total
