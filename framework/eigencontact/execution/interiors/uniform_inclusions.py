"""Inhomogeneities of one body with one uniform eigenstrain each: no cells, closed forms for their fields."""

from __future__ import annotations

from functools import partial
from typing import Any, cast

import numpy as np

from eigencontact.core.array_types import FloatArray
from eigencontact.core.parallel import in_parallel
from eigencontact.core.tensors import COMPONENTS
from eigencontact.errors import SceneError
from eigencontact.execution.blocks.block import Cost
from eigencontact.execution.blocks.contact import Fields
from eigencontact.execution.blocks.sampling import sampling_seconds
from eigencontact.execution.interiors.interior import loads
from eigencontact.execution.interiors.responding import Responding
from eigencontact.execution.routes.subsurface import Subsurface
from eigencontact.halfspace.potentials import HasFarField, HasPotentials
from eigencontact.model.kernels import KernelUse, StressCoefficients
from eigencontact.model.overlaps import overlapping
from eigencontact.model.regions import RegionLattice
from eigencontact.model.sources import Inhomogeneity
from eigencontact.plugin import LinearLaw

__all__ = ["Wholes"]


#: Points of an inclusion at which the stress of the contact is averaged, for the cost.
_POINTS = 32
#: Numbers that are held while the stress of the contact is averaged.
_CHUNK = 4_000_000


class Wholes(Responding):
    """One eigenstrain of each inhomogeneity.

    The mean stress in an inclusion by unit traction on a cell also gives the mean displacement of that cell by a
    uniform eigenstrain of the inclusion (Betti; see `eigencontact.solvers.mean_surface`), and is kept as a matrix.

    Raises
    ------
    SceneError
        A shape without closed form, a law or a prestrain that is not uniform and linear, or inclusions that overlap.
    """

    def __init__(self, subsurface: Subsurface, directions: str) -> None:
        super().__init__(subsurface, directions, None)
        for source in self.sources:
            _refuse(source)
        for first, second in overlapping(self.sources):
            raise SceneError(
                f"{second.where} ({second.name!r}) must not overlap with {first.name!r} for "
                "numerics.inclusion-resolution = 'whole' (got ground that both hold); set it to 'cells'"
            )
        self._kernels = subsurface.kernels
        self.why = "its uniform eigenstrain"
        if len(self.sources) > 1:
            self.why = f"one eigenstrain of each of {len(self.sources)} whole inhomogeneities"
        self._declare()

    def _declare(self) -> None:
        """Set price and kernels."""
        count, cells = len(self.sources), self._grid.nx * self._grid.ny
        influences = self._subsurface.influences
        seconds = sum(_POINTS * count * cells * sampling_seconds(i, self._half_space.material) for i in influences)
        self.cost = Cost(
            memory=48.0 * count * cells * len(influences) + 1e6,
            seconds_once=seconds / self._half_space.threads + 2e-3 * count,
            seconds_per_step=1e-2 * count,
        )
        what, shapes = "mean stress (6 components)", " and ".join(sorted({source.key for source in self.sources}))
        uses = [KernelUse(what, f"traction {i.traction}", i.key, "whole window", count) for i in influences]
        self.kernels = (*uses, KernelUse(what, "uniform eigenstrain", shapes, "each in each", count**2))
        if self._surface is not None:
            self.cost += self._surface.cost

    def start(self) -> None:
        """See `Interior.start`."""
        from eigencontact.solvers.whole_inclusions import WholeInclusions

        shapes = [cast("HasPotentials", source.shape) for source in self.sources]
        laws: list[Any] = []  # like laws are one object, so that their conditions are found once
        for source in self.sources:
            laws.append(next((law for law in laws if law == source.law), source.law))
        self._system = WholeInclusions(
            shapes, self._half_space.material, laws, space=self._half_space.space, threads=self._numerics.threads
        )
        if self._subsurface.prescribed:
            none = np.empty(0)
            points = RegionLattice(
                target=(0, 0), origin=(0.0, 0.0), x=none, y=none, depths=none, points=self._system.points.T.copy()
            )
            self._prescribed = self._subsurface.prescribed_field("stress", points)
        self._volumes = np.array(
            [float(cast("HasFarField", source.shape).far_field().volumes.sum()) for source in self.sources]
        )
        self._matrices = [self._by_cell(kernel) for kernel in self._kernels]

    def _by_cell(self, kernel: StressCoefficients) -> FloatArray:
        """Mean stress in every inclusion by unit traction on every cell, ``(6, n, ny, nx)``."""
        points, grid = self._system.points, self._grid
        out = np.empty((6, len(self.sources), *grid.shape))
        half = (0.5 * grid.dx, 0.5 * grid.dy)
        step = max(1, _CHUNK // (6 * grid.nx * points.shape[1]))

        def fill(first: int) -> None:
            y = grid.y[first : first + step]
            values = np.empty((6, y.size, grid.nx, points.shape[1]))
            for number, (px, py, pz) in enumerate(points.T):
                # Offsets (point minus cell) ascend when the cells are taken in descending order.
                table = kernel.table(list(COMPONENTS), px - grid.x[::-1], py - y[::-1], float(pz), half)
                values[..., number] = table[:, ::-1, ::-1]
            means = self._system.mean(values.reshape(-1, points.shape[1]))
            out[:, :, first : first + y.size] = means.reshape(6, y.size, grid.nx, -1).transpose(0, 3, 1, 2)

        in_parallel(self._half_space.threads, [partial(fill, first) for first in range(0, grid.ny, step)])
        return out

    def prestrain(self, time: float) -> FloatArray:
        """See `Responding.prestrain`."""
        return np.array([source.uniform_eigenstrain(time) for source in self.sources]).T

    def applied(self, tractions: Fields) -> FloatArray:
        """See `Responding.applied`."""
        total = np.zeros((6, len(self.sources)))
        if self._prescribed is not None:
            total += self._system.mean(self._prescribed.at(self._time))
        if tractions:
            for load, matrix in zip(loads(self.body, self._tractions, tractions), self._matrices, strict=True):
                total += np.tensordot(matrix, load, 2)
        return total

    def solve(self, applied: FloatArray, prestrain: FloatArray, tolerance: float) -> Any:
        """See `Responding.solve`."""
        return self._system.solve(
            applied, prestrain, start=self.eigenstrain, tolerance=tolerance,
            max_iterations=self._numerics.max_iterations, progress=self.progress,
        )  # fmt: skip

    def mean_displacement(self, eigenstrain: FloatArray) -> FloatArray:
        """See `Responding.mean_displacement`."""
        weighted = eigenstrain * self._volumes / self._grid.cell_area
        return np.array([np.tensordot(weighted, matrix, 2) for matrix in self._matrices])


def _refuse(source: Inhomogeneity) -> None:
    uniform = source.exact and isinstance(source.shape, HasFarField)
    if not (uniform and isinstance(source.law, LinearLaw)):
        raise SceneError(
            f"{source.where} ({source.name!r}) must have a closed form and be uniform, of a linear law, for "
            f"numerics.inclusion-resolution = 'whole' (got {source.key!r} of {source.law.key!r}); set it to 'cells'"
        )
