"""Half-spaces that are not exact, as ways to the field of eigenstrain: planned, priced and put into words."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from eigencontact.core.grid import Grid
from eigencontact.core.parallel import available_threads
from eigencontact.errors import SceneError
from eigencontact.planning.blocks import Cost
from eigencontact.planning.cell_groups import CellGroup, cell_groups
from eigencontact.planning.cost import speed
from eigencontact.planning.field_parts import FieldPart
from eigencontact.planning.regions import RegionLattice, surface_lattice
from eigencontact.planning.sources import Source
from eigencontact.scene.schema import Numerics

__all__ = ["ALIASES", "PRICE", "ImagePressurePart", "image_pressure_parts", "mirrored", "periodic_parts"]

#: Waves beyond those of the grid, each way, that the periodic half-space sums for eigenstrain in cells.
ALIASES = 2

#: What a choice of ``numerics.half-space`` costs in accuracy.
PRICE = {
    "image-pressure": "the traction on the surface is removed at the middles of the window's cells only: stress within "
    "two cells of the surface may be wrong by half, elsewhere and in the surface displacement by some per cent",
    "periodic": "the eigenstrain repeats with the window, no mean strain in the plane: a single region is met within "
    "some per cent if the window is ten times as wide as the region is wide and deep, its mean displacement apart",
}

#: Seconds that one wave takes at one layer or depth, on one thread; and one component of one loaded cell at one point.
_WAVE, _CELL = 2e-7, 1.5e-7


@dataclass(frozen=True, kw_only=True)
class ImagePressurePart(FieldPart):
    """Full space, mirror image and pressure, all of them parts in full space.

    Attributes
    ----------
    here, image, surface : sequence of FieldPart
        Field at the points, at their mirror images, and stress in the cells of the surface.
    """

    here: Sequence[FieldPart]
    image: Sequence[FieldPart]
    surface: Sequence[FieldPart]

    @property
    def words(self) -> str:
        """How the field is found, in words."""
        return "full space twice (the image is its mirror), and the pressure that is left on the cells of the window"


def mirrored(lattice: RegionLattice) -> RegionLattice:
    """Mirror images of points, planes in ascending order."""
    if lattice.points is not None:
        return replace(lattice, points=lattice.points * (1.0, 1.0, -1.0))
    return replace(lattice, depths=-lattice.depths[::-1])


def image_pressure_parts(
    sources: Sequence[Source],
    quantity: str,
    lattice: RegionLattice,
    *,
    grid: Grid,
    numerics: Numerics,
    find: Callable[[Sequence[Source], str, RegionLattice], list[FieldPart]],
) -> list[FieldPart]:
    """Parts for still and for moving sources, each made of parts in full space, which `find` finds."""
    found: list[FieldPart] = []
    for moving in (False, True):
        chosen = [source for source in sources if bool(source.field.varies) is moving]
        if not chosen:
            continue
        here, image = find(chosen, quantity, lattice), find(chosen, quantity, mirrored(lattice))
        surface = find(chosen, "stress", surface_lattice(grid))
        cost = sum((part.cost for part in (*here, *image, *surface)), _pressure_cost(grid, lattice, quantity, numerics))
        found.append(
            ImagePressurePart(
                quantity=quantity, body=chosen[0].body, sources=tuple(chosen), route="image-pressure", lattice=lattice,
                here=here, image=image, surface=surface, cost=cost,
            )
        )  # fmt: skip
    return found


def _pressure_cost(grid: Grid, lattice: RegionLattice, quantity: str, numerics: Numerics) -> Cost:
    """Loaded cells at points one by one, or a convolution for each plane and component."""
    count, workers = 3 if quantity == "displacement" else 6, 0.8 * (numerics.threads or available_threads())
    cells = grid.nx * grid.ny
    if lattice.points is not None:
        return Cost(memory=8.0 * cells * count, seconds_per_step=len(lattice.points) * cells * count * _CELL / workers)
    ny, nx = lattice.target[0] + grid.ny, lattice.target[1] + grid.nx
    one = speed("double", numerics.threads).convolution(ny, nx)
    seconds = lattice.depths.size * count * (2.0 * one + _CELL * ny * nx)
    return Cost(memory=8.0 * count * ny * nx * 3, seconds_per_step=seconds)


def periodic_parts(
    sources: Sequence[Source], quantity: str, lattice: RegionLattice, *, grid: Grid, numerics: Numerics
) -> list[FieldPart]:
    """One part for each box of cells, every source being cut into cells."""
    if lattice.points is not None:
        raise SceneError(
            "numerics.half-space must be 'exact' for fields on lines and at points (got 'periodic'); "
            "ask for planes or volumes"
        )
    return [
        FieldPart(
            quantity=quantity, body=group.sources[0].body, sources=group.sources, route="periodic", lattice=lattice,
            group=group, cost=_periodic_cost(group, quantity, lattice, grid, numerics),
        )
        for group in cell_groups(sources)
    ]  # fmt: skip


def _periodic_cost(group: CellGroup, quantity: str, lattice: RegionLattice, grid: Grid, numerics: Numerics) -> Cost:
    waves, layers, planes = grid.ny * (grid.nx // 2 + 1), group.lattice.shape[0], lattice.depths.size
    count, workers = 3 if quantity == "displacement" else 6, 0.8 * (numerics.threads or available_threads())
    seconds = waves * (2 * ALIASES + 1) ** 2 * (2 * layers + 3 * planes) * _WAVE / workers
    seconds += 4e-8 * waves * (6 * layers + count * planes) + 1e-3
    memory = 16.0 * waves * (6 * layers + count * planes) * 3 + 4e6
    return Cost(memory=memory, seconds_per_step=seconds) if group.varies else Cost(memory=memory, seconds_once=seconds)
