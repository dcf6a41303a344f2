"""Rates of wear by place: linear laws as they are, others by their derivative, cells out of contact by the nearest."""

from dataclasses import replace

import numpy as np
import pytest

from close import close
from eigencontact import app
from eigencontact.execution.wear import rate as module
from eigencontact.execution.wear.jumps import Jumps
from eigencontact.execution.wear.rate import energy_of, rate_of
from eigencontact.plugin import WearLaw, WearState

PRESSURE = np.array([[0.0, 0.0, 1e8, 4e8, 9e8]])
NONE = np.zeros_like(PRESSURE)
STATE = WearState(
    pressure=PRESSURE, shear=0.3 * PRESSURE, slip=np.full_like(PRESSURE, 1e-5), slip_amplitude=NONE,
    energy=3e-6 * PRESSURE, worn_depth=NONE, total_energy=NONE, material=NONE.astype(int),
    x=np.arange(5.0)[None], y=np.zeros((1, 1)), time=1.0,
)  # fmt: skip


class Archard(WearLaw):
    key, linear_in_pressure = "proportion", True

    def depth(self, state):
        return 1e-13 * state.pressure * state.slip


class Power(WearLaw):
    key = "power"

    def __init__(self, exponent):
        self.exponent = exponent

    def depth(self, state):
        return 1e-9 * (state.pressure / 1e8) ** self.exponent


class Offset(WearLaw):
    key = "offset"

    def depth(self, state):
        return 1e-18 * state.pressure + 2e-9


def test_a_proportion_wears_by_pressure_alone():
    """Cells that do not touch take the rate of the nearest in contact."""
    rate = rate_of(Archard(), STATE)
    np.testing.assert_allclose(rate.pressed, np.full_like(PRESSURE, 1e-18), rtol=1e-14)
    assert not rate.steady.any()
    assert rate.nonzero
    np.testing.assert_allclose(rate.depth(2 * PRESSURE), 2e-18 * PRESSURE, rtol=1e-14)


def test_what_wears_at_the_end_of_no_pressure_is_steady():
    """A cell that slid under pressure and has left contact since."""

    class Left(Archard):
        def depth(self, state):
            return 1e-9 * np.ones_like(state.pressure)

    rate = rate_of(Left(), STATE)
    np.testing.assert_allclose(rate.depth(PRESSURE), 1e-9, rtol=1e-14)
    np.testing.assert_array_equal(rate.steady, [[1e-9, 1e-9, 0, 0, 0]])


@pytest.mark.parametrize("exponent", [0.5, 1.0])
def test_the_derivative_of_a_law_that_grows_slower(exponent):
    """Of a power n the derivative is n depth / pressure, and the rest whatever the pressure."""
    law, loaded = Power(exponent), PRESSURE > 0
    rate, depth = rate_of(law, STATE), law.depth(STATE)
    np.testing.assert_allclose((rate.pressed * PRESSURE)[loaded], exponent * depth[loaded], rtol=1e-4)
    np.testing.assert_allclose(rate.depth(PRESSURE)[loaded], depth[loaded], rtol=1e-14)


def test_a_law_that_grows_faster_is_a_proportion():
    """Otherwise a lower pressure would make the surface grow."""
    law, loaded = Power(3.0), PRESSURE > 0
    rate = rate_of(law, STATE)
    np.testing.assert_allclose((rate.pressed * PRESSURE)[loaded], law.depth(STATE)[loaded], rtol=1e-14)
    assert rate.steady[loaded] == close(0.0, abs=1e-24)


def test_an_offset_is_steady():
    rate = rate_of(Offset(), STATE)
    np.testing.assert_allclose(rate.pressed, 1e-18, rtol=1e-6)
    np.testing.assert_allclose(rate.steady, 2e-9, rtol=1e-6)


def test_without_contact_nothing_wears():
    away = replace(STATE, pressure=NONE, shear=NONE, energy=NONE)
    assert not rate_of(Archard(), away).nonzero


def test_energy_goes_with_the_depth():
    """By the ratio of the solved cycle, that of the nearest worn cell elsewhere; by the cycles where nothing wore."""
    depth, energy = np.array([[0.0, 0.0, 2e-9, 1e-9]]), np.array([[5.0, 0.0, 8.0, 3.0]])
    added = np.array([[0.0, 1e-9, 4e-9, 2e-9]])
    np.testing.assert_allclose(energy_of(added, depth, energy, 7.0), [[35.0, 4.0, 16.0, 6.0]], rtol=1e-14)


@pytest.mark.parametrize("axis", [0, 1])
def test_cells_between_two_nearest_take_the_mean_of_both(axis):
    """A symmetric contact wears symmetrically: no side is preferred at equal distances."""
    pressure = np.outer([2e8, 2e8, 0.0, 1e8, 1e8], np.ones(6))
    if axis:
        pressure = pressure.T
    rate = rate_of(Power(2.0), replace(STATE, pressure=pressure, worn_depth=0 * pressure)).pressed
    below, between, above = (rate.T if axis else rate)[1:4, 3]
    assert between == close(0.5 * (below + above))
    assert below == close(2.0 * above, 1e-3)


def test_a_mirrored_contact_has_the_mirrored_rates():
    random = np.random.default_rng(4)
    half = np.maximum(random.normal(size=(12, 7)) * 1e8, 0.0)
    pressure = np.hstack([half, half[:, ::-1]])
    rate = rate_of(Power(2.0), replace(STATE, pressure=pressure, worn_depth=0 * pressure)).pressed
    np.testing.assert_array_equal(rate, rate[:, ::-1])


def test_one_search_alone_prefers_a_side(monkeypatch):
    monkeypatch.setattr(module, "_MIRRORS", 4 * module._MIRRORS[:1])
    with pytest.raises(AssertionError):
        test_a_mirrored_contact_has_the_mirrored_rates()
    with pytest.raises(AssertionError):
        test_cells_between_two_nearest_take_the_mean_of_both(0)


@pytest.mark.parametrize(("increments", "lowest", "highest"), [(1, 1.0 - 1e-9, 1.0 + 1e-9), (2, 0.7, 1.1)])
def test_a_cell_that_begins_to_touch_within_a_cycle_has_the_rate_of_whole_cycles(
    increments, lowest, highest, monkeypatch
):
    """Steady sliding: the rate of a cycle is that of Archard's law in every cell in contact, so that no cell stands out
    after the cycles that follow from it. The pressure falls within a cycle, so that two increments differ.
    """
    decide, ratios = Jumps.decide, []

    def recorded(self, state, cycle, rate, energy, pressure, peak, **where):
        ratios.append(rate.pressed[pressure > 0] / (1e-15 * 1e-4))
        decide(self, state, cycle, rate, energy, pressure, peak, **where)

    monkeypatch.setattr(Jumps, "decide", recorded)
    cycle = f"{{normal-load = '0.5 N', sliding-distance = '0.1 mm', increments = {increments}}}"
    steps = f"steps=[{{normal-load = '0.5 N'}}, {{cycle = {cycle}, repeat = 60}}]"
    cells = ["grid.cells=40", "grid.size=64e-6", "output.pictures=false", "output.animation=false"]
    data = app.run(app.load_scene("worn-rough-surface", [steps, *cells])).dataset
    assert np.count_nonzero(np.diff(data.contact_area.values) > 0) > 5
    assert min(ratio.min() for ratio in ratios) > lowest
    assert max(ratio.max() for ratio in ratios) < highest
    assert np.all(np.diff(data.max_pressure.values) < 0)
