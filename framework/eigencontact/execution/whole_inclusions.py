"""Inhomogeneities of one body with one uniform eigenstrain each, under the contact and prescribed eigenstrain."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import cast

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.elasticity import Elasticity
from eigencontact.core.parallel import available_threads, in_parallel
from eigencontact.core.tensors import COMPONENTS
from eigencontact.execution.eigenstrain import Sum
from eigencontact.execution.runners import State
from eigencontact.halfspace.potentials import HasPotentials
from eigencontact.planning.cells import installed_cell
from eigencontact.planning.field_parts import field_parts, space_of
from eigencontact.planning.kernels import DIRECTIONS, StressCoefficients
from eigencontact.planning.materials import elasticity_of
from eigencontact.planning.plan import Plan
from eigencontact.planning.regions import RegionLattice
from eigencontact.planning.sources import Source
from eigencontact.planning.whole_inclusions import volume_of
from eigencontact.solvers.equivalent_inclusions import InclusionReport
from eigencontact.solvers.whole_inclusions import WholeInclusions

__all__ = ["WholeBody"]

FloatArray = NDArray[np.float64]

#: Numbers that are held while the stress of the contact is averaged.
_CHUNK = 4_000_000


class WholeBody:
    """Inhomogeneities of one body.

    The mean stress in an inclusion by unit traction on a cell also gives the mean displacement of that cell by a
    uniform eigenstrain of the inclusion (Betti; see `eigencontact.solvers.mean_surface`), and is kept as a matrix.
    """

    def __init__(self, plan: Plan, body: int, sources: Sequence[Source], tractions: Sequence[str]) -> None:
        material = plan.half_space(body)
        numerics = plan.scene.numerics
        self._body, self._sources, self._numerics, self._grid = body, sources, numerics, plan.grid
        known: dict[str, Elasticity] = {}
        for source in sources:
            assert source.material is not None
            known.setdefault(source.material.model_dump_json(), cast("Elasticity", elasticity_of(source)))
        materials = [known[source.material.model_dump_json()] for source in sources if source.material is not None]
        shapes = [cast("HasPotentials", source.shape) for source in sources]
        self._system = WholeInclusions(shapes, material, materials, space=space_of(numerics), threads=numerics.threads)
        self._prescribed = self._prescribed_at(plan)
        sign = 1.0 if body == 1 else -1.0
        self._tractions = [("pressure", 1.0) if name == "p" else (f"shear_{name[-1]}", sign) for name in tractions]
        self._rows = ["xyz".index(DIRECTIONS[name]) for name in tractions]
        self._volumes = np.array([volume_of(source) for source in sources])
        self._means = [self._by_cell(StressCoefficients(plan.influences[name], material)) for name in tractions]

    def _prescribed_at(self, plan: Plan) -> Sum | None:
        """Stress of the prescribed eigenstrain of this body at the points that means are taken over."""
        others = [source for source in plan.sources if source.material is None and source.body == self._body]
        material = plan.half_space(self._body)
        if not others:
            return None
        none = np.empty(0)
        points = RegionLattice(
            target=(0, 0), origin=(0.0, 0.0), x=none, y=none, depths=none, points=self._system.points.T.copy()
        )
        cell = installed_cell(plan.registry)((0.0, 0.0, 0.5), (1.0, 1.0, 1.0))
        parts = field_parts(
            others, "stress", points, body=material, numerics=plan.scene.numerics, cell=cell, components=6
        )
        return Sum(plan, parts)

    def _by_cell(self, kernel: StressCoefficients) -> FloatArray:
        """Mean stress in every inclusion by unit traction on every cell, ``(6, n, ny, nx)``."""
        points, grid = self._system.points, self._grid
        out = np.empty((6, len(self._sources), *grid.shape))
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

        tasks = [partial(fill, first) for first in range(0, grid.ny, step)]
        in_parallel(self._numerics.threads or available_threads(), tasks)
        return out

    def solve(self, state: State, tolerance: float) -> tuple[FloatArray, InclusionReport]:
        """Eigenstrains ``(6, n)`` under what the state holds; leaves the displacement of the surface in it."""
        prestrain = np.array([source.uniform_eigenstrain(state.time) for source in self._sources]).T
        applied = np.zeros_like(prestrain)
        if self._prescribed is not None:
            applied += self._system.mean(self._prescribed(state.time))
        if "pressure" in state.fields:
            for (name, sign), matrix in zip(self._tractions, self._means, strict=True):
                applied += sign * np.tensordot(matrix, state.fields[name], 2)
        found = self._system.solve(
            applied,
            prestrain,
            start=state.equivalent.get(self._body),
            tolerance=tolerance,
            max_iterations=self._numerics.max_iterations,
            progress=state.progress,
        )
        lifted = np.zeros((3, *self._grid.shape))
        weighted = found.eigenstrain * self._volumes / self._grid.cell_area
        for row, matrix in zip(self._rows, self._means, strict=True):
            lifted[row] = np.tensordot(weighted, matrix, 2)
        if self._means:
            state.lifted[self._body] = lifted
        return found.eigenstrain, found.report
