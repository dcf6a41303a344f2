"""Planning of inhomogeneities that have one uniform eigenstrain each: no cells, closed forms for their fields."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import cast

from eigencontact.core.parallel import available_threads
from eigencontact.errors import SceneError
from eigencontact.halfspace.potentials import HasFarField, HasPotentials
from eigencontact.planning.blocks import Block, Cost
from eigencontact.planning.cost import sampling_seconds
from eigencontact.planning.field_cost import closed_form_cost
from eigencontact.planning.field_parts import FieldPart, space_of
from eigencontact.planning.inhomogeneities import EQUIVALENT, InhomogeneityDeclaration
from eigencontact.planning.kernels import DIRECTIONS, KernelUse
from eigencontact.planning.materials import elasticity_of
from eigencontact.planning.regions import RegionLattice, surface_lattice
from eigencontact.planning.sources import Source

__all__ = ["WholeDeclaration", "wholes_of"]

#: Points of an inclusion at which the stress of the contact is averaged, for the cost.
_POINTS = 32


def wholes_of(sources: Sequence[Source]) -> dict[int, tuple[Source, ...]]:
    """Inhomogeneities of each body that has some, checked.

    Raises
    ------
    SceneError
        A shape without closed form, or constants or a prestrain that are not uniform.
    """
    found: dict[int, tuple[Source, ...]] = {}
    for source in sources:
        if source.material is None:
            continue
        uniform = source.exact and isinstance(source.shape, HasFarField) and source.material.type != "map"
        if not uniform:
            raise SceneError(
                f"{source.where} ({source.name!r}) must have a closed form and be uniform for "
                f"numerics.inclusion-resolution = 'whole' (got plugin {source.key!r}); set it to 'cells'"
            )
        elasticity_of(source)  # refused here, not in the middle of a run
        found[source.body] = (*found.get(source.body, ()), source)
    return found


@dataclass(frozen=True, slots=True)
class WholeDeclaration(InhomogeneityDeclaration):
    """Facts of a scene that the blocks of its whole inhomogeneities are declared from.

    Attributes
    ----------
    wholes : mapping of int to tuple of Source
        By body.
    """

    wholes: Mapping[int, tuple[Source, ...]] = field(default_factory=dict)

    def solution(self) -> Block:
        """The solve for one eigenstrain of each."""
        tractions, cost, uses = tuple(self.influences), Cost(), []
        for body, members in self.wholes.items():
            count, workers = len(members), self.scene.numerics.threads or available_threads()
            held = 48.0 * count * self.grid.nx * self.grid.ny * len(tractions)
            seconds = sum(
                _POINTS
                * count
                * self.grid.nx
                * self.grid.ny
                * sampling_seconds(self.influences[name], self._material(body))
                for name in tractions
            )
            cost += Cost(
                memory=held + 1e6, seconds_once=seconds / workers + 2e-3 * count, seconds_per_step=1e-2 * count
            )
            uses += [
                KernelUse(
                    "mean stress (6 components)", f"traction {name}", self.influences[name].key, "whole window", count
                )
                for name in tractions
            ]
            shapes = " and ".join(sorted({member.key for member in members}))
            uses.append(
                KernelUse("mean stress (6 components)", "uniform eigenstrain", shapes, "each in each", count**2)
            )
        total = sum(len(members) for members in self.wholes.values())
        fields = {"p": "pressure", "q_x": "shear_x", "q_y": "shear_y"}
        return Block(
            name="inhomogeneities",
            runner="inhomogeneities",
            requires=frozenset(fields[name] for name in tractions),
            provides=frozenset({EQUIVALENT}),
            why=f"one eigenstrain of each of {total} whole inhomogeneities" if total > 1 else "its uniform eigenstrain",
            kernels=tuple(uses),
            cost=cost,
            settings={"wholes": self.wholes, "tractions": tractions},
        )

    def surface(self, components: str) -> Block:
        """Displacement of the surface by all eigenstrain, prescribed and equivalent."""
        base = self.prescribed.surface(components)
        tractions = tuple(name for name in self.influences if DIRECTIONS[name] in components)
        others = len(components) > len(tractions)
        lattice = surface_lattice(self.grid)
        parts = [self._part(body, "displacement", lattice, 3) for body in self.wholes] if others else []
        block = self._with(base, parts, "surface", {"displacement": "displacement x, y, z"})
        return replace(block, settings={**block.settings, "tractions": tractions})

    @property
    def _numbers(self) -> Sequence[int]:
        return tuple(self.wholes)

    def _part(self, body: int, quantity: str, lattice: RegionLattice, components: int) -> FieldPart:
        sources, numerics, material = self.wholes[body], self.scene.numerics, self._material(body)
        cost = closed_form_cost(sources, quantity, lattice, material, space_of(numerics), numerics.threads)
        return FieldPart(
            quantity=quantity, body=body, sources=sources, route="closed form", lattice=lattice,
            cost=cost if components else Cost(),
        )  # fmt: skip


def volume_of(source: Source) -> float:
    """Volume [m³] of a shape with point sources."""
    assert isinstance(source.shape, HasPotentials)
    return float(cast("HasFarField", source.shape).far_field().volumes.sum())
