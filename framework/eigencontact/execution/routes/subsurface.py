"""Subsurface of one body: its half-space, the eigenstrain in it, and the tractions above it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from eigencontact.core.array_types import FloatArray
from eigencontact.core.tractions import TRACTIONS, Traction
from eigencontact.execution.routes.closed_form import ClosedForms
from eigencontact.execution.routes.moment_forms import MomentForms
from eigencontact.execution.routes.prescribed import PrescribedField, cell_route
from eigencontact.execution.routes.route import HalfSpace, Route
from eigencontact.model.boxes import CellBox, box_of_inhomogeneities
from eigencontact.model.growth import filling, lattice_of
from eigencontact.model.initial import InitialState
from eigencontact.model.kernels import StressCoefficients
from eigencontact.model.model import Model
from eigencontact.model.regions import RegionLattice
from eigencontact.model.sources import Inhomogeneity, Lattice, Source
from eigencontact.plugin import SurfaceInfluence

__all__ = ["Subsurface", "subsurfaces_of"]


@dataclass(frozen=True, kw_only=True, eq=False)
class Subsurface:
    """Eigenstrain in one body.

    Attributes
    ----------
    half_space : HalfSpace
    prescribed, inhomogeneities : tuple of Source
        Regions in the body: with prescribed eigenstrain, and with a law of their own.
    influences : tuple of SurfaceInfluence
        Of the tractions on the body, the pressure first; none without a contact.
    recedes : bool
        Whether the surface loses depth, so that linear inhomogeneities rise towards it.
    initial : InitialState or None
        State of an earlier run at the start.
    """

    half_space: HalfSpace
    prescribed: tuple[Source, ...]
    inhomogeneities: tuple[Inhomogeneity, ...]
    influences: tuple[SurfaceInfluence, ...] = ()
    recedes: bool = False
    initial: InitialState | None = None

    @classmethod
    def of(cls, model: Model, body: int) -> Subsurface:
        """Subsurface of a body (1 or 2) of a model, with eigenstrain in it."""
        surface, numerics = model.interface, model.numerics
        half_space = HalfSpace(
            body=body,
            material=model.bodies.half_space(body),
            grid=model.grid,
            numerics=numerics,
            registry=model.registry,
            full=numerics.half_space in ("full-space", "image-pressure"),
            steps=model.steps,
        )
        return cls(
            half_space=half_space,
            prescribed=tuple(source for source in model.cells.prescribed if source.body == body),
            inhomogeneities=tuple(source for source in model.cells.inhomogeneities if source.body == body),
            influences=() if surface is None else tuple(surface.influences[item.name] for item in surface.tractions),
            recedes=body in model.scene.losses,
            initial=model.initial.get(body),
        )

    @property
    def body(self) -> int:
        """Body, 1 or 2."""
        return self.half_space.body

    @property
    def tractions(self) -> tuple[Traction, ...]:
        """Tractions of the contact, the pressure first; none without a contact."""
        return tuple(TRACTIONS[influence.traction] for influence in self.influences)

    @property
    def kernels(self) -> list[StressCoefficients]:
        """Stress by each traction."""
        return [StressCoefficients(influence, self.half_space.material) for influence in self.influences]

    @property
    def in_cells(self) -> bool:
        """Whether each cell of an inhomogeneity has an eigenstrain of its own."""
        return self.half_space.numerics.in_cells

    @cached_property
    def box(self) -> CellBox:
        """Box of cells of all inhomogeneities."""
        return box_of_inhomogeneities(self.inhomogeneities)

    @property
    def coords(self) -> dict[str, FloatArray]:
        """Centres of the cells of inhomogeneities along z, y, x [m], as results store them; empty without cells."""
        if not (self.inhomogeneities and self.in_cells):
            return {}
        points = self.box.centres(self.half_space.grid)
        return {"z": points.depths, "y": points.y, "x": points.x}

    def route(self, quantity: str, lattice: RegionLattice, rows: tuple[int, ...] | None = None) -> Route:
        """Route from the equivalent eigenstrain of the inhomogeneities to a field at the points of a lattice."""
        if self.in_cells:
            return cell_route(self.half_space, self.box, quantity, lattice, rows)
        if self.half_space.numerics.inclusion_resolution != "whole":
            return MomentForms(self.half_space, self.inhomogeneities, quantity, lattice, rows)
        return ClosedForms(self.half_space, self.inhomogeneities, quantity, lattice, rows)

    def prescribed_field(
        self, quantity: str, lattice: RegionLattice, rows: tuple[int, ...] | None = None
    ) -> PrescribedField:
        """Field of the prescribed eigenstrain at the points of a lattice."""
        return PrescribedField(self.half_space, self.prescribed, quantity, lattice, rows)

    def grown(self, lattice: Lattice) -> Subsurface:
        """Subsurface in which the cells of a yielding body fill a lattice as well."""
        return replace(self, inhomogeneities=filling(self.inhomogeneities, lattice, beside=True))

    def with_cells(self, coords: Mapping[str, FloatArray]) -> Subsurface | None:
        """Subsurface with the cells of stored results; None where the sources cannot have those."""
        if _same(coords, self.coords):
            return self
        if not coords or not any(source.guessed for source in self.inhomogeneities):
            return None
        # The box of an earlier step may be the smaller one: the lattice is the stored one, not a sum.
        lattice = lattice_of(coords, self.box.lattice.edges, self.half_space.grid)
        changed = replace(self, inhomogeneities=filling(self.inhomogeneities, lattice))
        return changed if _same(coords, changed.coords) else None


def subsurfaces_of(model: Model) -> list[Subsurface]:
    """Subsurface of each body with eigenstrain."""
    return [Subsurface.of(model, body) for body in sorted({source.body for source in model.sources})]


def _same(coords: Mapping[str, FloatArray], others: Mapping[str, FloatArray]) -> bool:
    """Whether centres of cells agree to round-off."""
    return coords.keys() == others.keys() and all(
        len(coords[axis]) == len(values)
        and np.allclose(coords[axis], values, rtol=0.0, atol=1e-9 * np.abs(values).max())
        for axis, values in others.items()
    )
