"""Planning the fields of prescribed eigenstrain: which blocks, by which way, at which cost."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

from eigencontact.core.grid import Grid
from eigencontact.core.material import Material
from eigencontact.planning.blocks import Block, Cost
from eigencontact.planning.field_parts import FieldPart, field_parts
from eigencontact.planning.kernels import Bodies, KernelUse
from eigencontact.planning.lower_fidelities import image_pressure_parts, periodic_parts
from eigencontact.planning.regions import RegionLattice, region_lattice, surface_lattice
from eigencontact.planning.sources import Source
from eigencontact.plugin import HasCornerPotentials
from eigencontact.scene.schema import Scene, StressRequest

__all__ = ["EigenstrainDeclaration"]


@dataclass(frozen=True, slots=True)
class EigenstrainDeclaration:
    """Facts of a scene that the blocks of its eigenstrain are declared from.

    Attributes
    ----------
    cell : HasCornerPotentials or None
        Shape of cells, where a source needs them.
    """

    scene: Scene
    grid: Grid
    sources: Sequence[Source]
    bodies: Bodies
    cell: HasCornerPotentials | None

    def surface(self, components: str) -> Block:
        """Displacement of the surface along `components` (of "xyz")."""
        lattice = surface_lattice(self.grid)
        parts = [
            part
            for body in sorted({source.body for source in self.sources})
            for part in self.parts(body, "displacement", lattice, len(components))
        ]
        words = f"{self.grid.nx} x {self.grid.ny} points of the surface"
        return Block(
            name="residual-displacement",
            runner="residual-displacement",
            provides=frozenset(f"residual_displacement_{c}" for c in components),
            why="displacement of the surface by " + (_names(self.sources) or "the inhomogeneities"),
            kernels=_uses(parts, {"displacement": f"displacement {', '.join(components)}"}, words),
            cost=sum((part.cost for part in parts), Cost()),
            settings={"components": components, "parts": parts},
        )

    def region(self, request: StressRequest) -> Block | None:
        """Fields at the points of a region; None where its body has no eigenstrain."""
        sources = [source for source in self.sources if source.body == request.body]
        if not sources:
            return None
        lattice = region_lattice(request, self.grid)
        if lattice.points is not None:
            words = f"{len(lattice.points)} points"
        else:
            words = f"{lattice.target[1]} x {lattice.target[0]} points at {lattice.depths.size} depths"
        spread = {"displacement": "displacement x, y, z"}
        spread |= {name: f"{name} (6 components)" for name in ("strain", "stress")}
        parts = [
            part
            for quantity in request.fields
            for part in self.parts(request.body, quantity, lattice, 3 if quantity == "displacement" else 6)
        ]
        return Block(
            name=f"eigenstrain-{request.label}",
            runner="eigenstrain-region",
            provides=frozenset({f"eigenstrain:{request.label}"}),
            why=f"fields of {_names(sources)} at the points of {request.label!r}",
            kernels=_uses(parts, spread, words),
            cost=sum((part.cost for part in parts), Cost()),
            settings={"request": request, "parts": parts},
        )

    def parts(self, body: int, quantity: str, lattice: RegionLattice, components: int) -> list[FieldPart]:
        """Parts whose sum is the field of the sources of one body at the points of a lattice."""
        material, numerics = self.bodies[body - 1], self.scene.numerics
        assert isinstance(material, Material)
        sources = [source for source in self.sources if source.body == body]
        if numerics.half_space == "periodic":
            return periodic_parts(sources, quantity, lattice, grid=self.grid, numerics=numerics)
        find = partial(field_parts, body=material, numerics=numerics, cell=self.cell, components=components)
        if numerics.half_space == "image-pressure":
            return image_pressure_parts(sources, quantity, lattice, grid=self.grid, numerics=numerics, find=find)
        return find(sources, quantity, lattice)


def _uses(parts: Sequence[FieldPart], spread: dict[str, str], words: str) -> tuple[KernelUse, ...]:
    """Kernels of the parts, those of like sources counted together."""
    uses: dict[tuple[str, str, str], KernelUse] = {}
    for part in parts:
        sources = part.sources if part.group is None else part.sources[:1]
        for source in sources:
            how = source.how if part.route == "closed form" else part.words
            like = (part.quantity, source.key, how)
            if like in uses:
                uses[like] = replace(uses[like], count=uses[like].count + 1)
                continue
            who = repr(source.name) if part.group is None else part.group.names
            uses[like] = KernelUse(spread[part.quantity], f"eigenstrain of {who}", source.key, f"{words}, {how}")
    return tuple(uses.values())


def _names(sources: Sequence[Source]) -> str:
    shown = ", ".join(repr(source.name) for source in sources[:4])
    return shown if len(sources) <= 4 else f"{shown} and {len(sources) - 4} more"
