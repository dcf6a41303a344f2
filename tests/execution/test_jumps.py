"""Sizes of jumps over cycles, and the stated error, of rates that are given: no contact is solved."""

import numpy as np
import pytest

from close import close
from eigencontact.core.grid import Grid
from eigencontact.execution.blocks.step import CyclePlace
from eigencontact.execution.wear.jumps import Jumps
from eigencontact.execution.wear.rate import Rate
from eigencontact.execution.wear.state import WornState
from eigencontact.scene.wear import Wear

GRID = Grid(nx=2, ny=2, dx=1e-6, dy=1e-6)
PRESSURE = np.full(GRID.shape, 1e9)
#: Depth of a cycle [m] at first.
DEPTH = 1e-9
CYCLES = 400


def worn(depth_at, *, in_its_end=False, **table):
    """Cycles that are solved where a cycle wears a given depth, the jump after each, and the state in the end."""
    chooser = Jumps(Wear(type="archard", **table), GRID, softness=1e-15)
    state = WornState(depth={1: np.zeros(GRID.shape)}, energy=np.zeros(GRID.shape))
    number, solved, jumps = 1, [], []
    while number <= CYCLES:
        depth = np.full(GRID.shape, depth_at(number))
        rate = Rate(pressed=depth / PRESSURE, steady=np.zeros(GRID.shape))
        place = CyclePlace(number=number, skipped=0, repeats_after=CYCLES - number, begins=True, ends=True)
        chooser.decide(state, place, rate, depth, PRESSURE, 1e9, in_its_end=in_its_end)
        solved.append(number)
        jumps.append(state.jump)
        state.wear(depth * state.jump, {1: 1.0})
        state.cycles += state.jump
        number += state.jump
    return np.array(solved), np.array(jumps), state


def test_each_solved_cycle_decides_the_next_jump_anew():
    """The rate is steady, and changes from cycle 200 on: jumps grow, and shrink."""
    solved, jumps, state = worn(lambda n: DEPTH * (1.0 if n < 200 else 0.5 - 0.2 * np.exp((200 - n) / 20)))
    before, after = solved < 200, solved >= 200
    assert jumps[:2].tolist() == [1, 1]
    assert jumps[before].max() > 20
    assert jumps[after][0] < 0.5 * jumps[before][-1]
    assert jumps[after][-2] < jumps[after][0]
    assert state.error > 0.0


@pytest.mark.parametrize("error", [1e-1, 1e-3])
def test_jumps_follow_the_error_that_is_asked_for(error):
    solved, _, state = worn(lambda n: DEPTH * (1.0 + np.exp(-n / 50)), jump_error=error)
    volume = float(state.total.sum()) * GRID.cell_area
    assert state.error < 2.0 * error * volume
    assert len(solved) == {1e-1: 13, 1e-3: 49}[error]


@pytest.mark.parametrize("cycles", [1, 5])
def test_the_error_of_one_update_a_cycle_is_that_of_explicit_steps(cycles):
    """Of V' = f(V), in steps of a cycle: -f ln(f/f_0)/2, told with its sign."""
    state = worn(lambda n: DEPTH * (1.0 + n / CYCLES), in_its_end=True, cycles_per_update=cycles)[2]
    each = DEPTH * PRESSURE.size * GRID.cell_area
    assert state.lag == close(-0.5 * 2.0 * each * np.log(2.0), rel=0.02)
    assert worn(lambda _: DEPTH, in_its_end=True)[2].lag == close(0.0, abs=1e-12 * each)
    assert worn(lambda n: DEPTH * (1.0 + n / CYCLES))[2].lag == 0.0


def test_the_error_of_one_update_a_cycle_fades_where_wear_comes_to_rest():
    fading, steady = (
        worn(lambda n, s=scale: DEPTH * np.exp(-n / s), in_its_end=True, cycles_per_update=1)[2].lag
        for scale in (20.0, 2000.0)
    )
    assert 0.0 < fading < 1e-6 * steady
