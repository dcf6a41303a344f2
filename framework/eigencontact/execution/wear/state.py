"""What is known of surfaces that wear from one step to the next: in stored records, and while a step is computed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.grid import Grid
from eigencontact.execution.step import Step
from eigencontact.results.records import HistoryRecord, StepRecord

__all__ = ["WornState", "recalled", "store"]

FloatArray = NDArray[np.float64]

#: What is remembered: unit and meaning.
_REMEMBERED = {
    "total_energy": ("J/m2", "work of friction so far, that of skipped cycles included"),
    "start_depth": ("m", "worn depth at the start of the cycle"),
    "start_energy": ("J/m2", "work of friction at the start of the cycle, that of skipped cycles included"),
    "start_slip": ("m", "path slipped at the start of the cycle"),
    "start_dissipated": ("J/m2", "work of friction of solved increments at the start of the cycle"),
    "rate": ("m/Pa", "depth that the last solved cycle wore, by pressure"),
    "steady": ("m", "depth that the last solved cycle wore whatever the pressure"),
    "slope": ("m/Pa", "change of the depth by pressure from cycle to cycle"),
    "cycle_energy": ("J/m2", "work of friction of the last solved cycle"),
}


@dataclass(kw_only=True, slots=True)
class WornState:
    """Two surfaces, one of which at least wears; arrays are (ny, nx).

    Attributes
    ----------
    depth : dict of int to array
        Lost by each body that wears [m].
    energy : array
        Work of friction so far, that of skipped cycles included [J/m²].
    memory : dict of str to array
        Values at the start of the cycle in progress, and rates of the last solved one.
    error : float
        Estimated error of the worn volume by jumps so far [m³].
    cycles : float
        Cycles done.
    jump : int
        Cycles that the last solved one stands for.
    """

    depth: dict[int, FloatArray]
    energy: FloatArray
    memory: dict[str, FloatArray] = field(default_factory=dict)
    error: float = 0.0
    cycles: float = 0.0
    jump: int = 1

    @property
    def total(self) -> FloatArray:
        """Depth lost by both [m]."""
        return np.asarray(sum(self.depth.values()))


def recalled(last: StepRecord | None, bodies: Mapping[int, float], grid: Grid) -> WornState:
    """State after the last accepted step, from its record alone; of new surfaces before the first."""
    zero = np.zeros(grid.shape)
    if last is None:
        return WornState(depth=dict.fromkeys(bodies, zero), energy=zero)
    held = {name: last.history[f"wear_{name}"].values[0, 0] for name in _REMEMBERED if f"wear_{name}" in last.history}
    return WornState(
        depth={body: last.fields[f"worn_depth_{body}"] for body in bodies},
        energy=held.pop("total_energy"),
        memory=held,
        error=last.scalars["wear_error"] * last.scalars["worn_volume"],
        cycles=last.scalars["cycles"],
        jump=int(last.scalars["jump_cycles"]),
    )


def store(state: WornState, step: Step, grid: Grid) -> None:
    """Fields, numbers and what is remembered, into a step."""
    total, area = state.total, grid.cell_area
    step.fields |= {"worn_depth": total, **{f"worn_depth_{body}": depth for body, depth in state.depth.items()}}
    volume = float(total.sum()) * area
    step.scalars |= {
        "worn_volume": volume,
        "max_worn_depth": float(total.max()),
        "cycles": state.cycles,
        "jump_cycles": float(state.jump),
        "wear_energy": float(state.energy.sum()) * area,
        "wear_error": state.error / volume if volume > 0 else 0.0,
    }
    coords = {"z": np.zeros(1), "y": grid.y, "x": grid.x}
    for name, values in {"total_energy": state.energy, **state.memory}.items():
        unit, meaning = _REMEMBERED[name]
        step.history[f"wear_{name}"] = HistoryRecord(
            name=f"wear_{name}", body=1, values=values[None, None], coords=coords, unit=unit, meaning=meaning
        )
