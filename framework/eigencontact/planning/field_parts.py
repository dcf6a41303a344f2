"""Ways to the field of eigenstrain at the points of a region: closed forms, planes, volumes, single points."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from eigencontact.core.material import Material
from eigencontact.planning.blocks import Cost
from eigencontact.planning.cell_groups import CellGroup, cell_groups
from eigencontact.planning.field_cost import Pace, closed_form_cost, planes_cost, volume_cost
from eigencontact.planning.regions import RegionLattice
from eigencontact.planning.sources import Source
from eigencontact.plugin import HasCornerPotentials
from eigencontact.scene.schema import Numerics

__all__ = ["FieldPart", "field_parts", "part_of_cells", "space_of", "volume_layers"]


@dataclass(frozen=True, kw_only=True)
class FieldPart:
    """Field of some sources of one body at the points of a region, found in one way.

    Attributes
    ----------
    route : str
        ``"closed form"``; for cells ``"planes"`` (FFT in the plane for each depth and layer), ``"volume"`` (FFT in
        space), ``"points"`` (one by one), ``"close-up"`` (points finer than the cells). Less than exact:
        ``"image-pressure"``, ``"periodic"``.
    group : CellGroup or None
        Cells of the sources.
    varies : bool
        Whether it changes with time.
    """

    quantity: str
    body: int
    sources: tuple[Source, ...]
    route: str
    lattice: RegionLattice
    group: CellGroup | None = None
    cost: Cost = field(default_factory=Cost)

    @property
    def varies(self) -> bool:
        """Whether the field changes with time."""
        return any(source.field.varies or source.material is not None for source in self.sources)

    @property
    def words(self) -> str:
        """How the field is found, in words."""
        if self.group is None:
            return self.sources[0].how
        nz, ny, nx = self.group.lattice.shape
        cells = f"{nx} x {ny} x {nz} cells"
        if self.route == "periodic":
            return f"{cells} repeated with the window, Fourier series in the plane"
        if self.route == "volume":
            return f"{cells}, FFT in space"
        if self.route == "close-up":
            my, mx = self.lattice.finer
            return f"{cells}, {mx} x {my} points to a cell, seen from above"
        return f"{cells}, {'FFT in the plane, layer by layer' if self.route == 'planes' else 'point by point'}"


def space_of(numerics: Numerics) -> str:
    """Name of the space in `eigencontact.halfspace`."""
    return "full" if numerics.half_space in ("full-space", "image-pressure") else "half"


def field_parts(
    sources: Sequence[Source],
    quantity: str,
    lattice: RegionLattice,
    *,
    body: Material,
    numerics: Numerics,
    cell: HasCornerPotentials | None,
    components: int,
) -> list[FieldPart]:
    """Parts whose sum is the field of `sources`, all in one body; for each box of cells the cheaper way is taken.

    Parameters
    ----------
    cell : HasCornerPotentials or None
        Shape of the cells, where there are any.
    components : int
        Number of components wanted.
    """
    space = space_of(numerics)
    parts: list[FieldPart] = []
    for moving in (False, True):
        exact = tuple(source for source in sources if source.exact and source.field.varies is moving)
        if exact:
            cost = closed_form_cost(exact, quantity, lattice, body, space, numerics.threads)
            part = FieldPart(
                quantity=quantity, body=exact[0].body, sources=exact, route="closed form", lattice=lattice, cost=cost
            )
            parts.append(part)
    for group in cell_groups(sources):
        assert cell is not None
        parts.append(
            part_of_cells(group, quantity, lattice, body=body, numerics=numerics, cell=cell, components=components)
        )
    return parts


def part_of_cells(
    group: CellGroup,
    quantity: str,
    lattice: RegionLattice,
    *,
    body: Material,
    numerics: Numerics,
    cell: HasCornerPotentials,
    components: int,
) -> FieldPart:
    """Field of one box of cells, in the cheaper way; parameters as those of `field_parts`."""
    pace = Pace.of(cell, quantity, body.poisson_ratio, space_of(numerics), numerics)
    base = FieldPart(
        quantity=quantity,
        body=group.sources[0].body,
        sources=group.sources,
        route="planes",
        lattice=lattice,
        group=group,
    )
    return _cheapest(base, pace, components)


def _cheapest(part: FieldPart, pace: Pace, components: int) -> FieldPart:
    lattice, group = part.lattice, part.group
    assert group is not None
    if lattice.points is not None:
        columns = len(np.unique(lattice.points[:, :2], axis=0))
        per_column = -(-len(lattice.points) // columns)
        one = planes_cost(pace, group.lattice, (1, 1), (0.5, 0.5), per_column, components)
        cost = Cost(columns * one.memory, columns * one.seconds_once, columns * one.seconds_per_step)
        return replace(part, route="points", cost=_kept(part, cost))
    if lattice.finer != (1, 1):
        count = lattice.finer[0] * lattice.finer[1]
        one = volume_cost(pace, group.lattice, lattice.target, (0.5, 0.5), lattice.depths.size)
        seconds = one.seconds_once + count * one.seconds_per_step
        return replace(part, route="close-up", cost=Cost(one.memory, 0.0, seconds))
    origin = (lattice.origin[0] - group.lattice.first[1], lattice.origin[1] - group.lattice.first[2])
    planes = planes_cost(pace, group.lattice, lattice.target, origin, lattice.depths.size, components)
    choices = [replace(part, cost=_kept(part, planes))]
    if volume_layers(part) is not None:
        count, on_surface = lattice.depths.size, bool(lattice.depths[0] == 0.0)
        cost = volume_cost(pace, group.lattice, lattice.target, origin, count - on_surface)
        if on_surface:
            top = planes_cost(pace, group.lattice, lattice.target, origin, 1, components)
            cost = Cost(
                cost.memory + top.memory,
                cost.seconds_once + top.seconds_once,
                cost.seconds_per_step + top.seconds_per_step,
            )
        choices.append(replace(part, route="volume", cost=_kept(part, cost)))
    return min(choices, key=lambda choice: choice.cost.seconds_once + choice.cost.seconds_per_step)


def _kept(part: FieldPart, cost: Cost) -> Cost:
    """Cost of one part: kernels of a field that changes are kept for every step, others serve once and go."""
    if part.varies:
        return cost
    return Cost(seconds_once=cost.seconds_once + cost.seconds_per_step, transient=cost.memory)


def volume_layers(part: FieldPart) -> tuple[float, int] | None:
    """First depth [m] and number of the planes that one transform in space serves; None where the pitch differs.

    A plane in the surface is left to the plane by plane way.
    """
    assert part.group is not None
    depths, dz = part.lattice.depths, part.group.lattice.edges[0]
    inner = depths[1:] if depths.size and depths[0] == 0.0 else depths
    if part.lattice.points is not None or inner.size < 2:
        return None
    even = np.allclose(np.diff(inner), dz, rtol=1e-6, atol=0.0)
    return (float(inner[0]), int(inner.size)) if even else None
