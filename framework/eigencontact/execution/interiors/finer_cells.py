"""Finer cells at the inclusions of a body with a nonlinear law, coupled with the other cells of the body.

Each level is an interior of its own, and both are iterated together. `eigencontact.solvers.two_levels` gives the stress
in both. The stress of tractions in finer cells is interpolated from means over coarse cells. The eigenstrain of finer
cells displaces the surface through the coarse cells that represent it. These two operations are adjoint. Coarse cells
of the patch have no eigenstrain of their own. Results store means over the finer cells in their place, and the values
of the finer cells under separate names.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from eigencontact.core.array_types import FloatArray
from eigencontact.core.grid import Grid
from eigencontact.errors import SceneError
from eigencontact.execution.blocks.contact import Fields
from eigencontact.execution.blocks.increment import Increment
from eigencontact.execution.interiors.interior import Interior, Records, by_direction, loads
from eigencontact.execution.interiors.swept_cells import SweptCells, should_sweep
from eigencontact.execution.routes.subsurface import Subsurface, ground_of
from eigencontact.model.boxes import CellBox, box_of_inhomogeneities
from eigencontact.model.refined import divided, divided_grid, divided_members, inner_bounds, inner_of
from eigencontact.model.sources import Lattice
from eigencontact.plugin import ConstitutiveLaw
from eigencontact.results.records import HistoryRecord
from eigencontact.solvers.mean_stress import MeanVolumeField
from eigencontact.solvers.two_levels import TwoLevels

__all__ = ["CoarseCells", "FinerCells", "Levels", "join_levels", "two_levels", "unsupported"]

_WHERE, _FINER = "numerics.inclusion-refinement", "_finer"


class CoarseCells(SweptCells):
    """Cells of a body outside the patch of finer cells at its inclusions.

    `join_levels` joins them with the finer cells before the first increment.
    """

    def __init__(self, subsurface: Subsurface, directions: str) -> None:
        super().__init__(subsurface, directions)
        self.reason = f"equivalent eigenstrain outside of the finer cells of body {self.body}, swept with the contact"

    def begin(self, increment: Increment, last: Records) -> None:
        """See `Interior.begin`; coarse cells of the patch have the means of the finer cells and no state."""
        super().begin(increment, last)
        assert self.levels is not None
        self.eigenstrain = self._start = self.levels.without_patch(self.eigenstrain)

    def state_records(self) -> dict[str, HistoryRecord]:
        """See `Interior.state_records`; the patch has means over the finer cells."""
        assert self.levels is not None
        records = super().state_records()
        for record in self.levels.fine.state_records().values():
            name = record.name.replace(_FINER, "")
            if name not in records:
                shape = (len(record.values), *self.box.lattice.shape)
                records[name] = self._record(name, np.zeros(shape), record.unit, record.meaning)
            values = records[name].values.copy()
            self.levels.field.put_means(values, record.values)
            records[name] = replace(records[name], values=values)
        return records

    def displaced_by(self, at_centres: FloatArray, means: FloatArray) -> dict[str, FloatArray]:
        """Displacement of the surface by eigenstrain ``(6, nz, ny, nx)`` in these cells, by direction [m].

        Along traction directions it follows from values at the cell centres, along other directions from means over
        cells.
        """
        moved: dict[str, FloatArray] = {}
        if self._joint is not None:
            along = (item.direction for item in self._tractions)
            rows = dict(zip(along, self._joint.displacement(at_centres), strict=True))
            moved = by_direction(self.body, self._means, np.array([rows[name] for name in self._means]))
        if self._surface is not None:
            moved |= by_direction(self.body, self._centres, self._surface.field(means)[:, 0])
        return moved

    def stress_of_tractions(self, tractions: Fields) -> FloatArray | None:
        """Mean stress ``(6, nz, ny, nx)`` [Pa] in the cells by the contact only; None without a contact."""
        if self._joint is None or not any(field.any() for field in tractions.values()):
            return None
        return self._joint.stress(loads(self.body, self._tractions, tractions))


class FinerCells(SweptCells):
    """Finer cells at the inclusions of a body.

    Parameters
    ----------
    subsurface : Subsurface
        Subsurface of the finer cells, without tractions: tractions act on them through the coarse cells.
    patch : Lattice
        Coarse cells that are divided, and their rim.
    coarse_grid : Grid
        Cells of the surface.
    """

    def __init__(self, subsurface: Subsurface, patch: Lattice, coarse_grid: Grid) -> None:
        self._patch, self._coarse_grid = patch, coarse_grid
        super().__init__(subsurface, "")
        self._stored = _finer(self._stored)
        self.state_names = frozenset({self._stored, *(self._name(n) for s in self.sources for n in s.law.variables)})
        ratio = self._numerics.refinement
        self.reason = f"equivalent eigenstrain in {self.box.words}, {ratio} times finer at inclusions, swept together"
        self._moved: tuple[FloatArray, dict[str, FloatArray]] | None = None

    def _name(self, variable: str) -> str:
        return _finer(super()._name(variable))

    def _record(self, name: str, values: FloatArray, unit: str, meaning: str) -> HistoryRecord:
        return replace(super()._record(name, values, unit, meaning), finer=True)

    def _declare(self) -> None:
        super()._declare()
        self.cost += self._operator_cost(self._patch)

    def start(self) -> None:
        """See `Interior.start`."""
        super().start()
        cells = CellBox(self.sources, self._patch).cells(self._coarse_grid)
        self.patch_operator = MeanVolumeField(
            self._half_space.cell, cells, cells, precision=self._numerics.precision,
            applications=self._applications * self._half_space.steps, **self._half_space.options("stress"),
        )  # fmt: skip

    @property
    def inner(self) -> tuple[slice, slice, slice]:
        """Coarse cells of the patch that are divided, along z, y, x."""
        return inner_of(self._patch)

    def applied(self, tractions: Fields) -> FloatArray:
        """See `Responding.applied`."""
        assert self.levels is not None
        total = super().applied({})
        means = self.levels.coarse.stress_of_tractions(tractions)
        return total if means is None else total + self.at_centres(self.levels.field.interpolated(means))

    def displacement(self, directions: str) -> dict[str, FloatArray]:
        """See `Interior.displacement`."""
        assert self.levels is not None
        if self._moved is None or not np.array_equal(self._moved[0], self.eigenstrain):
            spread = self.levels.field.spread
            moved = self.levels.coarse.displaced_by(spread(self.at_centres(self.eigenstrain)), spread(self.eigenstrain))
            self._moved = self.eigenstrain.copy(), moved
        return {name: self._moved[1][name] for name in directions}


class Levels:
    """Coarse and finer cells of one body, both started."""

    def __init__(self, coarse: CoarseCells, fine: FinerCells) -> None:
        self.coarse, self.fine = coarse, fine
        self.field = TwoLevels(coarse.operator, fine.patch_operator, fine.operator, fine.inner)

    def stress_in(self, cells: SweptCells) -> FloatArray:
        """Stress ``(6, nz, ny, nx)`` [Pa] in one level by the present eigenstrain of both levels."""
        coarse, fine = self.field.stress(self.coarse.eigenstrain, self.fine.eigenstrain)
        return coarse if cells is self.coarse else fine

    def without_patch(self, eigenstrain: FloatArray) -> FloatArray:
        """Eigenstrain of the coarse cells, zero in divided cells."""
        out = eigenstrain.copy()
        out[:, *self.field.place][:, *self.fine.inner] = 0.0
        return out


def join_levels(interiors: Sequence[Interior]) -> None:
    """Join coarse and finer cells of one body; all are started."""
    for fine in interiors:
        if isinstance(fine, FinerCells):
            coarse = next(cells for cells in interiors if isinstance(cells, CoarseCells) and cells.body == fine.body)
            if fine.levels is None or fine.levels.coarse is not coarse:
                coarse.levels = fine.levels = Levels(coarse, fine)
                coarse.is_beside = fine.is_beside = True


def two_levels(subsurface: Subsurface, directions: str) -> tuple[CoarseCells, FinerCells]:
    """Interiors of both levels of a body, not yet started.

    Raises
    ------
    SceneError
        The body has no inclusions or no nonlinear law, or it has a feature that finer cells do not support.
    """
    half_space, members = subsurface.half_space, subsurface.inhomogeneities
    if (reason := unsupported(subsurface)) is not None:
        raise SceneError(
            f"{_WHERE} must be 1 where {reason} (got {half_space.numerics.refinement}); leave it out, or "
            "give a finer grid and numerics.inclusion-pitch"
        )
    ratio, grid = half_space.numerics.refinement, half_space.grid
    inclusions = [source for source in members if not source.guessed]
    patch = box_of_inhomogeneities(inclusions).lattice
    inner = inner_bounds(patch, grid)
    place = replace(inclusions[0], name="finer cells", shape=inner, lattice=patch, degree=None)
    around = ground_of(place, half_space.material)
    finer = replace(
        subsurface, half_space=replace(half_space, grid=divided_grid(grid, ratio)), influences=(),
        inhomogeneities=(
            replace(around, lattice=divided(patch, ratio)), *divided_members(members, patch, inner, ratio)
        ),
    )  # fmt: skip
    coarse = CoarseCells(replace(subsurface, inhomogeneities=(*members, around)), directions)
    return coarse, FinerCells(finer, patch, grid)


def unsupported(subsurface: Subsurface) -> str | None:
    """Feature of a body that finer cells at inclusions do not support, in words; None without such a feature."""
    half_space, sources = subsurface.half_space, subsurface.inhomogeneities
    numerics = half_space.numerics
    linear = not should_sweep(subsurface)
    averaged = any(layer.averaged for source in sources for layer in _layers(source.law))
    reasons = {
        f"body {subsurface.body} has no inclusion": all(source.guessed for source in sources),
        f"all laws of body {subsurface.body} are linear, and beyond 1/20 to 20 times as stiff or no contact": linear,
        f"body {subsurface.body} has prescribed eigenstrain": bool(subsurface.prescribed),
        f"body {subsurface.body} begins with the state of another run": subsurface.initial is not None,
        f"the surface of body {subsurface.body} wears": subsurface.recedes,
        f"a law of body {subsurface.body} averages over a neighbourhood": averaged,
        f"numerics.half-space is {numerics.half_space!r}": numerics.half_space not in ("exact", "full-space"),
        "the contact is a line": half_space.grid.line,
    }
    return next((words for words, holds in reasons.items() if holds), None)


def _layers(law: ConstitutiveLaw) -> list[ConstitutiveLaw]:
    """Local laws of a composite law."""
    origin = np.zeros(1)
    return [layer for layer, _ in law.laws_at(origin, origin, origin)]


def _finer(name: str) -> str:
    """Name of a record of finer cells: that of coarse cells with a mark before the number of the body."""
    stem, _, body = name.rpartition("_")
    return f"{stem}{_FINER}_{body}"
