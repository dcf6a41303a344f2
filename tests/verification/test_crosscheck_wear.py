"""Cross-check of wear: what is judged is right on coarse cells, and planted faults are found."""

from dataclasses import replace

import numpy as np
import pytest

from eigencontact.execution.wear.surface import WornSurface
from eigencontact_plugins.wear.archard import Archard
from eigencontact_plugins.wear.dissipated_energy import DissipatedEnergy
from eigencontact_verification.crosscheck import cases
from eigencontact_verification.crosscheck.judge import judge
from eigencontact_verification.crosscheck.run import Solved, tasks_of
from eigencontact_verification.crosscheck.worker import perform
from eigencontact_verification.fem.uncertainty import estimate

CASES = {case.name: case for case in cases.cases_of("wear")}


def verdicts(name):
    """Verdicts by profile, from cells of a twelfth of a radius."""
    case = replace(CASES[name], cells=12, coarser=(8, 9))
    outcomes = tuple((task, perform(task)) for task in tasks_of(case))
    assert not any(outcome.reason for _, outcome in outcomes)
    return {row.profile: row.word for row in judge(Solved(case=case, outcomes=outcomes)).rows}


@pytest.mark.parametrize(
    "name", [name if CASES[name].quick else pytest.param(name, marks=pytest.mark.slow) for name in CASES]
)
def test_rings_know_their_value_to_two_per_cent(name):
    case = CASES[name]
    levels = [case.reference(level, "fixed") for level in (0, 1, 2)]
    for profile in case.profiles:
        found = estimate(*(fields[profile.name] for fields in levels), ratio=2.0, formal_order=2.0)
        assert found.uncertainty.max() < 0.02 * np.abs(levels[2][profile.name]).max()


@pytest.mark.slow
@pytest.mark.parametrize("name", ["sliding", "fretting"])
def test_sound_code_does_not_disagree(name):
    assert "disagrees" not in verdicts(name).values()


def too_deep(law):
    depth = law.depth
    return lambda self, state: 1.2 * depth(self, state)


@pytest.mark.slow
@pytest.mark.parametrize(("name", "law"), [("sliding", Archard), ("fretting", DissipatedEnergy)])
def test_a_law_that_wears_too_much_disagrees(monkeypatch, name, law):
    monkeypatch.setattr(law, "depth", too_deep(law))
    assert verdicts(name)["depth"] == "disagrees"


@pytest.mark.slow
@pytest.mark.parametrize("name", ["sliding", "fretting"])
def test_worn_surfaces_that_touch_as_new_disagree(monkeypatch, name):
    """The depth is kept, and the gap forgets it."""
    begin = WornSurface.begin

    def forgetful(self, step):
        return replace(begin(self, step), separation=step.surface.separation)

    monkeypatch.setattr(WornSurface, "begin", forgetful)
    assert "disagrees" in verdicts(name).values()
