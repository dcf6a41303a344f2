"""Inhomogeneities of one body with an equivalent eigenstrain that depends on the tractions."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from eigencontact.core.array_types import FloatArray
from eigencontact.core.bulk import bulk_of, in_plane_strain, plane_stress
from eigencontact.core.numbers import Number
from eigencontact.execution.blocks.contact import Fields
from eigencontact.execution.blocks.increment import Increment
from eigencontact.execution.interiors.interior import Interior, Records, by_direction, eigenstrain_name
from eigencontact.execution.routes.prescribed import PrescribedField
from eigencontact.execution.routes.route import Route
from eigencontact.execution.routes.subsurface import Subsurface
from eigencontact.model.regions import RegionLattice, surface_lattice
from eigencontact.results.records import HistoryRecord
from eigencontact.solvers.report import Progress

__all__ = ["Responding"]


class Responding(Interior):
    """Equivalent eigenstrain of the inhomogeneities of one body.

    Prescribed eigenstrain and bulk stress of the same body load the inhomogeneities by their stress. Prescribed
    eigenstrain inside an inhomogeneity adds to its prestrain.

    Parameters
    ----------
    subsurface : Subsurface
    directions : str
        Directions of the surface displacement, out of ``"xyz"``.
    points : RegionLattice or None
        Points for the stress of prescribed eigenstrain; None if `start` chooses them.

    Attributes
    ----------
    sources : tuple of Inhomogeneity
    eigenstrain : (6, ...)
        Present eigenstrain, prestrain included.
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

    def __init__(self, subsurface: Subsurface, directions: str, points: RegionLattice | None) -> None:
        body = subsurface.body
        self.body, self.name = body, "inhomogeneities" if body == 1 else f"inhomogeneities-{body}"
        self._subsurface, self._directions, self._half_space = subsurface, directions, subsurface.half_space
        self._numerics, self._grid = self._half_space.numerics, self._half_space.grid
        self.sources, self._tractions = subsurface.inhomogeneities, subsurface.tractions
        self._stored = eigenstrain_name(body, beside=subsurface.beside)
        self.state_names = frozenset({self._stored})
        self._coords = subsurface.coords
        # Along traction directions the mean over each cell is reciprocal to the mean stress; other directions use the
        # centre.
        self._means = "".join(item.direction for item in self._tractions if item.direction in directions)
        self._centres = "".join(name for name in directions if name not in self._means)
        self._prescribed: PrescribedField | None = None
        self._bulk: FloatArray | None = None
        if subsurface.prescribed and points is not None:
            self._prescribed = subsurface.prescribed_field("stress", points)
        self._surface: Route | None = None
        if self._centres:
            rows = tuple("xyz".index(name) for name in self._centres)
            self._surface = subsurface.route("displacement", surface_lattice(self._grid), rows)
        self._time, self._operator_calls, self._residual = 0.0, 0.0, 0.0
        self._lifted: tuple[FloatArray, FloatArray] | None = None
        self._progress: Progress | None = None

    @abstractmethod
    def mean_displacement(self, eigenstrain: FloatArray) -> FloatArray:
        """Mean displacement of the surface cells of this body along all tractions, ``(n, ny, nx)`` [m]."""

    @abstractmethod
    def applied(self, tractions: Fields) -> FloatArray:
        """Mean stress in the regions by the contact, prescribed eigenstrain and bulk stress, ``(6, ...)`` [Pa]."""

    @abstractmethod
    def prestrain(self, time: float) -> FloatArray:
        """Prestrain, ``(6, ...)``."""

    @abstractmethod
    def solve(self, applied: FloatArray, prestrain: FloatArray, tolerance: float) -> Any:
        """Solve for the eigenstrain; the result has ``eigenstrain`` and ``report``."""

    def begin(self, increment: Increment, last: Records) -> None:
        """See `Interior.begin`."""
        self._time, self._progress = increment.times[1], increment.progress
        self._prestrain = self.prestrain(self._time)
        self._bulk = self._bulk_stress(increment.bulk[1])
        record = last.get(self._stored)
        self.eigenstrain = self._prestrain if record is None else self.fitted(record)
        self._operator_calls, self._residual = 0.0, 0.0

    def _bulk_stress(self, values: Mapping[str, float]) -> FloatArray | None:
        """Mandel bulk stress ``(6,)`` [Pa]; None without bulk stress."""
        stress, material = bulk_of(values, self.body), self._half_space.material
        if not stress.any():
            return None
        return plane_stress(in_plane_strain(stress, material, self._grid), material)

    def fitted(self, record: HistoryRecord) -> FloatArray:
        """Stored values on the cells of this interior."""
        return record.values

    def image(self, tractions: Fields, tolerance: float) -> tuple[FloatArray, float]:
        """See `Interior.image`."""
        solution = self.solve(self.applied(tractions), self._prestrain, tolerance)
        self.eigenstrain, self._residual = solution.eigenstrain, solution.report.residual
        self._operator_calls += solution.report.iterations
        return self.unknown, self._residual

    def displacement(self, directions: str) -> dict[str, FloatArray]:
        """See `Interior.displacement`."""
        moved: dict[str, FloatArray] = {}
        if self._means and set(directions) & set(self._means):
            if self._lifted is None or not np.array_equal(self._lifted[0], self.eigenstrain):
                self._lifted = self.eigenstrain, self.mean_displacement(self.eigenstrain)
            rows = dict(zip((item.direction for item in self._tractions), self._lifted[1], strict=True))
            moved = by_direction(self.body, self._means, np.array([rows[name] for name in self._means]))
        if self._surface is not None and set(directions) & set(self._centres):
            moved |= by_direction(self.body, self._centres, self._surface.field(self.eigenstrain)[:, 0])
        return {name: moved[name] for name in directions}

    @property
    def progress(self) -> Progress | None:
        """Callback for the residual of each iteration."""
        return self._progress

    def state_records(self) -> dict[str, HistoryRecord]:
        """See `Interior.state_records`."""
        name = self._stored
        meaning = "eigenstrain equivalent to the inhomogeneities, prestrain included, Mandel components"
        return {name: self._record(name, self.eigenstrain, "1", meaning)}

    def _record(self, name: str, values: FloatArray, unit: str, meaning: str) -> HistoryRecord:
        coords = self._coords
        return HistoryRecord(name=name, body=self.body, values=values, coords=coords, unit=unit, meaning=meaning)

    def scalars(self) -> dict[str, float]:
        """See `Interior.scalars`."""
        return {"inclusion_iterations": self._operator_calls, "inclusion_residual": self._residual}
