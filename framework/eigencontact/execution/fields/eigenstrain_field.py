"""Fields of all eigenstrain of a body, prescribed and computed, at the points of a region."""

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
from eigencontact.execution.fields.within_regions import Content, content_of, empty_points, read_by_own_laws
from eigencontact.execution.interiors.interior import eigenstrain_name
from eigencontact.execution.routes.prescribed import PrescribedField
from eigencontact.execution.routes.route import Route
from eigencontact.execution.routes.subsurface import Subsurface
from eigencontact.model.kernels import KernelUse
from eigencontact.model.regions import RegionLattice
from eigencontact.scene.schema import StressRequest

if TYPE_CHECKING:
    from eigencontact.execution.fields.material_points import MaterialPoints
    from eigencontact.solvers.within_cells import WithinCells

__all__ = ["EigenstrainField"]


_WORDS = {"displacement": "displacement x, y, z", "strain": "strain (6 components)", "stress": "stress (6 components)"}


class EigenstrainField(Cause):
    """Fields of one body, with the eigenstrain of inhomogeneities from stored steps."""

    def __init__(self, subsurface: Subsurface, request: StressRequest, lattice: RegionLattice) -> None:
        where, inhomogeneities = lattice.words, subsurface.inhomogeneities
        self._subsurface, self._lattice, self._name = (
            subsurface,
            lattice,
            eigenstrain_name(subsurface.body, beside=subsurface.beside),
        )
        self.requires = frozenset({self._name} if inhomogeneities else ())
        self.kernels: list[KernelUse] = []
        self.cost = Cost()
        self._prescribed: dict[str, PrescribedField] = {}
        self._routes: dict[str, Route] = {}
        self.precisions: list[Precision] = []
        self._cell_stress: FloatArray | None = None
        for quantity in request.fields:
            if subsurface.prescribed and not subsurface.beside:
                field = subsurface.prescribed_field(quantity, lattice)
                self.kernels += field.uses(_WORDS[quantity], where)
                self._prescribed[quantity] = field
                self._add(field)
            if inhomogeneities:
                route = subsurface.route(quantity, lattice)
                first = inhomogeneities[0]
                label = repr(first.name) if len(inhomogeneities) == 1 else f"{len(inhomogeneities)} inhomogeneities"
                layout = f"{where}, {route.words}"
                self.kernels.append(KernelUse(_WORDS[quantity], f"eigenstrain of {label}", first.key, layout))
                self._routes[quantity] = route
                self._add(route)
        if "stress" in self._routes and subsurface.in_cells and not subsurface.recedes:
            from eigencontact.execution.fields.material_points import cost_beside

            self.cost += cost_beside(subsurface, lattice.flat_points())

    def _add(self, contribution: PrescribedField | Route) -> None:
        """Add the cost and precisions of a contribution; keep the first note."""
        self.cost += contribution.cost
        self.precisions += contribution.precisions
        self.note = self.note or contribution.note

    def fields(self, step: Step) -> dict[str, FloatArray]:
        """Fields by quantity, ``(3 or 6, *lattice.shape)``."""
        fields = {quantity: field.at(step.time) for quantity, field in self._prescribed.items()}
        if self._routes:
            self._follow(step)
        for quantity, route in self._routes.items():
            eigenstrain = step.history[self._name].values
            values = route.field(eigenstrain)
            if quantity != "displacement" and self._within is not None:
                values = values + self._within.difference(quantity, eigenstrain).reshape(values.shape)
            if quantity == "stress":
                self._cell_stress = values.reshape(6, -1)
            fields[quantity] = fields[quantity] + values if quantity in fields else values
        return fields

    def amend(self, fields: dict[str, FloatArray], step: Step) -> None:
        """Correct the sum of all causes by the material at points in and near regions; voids have zero stress."""
        if not self._routes or self._subsurface.recedes or not {"stress", "strain"} & fields.keys():
            return
        subsurface, eigenstrain = self._subsurface, step.history[self._name].values
        if "stress" in fields and self._within is not None:
            stress, material = fields["stress"].reshape(6, -1).copy(), subsurface.half_space.material
            read_by_own_laws(stress, self._within, eigenstrain, subsurface.inhomogeneities, material, step.time)
            fields["stress"] = stress.reshape(fields["stress"].shape)
        if self._material_points is not None:
            self._material_points.amend(fields, self._cell_stress, eigenstrain, step.time)
        if self._empty is not None and "stress" in fields:
            stress = fields["stress"].reshape(6, -1)
            fields["stress"] = np.where(self._empty, 0.0, stress).reshape(fields["stress"].shape)

    @cached_property
    def _empty(self) -> NDArray[np.bool_] | None:
        """Points in voids; their stress is zero."""
        return empty_points(self._subsurface.inhomogeneities, self._lattice)

    @cached_property
    def _within(self) -> WithinCells | None:
        """Continuation of the eigenstrain between the cells of a region; None if not needed."""
        content, route = self._content, next(iter(self._routes.values()))
        if content is None or not (route.steps and content.whole.any()):
            return None
        from eigencontact.solvers.within_cells import WithinCells

        half_space = self._subsurface.half_space
        cells, material = self._subsurface.box.cells(half_space.grid), half_space.material
        return WithinCells(
            cells, content.whole, self._lattice.flat_points(),
            poisson_ratio=material.poisson_ratio, shear_modulus=material.shear_modulus,
        )  # fmt: skip

    @cached_property
    def _material_points(self) -> MaterialPoints | None:
        """Points in and near regions; None without such points."""
        if self._content is None or not self._content.share.any():
            return None
        from eigencontact.execution.fields.material_points import MaterialPoints

        points = MaterialPoints(self._subsurface, self._content, self._lattice.flat_points())
        return points if points.needs_correction else None

    @cached_property
    def _content(self) -> Content | None:
        """Regions in the cells; None if regions are whole or move by wear."""
        subsurface = self._subsurface
        if not subsurface.in_cells or subsurface.recedes:
            return None
        sources, grid = subsurface.inhomogeneities, subsurface.half_space.grid
        return content_of(subsurface.box, sources, grid, self._lattice.flat_points())

    def _follow(self, step: Step) -> None:
        """Choose the routes for the cells of a step: those of the scene, or those of an extended box."""
        subsurface = self._subsurface.with_cells(step.history[self._name].coords)
        if subsurface is None:
            raise ResultsError(
                f"{self._name} of step {step.index} must be in the cells that the scene stands for now (got others); "
                "run the scene again"
            )
        if subsurface is not self._subsurface:
            self._subsurface = subsurface
            for name in ("_content", "_within", "_material_points"):
                self.__dict__.pop(name, None)
            self._routes = {quantity: subsurface.route(quantity, self._lattice) for quantity in self._routes}
