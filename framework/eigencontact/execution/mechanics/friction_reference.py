"""Reference blocks of a contact with friction: shear bound of the law, closed form of monotonic loading."""

from __future__ import annotations

from functools import partial

import numpy as np

from eigencontact.core.array_types import FloatArray
from eigencontact.core.grid import Grid
from eigencontact.core.material import contact_modulus
from eigencontact.execution.blocks.block import Stateless
from eigencontact.execution.blocks.step import Step
from eigencontact.execution.mechanics.exposed_material import exposed_facts
from eigencontact.model.bodies import without_layers
from eigencontact.model.exposed import Exposed
from eigencontact.model.kernels import Solids
from eigencontact.plugin import FrictionLaw, FrictionState, HasReferencePressure
from eigencontact.plugin.friction import checked_shear_bound
from eigencontact.results.records import StepRecord

__all__ = ["ReferenceShear", "ShearBound"]


#: Loads are equal if they differ by less than this fraction of the friction limit.
_LOAD_TOLERANCE = 1e-9
#: Sine of the largest angle between two loads of equal direction.
_TURN = 1e-4
#: Relative deviation from proportionality to the pressure up to which a bound has one coefficient of friction.
_UNIFORM = 1e-9


class ShearBound(Stateless):
    """Largest shear allowed by the friction law in each cell, for the pressure of the step."""

    name, reason = "shear-bound", "what the friction law allows, drawn beside the shear"
    requires = frozenset({"pressure", "slip_distance"})
    provides = frozenset({"shear_bound"})
    requesters = dict.fromkeys(("shear_bound",), "pictures")

    def __init__(self, law: FrictionLaw, grid: Grid, exposed: Exposed | None) -> None:
        self._law, self._axes, self._facts = law, grid.axes(), partial(exposed_facts, exposed)
        if exposed is not None:
            self.requires = self.requires | {"exposed_material"}

    def advance(self, step: Step) -> None:
        """See `Running.advance`."""
        y, x = self._axes
        pressure = step.fields["pressure"]
        slipped = np.zeros_like(pressure) if step.previous is None else step.previous.fields["slip_distance"]
        facts = self._facts(step.surface.exposed)
        state = FrictionState(pressure=pressure, x=x, y=y, slip_distance=slipped, time=step.time, **facts)
        step.fields["shear_bound"] = checked_shear_bound(self._law, state)


class ReferenceShear(Stateless):
    """Closed form of the shear, for a geometry with a closed form of the pressure, as long as it is valid.

    It requires a constant normal load P, a tangential load Q that rises from zero in one direction, and one coefficient
    of friction f. The shear is f times the pressure under P minus the pressure under P - Q/f: the solution of Cattaneo
    and Mindlin for a sphere, and of Ciavarella and Jaeger for any shape. The theorem neglects the normal displacement
    by shear, and displacement by shear across its direction, as most pairs of "none" and "partial" coupling do. A step
    that leaves this load path (unloading, change of direction, torsion, another normal load) ends the closed form for
    itself and all later steps.

    The stored field of the last step shows whether the path has been kept, so resumed runs agree.

    References
    ----------
    M. Ciavarella, The generalized Cattaneo partial slip plane contact problem, Int. J. Solids Structures 35 (1998).
    J. Jaeger, A new principle in contact mechanics, ASME J. Tribology 120 (1998) 677-684.
    """

    name = "reference-shear"
    requires = frozenset({"pressure", "shear_bound"})
    provides = frozenset({"reference_shear_x", "reference_shear_y"})
    requesters = dict.fromkeys(("reference_shear_x", "reference_shear_y"), "pictures")

    def __init__(self, geometry: HasReferencePressure, key: str, grid: Grid, solids: Solids) -> None:
        self._grid, self._geometry = grid, geometry
        self._modulus = contact_modulus(*without_layers(solids))
        self.reason = f"geometry {key!r} has a closed form of the shear while it rises in one direction"

    def advance(self, step: Step) -> None:
        """See `Running.advance`."""
        scalars, pressure = step.scalars, step.fields["pressure"]
        coefficient = _coefficient(pressure, step.fields["shear_bound"])
        if coefficient is None or any(scalars[name] for name in ("tilt_x", "tilt_y", "twist")):
            return
        load = np.array([scalars["tangential_load_x"], scalars["tangential_load_y"]])
        capacity = coefficient * scalars["normal_load"]
        if not _path_kept(load, scalars["normal_load"], capacity, step.previous):
            return
        size = float(np.hypot(*load))
        shear, along = np.zeros(self._grid.shape), np.zeros(2)
        if size > _LOAD_TOLERANCE * capacity:
            along = load / size
            full_pressure, stick_pressure = (
                self._pressure(scalars["normal_load"] * (1 - f)) for f in (0.0, size / capacity)
            )
            shear = coefficient * (full_pressure - stick_pressure)
        for axis, direction in zip("xy", along, strict=True):
            step.fields[f"reference_shear_{axis}"] = direction * shear

    def _pressure(self, load: float) -> FloatArray:
        if load <= 0:
            return np.zeros(self._grid.shape)
        y, x = self._grid.axes()
        return np.broadcast_to(self._geometry.reference_pressure(x, y, load, self._modulus), self._grid.shape)


def _coefficient(pressure: FloatArray, bound: FloatArray) -> float | None:
    """Ratio of the bound to the pressure if it is uniform."""
    loaded = pressure > 0
    if not loaded.any():
        return None
    ratio = bound[loaded] / pressure[loaded]
    return float(ratio.mean()) if np.ptp(ratio) <= _UNIFORM * ratio.max() and ratio.max() > 0 else None


def _path_kept(load: FloatArray, normal_load: float, capacity: float, last: StepRecord | None) -> bool:
    """Whether the tangential load still increases from zero in one direction under a constant normal load."""
    still = float(np.hypot(*load)) <= _LOAD_TOLERANCE * capacity
    if last is None:
        return still
    if "reference_shear_x" not in last.fields:
        return False
    before = np.array([last.scalars["tangential_load_x"], last.scalars["tangential_load_y"]])
    reached, size = float(np.hypot(*before)), float(np.hypot(*load))
    if still and reached <= _LOAD_TOLERANCE * capacity:
        return True
    if abs(normal_load - last.scalars["normal_load"]) > _LOAD_TOLERANCE * normal_load:
        return False
    # Increase along one line: no component across the last load, none against it. Small components by the solver's
    # error are allowed.
    across = abs(before[0] * load[1] - before[1] * load[0])
    return bool(
        reached <= _LOAD_TOLERANCE * capacity
        or (size >= reached * (1 - _LOAD_TOLERANCE) and before @ load > 0 and across <= _TURN * reached * size)
    )
