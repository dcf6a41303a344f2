"""Subsurface of one body: half-space, eigenstrain and influence of tractions."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import cast

import numpy as np

from eigencontact.core.array_types import FloatArray
from eigencontact.core.material import Material
from eigencontact.core.tractions import TRACTIONS, Traction
from eigencontact.errors import require
from eigencontact.execution.routes.closed_form import ClosedForms
from eigencontact.execution.routes.moment_forms import MomentForms
from eigencontact.execution.routes.prescribed import PrescribedField, cell_route
from eigencontact.execution.routes.route import HalfSpace, Route
from eigencontact.model.boxes import CellBox, box_of_inhomogeneities
from eigencontact.model.growth import filling, lattice_of
from eigencontact.model.initial import InitialState
from eigencontact.model.kernels import StressCoefficients
from eigencontact.model.matrix_law import matrix_law
from eigencontact.model.model import Model
from eigencontact.model.regions import RegionLattice
from eigencontact.model.sources import Inhomogeneity, Lattice, Source
from eigencontact.plugin import EigenstrainField, LinearLaw, SurfaceInfluence

__all__ = ["Subsurface", "ground_of", "subsurfaces_of"]


@dataclass(frozen=True, kw_only=True, eq=False)
class Subsurface:
    """Eigenstrain in one body.

    Attributes
    ----------
    half_space : HalfSpace
    prescribed, inhomogeneities : tuple of Source
        Regions in the body with prescribed eigenstrain, and regions with a material law.
    influences : tuple of SurfaceInfluence
        Influences of the tractions on the body, the pressure first; empty without a contact.
    recedes : bool
        Whether the surface wears, so that linear inhomogeneities rise towards it.
    initial : InitialState or None
        State of an earlier run at the start.
    beside : bool
        Whether the regions are whole inhomogeneities in a body that also has cells; the subsurface of the cells then
        has all other properties of the body.
    wholes : Subsurface or None
        Subsurface of the whole inhomogeneities beside these cells; the cells in their ground have the material of the
        body.
    """

    half_space: HalfSpace
    prescribed: tuple[Source, ...]
    inhomogeneities: tuple[Inhomogeneity, ...]
    influences: tuple[SurfaceInfluence, ...] = ()
    recedes: bool = False
    initial: InitialState | None = None
    beside: bool = False
    wholes: Subsurface | None = None

    @property
    def refined(self) -> bool:
        """Whether cells at inclusions are divided into finer ones."""
        return self.in_cells and self.half_space.numerics.refinement > 1

    @classmethod
    def of(cls, model: Model, body: int) -> Subsurface:
        """Subsurface of a body (1 or 2) of a model, with the eigenstrain in it."""
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
        members = tuple(source for source in model.cells.inhomogeneities if source.body == body)
        whole = cls(
            half_space=half_space,
            prescribed=tuple(source for source in model.cells.prescribed if source.body == body),
            inhomogeneities=members,
            influences=() if surface is None else tuple(surface.influences[item.name] for item in surface.tractions),
            recedes=body in model.scene.losses,
            initial=model.initial.get(body),
        )
        balls = tuple(source for source in members if source.whole)
        if not balls or len(balls) == len(members):
            return whole
        ground = tuple(ground_of(source, half_space.material) if source.whole else source for source in members)
        return replace(whole, inhomogeneities=ground, wholes=replace(whole, inhomogeneities=balls, beside=True))

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
        """Whether inhomogeneities are divided into cells."""
        return not self.beside and any(not source.whole for source in self.inhomogeneities)

    @cached_property
    def box(self) -> CellBox:
        """Box of cells of all inhomogeneities."""
        return box_of_inhomogeneities(self.inhomogeneities)

    @property
    def coords(self) -> dict[str, FloatArray]:
        """Centres of the cells of inhomogeneities along z, y, x [m], as in stored results; empty without cells."""
        if not (self.inhomogeneities and self.in_cells):
            return {}
        points = self.box.centres(self.half_space.grid)
        return {"z": points.depths, "y": points.y, "x": points.x}

    def route(self, quantity: str, lattice: RegionLattice, rows: tuple[int, ...] | None = None) -> Route:
        """Route from the equivalent eigenstrain of the inhomogeneities to a field at the points of a lattice."""
        if self.in_cells:
            return cell_route(self.half_space, self.box, quantity, lattice, rows)
        uniform = all(source.degree is not None and source.degree.degree == 0 for source in self.inhomogeneities)
        route = ClosedForms if uniform else MomentForms
        return route(self.half_space, self.inhomogeneities, quantity, lattice, rows)

    def prescribed_field(
        self, quantity: str, lattice: RegionLattice, rows: tuple[int, ...] | None = None
    ) -> PrescribedField:
        """Field of the prescribed eigenstrain at the points of a lattice."""
        return PrescribedField(self.half_space, self.prescribed, quantity, lattice, rows)

    def grown(self, lattice: Lattice) -> Subsurface:
        """Subsurface with additional cells of a yielding body."""
        return replace(self, inhomogeneities=filling(self.inhomogeneities, lattice, beside=True))

    def with_cells(self, coords: Mapping[str, FloatArray]) -> Subsurface | None:
        """Subsurface with the cells of stored results; None if the sources are incompatible with these cells."""
        if _agree(coords, self.coords):
            return self
        if not coords or not any(source.guessed for source in self.inhomogeneities):
            return None
        # The box of an earlier step may be smaller: the lattice is the stored one, not the union.
        lattice = lattice_of(coords, self.box.lattice.edges, self.half_space.grid)
        changed = replace(self, inhomogeneities=filling(self.inhomogeneities, lattice))
        return changed if _agree(coords, changed.coords) else None


def subsurfaces_of(model: Model) -> list[Subsurface]:
    """Subsurface of each body with eigenstrain; a body with cells and whole inhomogeneities has one for each."""
    blocks = []
    for body in sorted({source.body for source in model.sources}):
        subsurface = Subsurface.of(model, body)
        blocks += [subsurface] if subsurface.wholes is None else [subsurface, subsurface.wholes]
    return blocks


def _agree(coords: Mapping[str, FloatArray], other_coords: Mapping[str, FloatArray]) -> bool:
    """Whether centres of cells agree to round-off."""
    return coords.keys() == other_coords.keys() and all(
        len(coords[axis]) == len(values)
        and np.allclose(coords[axis], values, rtol=0.0, atol=1e-9 * np.abs(values).max())
        for axis, values in other_coords.items()
    )


class _ZeroEigenstrain(EigenstrainField):
    """No eigenstrain."""

    key, references, uniform = "nothing", (), True

    def eigenstrain(self, x: FloatArray, y: FloatArray, z: FloatArray, time: float) -> FloatArray:  # noqa: ARG002
        """See `EigenstrainField.eigenstrain`."""
        return np.zeros((6, *np.broadcast_shapes(np.shape(x), np.shape(y), np.shape(z))))


def ground_of(source: Inhomogeneity, matrix: Material) -> Inhomogeneity:
    """Cells of the material of the body without eigenstrain, for the cells of another interior."""
    law = matrix_law(matrix)
    rule = "below 0.5 in a body with cells around whole inclusions, or finer cells around inclusions"
    require(law is not None, f"body{source.body}", "poisson-ratio", matrix.poisson_ratio, rule)
    return replace(source, law=cast("LinearLaw", law), field=_ZeroEigenstrain())
