"""State of wearing surfaces, in stored records and during a step."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from eigencontact.core.array_types import FloatArray
from eigencontact.core.grid import Grid
from eigencontact.execution.blocks.step import Step
from eigencontact.results.records import HistoryRecord, StepRecord

__all__ = ["WornState", "recalled", "store", "updated"]


#: Decimals of a shift in cells: a shift by whole cells needs no interpolation.
_DIGITS = 9
#: Stored state of wear: unit and meaning.
_STORED_STATE = {
    "update": ("m", "worn depth added at the end of the step, after its pressure was computed"),
    "total_energy": ("J/m2", "work of friction per area so far, with skipped cycles"),
    "depth_2": ("m", "worn depth of body 2, in coordinates of body 2"),
    "start_depth": ("m", "worn depth at the start of the cycle"),
    "start_depth_2": ("m", "worn depth of body 2 at the start of the cycle, in coordinates of body 2"),
    "start_energy": ("J/m2", "work of friction per area at the start of the cycle, with skipped cycles"),
    "start_pressure": ("Pa", "pressure at the start of the cycle"),
    "cycle_depth": ("m", "worn depth of the cycle so far, by the wear law at the pressure of each increment"),
    "start_slip": ("m", "slip distance at the start of the cycle"),
    "start_dissipated": ("J/m2", "work of friction of solved increments at the start of the cycle"),
    "peak_pressure": ("Pa", "largest pressure in the cycle so far"),
    "rate": ("m/Pa", "worn depth of the last solved cycle per pressure"),
    "steady": ("m", "worn depth of the last solved cycle, independent of the pressure"),
    "steady_2": ("m", "worn depth of the last solved cycle on body 2, in coordinates of body 2"),
    "slope": ("m/Pa", "change of the worn depth per pressure from cycle to cycle"),
    "cycle_energy": ("J/m2", "work of friction of the last solved cycle"),
}


@dataclass(kw_only=True, slots=True)
class WornState:
    """Worn depth of both surfaces, of which at least one wears; arrays are (ny, nx).

    Body 1 is fixed in the window; body 2 moves with the geometry. The worn depth of body 2 is stored in coordinates
    that move with it, and interpolated linearly into the window. New worn depth in the window is transferred back by
    the adjoint of this interpolation, which conserves volume. The frame is periodic; the contact is smaller than a
    period.

    Attributes
    ----------
    depth : dict of int to array
        Worn depth of each body that wears, in its own coordinates [m].
    energy : array
        Friction work so far, skipped cycles included [J/m²].
    cells : (float, float)
        Displacement of body 2 along x and y, in cells.
    memory : dict of str to array
        Values at the start of the present cycle, and rates of the last solved cycle.
    error : float
        Estimated error of the worn volume by all jumps so far [m³].
    lag : float
        Estimated error of the worn volume because surfaces move once per cycle [m³]; negative for too little wear.
    cycles : float
        Number of completed cycles.
    jump : int
        Number of cycles represented by the last solved cycle.
    """

    depth: dict[int, FloatArray]
    energy: FloatArray
    cells: tuple[float, float] = (0.0, 0.0)
    memory: dict[str, FloatArray] = field(default_factory=dict)
    error: float = 0.0
    lag: float = 0.0
    cycles: float = 0.0
    jump: int = 1

    @property
    def total(self) -> FloatArray:
        """Worn depth of both bodies together, at their present positions [m]."""
        return np.asarray(sum(self.in_window(body) for body in self.depth))

    @property
    def sum_of_depths(self) -> FloatArray:
        """Worn depth of both bodies, each in its own coordinates [m]: for volumes and the start of a cycle."""
        return np.asarray(sum(self.depth.values()))

    def in_window(self, body: int) -> FloatArray:
        """Worn depth of a body, in coordinates of the window [m]."""
        return carried(self.depth[body], self.cells) if body == 2 else self.depth[body]

    def wear(self, added: FloatArray, parts: Mapping[int, float]) -> None:
        """Add a worn depth [m] to the bodies by their shares, in coordinates of the window."""
        x, y = self.cells
        local = {1: added, 2: carried(added, (-x, -y)) if 2 in parts else added}
        self.depth = {body: depth + parts[body] * local[body] for body, depth in self.depth.items()}


def carried(values: FloatArray, cells: tuple[float, float]) -> FloatArray:
    """Values ``(ny, nx)`` shifted by cells along x and y, by linear interpolation, periodic at the border.

    The sum is conserved; the reverse shift is the adjoint.

    Examples
    --------
    >>> carried(np.array([[0.0, 4.0, 0.0, 0.0]]), (1.25, 0.0))
    array([[0., 0., 3., 1.]])
    """
    for axis, distance in ((1, cells[0]), (0, cells[1])):
        whole = int(np.floor(distance))
        fraction = distance - whole
        if whole:
            values = np.roll(values, whole, axis)
        if fraction:
            values = (1.0 - fraction) * values + fraction * np.roll(values, 1, axis)
    return values


def updated(memory: dict[str, FloatArray]) -> dict[str, FloatArray]:
    """Entries of the memory that persist after a cycle: the motion of the surfaces at its end."""
    return {"update": memory["update"]} if "update" in memory else {}


def recalled(
    last: StepRecord | None, bodies: Mapping[int, float], grid: Grid, travel: tuple[float, float] | None
) -> WornState:
    """State after the last accepted step, from its record; unworn surfaces before the first step.

    `travel` is the new position of body 2 [m]; None if it never moves.
    """
    zero, cells = np.zeros(grid.shape), (0.0, 0.0)
    if travel is not None:
        cells = (round(travel[0] / grid.dx, _DIGITS), round(travel[1] / grid.dy, _DIGITS))
    if last is None:
        return WornState(depth=dict.fromkeys(bodies, zero), energy=zero, cells=cells)
    stored = {name: last.history[f"wear_{name}"].values[0] for name in _STORED_STATE if f"wear_{name}" in last.history}
    if "rate" in stored:
        stored.setdefault("steady", zero)
    depth = {body: last.fields[f"worn_depth_{body}"] for body in bodies}
    if "depth_2" in stored:
        depth[2] = stored.pop("depth_2")
    return WornState(
        depth=depth,
        cells=cells,
        energy=stored.pop("total_energy"),
        memory=stored,
        error=(last.scalars["wear_error"] - abs(last.scalars["update_error"])) * last.scalars["worn_volume"],
        lag=last.scalars["update_error"] * last.scalars["worn_volume"],
        cycles=last.scalars["cycles"],
        jump=int(last.scalars["jump_cycles"]),
    )


def store(state: WornState, step: Step, grid: Grid, *, travels: bool = False) -> None:
    """Store fields, numbers and state in a step; `travels` states that body 2 moves."""
    total, area = state.total, grid.cell_area
    body2_depth = {"depth_2": state.depth[2]} if travels and 2 in state.depth else {}
    step.fields |= {"worn_depth": total, **{f"worn_depth_{body}": state.in_window(body) for body in state.depth}}
    volume = float(total.sum()) * area
    step.scalars |= {
        "worn_volume": volume,
        "max_worn_depth": float(total.max()),
        "cycles": state.cycles,
        "jump_cycles": float(state.jump),
        "wear_energy": float(state.energy.sum()) * area,
        "wear_error": (state.error + abs(state.lag)) / volume if volume > 0 else 0.0,
        "update_error": state.lag / volume if volume > 0 else 0.0,
    }
    coords = {"y": grid.y, "x": grid.x}
    for name, values in {"total_energy": state.energy, **body2_depth, **state.memory}.items():
        if name == "steady" and not values.any():  # for example for a contact of constant size
            continue
        unit, meaning = _STORED_STATE[name]
        step.history[f"wear_{name}"] = HistoryRecord(
            name=f"wear_{name}", body=1, values=values[None], coords=coords, unit=unit, meaning=meaning
        )
