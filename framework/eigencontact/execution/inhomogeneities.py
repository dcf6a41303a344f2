"""Runners of inhomogeneities: their equivalent eigenstrain, and its fields on the surface and in regions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Protocol, cast

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.grid import Box, Grid
from eigencontact.core.material import Material
from eigencontact.execution.cells import CellFields
from eigencontact.execution.eigenstrain import ClosedForms, EigenstrainRegion, ResidualDisplacement, Sum
from eigencontact.execution.material_cells import MaterialCells
from eigencontact.execution.runners import State
from eigencontact.planning.blocks import Block
from eigencontact.planning.cell_groups import CellGroup
from eigencontact.planning.cells import installed_cell
from eigencontact.planning.field_parts import FieldPart, space_of
from eigencontact.planning.kernels import DIRECTIONS, StressCoefficients
from eigencontact.planning.plan import Plan
from eigencontact.solvers.cells import Cells
from eigencontact.solvers.equivalent_inclusions import InclusionReport, InhomogeneousCells
from eigencontact.solvers.mean_stress import MeanVolumeField
from eigencontact.solvers.mean_surface import MeanStressKernel, MeanSurfaceDisplacement
from eigencontact.solvers.subsurface import SubsurfaceStress

if TYPE_CHECKING:
    from eigencontact.execution.whole_inclusions import WholeBody
    from eigencontact.planning.sources import Source

__all__ = ["Inhomogeneities", "SolvedEigenstrainRegion", "SolvedResidualDisplacement"]

FloatArray = NDArray[np.float64]


class Inhomogeneities:
    """Equivalent eigenstrain of the cells of both bodies under the contact and the prescribed eigenstrain."""

    def __init__(self, plan: Plan, block: Block) -> None:
        boxes = cast("Mapping[int, CellGroup]", block.settings.get("boxes", {}))
        wholes = cast("Mapping[int, tuple[Source, ...]]", block.settings.get("wholes", {}))
        tractions = cast("tuple[str, ...]", block.settings["tractions"])
        prescribed = cast("Mapping[int, list[FieldPart]]", block.settings.get("prescribed", {}))
        self._numerics = plan.scene.numerics
        self._bodies: dict[int, _Box | WholeBody] = {
            body: _Box(plan, box, body, tractions, prescribed[body]) for body, box in boxes.items()
        }
        if wholes:
            from eigencontact.execution.whole_inclusions import WholeBody

            self._bodies |= {body: WholeBody(plan, body, sources, tractions) for body, sources in wholes.items()}

    def __call__(self, state: State) -> None:
        """Advance one step; see `Runner`."""
        self.solve(state, self._numerics.tolerance)

    def solve(self, state: State, tolerance: float) -> None:
        """Solve to a tolerance, from the eigenstrain that the state holds."""
        reports = []
        for body, box in self._bodies.items():
            state.equivalent[body], report = box.solve(state, tolerance)
            reports.append(report)
        spent = state.scalars.get("inclusion_iterations", 0.0)
        state.scalars["inclusion_iterations"] = spent + sum(report.iterations for report in reports)
        state.scalars["inclusion_residual"] = max(report.residual for report in reports)


class _Box:
    """Inhomogeneities of one body."""

    def __init__(
        self, plan: Plan, box: CellGroup, body: int, tractions: Sequence[str], prescribed: list[FieldPart]
    ) -> None:
        material = plan.half_space(body)
        self._body, self._numerics = body, plan.scene.numerics
        self._content = MaterialCells(box, plan.grid)
        self._prescribed = Sum(plan, prescribed) if prescribed else None
        self._varies = box.varies
        self._prestrain: FloatArray | None = None
        cell = installed_cell(plan.registry)((0.0, 0.0, 0.5), (1.0, 1.0, 1.0))
        cells = _cells(box, plan.grid)
        operator = MeanVolumeField(
            cell,
            cells,
            cells,
            poisson_ratio=material.poisson_ratio,
            space=space_of(self._numerics),
            shear_modulus=material.shear_modulus,
            precision=self._numerics.precision,
            threads=self._numerics.threads,
        )
        content = self._content
        self._system = InhomogeneousCells(
            operator,
            material,
            content.materials,
            content.index,
            fraction=content.fraction,
            beside=content.beside,
            normal=content.normal,
        )
        sign = 1.0 if body == 1 else -1.0
        self._tractions = [("pressure", 1.0) if name == "p" else (f"shear_{name[-1]}", sign) for name in tractions]
        self._load: SubsurfaceStress | None = None
        if tractions:
            # The whole window: a box that followed the contact would depend on the steps before.
            self._load = SubsurfaceStress(
                plan.grid,
                _mean_kernels(plan, box, material, tractions),
                source=Box(0, plan.grid.ny, 0, plan.grid.nx),
                target=box.lattice.shape[1:],
                origin=(float(box.lattice.first[1]), float(box.lattice.first[2])),
                depths=cells.centres(2),
                precision=self._numerics.precision,
                threads=self._numerics.threads,
            )

    def solve(self, state: State, tolerance: float) -> tuple[FloatArray, InclusionReport]:
        """Eigenstrain of the cells under what the state holds."""
        if self._prestrain is None or self._varies:
            self._prestrain = self._content.prestrain(state.time)
        found = self._system.solve(
            self._applied(state),
            self._prestrain,
            start=state.equivalent.get(self._body),
            tolerance=tolerance,
            max_iterations=self._numerics.max_iterations,
            progress=state.progress,
        )
        return found.eigenstrain, found.report

    def _applied(self, state: State) -> FloatArray:
        """Stress in the cells by the contact and by the prescribed eigenstrain of this body."""
        total = np.zeros((6, *self._content.shape))
        if self._prescribed is not None:
            total += self._prescribed(state.time)
        if self._load is not None and "pressure" in state.fields:
            tractions = [sign * state.fields[name] for name, sign in self._tractions]
            if any(traction.any() for traction in tractions):
                total += self._load.apply(tractions)
        return total


def _cells(box: CellGroup, grid: Grid) -> Cells:
    z, y, x = box.lattice.axes(grid)
    dz, dy, dx = box.lattice.edges
    return Cells(first=(float(x[0]), float(y[0]), float(z[0])), pitch=(dx, dy, dz), shape=box.lattice.shape)


def _mean_kernels(plan: Plan, box: CellGroup, body: Material, tractions: Sequence[str]) -> list[MeanStressKernel]:
    return [
        MeanStressKernel(StressCoefficients(plan.influences[name], body), box.lattice.edges[0]) for name in tractions
    ]


def _field(plan: Plan, part: FieldPart) -> _Field:
    """Field of a solved eigenstrain, of cells or of whole inhomogeneities."""
    if part.group is not None:
        return CellFields(plan, part)
    return _OfEach(ClosedForms(plan, part))


class _Field(Protocol):
    def of(self, strain: FloatArray) -> FloatArray:
        """Field at the points of its part."""
        ...


class _OfEach:
    """Field of uniform eigenstrains, components first."""

    def __init__(self, forms: ClosedForms) -> None:
        self._forms = forms

    def of(self, strain: FloatArray) -> FloatArray:
        return self._forms.of(strain.T)


class SolvedResidualDisplacement(ResidualDisplacement):
    """Displacement of the surface by prescribed and equivalent eigenstrain.

    Along the tractions of a contact it is the mean over each cell, which belongs to the mean stress by those tractions
    (see `eigencontact.solvers.mean_surface`); elsewhere that in the centres of the cells.
    """

    def __init__(self, plan: Plan, block: Block) -> None:
        super().__init__(plan, block)
        parts = cast("list[FieldPart]", block.settings["solved"])
        self._centres = {part.body: _field(plan, part) for part in parts}
        tractions = cast("tuple[str, ...]", block.settings["tractions"])
        self._rows = ["xyz".index(DIRECTIONS[name]) for name in tractions]
        boxes = cast("Mapping[int, CellGroup]", block.settings.get("boxes", {}))
        self._means = {}
        for body, box in boxes.items() if tractions else ():
            material = plan.half_space(body)
            self._means[body] = MeanSurfaceDisplacement(
                plan.grid,
                _mean_kernels(plan, box, material, tractions),
                _cells(box, plan.grid),
                precision=plan.scene.numerics.precision,
                threads=plan.scene.numerics.threads,
            )

    def _of_bodies(self, state: State) -> dict[int, FloatArray]:
        found = super()._of_bodies(state)
        for body, strain in state.equivalent.items():
            more = np.zeros((3, *self._shape))
            if body in self._centres:
                more = self._centres[body].of(strain)[:, 0]
            if body in self._means:
                more[self._rows] = self._means[body].apply(strain)
            elif body in state.lifted:
                more[self._rows] = state.lifted[body][self._rows]
            found[body] = found[body] + more if body in found else more
        return found

    def _before(self, state: State) -> dict[str, FloatArray]:
        return state.initial  # from whoever solves for the eigenstrain


class SolvedEigenstrainRegion(EigenstrainRegion):
    """Fields of prescribed and equivalent eigenstrain at the points of a region."""

    def __init__(self, plan: Plan, block: Block) -> None:
        super().__init__(plan, block)
        parts = cast("list[FieldPart]", block.settings["solved"])
        self._solved = {part.quantity: _field(plan, part) for part in parts}
        self._body = parts[0].body

    def __call__(self, state: State) -> None:
        """Advance one step; see `Runner`."""
        super().__call__(state)
        inner = state.inner[self._label]
        for name, fields in self._solved.items():
            more = fields.of(state.equivalent[self._body])
            inner[name] = inner[name] + more if name in inner else more
