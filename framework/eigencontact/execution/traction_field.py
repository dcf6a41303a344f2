"""Stress and strain that the tractions of a contact cause at the points of a region."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigencontact.convolution import Layout
from eigencontact.core.grid import Box
from eigencontact.core.material import Material
from eigencontact.core.parallel import available_threads, working_threads
from eigencontact.execution.block import Cost
from eigencontact.execution.interiors.interior import loads
from eigencontact.execution.precision import plane_round_off, settled
from eigencontact.execution.sampling import sampling_seconds, section_cost, spectra_cost
from eigencontact.execution.step import Step
from eigencontact.model.bodies import kernel_key
from eigencontact.model.kernels import KernelUse, Solid, StressCoefficients
from eigencontact.model.model import Model
from eigencontact.model.regions import RegionLattice
from eigencontact.scene.schema import StressRequest
from eigencontact.solvers.surface_means import depth_of_means

__all__ = ["TractionField"]

FloatArray = NDArray[np.float64]

#: What is told of a region that has points next to the surface.
_NOTE = "stress by tractions above a depth of {:.3g} m is a mean over each cell, linear between their centres"
#: Tables for one mean over a cell, and means for one point between cells.
_TABLES, _MEANS = 4, 4
#: Depths of a close-up whose coefficients are held at once.
_AT_ONCE = 16


class TractionField:
    """Field of one body; the spectra are kept as long as the contact stays in the box that they were made for.

    Body 2 is loaded by the same pressure and the opposite shear; seen along its own z axis, which points into it, its
    stress is that of body 1 under those. Next to the surface of a window that is not periodic, stress is a mean over
    cells (`eigencontact.solvers.surface_means`).
    """

    def __init__(self, model: Model, request: StressRequest, lattice: RegionLattice) -> None:
        body = model.bodies[request.body - 1]
        assert body is not None
        self._body: Solid = body
        self._number, self._wanted, self._lattice = request.body, request.fields, lattice
        self._grid, self._periodic = model.grid, model.periodic
        self._numerics, self.precisions = settled(
            model.numerics, "stress by tractions",
            lambda: plane_round_off() if lattice.points is None and lattice.finer == (1, 1) else None,
        )  # fmt: skip
        self._tractions = model.tractions
        self._kernels = [StressCoefficients(model.influences[item.name], body) for item in model.tractions]
        self.requires = frozenset(item.field for item in model.tractions)
        depths = lattice.depths if lattice.points is None else lattice.points[:, 2]
        self._near = np.zeros(depths.shape, dtype=bool) if model.periodic else depths < depth_of_means(model.grid)
        self.note = _NOTE.format(depth_of_means(model.grid)) if self._near.any() else ""
        self._operators: dict[bool, Any] = {}
        self._declare(model)

    def _declare(self, model: Model) -> None:
        """Price and kernels."""
        lattice, numerics, pressure = self._lattice, self._numerics, model.influences["p"]
        sampling, count = sampling_seconds(pressure, self._body, periodic=self._periodic), len(self._tractions)
        if lattice.points is not None:
            tables = int(np.where(self._near, _TABLES * _MEANS, 1).sum())
            text = f"{len(lattice.points)} points, superposed directly"
            cells, workers = model.contact_box[0] * model.contact_box[1], numerics.threads or available_threads()
            seconds = tables * (sampling * count * cells + 1e-4) / working_threads(workers)
            cost = Cost(memory=cells * 8.0 * 30 * workers, seconds_per_step=seconds)
        else:
            tables = int(np.where(self._near, _TABLES, lattice.finer[0] * lattice.finer[1]).sum())
            text = lattice.words
            price = section_cost if self._in_section else spectra_cost
            cost = price(self._layout(model), tables, sampling, numerics, tractions=count)
            if lattice.finer != (1, 1):  # made anew in each step, few depths at a time
                cost = Cost(
                    seconds_per_step=cost.seconds_once + cost.seconds_per_step,
                    transient=cost.memory * min(1.0, _AT_ONCE / tables),
                )
        self.cost = cost
        if not isinstance(self._body, Material):
            from eigencontact.execution.layered_cost import layered_stress_cost

            anew = lattice.points is not None
            self.cost += layered_stress_cost(self._body, tables * count, numerics, anew=anew)
        self.kernels = tuple(
            KernelUse(
                "stress (6 components)", item.words, kernel_key(model.influences[item.name], [self._body]), text,
                1 if lattice.points is not None else tables,
            )
            for item in self._tractions
        )  # fmt: skip

    @property
    def _in_section(self) -> bool:
        """Whether the points are one row at each depth, of the pitch of the cells."""
        lattice = self._lattice
        return 1 in lattice.target and lattice.finer == (1, 1) and not self._periodic

    def _layout(self, model: Model) -> Layout:
        """Transform from a contact in the middle of the window to the lattice."""
        shape, lattice = model.grid.shape, self._lattice
        if self._periodic:
            return Layout(shape, shape, periodic=True)
        first = [(n - b) // 2 for n, b in zip(shape, model.contact_box, strict=True)]
        target = tuple(-(-n // m) for n, m in zip(lattice.target, lattice.finer, strict=True))
        origin = (lattice.origin[0] - first[0], lattice.origin[1] - first[1])
        return Layout(model.contact_box, (target[0], target[1]), origin)

    def fields(self, step: Step) -> dict[str, FloatArray]:
        """Stress, and strain where it is wanted, ``(6, *lattice.shape)``."""
        tractions = loads(self._number, self._tractions, step.fields)
        stress = self._on_lattice(tractions) if self._lattice.points is None else self._at_points(tractions)
        return {"stress": stress, "strain": self._strain(stress)} if "strain" in self._wanted else {"stress": stress}

    def _strain(self, stress: FloatArray) -> FloatArray:
        """Elastic strain; at the depth of an interface by the constants of the deeper layer, as the stress is."""
        if isinstance(self._body, Material):
            return _hooke(stress, self._body)
        depths = self._lattice.depths if self._lattice.points is None else self._lattice.points[:, 2]
        strain = np.empty_like(stress)
        for depth in np.unique(depths):
            there = depths == depth
            strain[:, there] = _hooke(stress[:, there], self._body.material_at(float(depth) + 0.0))
        return strain

    def _at_points(self, tractions: list[FloatArray]) -> FloatArray:
        from eigencontact.solvers.subsurface import stress_at_points
        from eigencontact.solvers.surface_means import means_at_points

        points, near = self._lattice.points, self._near
        assert points is not None
        stress = np.empty((6, len(points)))
        for some, found in ((near, means_at_points), (~near, stress_at_points)):
            if some.any():
                stress[:, some] = found(
                    self._grid, self._kernels, tractions, points[some], threads=self._numerics.threads
                )  # fmt: skip
        return stress

    def _on_lattice(self, tractions: list[FloatArray]) -> FloatArray:
        box, near = Box.around(tractions[0] > 0), self._near
        if box is None:
            return np.zeros((6, *self._lattice.shape))
        stress = np.empty((6, *self._lattice.shape))
        if near.any():
            stress[:, near] = self._kept(box, near=True).apply(tractions)
        if self._lattice.finer != (1, 1):
            self._close_up(tractions, box, stress)
        elif not near.all():
            stress[:, ~near] = self._kept(box, near=False).apply(tractions)
        return stress

    def _kept(self, box: Box, *, near: bool) -> Any:
        """Operator of the points next to the surface, or below; with a margin where the contact has left its box."""
        operator = self._operators.pop(near, None)
        if operator is None or not operator.covers(box):
            margin = 0 if operator is None else max(2, max(box.shape) // 6)
            operator = None  # its memory goes before the next is made
            operator = self._operator(box.grown(margin, margin, self._grid.shape), near=near)
        self._operators[near] = operator
        return operator

    def _operator(self, source: Box, *, near: bool) -> Any:
        from eigencontact.solvers.surface_means import MeansOnLattice

        lattice, numerics = self._lattice, self._numerics
        precision, threads = numerics.precision, numerics.threads
        depths = lattice.depths[self._near == near]
        if near:
            return MeansOnLattice(
                self._grid, self._kernels, source=source, x=lattice.x, y=lattice.y, depths=depths,
                precision=precision, threads=threads,
            )  # fmt: skip
        where = {"source": source, "target": lattice.target, "origin": lattice.origin, "depths": depths}
        if self._in_section:
            from eigencontact.solvers.section_stress import SectionStress

            return SectionStress(self._grid, self._kernels, **where, precision=precision, threads=threads)
        from eigencontact.solvers.subsurface import SubsurfaceStress

        return SubsurfaceStress(
            self._grid, self._kernels, **where, periodic=self._periodic, precision=precision, threads=threads
        )

    def _close_up(self, tractions: list[FloatArray], box: Box, out: FloatArray) -> None:
        """Stress on points finer than the cells: lattices of the cells' pitch, one after the other, few depths each."""
        from eigencontact.solvers.subsurface import SubsurfaceStress

        for begin in range(int(self._near.sum()), self._lattice.depths.size, _AT_ONCE):
            layers = slice(begin, begin + _AT_ONCE)
            for (rows, columns), lattice in self._lattice.shifted:
                operator = SubsurfaceStress(
                    self._grid,
                    self._kernels,
                    source=box,
                    target=lattice.target,
                    origin=lattice.origin,
                    depths=lattice.depths[layers],
                    threads=self._numerics.threads,
                )
                out[:, layers, rows, columns] = operator.apply(tractions)


def _hooke(stress: FloatArray, body: Material) -> FloatArray:
    """Elastic Mandel strain of a Mandel stress ``(6, ...)``: Hooke's law, for an incompressible body too."""
    E, nu = body.young_modulus, body.poisson_ratio
    strain = (1.0 + nu) / E * stress
    strain[:3] -= nu / E * stress[:3].sum(axis=0)
    return np.asarray(strain)
