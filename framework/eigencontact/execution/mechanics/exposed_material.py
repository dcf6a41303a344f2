"""Block of the exposed material, and exposed material in the state for laws."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigencontact.execution.blocks.block import Stateless
from eigencontact.execution.blocks.step import Step
from eigencontact.model.exposed import Exposed

__all__ = ["ExposedMaterial", "exposed_facts"]


class ExposedMaterial(Stateless):
    """Topmost material of each column at the surface for the contact of a step."""

    name = "exposed-material"
    requires = frozenset({"separation"})
    provides = frozenset({"exposed_material"})
    requesters = dict.fromkeys(("exposed_material",), "laws by material")

    def __init__(self, exposed: Exposed) -> None:
        self._exposed = exposed
        names = dict.fromkeys(exposed.names)
        self.reason = f"what of body {exposed.body} is at the surface: {', '.join(names)}"

    def advance(self, step: Step) -> None:
        """See `Running.advance`."""
        material = self._exposed.at(step.surface.worn_depths.get(self._exposed.body))
        step.surface = replace(step.surface, exposed=material)
        step.fields["exposed_material"] = material.astype(float)


def exposed_facts(exposed: Exposed | None, material: NDArray[np.intp] | None) -> dict[str, Any]:
    """Number of the exposed material in each cell, and names, for the states of laws; empty if no law needs them."""
    if exposed is None or material is None:
        return {}
    return {"material": material, "materials": exposed.names}
