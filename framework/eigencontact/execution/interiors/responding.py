"""Inhomogeneities of one body: their equivalent eigenstrain answers the tractions, as a whole or by sweeps."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.numbers import Number
from eigencontact.execution.blocks.contact import Fields
from eigencontact.execution.blocks.increment import Increment
from eigencontact.execution.interiors.interior import Interior, Remembered, by_direction, eigenstrain_name
from eigencontact.execution.routes.closed_form import ClosedForms
from eigencontact.execution.routes.prescribed import PrescribedField, cell_route
from eigencontact.execution.routes.route import HalfSpace, Route
from eigencontact.model.boxes import box_of_inhomogeneities
from eigencontact.model.model import Model
from eigencontact.model.regions import RegionLattice, surface_lattice
from eigencontact.model.sources import Inhomogeneity
from eigencontact.results.records import HistoryRecord
from eigencontact.solvers.report import Progress

__all__ = ["Responding", "places_solved", "solved_route"]

FloatArray = NDArray[np.float64]


def solved_route(
    model: Model, body: int, quantity: str, lattice: RegionLattice, rows: tuple[int, ...] | None = None
) -> Route:
    """Route from the equivalent eigenstrain of a body to its field at the points of a lattice."""
    half_space = HalfSpace.of(model, body)
    sources = [source for source in model.inhomogeneities if source.body == body]
    if model.numerics.inclusion_resolution == "whole":
        return ClosedForms(half_space, sources, quantity, lattice, rows)
    return cell_route(half_space, box_of_inhomogeneities(sources), quantity, lattice, rows)


def places_solved(model: Model, body: int) -> dict[str, FloatArray]:
    """Centres along z, y, x of the cells with an eigenstrain to be found, as stored; empty for whole inclusions."""
    if model.numerics.inclusion_resolution == "whole":
        return {}
    points = box_of_inhomogeneities([s for s in model.inhomogeneities if s.body == body]).centres(model.grid)
    return {"z": points.depths, "y": points.y, "x": points.x}


class Responding(Interior):
    """Equivalent eigenstrain of the inhomogeneities of one body.

    Prescribed eigenstrain of the same body acts on them by its stress. Where it lies in an inhomogeneity it stays what
    it is, a strain without stress, whatever the material: it adds to the prestrain there.

    Attributes
    ----------
    sources : tuple of Inhomogeneity
    eigenstrain : (6, ...)
        As it is, prestrain included.
    """

    numbers: Sequence[Number] = (
        Number(
            name="inclusion_iterations", unit="1", meaning="iterations for the equivalent eigenstrain, over all rounds",
            role="effort", over="sum",
        ),
        Number(
            name="inclusion_residual", unit="1", meaning="relative residual of the equivalent eigenstrain",
            role="certificate",
        ),
    )  # fmt: skip

    def __init__(self, model: Model, body: int, directions: str, points: RegionLattice | None) -> None:
        self.body, self.name = body, "inhomogeneities" if body == 1 else f"inhomogeneities-{body}"
        self._model, self._directions, self._numerics = model, directions, model.numerics
        self._half_space = HalfSpace.of(model, body)
        self.sources: tuple[Inhomogeneity, ...] = tuple(s for s in model.inhomogeneities if s.body == body)
        self.remembers = frozenset({eigenstrain_name(body)})
        self._tractions = model.tractions
        self._coords = places_solved(model, body)
        # Along tractions the mean over each cell belongs to the mean stress by those; elsewhere the centres are taken.
        self._means = "".join(item.direction for item in self._tractions if item.direction in directions)
        self._centres = "".join(name for name in directions if name not in self._means)
        others = [source for source in model.prescribed if source.body == body]
        self._prescribed = None
        if others and points is not None:
            self._prescribed = PrescribedField(self._half_space, others, "stress", points)
        self._surface: Route | None = None
        if self._centres:
            rows = tuple("xyz".index(name) for name in self._centres)
            self._surface = solved_route(model, body, "displacement", surface_lattice(model.grid), rows)
        self._time, self._spent, self._residual = 0.0, 0.0, 0.0
        self._lifted: tuple[FloatArray, FloatArray] | None = None
        self._progress: Progress | None = None

    @abstractmethod
    def mean_displacement(self, eigenstrain: FloatArray) -> FloatArray:
        """Mean displacement of the surface cells along all tractions, ``(n, ny, nx)`` [m], of this body alone."""

    @abstractmethod
    def applied(self, tractions: Fields) -> FloatArray:
        """Mean stress of the contact and of the prescribed eigenstrain in them, ``(6, ...)`` [Pa]."""

    @abstractmethod
    def prestrain(self, time: float) -> FloatArray:
        """Eigenstrain of their own, ``(6, ...)``."""

    @abstractmethod
    def solve(self, applied: FloatArray, prestrain: FloatArray, tolerance: float) -> Any:
        """Solve for the eigenstrain: an answer with ``eigenstrain`` and ``report``."""

    def begin(self, increment: Increment, last: Remembered) -> None:
        """See `Interior.begin`."""
        self._time, self._progress = increment.times[1], increment.progress
        self._own = self.prestrain(self._time)
        known = last.get(eigenstrain_name(self.body))
        self.eigenstrain = self._own if known is None else self.fitted(known)
        self._spent, self._residual = 0.0, 0.0

    def fitted(self, known: HistoryRecord) -> FloatArray:
        """What was stored, on the cells of this interior."""
        return known.values

    def image(self, tractions: Fields, tolerance: float) -> tuple[FloatArray, float]:
        """See `Interior.image`."""
        found = self.solve(self.applied(tractions), self._own, tolerance)
        self.eigenstrain, self._residual = found.eigenstrain, found.report.residual
        self._spent += found.report.iterations
        return self.unknown, self._residual

    def displacement(self, directions: str) -> dict[str, FloatArray]:
        """See `Interior.displacement`."""
        found: dict[str, FloatArray] = {}
        if self._means and set(directions) & set(self._means):
            if self._lifted is None or not np.array_equal(self._lifted[0], self.eigenstrain):
                self._lifted = self.eigenstrain, self.mean_displacement(self.eigenstrain)
            rows = dict(zip((item.direction for item in self._tractions), self._lifted[1], strict=True))
            found = by_direction(self.body, self._means, np.array([rows[name] for name in self._means]))
        if self._surface is not None and set(directions) & set(self._centres):
            found |= by_direction(self.body, self._centres, self._surface.field(self.eigenstrain)[:, 0])
        return {name: found[name] for name in directions}

    @property
    def progress(self) -> Progress | None:
        """Told the residual of each iteration."""
        return self._progress

    def remembered(self) -> dict[str, HistoryRecord]:
        """See `Interior.remembered`."""
        name = eigenstrain_name(self.body)
        meaning = "eigenstrain equivalent to the inhomogeneities, prestrain included, Mandel components"
        return {name: self._record(name, self.eigenstrain, "1", meaning)}

    def _record(self, name: str, values: FloatArray, unit: str, meaning: str) -> HistoryRecord:
        coords = self._coords
        return HistoryRecord(name=name, body=self.body, values=values, coords=coords, unit=unit, meaning=meaning)

    def scalars(self) -> dict[str, float]:
        """See `Interior.scalars`."""
        return {"inclusion_iterations": self._spent, "inclusion_residual": self._residual}
