"""Fields that all eigenstrain of a body causes at the points of a region, prescribed or found."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from eigencontact.errors import ResultsError
from eigencontact.execution.blocks.block import Cost
from eigencontact.execution.blocks.precision import Precision
from eigencontact.execution.blocks.step import Step
from eigencontact.execution.fields.within_regions import empty_points, read_by_own_laws, rises, whole_cells
from eigencontact.execution.interiors.interior import eigenstrain_name
from eigencontact.execution.interiors.responding import places_solved, solved_route
from eigencontact.execution.routes.prescribed import PrescribedField
from eigencontact.execution.routes.route import CellRoute, HalfSpace, Route
from eigencontact.model.growth import lattice_of
from eigencontact.model.kernels import KernelUse
from eigencontact.model.model import Model
from eigencontact.model.regions import RegionLattice
from eigencontact.model.sources import Inhomogeneity
from eigencontact.scene.schema import StressRequest

if TYPE_CHECKING:
    from eigencontact.solvers.within_cells import WithinCells

__all__ = ["EigenstrainField"]

FloatArray = NDArray[np.float64]

_WORDS = {"displacement": "displacement x, y, z", "strain": "strain (6 components)", "stress": "stress (6 components)"}


class EigenstrainField:
    """Fields of one body; the eigenstrain of inhomogeneities is what the step remembers."""

    def __init__(self, model: Model, request: StressRequest, lattice: RegionLattice) -> None:
        body, where = request.body, lattice.words
        self._model, self._body, self._lattice = model, body, lattice
        self._name = eigenstrain_name(body)
        prescribed = [source for source in model.prescribed if source.body == body]
        solved = [source for source in model.inhomogeneities if source.body == body]
        self.requires = frozenset({self._name} if solved else ())
        self.kernels: list[KernelUse] = []
        self.cost = Cost()
        self._cells = places_solved(model, body) if solved else {}
        self._prescribed: dict[str, PrescribedField] = {}
        self._solved: dict[str, Route] = {}
        self.note, self.mean_above = "", 0.0
        self.precisions: list[Precision] = []
        for quantity in request.fields:
            if prescribed:
                field = PrescribedField(HalfSpace.of(model, body), prescribed, quantity, lattice)
                self.kernels += field.uses(_WORDS[quantity], where)
                self._prescribed[quantity] = field
                self.cost += field.cost
                self.precisions += field.precisions
                self.note = self.note or field.note
            if solved:
                route = solved_route(model, body, quantity, lattice)
                who = repr(solved[0].name) if len(solved) == 1 else f"{len(solved)} inhomogeneities"
                uses = KernelUse(_WORDS[quantity], f"eigenstrain of {who}", solved[0].key, f"{where}, {route.words}")
                self.kernels.append(uses)
                self._solved[quantity] = route
                self.cost += route.cost
                self.precisions += route.precisions
                self.note = self.note or route.note

    def fields(self, step: Step) -> dict[str, FloatArray]:
        """Fields by quantity, ``(3 or 6, *lattice.shape)``."""
        found = {quantity: field.at(step.time) for quantity, field in self._prescribed.items()}
        for quantity, route in self._routes(step).items():
            eigenstrain = step.history[self._name].values
            values = route.field(eigenstrain)
            if quantity != "displacement" and self._within is not None:
                values = values + self._within.difference(quantity, eigenstrain).reshape(values.shape)
            found[quantity] = found[quantity] + values if quantity in found else values
        return found

    def amend(self, fields: dict[str, FloatArray], step: Step) -> None:
        """Read the stress of all causes as the regions have it: nothing in voids, by its own law in what is softer."""
        if "stress" not in fields or not self._solved or rises(self._model, self._body):
            return
        stress, sources = fields["stress"].reshape(6, -1), self._sources
        if self._within is not None:
            stress, material = stress.copy(), self._model.half_space(self._body)
            read_by_own_laws(stress, self._within, step.history[self._name].values, sources, material, step.time)
        if self._empty is not None:
            stress = np.where(self._empty, 0.0, stress)
        fields["stress"] = stress.reshape(fields["stress"].shape)

    @property
    def _sources(self) -> list[Inhomogeneity]:
        return [source for source in self._model.inhomogeneities if source.body == self._body]

    @cached_property
    def _empty(self) -> NDArray[np.bool_] | None:
        """Points in voids, which carry no stress, whatever the cells about them leave."""
        return empty_points(self._sources, self._lattice)

    @cached_property
    def _within(self) -> WithinCells | None:
        """What makes the eigenstrain go on between the cells of a region; None where it need not."""
        route = next(iter(self._solved.values()))
        if not (route.steps and isinstance(route, CellRoute)) or rises(self._model, self._body):
            return None
        from eigencontact.solvers.within_cells import WithinCells

        box, grid, points = route.box, self._model.grid, self._lattice.flat_points()
        region, material = whole_cells(box, self._sources, grid, points), route.half_space.material
        if not region.any():
            return None
        return WithinCells(
            box.cells(grid), region, points, poisson_ratio=material.poisson_ratio, shear_modulus=material.shear_modulus
        )  # fmt: skip

    def _routes(self, step: Step) -> dict[str, Route]:
        """Routes from the cells that the step remembers: those of the scene, or more where a body's box has grown."""
        if not self._solved:
            return self._solved
        known = step.history[self._name].coords
        if not _same(known, self._cells):
            self._model = self._grown(step, known)
            self._cells = places_solved(self._model, self._body)
            self.__dict__.pop("_within", None)
            self._solved = {
                quantity: solved_route(self._model, self._body, quantity, self._lattice) for quantity in self._solved
            }
        return self._solved

    def _grown(self, step: Step, known: Mapping[str, FloatArray]) -> Model:
        sources = [source for source in self._model.inhomogeneities if source.body == self._body and source.guessed]
        lattice = sources[0].lattice if sources else None
        if lattice is not None and known:
            stored = lattice_of(known, lattice.edges, self._model.grid)
            # The lattice of the scene again, as a box may be larger in an earlier look than in this one.
            plain = replace(sources[0], lattice=stored)
            others = tuple(plain if source is sources[0] else source for source in self._model.inhomogeneities)
            model = replace(self._model, inhomogeneities=others)
            if _same(known, places_solved(model, self._body)):
                return model
        raise ResultsError(
            f"{self._name} of step {step.index} must be in the cells that the scene stands for now (got others); "
            "run the scene again"
        )


def _same(one: Mapping[str, FloatArray], other: Mapping[str, FloatArray]) -> bool:
    return one.keys() == other.keys() and all(
        len(one[axis]) == len(values) and np.allclose(one[axis], values, rtol=0.0, atol=1e-9 * np.abs(values).max())
        for axis, values in other.items()
    )
