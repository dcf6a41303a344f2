"""Prescribed eigenstrain: its surface displacement does not depend on the tractions."""

from __future__ import annotations

from eigencontact.core.array_types import FloatArray
from eigencontact.execution.blocks.increment import Increment
from eigencontact.execution.interiors.interior import Interior, Records, by_direction
from eigencontact.execution.routes.subsurface import Subsurface
from eigencontact.model.regions import surface_lattice

__all__ = ["PrescribedEigenstrain", "names_of"]


class PrescribedEigenstrain(Interior):
    """Regions of one body with prescribed eigenstrain.

    Parameters
    ----------
    subsurface : Subsurface
        Subsurface with prescribed eigenstrain.
    directions : str
        Directions of the surface displacement, out of ``"xyz"``.
    """

    responds = False

    def __init__(self, subsurface: Subsurface, directions: str) -> None:
        body, grid = subsurface.body, subsurface.half_space.grid
        self.body, self._directions = body, directions
        self.name = "residual-displacement" if body == 1 else f"residual-displacement-{body}"
        self.reason = "displacement of the surface by " + names_of([source.name for source in subsurface.prescribed])
        rows = tuple("xyz".index(name) for name in directions)
        self._field = subsurface.prescribed_field("displacement", surface_lattice(grid), rows)
        self.cost, self.precisions = self._field.cost, self._field.precisions
        points = f"{grid.nx} x {grid.ny} points of the surface"
        self.kernels = self._field.uses(f"displacement {', '.join(directions)}", points)
        self._time = 0.0

    def begin(self, increment: Increment, last: Records) -> None:  # noqa: ARG002
        """See `Interior.begin`."""
        self._time = increment.times[1]

    def displacement(self, directions: str) -> dict[str, FloatArray]:
        """See `Interior.displacement`."""
        displacement = by_direction(self.body, self._directions, self._field.at(self._time)[:, 0])
        return {name: displacement[name] for name in directions}


def names_of(names: list[str]) -> str:
    """Names of regions for messages, at most the first four."""
    quoted = ", ".join(map(repr, names[:4]))
    return quoted if len(names) <= 4 else f"{quoted} and {len(names) - 4} more"
