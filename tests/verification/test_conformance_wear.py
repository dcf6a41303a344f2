"""The kit of wear laws can fail: each planted fault is caught by the check that is meant for it."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import pytest

from eigencontact.plugin import WearLaw, require
from eigencontact_verification.conformance import ConformanceError, checks_for


@dataclass(frozen=True, kw_only=True)
class Sound(WearLaw):
    """A correct law, to spoil."""

    key: ClassVar[str] = "sound"
    references: ClassVar[tuple[str, ...]] = ("elementary",)

    coefficient: float = 1e-12

    def __post_init__(self):
        rule = "zero or positive, and finite"
        require(0 <= self.coefficient < np.inf, self.key, "coefficient", self.coefficient, rule)

    def depth(self, state):
        return self.coefficient * state.pressure * state.slip


class OneNumber(Sound):
    def depth(self, state):
        return float(super().depth(state).sum())


class NotFinite(Sound):
    def depth(self, state):
        return np.where(state.pressure > 1e9, np.inf, super().depth(state))


class Grows(Sound):
    def depth(self, state):
        return -super().depth(state)


class WritesOnTheState(Sound):
    def depth(self, state):
        state.slip[...] *= 0.5
        return super().depth(state)


class Remembers(Sound):
    def depth(self, state):
        count = self.__dict__.setdefault("asked", [])
        count.append(1)
        return super().depth(state) * len(count)


class WearsByRest(Sound):
    def depth(self, state):
        return super().depth(state) + 1e-20 * state.pressure


class ClaimsProportion(Sound):
    linear_in_pressure = True

    def depth(self, state):
        return super().depth(state) * np.sqrt(state.pressure)


class ClaimsEnergy(Sound):
    needs_friction = True
    volume_per_energy = 1e-12

    def depth(self, state):
        return 1.001 * self.coefficient * state.energy


class HidesFriction(Sound):
    def depth(self, state):
        return self.coefficient * state.energy


class HidesCycles(Sound):
    def depth(self, state):
        return 1e6 * self.coefficient * state.pressure * state.slip_amplitude * state.slip


class ClaimsFriction(Sound):
    needs_friction = True


class ClaimsCycles(Sound):
    needs_cycles = True


class CountsIncrements(Sound):
    """The local reading of a law of amplitude: its sum depends on the number of increments."""

    def depth(self, state):
        return 1e6 * super().depth(state) * state.slip


class CountsCells(Sound):
    def depth(self, state):
        return super().depth(state) * (1.0 + np.arange(state.slip.size).reshape(state.slip.shape))


FAULTS = {
    OneNumber: {"check_worn_depth"},
    NotFinite: {"check_worn_depth", "check_no_slip_no_wear"},
    Grows: {"check_worn_depth"},
    WritesOnTheState: {"check_worn_depth_pure"},
    Remembers: {"check_worn_depth_pure"},
    WearsByRest: {"check_no_slip_no_wear"},
    ClaimsProportion: {"check_pressed_in_proportion"},
    ClaimsEnergy: {"check_volume_by_energy"},
    HidesFriction: {"check_says_what_it_needs"},
    HidesCycles: {"check_says_what_it_needs"},
    ClaimsFriction: {"check_says_what_it_needs"},
    ClaimsCycles: {"check_says_what_it_needs"},
    CountsIncrements: {"check_cut_increments"},
    CountsCells: {"check_reversed_cells"},
}


def noticing(law):
    noticed = {}
    for check in checks_for(law):
        try:
            check(law)
        except ConformanceError as problem:
            noticed[check.__name__] = str(problem)
    del noticed["check_registered"]
    return noticed


def test_a_sound_law_passes():
    assert noticing(Sound()) == {}
    assert noticing(Sound(coefficient=0.0)) == {}


@pytest.mark.parametrize("fault", FAULTS, ids=lambda fault: fault.__name__)
def test_a_fault_is_noticed(fault):
    noticed = noticing(fault())
    for name in FAULTS[fault]:
        assert noticed[name].startswith(f"{name} of wear-law 'sound': ")
        assert " must " in noticed[name]


def test_every_check_of_wear_has_a_fault():
    own = {check.__name__ for check in checks_for(Sound()) if check.__module__.endswith(".wear")}
    assert set().union(*FAULTS.values()) == own
