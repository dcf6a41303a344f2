"""Runner of a stress region under a contact: stress of pressure and shear; that of eigenstrain adds to it."""

from __future__ import annotations

from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.grid import Box
from eigencontact.core.material import Material
from eigencontact.execution.regions import store_region, strain_from_stress
from eigencontact.execution.runners import State
from eigencontact.planning.blocks import Block
from eigencontact.planning.declare import AT_ONCE
from eigencontact.planning.kernels import StressCoefficients
from eigencontact.planning.plan import Plan
from eigencontact.planning.regions import RegionLattice
from eigencontact.scene.schema import StressRequest

__all__ = ["Stress"]

FloatArray = NDArray[np.float64]


class Stress:
    """One region; the spectra are kept as long as the contact stays in the box that they were made for.

    Body 2 is loaded by the same pressure and the opposite shear; seen along its own z axis, which points into it, its
    stress is that of body 1 under those.
    """

    def __init__(self, plan: Plan, block: Block) -> None:
        request, lattice = block.settings["request"], block.settings["lattice"]
        assert isinstance(request, StressRequest)
        assert isinstance(lattice, RegionLattice)
        self._request, self._lattice, self._grid = request, lattice, plan.grid
        body = plan.bodies[request.body - 1]
        assert body is not None
        tractions = cast("tuple[str, ...]", block.settings["tractions"])
        self._body = body
        self._kernels = [StressCoefficients(plan.influences[name], body) for name in tractions]
        sign = 1.0 if request.body == 1 else -1.0
        self._shear = [(f"shear_{name[-1]}", sign) for name in tractions if name != "p"]
        self._numerics = plan.scene.numerics
        self._operator: Any = None

    def __call__(self, state: State) -> None:
        """Advance one step; see `Runner`."""
        tractions = [state.fields["pressure"], *(sign * state.fields[name] for name, sign in self._shear)]
        request, lattice = self._request, self._lattice
        stress = self._at_points(tractions) if lattice.points is not None else self._on_lattice(tractions)
        fields = {"stress": stress}
        if "strain" in request.fields:
            fields["strain"] = self._strain(stress)
        for name, values in state.inner.get(request.label, {}).items():
            fields[name] = fields[name] + values
        store_region(state, request, lattice, fields)

    def _strain(self, stress: FloatArray) -> FloatArray:
        if isinstance(self._body, Material):
            return strain_from_stress(stress, self._body)
        from eigencontact.execution.layered import strain_in_layers

        return strain_in_layers(stress, self._body, self._lattice)

    def _at_points(self, tractions: list[FloatArray]) -> FloatArray:
        from eigencontact.solvers.subsurface import stress_at_points

        assert self._lattice.points is not None
        points, threads = self._lattice.points, self._numerics.threads
        return stress_at_points(self._grid, self._kernels, tractions, points, threads=threads)

    def _on_lattice(self, tractions: list[FloatArray]) -> FloatArray:
        from eigencontact.solvers.subsurface import SubsurfaceStress

        lattice, numerics = self._lattice, self._numerics
        box = Box.around(tractions[0] > 0)
        if box is None:
            return np.zeros((6, *lattice.shape))
        if lattice.finer != (1, 1):
            return self._close_up(tractions, box)
        if self._operator is None or not self._operator.covers(box):
            margin = 0 if self._operator is None else max(2, max(box.shape) // 6)
            self._operator = None  # its memory goes before the next is made
            self._operator = SubsurfaceStress(
                self._grid,
                self._kernels,
                source=box.grown(margin, margin, self._grid.shape),
                target=lattice.target,
                origin=lattice.origin,
                depths=lattice.depths,
                periodic=numerics.boundary == "periodic",
                precision=numerics.precision,
                threads=numerics.threads,
            )
        return np.asarray(self._operator.apply(tractions), dtype=float)

    def _close_up(self, tractions: list[FloatArray], box: Box) -> FloatArray:
        """Stress on points finer than the cells: lattices of the cells' pitch, one after the other, few depths each."""
        from eigencontact.solvers.subsurface import SubsurfaceStress

        out = np.empty((6, *self._lattice.shape))
        for begin in range(0, self._lattice.depths.size, AT_ONCE):
            layers = slice(begin, begin + AT_ONCE)
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
        return out
