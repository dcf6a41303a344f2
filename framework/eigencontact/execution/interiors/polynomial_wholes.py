"""Inhomogeneities with a polynomial eigenstrain each, in one body: no cells, no integration of the contact's stress."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from eigencontact.core.array_types import FloatArray
from eigencontact.core.grid import Grid
from eigencontact.core.numbers import Number
from eigencontact.core.tractions import side
from eigencontact.errors import SceneError
from eigencontact.execution.blocks.block import Cost
from eigencontact.execution.blocks.contact import Fields
from eigencontact.execution.blocks.increment import Increment
from eigencontact.execution.interiors.checked_work import CheckedWork
from eigencontact.execution.interiors.interior import Records, loads
from eigencontact.execution.interiors.responding import Responding
from eigencontact.execution.routes.subsurface import Subsurface
from eigencontact.halfspace.cloud import likeness
from eigencontact.halfspace.moments import densities_up_to
from eigencontact.halfspace.potentials import HasMomentPotentials
from eigencontact.halfspace.region_means import is_ball
from eigencontact.model.kernels import KernelUse
from eigencontact.model.overlaps import overlapping
from eigencontact.model.whole_degrees import functions_up_to
from eigencontact.results.records import HistoryRecord
from eigencontact.solvers.whole_surface import WholeSurface, table_key

if TYPE_CHECKING:
    from eigencontact.execution.interiors.beside_cells import BesideCells
    from eigencontact.solvers.polynomial_inclusions import PolynomialInclusions

__all__ = ["PolynomialWholes"]

#: Seconds per function and surface cell on one thread, with four points in each cell.
_TABLE = 4e-7


class PolynomialWholes(Responding):
    """Polynomial eigenstrain of each inhomogeneity.

    One table has the mean displacement of every surface cell by each function of an inclusion. By Betti's theorem it
    also gives the work of tractions on that function; see `eigencontact.solvers.whole_surface`.

    Raises
    ------
    SceneError
        Inclusions overlap, or no degree reaches the allowed error.
    """

    numbers: Sequence[Number] = (
        *Responding.numbers,
        Number(
            name="inclusion_degree_error", unit="1", role="error", over="max",
            meaning="estimated error of the eigenstrain of whole inhomogeneities by their degree, in parts of it",
            headline=True, label="error of inclusions by degree",
        ),
        Number(
            name="inclusion_load_error", unit="1", role="error", over="max",
            meaning="estimated error of the eigenstrain of whole inhomogeneities by the integration of the stress of "
            "prescribed eigenstrain, in parts of what this stress causes",
        ),
    )  # fmt: skip

    def __init__(self, subsurface: Subsurface, directions: str) -> None:
        super().__init__(subsurface, directions, None)
        self.beside: Sequence[BesideCells] = ()
        self._work: CheckedWork | None = None
        for first, second in overlapping(self.sources):
            raise SceneError(
                f"{second.where} ({second.name!r}) must not overlap with {first.name!r} for whole inclusions in "
                "numerics.inclusion-resolution (got ground that both hold); set it to 'cells'"
            )
        self._degrees = [source.degree for source in self.sources if source.degree is not None]
        # There is no lower degree for a comparison with degree 0.
        self.estimates_degree = max(item.degree for item in self._degrees) > 0
        if not self.estimates_degree:
            self.numbers = Responding.numbers
        self.reason = self._reason()
        self._declare()

    def _reason(self) -> str:
        lowest, highest = (pick(item.degree for item in self._degrees) for pick in (min, max))
        degrees = f"degree {highest}" if lowest == highest else f"degrees {lowest} to {highest}"
        unknowns = sum(functions_up_to(item.degree) for item in self._degrees)
        worst = max(item.error for item in self._degrees)
        count = "its" if len(self.sources) == 1 else f"{len(self.sources)} inhomogeneities of"
        kind = f"polynomial eigenstrain of {degrees}" if highest else "uniform eigenstrain"
        text = f"{count} {kind}, {unknowns} unknowns"
        foretold = f", foretold error {100 * worst:.2g} % of what the load causes there"
        return text + foretold if worst > 0 and highest else text

    def _declare(self) -> None:
        """Set cost and kernels."""
        count, cells, along = len(self.sources), self._grid.nx * self._grid.ny, max(len(self._means), 1)
        alike = Counter(
            (likeness(source.shape), item.degree, table_key(source.shape.bounds, self._grid), is_ball(source.shape))
            for source, item in zip(self.sources, self._degrees, strict=True)
        )
        functions = [(functions_up_to(degree), members) for (_, degree, _, _), members in alike.items()]
        tables = sum(size * cells * min(members, 4) for size, members in functions)
        blocks = sum(8.0 * size**2 * min(count, 30) for size, _ in functions)
        matrices = [_matrix_cost(degree, ball=ball) for _, degree, _, ball in alike]
        self.cost = Cost(
            memory=8.0 * tables * (2 * along + 1) + blocks + max(matrix_memory for matrix_memory, _ in matrices) + 60e6,
            seconds_once=(tables * _TABLE + sum(seconds for _, seconds in matrices) * min(count, 30))
            / self._half_space.threads,
            seconds_per_step=sum(4e-8 * size * cells * members for size, members in functions) + 1e-3 * count,
        )
        shapes = " and ".join(sorted({source.key for source in self.sources}))
        self.kernels = (
            KernelUse("mean displacement", "polynomial eigenstrain", shapes, "whole window", count),
            KernelUse("work of stress", "polynomial eigenstrain", shapes, "each in each", count**2),
        )
        if self._surface is not None:
            self.cost += self._surface.cost

    def start(self) -> None:
        """See `Interior.start`."""
        from eigencontact.solvers.polynomial_inclusions import PolynomialInclusions

        self._system = PolynomialInclusions(
            [cast("HasMomentPotentials", source.shape) for source in self.sources], self._half_space.material,
            [cast("Any", source.law) for source in self.sources], [item.degree for item in self._degrees],
            space=self._half_space.space, threads=self._numerics.threads,
        )  # fmt: skip
        self._table = None
        if self._tractions:
            along = "".join(item.direction for item in self._tractions)
            self._table = WholeSurface(self._system, self._grid, along, threads=self._numerics.threads)
        if self._subsurface.prescribed:
            self._work = CheckedWork(self._system, self._subsurface)

    def begin(self, increment: Increment, last: Records) -> None:
        """See `Interior.begin`."""
        super().begin(increment, last)
        if self._stored not in last:
            zero = np.zeros(self._system.size)
            self.eigenstrain = self._system.eigenstrain(zero, self._prestrain)
        self._amplitudes = self._system.amplitudes_of(self.eigenstrain, self._prestrain)
        self._load = np.zeros(self._system.size)
        self._below: tuple[FloatArray, FloatArray] | None = None
        if self._work is not None:
            self._work.begin(self._time)

    @property
    def system(self) -> PolynomialInclusions:
        """System of all inclusions."""
        return self._system

    @property
    def grid(self) -> Grid:
        """Grid of the surface."""
        return self._grid

    @property
    def amplitudes(self) -> FloatArray:
        """Present amplitudes of all functions."""
        return self._amplitudes

    @property
    def present(self) -> FloatArray:
        """Present prestrain, ``(6, n)``."""
        return self._prestrain

    def prestrain(self, time: float) -> FloatArray:
        """See `Responding.prestrain`."""
        return np.array([source.uniform_eigenstrain(time) for source in self.sources]).T

    def applied(self, tractions: Fields) -> FloatArray:
        """See `Responding.prestrain`."""
        total = np.zeros(self._system.size)
        for cells in self.beside:
            total += cells.work()
        if self._work is not None:
            total += self._work.present
        if self._bulk is not None:
            points = self._system.points.shape[1]
            total += self._system.moments(np.broadcast_to(self._bulk[:, None], (6, points)))
        if tractions:
            assert self._table is not None
            total += self._table.work(np.array(loads(self.body, self._tractions, tractions)))
        return total

    def solve(self, applied: FloatArray, prestrain: FloatArray, tolerance: float) -> Any:
        """See `Responding.solve`."""
        answer = self._system.solve(
            applied, prestrain, start=self._amplitudes, tolerance=tolerance,
            max_iterations=self._numerics.max_iterations, progress=self.progress,
        )  # fmt: skip
        self._amplitudes, self._load, self._below = answer.amplitudes, applied, None
        return answer

    def mean_displacement(self, eigenstrain: FloatArray) -> FloatArray:
        """See `Responding.mean_displacement`."""
        assert self._table is not None
        return self._table.displacement(self._system.amplitudes_of(eigenstrain, self._prestrain), self._prestrain)

    def scalars(self) -> dict[str, float]:
        """See `Interior.scalars`."""
        errors = {"inclusion_degree_error": self._error()} if self.estimates_degree else {}
        if self._work is not None and self.estimates_degree:
            errors["inclusion_load_error"] = self._work.error
        return super().scalars() | errors

    def _lower(self) -> tuple[FloatArray, FloatArray]:
        """Amplitudes of the solutions with a degree lower by one, and by two, under the present load."""
        if self._below is None:
            start, prestrain = self._amplitudes, self._prestrain
            first, second = (
                self._system.solve(self._load, prestrain, start=start, lower=lower).amplitudes for lower in (1, 2)
            )
            self._below = first, second
        return self._below

    def _error(self) -> float:
        """Estimated error of the inclusion with the largest error, relative to the largest eigenstrain."""
        system = self._system
        largest = float(system.difference(self._amplitudes, np.zeros(system.size)).max())
        if largest == 0.0:
            return 0.0
        below, far_below = self._lower()
        last, earlier = system.difference(self._amplitudes, below), system.difference(below, far_below)
        return float((np.maximum(last, 0.5 * earlier) * self._beyond).max() / largest)

    @property
    def _beyond(self) -> FloatArray:
        """Predicted change by all higher degrees of each inclusion, relative to the change by the last degree."""
        return np.array([max(item.quality / (1.0 - item.quality), 0.1) for item in self._degrees])

    def normal_displacement_by_less(self) -> tuple[float, Sequence[FloatArray]]:
        """See `Interior.normal_displacement_by_less`."""
        if self._table is None or not (self.estimates_degree and self._amplitudes.any()):
            return 0.0, ()
        zero_prestrain = np.zeros_like(self._prestrain)
        changes = [
            self._table.displacement(below - self._amplitudes, zero_prestrain)[0] * side(self.body, "z")
            for below in self._lower()
        ]
        return max(float(self._beyond.max()), 1.0), changes

    def state_records(self) -> dict[str, HistoryRecord]:
        """See `Interior.state_records`."""
        name = self._stored
        meaning = "eigenstrain equivalent to the inhomogeneities per density of their shapes, Mandel components"
        return {name: self._record(name, self.eigenstrain, "1", meaning)}


def _matrix_cost(degree: int, *, ball: bool) -> tuple[float, float]:
    """Memory [bytes] and time [s] of the matrix of one pair, or of one inclusion and its image, on one thread.

    Fitted to voids at a depth of half a radius, degrees 4 to 12 for a ball and 2 to 6 for an ellipsoid.
    """
    weights = 24.0 * functions_up_to(degree) * densities_up_to(degree)
    if ball:
        return 0.7e3 * weights, 0.03 + 0.12 * (0.2 * (degree + 1)) ** 5.6
    return 4.4e3 * weights, 0.2 + 1.7 * (0.2 * (degree + 1)) ** 7.5
