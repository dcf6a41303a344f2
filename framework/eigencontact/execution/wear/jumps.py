"""Number of cycles that a solved cycle represents, from the allowed error of the worn volume.

The wear rate of a cycle is extrapolated linearly from the last two solved cycles. The difference between the next
solved cycle and the extrapolation is the error of the jump. It grows with the square of the jump size, relative to the
wear of the jump.
"""

from __future__ import annotations

import numpy as np

from eigencontact.core.array_types import FloatArray
from eigencontact.core.grid import Grid
from eigencontact.execution.blocks.step import CyclePlace
from eigencontact.execution.wear.rate import Rate
from eigencontact.execution.wear.state import WornState, updated
from eigencontact.scene.wear import Wear

__all__ = ["MOST", "Jumps", "against_deflection", "ahead"]


#: Largest wear of one update, in deflections of a loaded cell: the worn shape has converged long before.
MOST = 1e7
#: Largest and smallest ratio of successive jumps, and safety factor on the size allowed by the error.
_GROWTH, _FALL, _SAFETY = 2.5, 0.3, 0.95
#: Fraction of the mean wear rate so far to which the error is relative, if the last cycles wear little.
_OF_ALL = 0.5
#: Number of first cycles that are not representative of later ones.
_RUN_IN = 1
#: Fraction of the stable explicit step (0.9 dx p / E*, or 0.8 times the deflection of a loaded cell).
_STABLE = 0.4


def ahead(memory: dict[str, FloatArray], cycles: float) -> Rate:
    """Rate at a number of cycles after the last solved one, limited to between zero and twice the last rate."""
    rate = memory["rate"]
    return Rate(pressed=np.clip(rate + cycles * memory["slope"], 0.0, 2.0 * rate), steady=memory["steady"])


def against_deflection(rate: Rate, pressure: FloatArray, softness: float) -> float:
    """Largest worn depth of a cycle relative to the displacement of a cell by the largest pressure."""
    most = float(pressure.max()) * softness
    return float(rate.depth(pressure).max()) / most if most > 0 else 0.0


class Jumps:
    """Size of jumps over cycles.

    Parameters
    ----------
    table : Wear
        Wear table with the allowed error, or with the size of jumps.
    grid : Grid
    softness : callable
        Deflection of a cell by a unit pressure on it [m/Pa].
    """

    def __init__(self, table: Wear, grid: Grid, softness: float) -> None:
        self._table, self._area, self._softness = table, grid.cell_area, softness

    def decide(
        self,
        state: WornState,
        cycle: CyclePlace,
        rate: Rate,
        energy: FloatArray,
        pressure: FloatArray,
        peak: float,
        *,
        in_its_end: bool,
    ) -> None:
        """Set the next jump and its data from a solved cycle: rate, energy, final pressure, peak pressure.

        `in_its_end` states that the surfaces move only at the end of the cycle.
        """
        memory, last = state.memory, state.jump
        previous, slope, jump = memory.get("rate"), np.zeros_like(pressure), 1.0
        if previous is not None:
            slope = (rate.pressed - previous) / last
            expected = ahead(memory, last)
            mismatch = np.abs(rate.pressed - expected.pressed) * pressure + np.abs(rate.steady - expected.steady)
            missing = float(mismatch.sum()) * self._area
            # In a solved cycle the surfaces move at its end, unless they move with each increment.
            state.error += 0.5 * (last - (self._table.update == "increment")) * missing
            if in_its_end:
                change = last * float((slope * pressure).sum()) * self._area
                work, before = float(energy.sum()), float(memory["cycle_energy"].sum())
                fading = work / before if before > 0 else 1.0
                # The first change also represents the cycle before it, which starts without slip.
                state.lag = fading * state.lag - (0.5 if memory["slope"].any() else 1.0) * change
            jump = self._by_error(state, missing, float(rate.depth(pressure).sum()) * self._area)
            if _regime(rate.pressed, pressure) != _regime(previous, pressure):
                jump = 1.0
        if self._table.cycles_per_update is not None:
            jump = float(self._table.cycles_per_update)
        most = float(rate.steady.max())
        if most > 0:
            jump = min(jump, max(1.0, _STABLE * self._softness * peak / most))
        share = against_deflection(rate, pressure, self._softness)
        if share > 0:
            jump = min(jump, MOST / share)
        state.jump = max(1, min(int(jump), cycle.repeats_after))
        if state.cycles < _RUN_IN + 0.5:  # the first cycle starts without slip
            state.memory, state.jump = updated(memory), 1
            return
        state.memory = updated(memory) | {
            "rate": rate.pressed, "steady": rate.steady, "slope": slope, "cycle_energy": energy,
        }  # fmt: skip

    def _by_error(self, state: WornState, missing: float, worn: float) -> float:
        """Next jump from the error of the last jump per cycle, and the wear per cycle [m³]."""
        if self._table.error is None:
            return 1.0
        volume, last = float(state.total.sum()) * self._area, state.jump
        allowed = self._table.error * max(worn, _OF_ALL * volume / (state.cycles + last))
        share = 0.5 * missing / allowed if allowed > 0 else 0.0
        factor = float(np.clip(_SAFETY / np.sqrt(share), _FALL, _GROWTH)) if share > 0 else _GROWTH
        return max(last * factor, last + 1.0) if factor > 1.0 else last * factor


def _regime(rate: FloatArray, pressure: FloatArray) -> tuple[bool, bool]:
    """Whether some, and whether all, cells in contact wear."""
    inside = rate[pressure > 0] > 0
    return bool(inside.any()), bool(inside.all())
