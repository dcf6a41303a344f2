"""Fields of all eigenstrain of a body at the points of a region, prescribed or computed."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.array_types import FloatArray
from eigencontact.errors import ResultsError
from eigencontact.execution.blocks.block import Cost
from eigencontact.execution.blocks.precision import Precision
from eigencontact.execution.blocks.step import Step
from eigencontact.execution.fields.cause import Cause
from eigencontact.execution.fields.within_regions import empty_points, read_by_own_laws, whole_cells
from eigencontact.execution.interiors.interior import eigenstrain_name
from eigencontact.execution.routes.prescribed import PrescribedField
from eigencontact.execution.routes.route import CellRoute, Route
from eigencontact.execution.routes.subsurface import Subsurface
from eigencontact.model.kernels import KernelUse
from eigencontact.model.regions import RegionLattice
from eigencontact.scene.schema import StressRequest

if TYPE_CHECKING:
    from eigencontact.solvers.within_cells import WithinCells

__all__ = ["EigenstrainField"]


_WORDS = {"displacement": "displacement x, y, z", "strain": "strain (6 components)", "stress": "stress (6 components)"}


class EigenstrainField(Cause):
    """Fields of one body; steps store the eigenstrain of inhomogeneities."""

    def __init__(self, subsurface: Subsurface, request: StressRequest, lattice: RegionLattice) -> None:
        where, inhomogeneities = lattice.words, subsurface.inhomogeneities
        self._subsurface, self._lattice, self._name = subsurface, lattice, eigenstrain_name(subsurface.body)
        self.requires = frozenset({self._name} if inhomogeneities else ())
        self.kernels: list[KernelUse] = []
        self.cost = Cost()
        self._prescribed: dict[str, PrescribedField] = {}
        self._solved: dict[str, Route] = {}
        self.precisions: list[Precision] = []
        for quantity in request.fields:
            if subsurface.prescribed:
                field = subsurface.prescribed_field(quantity, lattice)
                self.kernels += field.uses(_WORDS[quantity], where)
                self._prescribed[quantity] = field
                self._add(field)
            if inhomogeneities:
                route = subsurface.route(quantity, lattice)
                first = inhomogeneities[0]
                who = repr(first.name) if len(inhomogeneities) == 1 else f"{len(inhomogeneities)} inhomogeneities"
                layout = f"{where}, {route.words}"
                self.kernels.append(KernelUse(_WORDS[quantity], f"eigenstrain of {who}", first.key, layout))
                self._solved[quantity] = route
                self._add(route)

    def _add(self, contribution: PrescribedField | Route) -> None:
        """Add the cost and precisions of a contribution; keep the first note."""
        self.cost += contribution.cost
        self.precisions += contribution.precisions
        self.note = self.note or contribution.note

    def fields(self, step: Step) -> dict[str, FloatArray]:
        """Fields by quantity, ``(3 or 6, *lattice.shape)``."""
        fields = {quantity: field.at(step.time) for quantity, field in self._prescribed.items()}
        if self._solved:
            self._follow(step)
        for quantity, route in self._solved.items():
            eigenstrain = step.history[self._name].values
            values = route.field(eigenstrain)
            if quantity != "displacement" and self._within is not None:
                values = values + self._within.difference(quantity, eigenstrain).reshape(values.shape)
            fields[quantity] = fields[quantity] + values if quantity in fields else values
        return fields

    def amend(self, fields: dict[str, FloatArray], step: Step) -> None:
        """Correct the stress of all causes: zero in voids, by its own law in a softer region."""
        if "stress" not in fields or not self._solved or self._subsurface.recedes:
            return
        stress, sources = fields["stress"].reshape(6, -1), self._subsurface.inhomogeneities
        if self._within is not None:
            stress, material = stress.copy(), self._subsurface.half_space.material
            read_by_own_laws(stress, self._within, step.history[self._name].values, sources, material, step.time)
        if self._empty is not None:
            stress = np.where(self._empty, 0.0, stress)
        fields["stress"] = stress.reshape(fields["stress"].shape)

    @cached_property
    def _empty(self) -> NDArray[np.bool_] | None:
        """Points in voids, which carry no stress, whatever the cells about them leave."""
        return empty_points(self._subsurface.inhomogeneities, self._lattice)

    @cached_property
    def _within(self) -> WithinCells | None:
        """Continuation of the eigenstrain between the cells of a region; None where it is not needed."""
        route = next(iter(self._solved.values()))
        if not (route.steps and isinstance(route, CellRoute)) or self._subsurface.recedes:
            return None
        from eigencontact.solvers.within_cells import WithinCells

        box, grid, points = route.box, route.half_space.grid, self._lattice.flat_points()
        material = route.half_space.material
        region = whole_cells(box, self._subsurface.inhomogeneities, grid, points)
        if not region.any():
            return None
        return WithinCells(
            box.cells(grid), region, points, poisson_ratio=material.poisson_ratio, shear_modulus=material.shear_modulus
        )  # fmt: skip

    def _follow(self, step: Step) -> None:
        """Take routes from the cells in the history of a step: those of the scene, or those of a box that grew."""
        subsurface = self._subsurface.with_cells(step.history[self._name].coords)
        if subsurface is None:
            raise ResultsError(
                f"{self._name} of step {step.index} must be in the cells that the scene stands for now (got others); "
                "run the scene again"
            )
        if subsurface is not self._subsurface:
            self._subsurface = subsurface
            self.__dict__.pop("_within", None)
            self._solved = {quantity: subsurface.route(quantity, self._lattice) for quantity in self._solved}
