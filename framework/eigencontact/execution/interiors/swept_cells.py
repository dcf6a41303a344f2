"""Cells that are updated within the coupled iteration: nonlinear laws, and linear laws if this is cheaper.

Applications of the volume operator by rounds of Krylov solves and by sweeps, without and with friction, for a ball of a
third of the contact radius below a contact, tolerance 1e-6:

| ratio of stiffness | 0 | .05 | .2 | .5 | 2 | 5 | 20 | 1e4 |
|---|---|---|---|---|---|---|---|---|
| solves | 92, 166 | 74, 119 | 46, 85 | 29, 49 | 26, 50 | 47, 83 | 70, 113 | 90, 150 |
| sweeps | 48, 92 | 24, 48 | 13, 27 | 7, 15 | 8, 14 | 13, 26 | 28, 58 | 54, 95 |

Voids beside stiff inclusions or in clusters take hundreds of sweeps. Beyond a ratio of 20 only solves are reliable.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.array_types import BoolArray, FloatArray
from eigencontact.core.elasticity import shear_ratios
from eigencontact.core.material import Material
from eigencontact.core.numbers import Number
from eigencontact.core.parallel import available_threads
from eigencontact.execution.blocks.block import Cost
from eigencontact.execution.blocks.contact import Fields
from eigencontact.execution.blocks.increment import Increment
from eigencontact.execution.interiors.averages import Averages
from eigencontact.execution.interiors.cells import Cells
from eigencontact.execution.interiors.cut_cells import CutCells
from eigencontact.execution.interiors.initial import moved_state
from eigencontact.execution.interiors.interior import Outgrown, Records
from eigencontact.execution.interiors.linked_cells import linked_cells
from eigencontact.execution.routes.subsurface import Subsurface
from eigencontact.model.growth import enlarged, lattice_of
from eigencontact.model.sources import Inhomogeneity, Lattice
from eigencontact.plugin import ConstitutiveLaw, HasCellAnswer, LawStep, Surroundings
from eigencontact.results.records import HistoryRecord
from eigencontact.solvers.flowing_part import LARGEST_PART
from eigencontact.solvers.second_order import centre_values

if TYPE_CHECKING:
    from eigencontact.execution.interiors.finer_cells import Levels
    from eigencontact.solvers.cell_sweeps import Sweep
    from eigencontact.solvers.flowing_part import FlowingPart

__all__ = ["SweptCells", "should_sweep", "stiffness_ratios"]


#: Range of stiffness ratios in which sweeps take a third to a half of the applications of Krylov solves.
_MODERATE = (0.05, 20.0)
#: Typical number of sweeps per step.
_SWEEPS = 15
#: Number of sample points for constants that depend on position.
_LOOKS = 512


class SweptCells(Cells):
    """Equivalent eigenstrain of the cells of one box, iterated together with the contact; parameters as in `Cells`.

    Attributes
    ----------
    levels : Levels or None
        Levels of these cells and of finer cells in a part of the box.
    """

    numbers = (
        *Cells.numbers,
        Number(
            name="law_residual", unit="1", role="certificate",
            meaning="largest misfit of stress and strain to the law of a cell, by the largest stress",
        ),
    )  # fmt: skip

    def __init__(self, subsurface: Subsurface, directions: str) -> None:
        super().__init__(subsurface, directions)
        self.levels: Levels | None = None
        self._sweeping, self._linear = True, all(source.law.linear for source in self.sources)
        self.state_names |= {self._name(name) for source in self.sources for name in source.law.variables}
        self._laws: list[tuple[ConstitutiveLaw, NDArray[np.intp]]] = []
        if len(self.sources) == 1 and not self._linear:
            self.cost += Cost(memory=LARGEST_PART * self._operator_cost(self._box.lattice).memory)
        self.reason += ", swept with the contact" if self._kernels else ", swept"

    def _name(self, variable: str) -> str:
        """Name of a stored variable of a law."""
        return f"{variable}_{self.body}"

    @property
    def _applications(self) -> float:
        return _SWEEPS

    def _fill(self) -> None:
        """See `Cells`."""
        from eigencontact.solvers.cell_sweeps import CellSweeps
        from eigencontact.solvers.law_cells import LawCells

        super()._fill()
        whole = [(law, np.flatnonzero(filled)) for law, filled in self._content.nonlinear]
        self._cut = CutCells.all_of(self._content, self._half_space.material)
        self._laws = [*whole, *((cut.law, cut.cells) for cut in self._cut)]
        self._averages = Averages(self._laws, self._content.shape, self._box.lattice.edges)
        deep, across, wide = self._averages.width
        self._width = (deep, across if 1 in self._grid.bounded_axes else 0, wide)
        self._rim = self._content.rim(self._width).ravel()
        matrix = self._half_space.material
        self._faces = linked_cells(self._content, whole, self._places, matrix)
        around = Surroundings(young_modulus=matrix.young_modulus, poisson_ratio=matrix.poisson_ratio)
        self._cells = cells = LawCells(
            matrix, self._system.self_stress, self._laws, around, self._content.shape, self._numerics.threads
        )
        self._sweeps = CellSweeps(self._system, cells)
        self._part = self._flowing_part(around)

    def _flowing_part(self, around: Surroundings) -> FlowingPart | None:
        """Restricted sweeps where a single law, whose response of a cell needs no Newton iteration, fills the box."""
        from eigencontact.solvers.flowing_part import FlowingPart
        from eigencontact.solvers.law_cells import LawCells

        if len(self._laws) != 1 or self._cut:
            return None
        law, filled = self._laws[0]
        if not isinstance(law, HasCellAnswer) or law.averaged or filled.size != self._places[0].size:
            return None
        cells, matrix = self._box.cells(self._grid), self._half_space.material

        def laws(subset: NDArray[np.intp]) -> LawCells:
            return LawCells(matrix, self._system.self_stress, [(law, subset)], around, None, self._numerics.threads)

        return FlowingPart(self._content.shape, lambda window: self._field_in(cells.window_cells(window)), laws)

    def at_centres(self, means: FloatArray, layers: slice | None = None) -> FloatArray:
        """See `Cells.at_centres`."""
        if self._faces is None:
            return means
        faces = self._faces
        if layers is not None:
            along_z, along_y, along_x = faces
            faces = along_z[layers.start : layers.stop - 1], along_y[layers], along_x[layers]
        return centre_values(means, faces, self._numerics.threads or available_threads())

    def begin(self, increment: Increment, last: Records) -> None:
        """See `Interior.begin`."""
        super().begin(increment, last)
        self._sweeping, self._is_first, self._start = True, True, self.eigenstrain
        if self._part is not None:
            self._part.begin()
        self._before = [self._variables(law, cells, last) for law, cells in self._laws]
        self._after = self._before
        self._about = self._averages.of(self._before)
        steps = [self._law_step(cells, increment) for _, cells in self._laws]
        for number, cut in enumerate(self._cut, len(steps) - len(self._cut)):
            steps[number] = cut.step(steps[number], self._content)
        self._steps = self._averages.with_means(steps, self._about)

    def _law_step(self, cells: NDArray[np.intp], increment: Increment) -> LawStep:
        x, y, z = (axis[cells] for axis in self._places)
        start, end = increment.times
        return LawStep(x=x, y=y, z=z, time=end, duration=end - start)

    def _variables(self, law: ConstitutiveLaw, cells: NDArray[np.intp], last: Records) -> dict[str, FloatArray]:
        """Variables of the cells of a law in stored records; zero in the rest state."""
        variables = {}
        for name, variable in law.variables.items():
            record, count = last.get(self._name(name)), variable.components
            whole = np.zeros((count, cells.size)) if record is None else self.fitted(record).reshape(count, -1)
            variables[name] = whole if record is None else whole[:, cells]
        return variables

    def adopted(self) -> Records:
        """See `Interior.adopted`."""
        state = self._subsurface.initial
        return {} if state is None else moved_state(state, self._laws, self._coords, self._box.lattice.edges)

    @property
    def unknown(self) -> FloatArray:
        """See `Interior.unknown`."""
        if not self._sweeping:
            return np.zeros(0)
        return np.concatenate([self.eigenstrain, self._about]) if self._about.size else self.eigenstrain

    def take(self, unknown: FloatArray) -> None:
        """See `Interior.take`."""
        self.eigenstrain, self._about = unknown[:6], unknown[6:]
        self._steps = self._averages.with_means(self._steps, self._about)

    def answer_as_a_whole(self) -> bool:
        """See `Interior.answer_as_a_whole`."""
        if not (self._sweeping and self._linear) or self.levels is not None:
            return False
        self._sweeping, self.eigenstrain = False, self._start
        return True

    def image(self, tractions: Fields, tolerance: float) -> tuple[FloatArray, float]:
        """See `Interior.image`."""
        if not self._sweeping:
            return super().image(tractions, tolerance)
        # Only under tractions of the tolerance of the scene may the increment end: the whole box must confirm it.
        may_end = tolerance <= self._numerics.tolerance
        before, sweep = self._applied, None if may_end and self._is_first else self._sweep_of_part(tractions)
        self._is_first = False
        if sweep is None or (may_end and sweep.residual <= self._numerics.tolerance):
            self._load = self.applied(tractions)
            sweep = self._sweeps.sweep(
                self.eigenstrain,
                self._load,
                self._prestrain,
                self._before,
                self._steps,
                self._start,
                self._joint_stress(),
            )
            self._after, self._size = sweep.variables, sweep.size
            if self._part is not None and self.levels is None:
                self._part.follow(_present(self.eigenstrain) | _present(sweep.image) | _present(self._start))
        self._residual = sweep.residual
        self._operator_calls += self._applied - before
        self._change = sweep.image - self.eigenstrain
        if not self._about.size:
            return sweep.image, sweep.residual
        means = self._averages.of(sweep.variables)
        size = float(np.linalg.norm(means))
        change = float(np.linalg.norm(means - self._about)) / size if size > 0.0 else 0.0
        self._residual = max(sweep.residual, change)
        return np.concatenate([sweep.image, means]), self._residual

    def _sweep_of_part(self, tractions: Fields) -> Sweep | None:
        """Sweep over the part of the box that flows; None where the whole box must be swept.

        That is where nothing has flowed yet in the increment, and where the edge of the part has begun to flow.
        """
        flowing_part = self._part
        if (
            flowing_part is None
            or flowing_part.window is None
            or flowing_part.reaches_rim
            or self.eigenstrain is self._start
        ):
            return None
        start = self._prestrain, self._before, self._steps
        return flowing_part.sweep(self.eigenstrain, self.applied_in(flowing_part.window, tractions), start, self._size)

    @property
    def _applied(self) -> int:
        """Number of operator applications so far; the first level counts those of both."""
        level_applications = 0 if self.levels is None else self.levels.field.applications
        return self._sweeps.applications + level_applications + (0 if self._part is None else self._part.applications)

    def _joint_stress(self) -> FloatArray | None:
        """Stress in these cells by the eigenstrain of both levels; None with a single level."""
        return None if self.levels is None else self.levels.stress_in(self)

    def scalars(self) -> dict[str, float]:
        """See `Interior.scalars`; with the certificate of nonlinear laws."""
        scalars = super().scalars()
        if self._sweeping and self._laws:
            stress = self._joint_stress()
            scalars["law_residual"] = self._sweeps.misfit(
                self.eigenstrain, self._load, self._prestrain, self._before, self._steps, self._start, stress
            )
        return scalars

    def flowed(self, before: Records, after: Records) -> bool:
        """See `Interior.flowed`."""
        names = {
            self._name(n) for law, _ in self._laws for n, variable in law.variables.items() if not variable.elastic
        }
        return any(
            not np.array_equal(after[name].values, before[name].values) if name in before else after[name].values.any()
            for name in names & after.keys()
        )

    def distance(self, state: Records, reference: Records) -> float:
        """See `Interior.distance`; relative to the reference strain if it exceeds the strain by the load."""
        first, second = (records[self._stored].values for records in (state, reference))
        return float(np.linalg.norm(first - second)) / max(self._size, float(np.linalg.norm(second)))

    def trouble(self) -> str:
        """See `Interior.trouble`."""
        sizes = np.linalg.norm(self._change.reshape(6, -1), axis=0) if self._sweeping else np.zeros(0)
        largest = [(float(sizes[cells].max()), n) for n, (_, cells) in enumerate(self._laws)] if sizes.size else []
        if not largest:
            return ""
        number = max(largest)[1]
        law, cells = self._laws[number]
        words = self._cells.words(law, int(sizes[cells].argmax()), self._steps[number])
        return f", most in {words} of {law.key!r} (where it softens, {law.advice})"

    @property
    def tries_elastic(self) -> bool:
        """See `Interior.tries_elastic`."""
        return self._sweeping and not self._linear

    def check(self) -> None:
        """See `Interior.check`: the law of a body must be elastic in the outermost cells."""
        if not self._rim.any():
            return
        reached = np.zeros(self._rim.shape, dtype=bool)
        for (law, cells), variables in zip(self._laws, self._after, strict=True):
            changed = [values.any(axis=0) for name, values in variables.items() if not law.variables[name].elastic]
            reached[cells] |= np.any(changed, axis=0)
        reached &= self._rim
        if reached.any():
            cells = np.argwhere(reached.reshape(self._content.shape))
            raise self._outgrown(enlarged(self._box.lattice, cells, self._width))

    def _outgrown(self, lattice: Lattice) -> Outgrown:
        """Exception for a box that must also contain the cells of a lattice."""
        return Outgrown(self, type(self)(self._subsurface.grown(lattice), self._directions))

    def fitted(self, record: HistoryRecord) -> FloatArray:
        """See `Responding.fitted`; cells outside the stored ones are in the rest state."""
        lattice = self._box.lattice
        if record.values.shape[1:] == lattice.shape or not record.coords:
            return record.values
        stored = lattice_of(record.coords, lattice.edges, self._grid)
        start = np.subtract(stored.first, lattice.first)
        if np.any(start < 0) or np.any(start + stored.shape > lattice.shape):
            raise self._outgrown(stored)
        values = np.zeros((len(record.values), *lattice.shape))
        k, j, i = (slice(int(low), int(low) + count) for low, count in zip(start, stored.shape, strict=True))
        values[:, k, j, i] = record.values
        return values

    def states(self) -> Iterator[tuple[ConstitutiveLaw, Mapping[str, FloatArray], float, FloatArray | float]]:
        """See `Interior.states`; a whole cell counts with its volume, a material of a cut cell with its fraction."""
        volume = float(np.prod(self._box.cells(self._grid).pitch))
        whole = len(self._laws) - len(self._cut)
        for (law, _), variables in zip(self._laws[:whole], self._after[:whole], strict=True):
            yield law, variables, volume, 1.0
        for cut, variables in zip(self._cut, self._after[whole:], strict=True):
            for law, share, law_variables in cut.parts(variables):
                yield law, law_variables, volume, share

    def state_records(self) -> dict[str, HistoryRecord]:
        """See `Interior.state_records`."""
        records = super().state_records()
        for (law, cells), variables in zip(self._laws, self._after, strict=True):
            for name, variable in law.variables.items():
                key, shape = self._name(name), (variable.components, *self._content.shape)
                if key not in records:
                    records[key] = self._record(key, np.zeros(shape), variable.unit, variable.meaning)
                records[key].values.reshape(shape[0], -1)[:, cells] = variables[name]
        return records


def _present(eigenstrain: FloatArray) -> BoolArray:
    """Cells with an eigenstrain."""
    return np.asarray(np.any(eigenstrain != 0.0, axis=0))


def should_sweep(subsurface: Subsurface) -> bool:
    """Whether sweeps solve the inhomogeneities of a body.

    Nonlinear laws need sweeps. Linear laws take fewer applications of the operator with sweeps if they are below a
    contact and the stiffness ratios are moderate.
    """
    sources = subsurface.inhomogeneities
    laws = [law for n, law in enumerate(s.law for s in sources) if law not in [s.law for s in sources[:n]]]
    if not all(law.linear for law in laws):
        return True
    low, high = _MODERATE
    ratios = [stiffness_ratios(subsurface.half_space.material, law, sources) for law in laws]
    return bool(subsurface.influences) and all(low <= least and most <= high for least, most in ratios)


def stiffness_ratios(matrix: Material, law: ConstitutiveLaw, sources: Sequence[Inhomogeneity]) -> tuple[float, float]:
    """Smallest and largest ratio of the shear moduli of a linear law, in regions of one body, to that of the body."""
    return shear_ratios(_somewhere(law, sources), matrix.shear_modulus)  # type: ignore[arg-type]


def _somewhere(law: ConstitutiveLaw, sources: Sequence[Inhomogeneity]) -> ConstitutiveLaw:
    """The law if uniform, otherwise the law at sample points in the bounds of its regions."""
    if not law.varies:
        return law
    bounds = np.array([source.shape.bounds for source in sources if source.law == law])
    low, high = bounds[:, 0].min(axis=0), bounds[:, 1].max(axis=0)
    x, y, z = low[:, None] + np.random.default_rng(0).random((3, _LOOKS)) * (high - low)[:, None]
    return law.at(x, y, z)
