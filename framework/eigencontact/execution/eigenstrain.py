"""Runners of prescribed eigenstrain: displacement of the surface, fields at the points of a region."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol, cast

import numpy as np
from numpy.typing import NDArray

from eigencontact.execution.runners import State
from eigencontact.halfspace.potentials import HasPotentials
from eigencontact.planning.blocks import Block
from eigencontact.planning.field_cost import CLOUD
from eigencontact.planning.field_parts import FieldPart, space_of
from eigencontact.planning.plan import Plan
from eigencontact.scene.schema import StressRequest

__all__ = ["ClosedForms", "EigenstrainRegion", "ResidualDisplacement", "Sum"]

FloatArray = NDArray[np.float64]


class ResidualDisplacement:
    """Displacement of the surface: along z of both bodies summed (it opens the gap), along x and y of body 1 less 2."""

    def __init__(self, plan: Plan, block: Block) -> None:
        self._components = str(block.settings["components"])
        parts = cast("list[FieldPart]", block.settings["parts"])
        self._bodies = {
            number: Sum(plan, [part for part in parts if part.body == number])
            for number in sorted({part.body for part in parts})
        }
        self._friction, self._shape = plan.friction is not None, plan.grid.shape

    def __call__(self, state: State) -> None:
        """Advance one step; see `Runner`."""
        state.fields |= self._relative(self._of_bodies(state))
        if self._friction and state.previous is None:
            state.initial = self._before(state)
        if "z" in self._components:
            sunk = state.fields["residual_displacement_z"]
            state.scalars["max_uplift"] = max(0.0, -float(sunk.min()))
            state.scalars["max_sink"] = max(0.0, float(sunk.max()))

    def _of_bodies(self, state: State) -> dict[int, FloatArray]:
        """Displacement of each body with eigenstrain, ``(3, ny, nx)``."""
        return self._at(state.time)

    def _before(self, _state: State) -> dict[str, FloatArray]:
        """Surface fields before the first step."""
        return self._relative(self._at(0.0))

    def _at(self, time: float) -> dict[int, FloatArray]:
        return {number: total(time)[:, 0] for number, total in self._bodies.items()}

    def _relative(self, by_body: dict[int, FloatArray]) -> dict[str, FloatArray]:
        """Surface fields of both bodies together."""
        found = {}
        for row, component in enumerate("xyz"):
            if component not in self._components:
                continue
            values = [(-1.0 if n == 2 and component != "z" else 1.0) * u[row] for n, u in by_body.items()]
            found[f"residual_displacement_{component}"] = np.sum(values, axis=0)
        return found


class EigenstrainRegion:
    """Fields of the eigenstrain of one body at the points of a region."""

    def __init__(self, plan: Plan, block: Block) -> None:
        request = block.settings["request"]
        parts = cast("list[FieldPart]", block.settings["parts"])
        assert isinstance(request, StressRequest)
        self._label = request.label
        by_name = {name: [part for part in parts if part.quantity == name] for name in request.fields}
        self._sums = {name: Sum(plan, some) for name, some in by_name.items() if some}

    def __call__(self, state: State) -> None:
        """Advance one step; see `Runner`."""
        state.inner[self._label] = {name: total(state.time) for name, total in self._sums.items()}


class Part(Protocol):
    """Field of one source at the points of a region."""

    def __call__(self, time: float) -> FloatArray:
        """``(3 or 6, *lattice.shape)``; stress in Pa."""
        ...


class Sum:
    """Sum of parts of one quantity; those that do not change with time are evaluated once and then forgotten."""

    def __init__(self, plan: Plan, parts: Sequence[FieldPart]) -> None:
        self._shape = (3 if parts[0].quantity == "displacement" else 6, *parts[0].lattice.shape)
        self._still = [_built(plan, part) for part in parts if not part.varies]
        self._moving = [_built(plan, part) for part in parts if part.varies]
        self._once: FloatArray | None = None

    def __call__(self, time: float) -> FloatArray:
        """Sum of the fields at one time."""
        if self._once is None:
            self._once = np.zeros(self._shape)
            while self._still:
                self._once += self._still.pop()(time)
        if not self._moving:
            return self._once
        total = self._once.copy()
        for part in self._moving:
            total += part(time)
        return total


def _built(plan: Plan, part: FieldPart) -> Part:
    if part.route in ("image-pressure", "periodic"):
        from eigencontact.execution.lower_fidelities import ImagePressureFields, PeriodicFields

        return ImagePressureFields(plan, part) if part.route == "image-pressure" else PeriodicFields(plan, part)
    if part.group is None:
        return ClosedForms(plan, part)
    from eigencontact.execution.cells import CellFields

    return CellFields(plan, part)


class ClosedForms:
    """Shapes with potentials and uniform eigenstrain, all in one body.

    Their field is linear in the eigenstrain: where all of it only changes by one factor, the field at the end of the
    first step is scaled (always that one, so that a resumed run gives the same numbers to the last digit).
    """

    def __init__(self, plan: Plan, part: FieldPart) -> None:
        body = plan.half_space(part.body)
        self._numerics, self._sources, self._quantity = plan.scene.numerics, part.sources, part.quantity
        self._lattice, self._body = part.lattice, body
        self._end = np.array([source.uniform_eigenstrain(1.0) for source in part.sources])
        self._at_end: FloatArray | None = None

    def __call__(self, time: float) -> FloatArray:
        """Field at one time; see `Part`."""
        eigenstrain = np.array([source.uniform_eigenstrain(time) for source in self._sources])
        size = float(np.sum(self._end * self._end))
        factor = float(np.sum(eigenstrain * self._end)) / size if size else 0.0
        if not np.allclose(factor * self._end, eigenstrain, rtol=1e-14, atol=0.0):
            return self.of(eigenstrain)
        if self._at_end is None:
            self._at_end = self.of(self._end)
        return factor * self._at_end

    def of(self, eigenstrain: FloatArray) -> FloatArray:
        """Field of uniform eigenstrains, ``(n, 6)`` of the n shapes."""
        shapes = [cast("HasPotentials", source.shape) for source in self._sources]
        points, quantity, nu = self._lattice.flat_points(), self._quantity, self._body.poisson_ratio
        space, threads = space_of(self._numerics), self._numerics.threads
        if len(shapes) >= CLOUD:
            from eigencontact.halfspace.cloud import field_of_cloud

            values = field_of_cloud(
                shapes, eigenstrain, points, poisson_ratio=nu, quantity=quantity, space=space, threads=threads
            )
        else:
            from eigencontact.halfspace.points import field_at_points

            values = np.zeros((3 if quantity == "displacement" else 6, points[0].size))
            for shape, strain in zip(shapes, eigenstrain, strict=True):
                values += field_at_points(
                    shape, strain, points, poisson_ratio=nu, quantity=quantity, space=space, threads=threads
                )
        if quantity == "stress":
            values *= self._body.shear_modulus
        return values.reshape(-1, *self._lattice.shape)
