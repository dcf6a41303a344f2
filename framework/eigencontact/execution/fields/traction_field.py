"""Stress, strain and displacement by the tractions of a contact, at the points of a region."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigencontact.convolution import Layout
from eigencontact.core.array_types import FloatArray
from eigencontact.core.grid import Box
from eigencontact.core.kept import cached_object
from eigencontact.core.material import Material
from eigencontact.core.parallel import available_threads, working_threads
from eigencontact.execution.blocks.block import Cost
from eigencontact.execution.blocks.precision import plane_round_off, settled
from eigencontact.execution.blocks.sampling import sampling_seconds, section_cost, spectra_cost, tables_of_images
from eigencontact.execution.blocks.step import Step as LoadStep
from eigencontact.execution.fields.cause import Cause, StressAtDepths
from eigencontact.execution.interiors.interior import loads
from eigencontact.model.bodies import kernel_key
from eigencontact.model.interface import Interface
from eigencontact.model.kernels import KernelUse, Solid, StressCoefficients
from eigencontact.model.regions import RegionLattice
from eigencontact.model.window import Window
from eigencontact.scene.schema import Numerics, Step, StressRequest
from eigencontact.solvers.surface_means import depth_of_means

__all__ = ["TractionField", "moves"]


#: Note for a region with points next to the surface.
_NOTE = "stress by tractions above a depth of {:.3g} m is a mean over each cell, linear between their centres"
_WORDS = {"stress": "stress (6 components)", "displacement": "displacement x, y, z"}
#: Tables per mean over a cell; means per point between cells.
_TABLES, _MEANS = 4, 4
#: Depths of a close-up with coefficients in memory at the same time.
_AT_ONCE = 16


class TractionField(Cause):
    """Field of the tractions in one body; the spectra are valid as long as the contact stays in their box.

    The load of body 2 is the same pressure and the opposite shear. In the axes of body 2, with z into that body, its
    stress equals the stress of body 1 under this load. Stress next to the surface of a non-periodic window is a mean
    over cells (`eigencontact.solvers.surface_means`). The displacement is relative to distant points of the body, in a
    periodic window relative to the mean of the surface.
    """

    def __init__(
        self, interface: Interface, window: Window, numerics: Numerics, request: StressRequest, lattice: RegionLattice,
        *, moves: bool,
    ) -> None:  # fmt: skip
        body = interface.solids[request.body - 1]
        assert body is not None
        self._body: Solid = body
        self._number, self._fields, self._lattice = request.body, request.fields, lattice
        self._window, self._grid, self._moves = window, window.grid, moves
        self._periodic = numerics.boundary == "periodic"
        self._numerics, self.precisions = settled(
            numerics, "stress by tractions",
            lambda: plane_round_off() if lattice.points is None and lattice.finer == (1, 1) else None,
        )  # fmt: skip
        self._tractions = interface.tractions
        stress = not {"stress", "strain"}.isdisjoint(request.fields)
        self._quantities = [*(["stress"] if stress else []), *({"displacement"} & set(request.fields))]
        self._kernels = {
            quantity: [
                StressCoefficients(interface.influences[t.name], body, quantity, interface.datum, interface.period)
                for t in self._tractions
            ]
            for quantity in self._quantities
        }
        self.requires = frozenset(item.field for item in self._tractions)
        depths = lattice.depths if lattice.points is None else lattice.points[:, 2]
        far = np.zeros(depths.shape, dtype=bool)
        near = far if self._periodic else depths < depth_of_means(self._grid)
        self._near = {"stress": near, "displacement": far}  # no displacement is infinite
        self.mean_above = depth_of_means(self._grid) if stress and near.any() else 0.0
        self.note = _NOTE.format(self.mean_above) if self.mean_above else ""
        self.by_depths = stress and lattice.points is None and self._in_section
        self._operators: dict[tuple[str, bool], Any] = {}
        self.cost = Cost()
        self.kernels: tuple[KernelUse, ...] = ()
        for quantity in self._quantities:
            self._declare(interface, quantity)

    def _declare(self, interface: Interface, quantity: str) -> None:
        """Add cost and kernels of a quantity; three displacement coefficients count as six of stress."""
        lattice, numerics, pressure = self._lattice, self._numerics, interface.influences["p"]
        sampling, count = sampling_seconds(pressure, self._body, periodic=self._periodic), len(self._tractions)
        sampling *= tables_of_images(numerics)
        near = self._near[quantity]
        if lattice.points is not None:
            tables = int(np.where(near, _TABLES * _MEANS, 1).sum())
            text = f"{len(lattice.points)} points, superposed directly"
            cells, workers = self._window.box[0] * self._window.box[1], numerics.threads or available_threads()
            seconds = tables * (sampling * count * cells + 1e-4) / working_threads(workers)
            cost = Cost(memory=cells * 8.0 * 30 * workers, seconds_per_step=seconds)
        else:
            tables = int(np.where(near, _TABLES, lattice.finer[0] * lattice.finer[1]).sum())
            text = lattice.words
            price = section_cost if self._in_section else spectra_cost
            cost = price(self._layout(), tables, sampling, numerics, tractions=count)
            if lattice.finer != (1, 1):  # computed again in each step, few depths at a time
                cost = Cost(
                    seconds_per_step=cost.seconds_once + cost.seconds_per_step,
                    transient=cost.memory * min(1.0, _AT_ONCE / tables),
                )
        self.cost += cost
        if not isinstance(self._body, Material):
            from eigencontact.execution.blocks.layered_cost import layered_stress_cost

            every_step = lattice.points is not None
            self.cost += layered_stress_cost(self._body, tables * count, numerics, every_step=every_step)
        self.kernels += tuple(
            KernelUse(
                _WORDS[quantity], item.words, kernel_key(interface.influences[item.name], [self._body]), text,
                1 if lattice.points is not None else tables,
            )
            for item in self._tractions
        )  # fmt: skip

    @property
    def _in_section(self) -> bool:
        """Whether the points form one row at each depth, with the pitch of the cells."""
        lattice = self._lattice
        return 1 in lattice.target and lattice.finer == (1, 1) and not self._periodic

    def _layout(self) -> Layout:
        """Transform from a contact in the middle of the window to the lattice."""
        shape, lattice = self._grid.shape, self._lattice
        if self._periodic:
            return Layout(shape, shape, periodic=True)
        box = self._window.box
        if self._moves:  # an operator for a contact that moves has a margin; see `_cached_operator`
            box = tuple(min(n, b + 2 * max(2, b // 6)) for n, b in zip(shape, box, strict=True))  # type: ignore[assignment]
        first = [(n - b) // 2 for n, b in zip(shape, box, strict=True)]
        target = tuple(-(-n // m) for n, m in zip(lattice.target, lattice.finer, strict=True))
        origin = (lattice.origin[0] - first[0], lattice.origin[1] - first[1])
        return Layout(box, (target[0], target[1]), origin)

    def fields(self, step: LoadStep) -> dict[str, FloatArray]:
        """Stress, and requested strain and displacement, ``(6 or 3, *lattice.shape)``."""
        tractions = loads(self._number, self._tractions, step.fields)
        evaluate = self._on_lattice if self._lattice.points is None else self._at_points
        fields = {quantity: evaluate(quantity, tractions) for quantity in self._quantities}
        return fields | ({"strain": self._strain(fields["stress"])} if "strain" in self._fields else {})

    def of_steps(self, steps: Sequence[LoadStep]) -> StressAtDepths:
        """See `Cause.of_steps`; one operator covers the contact of all steps."""
        fields = {item.field: np.stack([step.fields[item.field] for step in steps]) for item in self._tractions}
        tractions = loads(self._number, self._tractions, fields)
        box, near = Box.around(tractions[0].max(axis=0) > 0), self._near["stress"]
        if box is None:
            return lambda layers: np.zeros((1, 6, len(layers), 1))
        above = np.empty((len(steps), 6, near.sum(), self._lattice.x.size * self._lattice.y.size))
        if near.any():
            means = self._cached_operator("stress", box, near=True)
            for number, loaded in enumerate(zip(*tractions, strict=True)):
                above[number] = means.apply(loaded).reshape(above.shape[1:])
        if near.all():
            return lambda layers: above[:, :, layers]
        below: StressAtDepths = self._cached_operator("stress", box, near=False).of_steps(tractions)
        rows = np.where(near, np.cumsum(near), np.cumsum(~near)) - 1  # of a depth among those of its operator

        def at(layers: NDArray[np.intp]) -> FloatArray:
            shallow = near[layers]
            if not shallow.any():
                return below(rows[layers])
            out = np.empty((*above.shape[:2], len(layers), above.shape[3]))
            out[:, :, shallow], out[:, :, ~shallow] = above[:, :, rows[layers[shallow]]], below(rows[layers[~shallow]])
            return out

        return at

    def _strain(self, stress: FloatArray) -> FloatArray:
        """Elastic strain; at the depth of an interface by the constants of the deeper layer, like the stress."""
        if isinstance(self._body, Material):
            return _hooke(stress, self._body)
        depths = self._lattice.depths if self._lattice.points is None else self._lattice.points[:, 2]
        strain = np.empty_like(stress)
        for depth in np.unique(depths):
            at_depth = depths == depth
            strain[:, at_depth] = _hooke(stress[:, at_depth], self._body.material_at(float(depth) + 0.0))
        return strain

    def _at_points(self, quantity: str, tractions: list[FloatArray]) -> FloatArray:
        from eigencontact.solvers.subsurface import stress_at_points
        from eigencontact.solvers.surface_means import means_at_points

        points, near, kernels = self._lattice.points, self._near[quantity], self._kernels[quantity]
        assert points is not None
        values = np.empty((len(kernels[0].components), len(points)))
        threads = self._numerics.threads
        for mask, evaluate in ((near, means_at_points), (~near, stress_at_points)):
            if mask.any():
                values[:, mask] = evaluate(self._grid, kernels, tractions, points[mask], threads=threads)
        return values

    def _on_lattice(self, quantity: str, tractions: list[FloatArray]) -> FloatArray:
        box, near = Box.around(tractions[0] > 0), self._near[quantity]
        values = np.zeros((len(self._kernels[quantity][0].components), *self._lattice.shape))
        if box is None:
            return values
        if near.any():
            values[:, near] = self._cached_operator(quantity, box, near=True).apply(tractions)
        if self._lattice.finer != (1, 1):
            self._close_up(quantity, tractions, box, values)
        elif not near.all():
            values[:, ~near] = self._cached_operator(quantity, box, near=False).apply(tractions)
        return values

    def _cached_operator(self, quantity: str, box: Box, *, near: bool) -> Any:
        """Operator of points near the surface, or of deeper points; replaced when the contact leaves its box."""
        operator = self._operators.pop((quantity, near), None)
        if operator is None or not operator.covers(box):
            margin = 0 if operator is None else max(2, max(box.shape) // 6)
            operator = None  # its memory goes before the next is made
            source = box.grown(margin, margin, self._grid.shape)
            operator = cached_object(
                lambda: self._key(quantity, source, near=near), lambda: self._operator(quantity, source, near=near)
            )
        self._operators[quantity, near] = operator
        return operator

    def _key(self, quantity: str, source: Box, *, near: bool) -> Hashable:
        """All inputs of an operator; sweep variants with equal keys share the operator (`core.kept`)."""
        lattice, numerics = self._lattice, self._numerics
        points = tuple(array.tobytes() for array in (lattice.x, lattice.y, lattice.depths, self._near[quantity]))
        influences = [kernel.influence for kernel in self._kernels[quantity]]
        kernels = tuple((type(influence), influence.key, influence.traction) for influence in influences)
        data = tuple((kernel.datum, kernel.period) for kernel in self._kernels[quantity])
        settings = (self._periodic, numerics.precision, numerics.threads, lattice.target, tuple(lattice.origin), data)
        return (quantity, self._grid, self._body, kernels, source, near, points, settings)

    def _operator(self, quantity: str, source: Box, *, near: bool) -> Any:
        from eigencontact.solvers.surface_means import MeansOnLattice

        lattice, numerics, kernels = self._lattice, self._numerics, self._kernels[quantity]
        precision, threads = numerics.precision, numerics.threads
        depths = lattice.depths[self._near[quantity] == near]
        if near:
            return MeansOnLattice(
                self._grid, kernels, source=source, x=lattice.x, y=lattice.y, depths=depths,
                precision=precision, threads=threads,
            )  # fmt: skip
        where = {"source": source, "target": lattice.target, "origin": lattice.origin, "depths": depths}
        if self._in_section:
            from eigencontact.solvers.section_stress import SectionStress

            return SectionStress(self._grid, kernels, **where, precision=precision, threads=threads)
        from eigencontact.solvers.subsurface import SubsurfaceStress

        return SubsurfaceStress(
            self._grid, kernels, **where, periodic=self._periodic, precision=precision, threads=threads
        )

    def _close_up(self, quantity: str, tractions: list[FloatArray], box: Box, out: FloatArray) -> None:
        """Field on points finer than the cells, by lattices of the cells' pitch, few depths at a time."""
        from eigencontact.solvers.subsurface import SubsurfaceStress

        for begin in range(int(self._near[quantity].sum()), self._lattice.depths.size, _AT_ONCE):
            layers = slice(begin, begin + _AT_ONCE)
            for (rows, columns), lattice in self._lattice.shifted:
                operator = SubsurfaceStress(
                    self._grid,
                    self._kernels[quantity],
                    source=box,
                    target=lattice.target,
                    origin=lattice.origin,
                    depths=lattice.depths[layers],
                    threads=self._numerics.threads,
                )
                out[:, layers, rows, columns] = operator.apply(tractions)


def moves(ramps: Sequence[Step]) -> bool:
    """Whether the contact of a later increment extends beyond that of the first, by growth or tilt."""
    pressed = [(ramp.normal_load, ramp.approach) for ramp in ramps]
    tilts = any(getattr(ramp, f"{name}_{axis}") for ramp in ramps for name in ("moment", "tilt") for axis in "xy")
    return bool(ramps) and (ramps[0].increments > 1 or max(map(_size, pressed)) > _size(pressed[0]) or tilts)


def _size(pressed: tuple[float | None, float | None]) -> float:
    return max(abs(value or 0.0) for value in pressed)


def _hooke(stress: FloatArray, body: Material) -> FloatArray:
    """Elastic Mandel strain of a Mandel stress ``(6, ...)``: Hooke's law, for an incompressible body too."""
    E, nu = body.young_modulus, body.poisson_ratio
    strain = (1.0 + nu) / E * stress
    strain[:3] -= nu / E * stress[:3].sum(axis=0)
    return np.asarray(strain)
