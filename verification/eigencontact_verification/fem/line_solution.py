"""Solution of a line contact by finite elements: tractions, slip and displacement after each step, stress at points."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eigencontact_verification.fem.line_contact_model import LineContact, LineStep
from eigencontact_verification.fem.line_half_plane import HalfPlane
from eigencontact_verification.fem.plane_recovery import recovered_plane
from eigencontact_verification.fem.plane_strain import PlaneBody
from eigencontact_verification.fem.yielding_law import State

__all__ = ["LineMoment", "LineSolution"]

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True, eq=False)
class LineMoment:
    """State of the bodies at the end of an increment.

    Attributes
    ----------
    step : LineStep
    pressure, shear, slip : (n,) float64
        At `LineSolution.x`: tractions on body 1 [Pa]; slip of body 2 over body 1 since first contact [m].
    stick : (n,) bool
        Nodes in contact that the last increment did not shift.
    displacement : (unknowns + 2,) float64
        Unknowns of the bodies (`HalfPlane`); last the rigid motion of body 2 into and along body 1.
    stresses : tuple of (4, elements, 9) float64 or None
        xx, yy, zz, sqrt2 xz at the integration points of each body; None of an elastic one.
    states : tuple
        State variables of the laws, by body.
    iterations : int
        Number of solved linear systems.
    increments : int
        Number of increments of the step after halving, for want of a solution.
    """

    step: LineStep
    pressure: FloatArray
    shear: FloatArray
    slip: FloatArray
    stick: NDArray[np.bool_]
    displacement: FloatArray
    stresses: tuple[FloatArray | None, ...] = field(repr=False)
    states: tuple[tuple[State, ...], ...] = field(repr=False)
    iterations: int = 0
    increments: int = 1


@dataclass(frozen=True, kw_only=True, eq=False)
class LineSolution:
    """State of both bodies after each step.

    Attributes
    ----------
    model : LineContact
    halves : tuple of HalfPlane
    x, weight : (n,) float64
        Ascending surface nodes of possible contact, and their shares of the length [m].
    moments : tuple of LineMoment
        One for each step.
    seconds : float
    """

    model: LineContact
    halves: tuple[HalfPlane, ...]
    x: FloatArray
    weight: FloatArray
    moments: tuple[LineMoment, ...]
    seconds: float

    @property
    def bodies(self) -> tuple[PlaneBody, ...]:
        """Meshes of the bodies."""
        return tuple(half.body for half in self.halves)

    def stress(self, points: ArrayLike, moment: int = -1, body: int = 1) -> FloatArray:
        """Stress xx, yy, zz, xz (4, n) at points (x, z), (n, 2), z into body 1 or upwards into body 2 [Pa].

        Of body 2 in the axes of body 1: its xz changes sign, because its z points the other way.
        """
        half, state, points = self.halves[body - 1], self.moments[moment], np.asarray(points, dtype=float)
        at_integration_points = state.stresses[body - 1]
        if at_integration_points is None:
            first = sum(len(side.unknowns) for side in self.halves[: body - 1])
            at_integration_points = half.stress(state.displacement[first : first + len(half.unknowns)], state.step)
        material = half.material
        stress = recovered_plane(half.body, at_integration_points, points, breaks=material.breaks(), side=material.side)
        stress[3] *= (1 if body == 1 else -1) / np.sqrt(2.0)
        return stress

    def plastic_strain(self, points: ArrayLike, moment: int = -1, body: int = 1) -> FloatArray:
        """Equivalent plastic strain (n,) at points (x, z), (n, 2)."""
        mesh = self.bodies[body - 1]
        return mesh.read(mesh.of_state(self.moments[moment].states[body - 1]), points)

    def contact(self, moment: int = -1) -> tuple[float, float]:
        """Ends of the contact: where the squared pressure of the last nodes inside, with straight lines, is zero."""
        return self._ends(self.moments[moment].pressure ** 2)

    def stick(self, moment: int = -1) -> tuple[float, float]:
        """Ends of the stick zone, where ``(friction p - |q|)²`` is zero (a root's distance from full friction)."""
        state = self.moments[moment]
        return self._ends(np.where(state.stick, self.model.friction * state.pressure - np.abs(state.shear), 0.0) ** 2)

    def _ends(self, value: FloatArray) -> tuple[float, float]:
        """Where a function that is positive between two places and straight beside them rises from 0 and falls to 0."""
        inside = np.flatnonzero(value > 0)
        if inside.size < 4:
            return (float(self.x[inside].min(initial=0.0)), float(self.x[inside].max(initial=0.0)))
        first, last = int(inside[0]), int(inside[-1])
        ends = []
        for nodes, low, high in (
            (np.s_[first : first + 4], self.x[max(first - 1, 0)], self.x[first]),
            (np.s_[last - 3 : last + 1], self.x[last], self.x[min(last + 1, len(self.x) - 1)]),
        ):
            slope, start = np.polyfit(self.x[nodes] - self.x[first], value[nodes], 1)
            ends.append(float(np.clip(self.x[first] - start / slope, low, high)))
        return ends[0], ends[1]
