"""Fields of prescribed eigenstrain at any time: the regions of one body, each by its cheapest route."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from eigencontact.core.array_types import FloatArray
from eigencontact.execution.blocks.block import Cost
from eigencontact.execution.blocks.precision import Precision
from eigencontact.execution.routes.cell_strain import CellStrain
from eigencontact.execution.routes.cells import Between, Planes, cheapest
from eigencontact.execution.routes.closed_form import ClosedForms
from eigencontact.execution.routes.route import CellRoute, HalfSpace
from eigencontact.model.boxes import CellBox, boxes_of
from eigencontact.model.kernels import KernelUse
from eigencontact.model.regions import RegionLattice
from eigencontact.model.sources import Source

__all__ = ["PrescribedField", "cell_route"]

Rows = tuple[int, ...] | None


class PrescribedField:
    """Field of the prescribed eigenstrain of one body at the points of a lattice.

    Constant eigenstrain is evaluated once, and its operators are then released.
    """

    def __init__(
        self, half_space: HalfSpace, sources: Sequence[Source], quantity: str, lattice: RegionLattice, rows: Rows = None
    ) -> None:
        self.quantity, self._rows = quantity, rows
        self._shape = (len(rows) if rows is not None else 3 if quantity == "displacement" else 6, *lattice.shape)
        steady, moving = ([s for s in sources if bool(s.field.varies) is varies] for varies in (False, True))
        find = partial(_terms, half_space, quantity=quantity, lattice=lattice, rows=rows)
        self._still, self._moving = find(steady), find(moving)
        #: Cost of all steps.
        self.cost = sum((term.cost for term in self._moving), sum((term.cost.once for term in self._still), Cost()))
        self._regions = [region for term in (*self._still, *self._moving) for region in term.regions()]
        #: See `PlanItem`.
        self.precisions = [precision for term in (*self._still, *self._moving) for precision in term.precisions]
        #: Remark on the values; may be empty.
        self.note = next((term.note for term in (*self._still, *self._moving) if term.note), "")
        self._once: FloatArray | None = None

    def uses(self, field: str, where: str) -> list[KernelUse]:
        """Influence coefficients for `explain`; equal regions are counted together.

        Parameters
        ----------
        field : str
            Name of the field, for example ``"stress (6 components)"``.
        where : str
            Description of the points.
        """
        uses: dict[tuple[str, str], KernelUse] = {}
        for source, label, method in self._regions:
            like = (source.key, method)
            if like in uses:
                uses[like] = replace(uses[like], count=uses[like].count + 1)
            else:
                uses[like] = KernelUse(field, f"eigenstrain of {label}", source.key, f"{where}, {method}")
        return list(uses.values())

    def at(self, time: float) -> FloatArray:
        """Field at one time, ``(rows, *lattice.shape)``."""
        if self._once is None:
            self._once = np.zeros(self._shape)
            while self._still:
                self._once += self._still.pop().at(time)
        total = self._once
        for term in self._moving:
            total = total + term.at(time)
        return total


class _Term(ABC):
    """Field of some regions, and its description for `explain`."""

    cost: Cost
    note = ""
    precisions: Sequence[Precision] = ()

    @abstractmethod
    def regions(self) -> list[tuple[Source, str, str]]:
        """Regions, each with its name and the description of its method."""

    @abstractmethod
    def at(self, time: float) -> FloatArray:
        """Field at one time."""


def _terms(
    half_space: HalfSpace, sources: Sequence[Source], quantity: str, lattice: RegionLattice, rows: Rows
) -> list[_Term]:
    if not sources:
        return []
    if half_space.numerics.half_space == "image-pressure":
        return [_ByImage(half_space, sources, quantity, lattice, rows)]
    exact = [source for source in sources if source.lattice is None]
    terms: list[_Term] = [_Uniform(ClosedForms(half_space, exact, quantity, lattice, rows))] if exact else []
    return terms + [
        _InCells(cell_route(half_space, box, quantity, lattice, rows)) for box in boxes_of(sources)
    ]  # fmt: skip


def cell_route(
    half_space: HalfSpace, box: CellBox, quantity: str, lattice: RegionLattice, rows: Rows = None
) -> CellRoute:
    """Route from the eigenstrain in a box of cells: the method of the numerics, or the cheapest exact one."""
    if half_space.numerics.half_space == "periodic":
        from eigencontact.execution.routes.lower_fidelities import Periodic

        return Periodic(half_space, box, quantity, lattice, rows)

    def make(kind: type[Planes]) -> Planes:
        return kind(half_space, box, quantity, lattice, rows)

    if Between.fits(lattice, box, half_space.grid):
        return make(Between)
    return cheapest(make, lattice, box.lattice.edges[0])


class _InCells(_Term):
    """Regions divided into cells."""

    def __init__(self, route: CellRoute) -> None:
        self._route, self._strain = route, CellStrain(route.box, route.half_space.grid)
        self.cost, self.note, self.precisions = route.cost, route.note, route.precisions

    def regions(self) -> list[tuple[Source, str, str]]:
        return [(self._route.sources[0], self._route.box.names, self._route.words)]

    def at(self, time: float) -> FloatArray:
        return self._route.field(self._strain(time))


class _Uniform(_Term):
    """Shapes with uniform eigenstrain.

    Their field is linear in the eigenstrain. If all eigenstrain changes by one common factor, the route scales the
    field at the end of the first step. It always scales this field, so that a resumed run gives identical numbers.
    """

    def __init__(self, route: ClosedForms) -> None:
        self._route = route
        self._end = self._strain(1.0)
        self._at_end: FloatArray | None = None
        self.cost = route.cost.once

    def regions(self) -> list[tuple[Source, str, str]]:
        return [(source, repr(source.name), source.how) for source in self._route.sources]

    def _strain(self, time: float) -> FloatArray:
        return np.array([source.uniform_eigenstrain(time) for source in self._route.sources]).T

    def at(self, time: float) -> FloatArray:
        eigenstrain, size = self._strain(time), float(np.sum(self._end * self._end))
        factor = float(np.sum(eigenstrain * self._end)) / size if size else 0.0
        if not np.allclose(factor * self._end, eigenstrain, rtol=1e-14, atol=0.0):
            return self._route.field(eigenstrain)
        if self._at_end is None:
            self._at_end = self._route.field(self._end)
        return factor * self._at_end


class _ByImage(_Term):
    """Regions in a half-space by image and pressure."""

    def __init__(
        self, half_space: HalfSpace, sources: Sequence[Source], quantity: str, lattice: RegionLattice, rows: Rows
    ) -> None:
        from eigencontact.execution.routes.lower_fidelities import ImagePressureField

        exact = replace(half_space, numerics=half_space.numerics.model_copy(update={"half_space": "full-space"}))
        self._field = ImagePressureField(
            half_space, sources, quantity, lattice, lambda name, points: PrescribedField(exact, sources, name, points)
        )
        self._rows, self._sources = slice(None) if rows is None else list(rows), sources
        self.cost = self._field.cost

    def regions(self) -> list[tuple[Source, str, str]]:
        return [(source, repr(source.name), self._field.words) for source in self._sources]

    def at(self, time: float) -> FloatArray:
        return self._field.at(time)[self._rows]
