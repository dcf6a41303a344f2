"""Runners of prescribed eigenstrain: displacement of the surface, fields at the points of a region."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.material import Material
from eigencontact.execution.runners import State
from eigencontact.planning.blocks import Block
from eigencontact.planning.eigenstrain import space_of
from eigencontact.planning.plan import Plan
from eigencontact.planning.regions import RegionLattice
from eigencontact.planning.sources import Source
from eigencontact.scene.schema import StressRequest

__all__ = ["EigenstrainRegion", "ResidualDisplacement"]

FloatArray = NDArray[np.float64]


class ResidualDisplacement:
    """Displacement of the surface: along z of both bodies summed (it opens the gap), along x and y of body 1 less 2."""

    def __init__(self, plan: Plan, block: Block) -> None:
        lattice = block.settings["lattice"]
        assert isinstance(lattice, RegionLattice)
        self._components = str(block.settings["components"])
        self._bodies = {
            number: Sum(plan, [source for source in plan.sources if source.body == number], "displacement", lattice)
            for number in sorted({source.body for source in plan.sources})
        }

    def __call__(self, state: State) -> None:
        """Advance one step; see `Runner`."""
        by_body = {number: total(state.time)[:, 0] for number, total in self._bodies.items()}
        for row, component in enumerate("xyz"):
            if component not in self._components:
                continue
            values = [(-1.0 if n == 2 and component != "z" else 1.0) * u[row] for n, u in by_body.items()]
            state.fields[f"residual_displacement_{component}"] = np.sum(values, axis=0)
        if "z" in self._components:
            sunk = state.fields["residual_displacement_z"]
            state.scalars["max_uplift"] = max(0.0, -float(sunk.min()))
            state.scalars["max_sink"] = max(0.0, float(sunk.max()))


class EigenstrainRegion:
    """Fields of the eigenstrain of one body at the points of a region."""

    def __init__(self, plan: Plan, block: Block) -> None:
        request, lattice = block.settings["request"], block.settings["lattice"]
        assert isinstance(request, StressRequest)
        assert isinstance(lattice, RegionLattice)
        self._label = request.label
        sources = [source for source in plan.sources if source.body == request.body]
        self._sums = {name: Sum(plan, sources, name, lattice) for name in request.fields}

    def __call__(self, state: State) -> None:
        """Advance one step; see `Runner`."""
        state.inner[self._label] = {name: total(state.time) for name, total in self._sums.items()}


class Part(Protocol):
    """Field of one source at the points of a region."""

    def __call__(self, time: float) -> FloatArray:
        """``(3 or 6, *lattice.shape)``; stress in Pa."""
        ...


class Sum:
    """Sum over sources of one body; those that do not change with time are evaluated once."""

    def __init__(self, plan: Plan, sources: Sequence[Source], quantity: str, lattice: RegionLattice) -> None:
        self._shape = (3 if quantity == "displacement" else 6, *lattice.shape)
        self._still = [_part(plan, source, quantity, lattice) for source in sources if not source.field.varies]
        self._moving = [_part(plan, source, quantity, lattice) for source in sources if source.field.varies]
        self._once: FloatArray | None = None

    def __call__(self, time: float) -> FloatArray:
        if self._once is None:
            self._once = np.zeros(self._shape)
            for part in self._still:
                self._once += part(time)
            self._still = []
        if not self._moving:
            return self._once
        total = self._once.copy()
        for part in self._moving:
            total += part(time)
        return total


def _part(plan: Plan, source: Source, quantity: str, lattice: RegionLattice) -> Part:
    body = plan.bodies[source.body - 1]
    assert body is not None
    if source.exact:
        return ClosedForm(plan, source, quantity, lattice, body)
    raise NotImplementedError


class ClosedForm:
    """A shape with potentials and a uniform eigenstrain; linear in it, so a changed factor only scales the field."""

    def __init__(self, plan: Plan, source: Source, quantity: str, lattice: RegionLattice, body: Material) -> None:
        self._plan, self._source, self._quantity = plan, source, quantity
        self._lattice, self._body = lattice, body
        self._known: tuple[FloatArray, FloatArray] | None = None

    def __call__(self, time: float) -> FloatArray:
        eigenstrain = self._source.uniform_eigenstrain(time)
        if self._known is not None:
            before, values = self._known
            factor = float(eigenstrain @ before) / float(before @ before)
            if np.allclose(factor * before, eigenstrain, rtol=1e-14, atol=0.0):
                return factor * values
        values = self._evaluate(eigenstrain)
        if self._source.field.varies and eigenstrain.any():
            self._known = eigenstrain, values
        return values

    def _evaluate(self, eigenstrain: FloatArray) -> FloatArray:
        from eigencontact.halfspace.points import field_at_points
        from eigencontact.halfspace.potentials import HasPotentials

        numerics, shape = self._plan.scene.numerics, self._source.shape
        assert isinstance(shape, HasPotentials)
        values = field_at_points(
            shape,
            eigenstrain,
            self._lattice.flat_points(),
            poisson_ratio=self._body.poisson_ratio,
            quantity=self._quantity,
            space=space_of(numerics),
            threads=numerics.threads,
        )
        if self._quantity == "stress":
            values *= self._body.shear_modulus
        return values.reshape(-1, *self._lattice.shape)
