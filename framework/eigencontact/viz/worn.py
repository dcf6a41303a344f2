"""What stored results say of surfaces that wear: their shapes, the cycles that were solved, the course of the wear."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact.errors import EigencontactError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from eigencontact.model.sources import Source
    from eigencontact.results.stored import Results

__all__ = [
    "SolvedCycle",
    "coatings",
    "course",
    "ends_of_cycles",
    "initial_separation",
    "interfaces",
    "scene_of",
    "solved_cycles",
    "wears",
]

#: Places in the load history closer than this are one.
SAME = 1e-6
_MOVED = ("displacement_z", "residual_displacement_z")


@dataclass(frozen=True)
class SolvedCycle:
    """A cycle of the load history whose increments were solved.

    Attributes
    ----------
    first, last : int
        Positions along ``step`` of its first and last increment.
    done : float
        Cycles done in all when it ended.
    """

    first: int
    last: int
    done: float


def wears(dataset: Results) -> bool:
    """Whether a surface has lost depth."""
    return "max_worn_depth" in dataset and float(np.nanmax(dataset["max_worn_depth"].values)) > 0.0


def solved_cycles(dataset: Results) -> list[SolvedCycle]:
    """Cycles of a history, in order; those that wear skipped are not among them."""
    time = np.asarray(dataset["time"].values, dtype=float)
    done = np.asarray(dataset["cycles"].values, dtype=float) if "cycles" in dataset else None
    found: list[SolvedCycle] = []
    begin = 0.0
    for step in _steps(dataset):
        ramps, repeat = len(step.get("cycle", [step])), int(step.get("repeat", 1))
        inside = np.flatnonzero((time > begin + SAME) & (time < begin + ramps * repeat + SAME))
        if "cycle" in step:
            number = np.ceil((time[inside] - begin) / ramps - SAME)
            for one in np.unique(number):
                own = inside[number == one]
                number_done = len(found) + 1.0 if done is None else float(done[own[-1]])
                found.append(SolvedCycle(int(own[0]), int(own[-1]), number_done))
        begin += ramps * repeat
    return found


def ends_of_cycles(dataset: Results) -> NDArray[np.intp]:
    """Positions along ``step`` of ends of solved cycles, and of all steps outside of cycles."""
    inside = {n for cycle in solved_cycles(dataset) for n in range(cycle.first, cycle.last)}
    return np.array([n for n in range(dataset.sizes["step"]) if n not in inside], dtype=np.intp)


def course(dataset: Results) -> tuple[NDArray[np.float64], str, str]:
    """What a history goes by, in each step: its values, what it is, and its unit.

    Cycles where there are some; else the path of sliding all over the contact; else the number of the step.
    """
    cycles = np.asarray(dataset["cycles"].values, dtype=float) if "cycles" in dataset else np.zeros(0)
    if cycles.max(initial=0.0) > 0:
        return cycles, "Cycles", "1"
    paths = [float(ramp.get("sliding-distance", 0.0)) for step in _steps(dataset) for ramp in step.get("cycle", [step])]
    if sum(paths) > 0:
        slid = np.concatenate([[0.0], np.cumsum(paths)])
        return np.interp(dataset["time"].values, np.arange(slid.size), slid), "Sliding distance", "m"
    return np.asarray(dataset["step"].values, dtype=float), "Step", "1"


def initial_separation(dataset: Results, step: int = -1) -> NDArray[np.float64]:
    """Separation (ny, nx) [m] of the unloaded and unworn surfaces, where the geometry is at a step.

    It follows from the gap ``g = h + w + u + r - approach - tilt_x y + tilt_y x`` of the first step, which meets a worn
    depth w only where it slides by a distance; of a geometry that travels from that of the step, worn on its way there.
    r is what eigenstrain displaces.
    """
    position = step % dataset.sizes["step"]
    moves = any(float(np.ptp(dataset[axis].values)) > 0 for axis in ("travel_x", "travel_y") if axis in dataset)
    first = _steps(dataset)[0]
    slides = "sliding-distance" in first.get("cycle", [first])[0]  # what slips wears after it is solved
    if not moves:
        position = 0
    met: Any = dataset["worn_depth"][position].values * (moves or slides) if "worn_depth" in dataset else 0.0
    wanted = ("gap", "approach", *_MOVED, "tilt_x", "tilt_y")
    one = {name: dataset[name][position] for name in wanted if name in dataset}
    tilt: Any = 0.0
    if "tilt_x" in one and "tilt_y" in one:
        tilt = float(one["tilt_x"]) * dataset["y"].values[:, None] - float(one["tilt_y"]) * dataset["x"].values
    moved = sum(one[name].values for name in _MOVED if name in one)
    found = one["gap"].values - met - moved + float(one["approach"]) + tilt
    return np.asarray(found, dtype=float)


def interfaces(dataset: Results, body: int) -> tuple[float, ...]:
    """Depths [m] below the first surface at which the layers of a body end; none where its medium is not installed."""
    from eigencontact.scene.components import build_component
    from eigencontact.scene.schema import Scene

    table: dict[str, Any] | None = scene_of(dataset).get(f"body{body}", {}).get("medium")
    if table is None:
        return ()
    try:
        known = Scene(**scene_of(dataset)).known_plugins()
        medium = build_component(known, "layered-medium", table, f"body{body}.medium")
    except EigencontactError:
        return ()
    return tuple(medium.interfaces)


def coatings(dataset: Results) -> tuple[Source, ...]:
    """Inclusions that reach the surface of their body; none where the scene cannot be built again."""
    return _coatings(dataset.attrs["scene"]) if scene_of(dataset).get("inclusions") else ()


@lru_cache(maxsize=1)
def _coatings(scene: str) -> tuple[Source, ...]:
    from eigencontact.model.model import build_model
    from eigencontact.scene.schema import Scene

    try:
        stored = Scene(**tomllib.loads(scene))
        sources = build_model(stored, stored.known_plugins()).sources
    except EigencontactError:
        return ()
    return tuple(one for one in sources if not one.guessed and one.shape.bounds[0][2] <= 0.0)


def scene_of(dataset: Results) -> dict[str, Any]:
    """Tables of the scene of a run."""
    return _tables(dataset.attrs["scene"])


@lru_cache(maxsize=4)
def _tables(scene: str) -> dict[str, Any]:
    return tomllib.loads(scene)


def _steps(dataset: Results) -> list[dict[str, Any]]:
    return list(scene_of(dataset).get("steps", [{}]))
