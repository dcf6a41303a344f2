"""Worn surfaces in stored results: shapes, solved cycles and history of the wear."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from eigencontact.results.stored import Results

__all__ = [
    "SolvedCycle",
    "course",
    "ends_of_cycles",
    "initial_separation",
    "interfaces",
    "solved_cycles",
    "wears",
]

_MOVED = ("displacement_z", "residual_displacement_z")


@dataclass(frozen=True)
class SolvedCycle:
    """A cycle whose increments were solved: positions along ``step`` of first and last, and cycles done at its end."""

    first: int
    last: int
    cycle_count: float


def wears(dataset: Results) -> bool:
    """Whether a surface has lost depth."""
    return "max_worn_depth" in dataset and float(np.nanmax(dataset["max_worn_depth"].values)) > 0.0


def solved_cycles(dataset: Results) -> list[SolvedCycle]:
    """Solved cycles of a history, in order, without skipped cycles."""
    if "load_cycle" not in dataset:
        return []
    number = np.asarray(dataset["load_cycle"].values)
    cycles_at_step = np.asarray(dataset["cycles"].values, dtype=float) if "cycles" in dataset else None
    cycles: list[SolvedCycle] = []
    for cycle in np.unique(number[number > 0]):
        steps = np.flatnonzero(number == cycle)
        number_done = len(cycles) + 1.0 if cycles_at_step is None else float(cycles_at_step[steps[-1]])
        cycles.append(SolvedCycle(int(steps[0]), int(steps[-1]), number_done))
    return cycles


def ends_of_cycles(dataset: Results) -> NDArray[np.intp]:
    """Positions along ``step`` of ends of solved cycles, and of all steps outside of cycles."""
    inside = {n for cycle in solved_cycles(dataset) for n in range(cycle.first, cycle.last)}
    return np.array([n for n in range(dataset.sizes["step"]) if n not in inside], dtype=np.intp)


def course(dataset: Results) -> tuple[NDArray[np.float64], str, str]:
    """Coordinate of a wear history at each step: values, name and unit.

    Cycles where there are some; else the path of sliding all over the contact; else the number of the step.
    """
    cycles = np.asarray(dataset["cycles"].values, dtype=float) if "cycles" in dataset else np.zeros(0)
    if cycles.max(initial=0.0) > 0:
        return cycles, "Cycles", "1"
    if "sliding_path" in dataset:
        return np.asarray(dataset["sliding_path"].values, dtype=float), "Sliding distance", "m"
    return np.asarray(dataset["step"].values, dtype=float), "Step", "1"


def initial_separation(dataset: Results, step: int = -1) -> NDArray[np.float64]:
    """Separation (ny, nx) [m] of the unloaded and unworn surfaces, where the geometry is at a step.

    It follows from the gap ``g = h + w + u + r - approach - tilt_x y + tilt_y x`` of the first step, which meets a worn
    depth w only where it slides by a distance; of a geometry that travels from that of the step, worn on its way there.
    r is what eigenstrain displaces.
    """
    position = step % dataset.sizes["step"]
    moves = any(float(np.ptp(dataset[axis].values)) > 0 for axis in ("travel_x", "travel_y") if axis in dataset)
    # What slips wears after it is solved.
    slides = "sliding_path" in dataset and float(dataset["sliding_path"][0]) > 0.0
    if not moves:
        position = 0
    met: Any = dataset["worn_depth"][position].values * (moves or slides) if "worn_depth" in dataset else 0.0
    tilt: Any = 0.0
    if "tilt_x" in dataset and "tilt_y" in dataset:
        tilt_x, tilt_y = (float(dataset[name][position]) for name in ("tilt_x", "tilt_y"))
        tilt = tilt_x * dataset["y"].values[:, None] - tilt_y * dataset["x"].values
    moved = sum(dataset[name][position].values for name in _MOVED if name in dataset)
    gap, approach = dataset["gap"][position].values, float(dataset["approach"][position])
    return np.asarray(gap - met - moved + approach + tilt, dtype=float)


def interfaces(dataset: Results, body: int) -> tuple[float, ...]:
    """Depths [m] of the interfaces of a body below the unworn surface."""
    layers = json.loads(dataset.attrs.get("layers", "{}")).get(str(body), [])
    return tuple(layer["bottom"] for layer in layers)
