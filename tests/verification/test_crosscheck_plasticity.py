"""Cross-check of bodies that yield: what is judged is right on coarse meshes, and planted faults are found.

The reference is solved once for the sound code. Each fault then changes the law of the plugins or the framework around
it; what is judged runs a scene as always.
"""

from dataclasses import replace

import numpy as np
import pytest

import eigencontact as ec
from bodies import STEEL
from close import close
from eigencontact.errors import SceneError
from eigencontact.execution.interiors.cells import Cells
from eigencontact.results.store import ResultStore
from eigencontact.scene.installed import installed_plugins
from eigencontact_plugins.laws import j2
from eigencontact_verification.crosscheck import cases
from eigencontact_verification.crosscheck.judge import judge
from eigencontact_verification.crosscheck.plasticity import plastic_case
from eigencontact_verification.crosscheck.run import Solved, tasks_of
from eigencontact_verification.crosscheck.worker import perform
from eigencontact_verification.fem.yielding_law import tabulated
from planted import failing_checks

CASES = {case.name: case for case in cases.cases_of("plasticity")}


def coarser(case, **changes):
    """The same case on elements of a quarter of a contact radius and cells of a sixth, without the small parts."""
    kept = tuple(profile for profile in case.profiles if profile.quantity != "strain")
    parameters = {**case.parameters, "fine": 1.0, "divisions": [1, 2, 4]}
    return replace(case, profiles=kept, parameters=parameters, cells=6, coarser=(4,), **changes)


def solved(case):
    outcomes = tuple((task, perform(task)) for task in tasks_of(case))
    assert not any(outcome.reason for _, outcome in outcomes)
    return Solved(case=case, outcomes=outcomes)


def judged_again(found):
    """Verdicts on the code as it is now, with the finite elements that are there."""
    outcomes = tuple(
        (task, perform(task)) if task.level is None else (task, outcome) for task, outcome in found.outcomes
    )
    return judge(replace(found, outcomes=outcomes))


def disagreeing(found):
    return {row.profile for row in judged_again(found).rows if row.word == "disagrees"}


# --- what the list says --------------------------------------------------------------------------------------------


def test_every_bundled_hardening_is_judged():
    """And both ways to ask for yield with damage, a layer, what is below it, inclusions, prior stress, cycles."""
    tables = [case.parameters["law"] for case in CASES.values() if case.parameters["law"]]
    used = {one["type"] for table in tables for one in table["hardening"]}
    assert used == {entry.key for entry in installed_plugins().of_kind("hardening-law")}
    assert {table.get("yield_on", "nominal") for table in tables if "damage" in table} == {"nominal", "effective"}
    kinds = {region["kind"] for case in CASES.values() for region in case.parameters["regions"]}
    assert kinds == {"layer", "ball", "disc"}
    assert sum(case.parameters["path"].count(1.0) > 1 for case in CASES.values()) >= 2


def test_units_are_those_of_hertz():
    problem = CASES["perfect"].problem
    assert problem.contact_radius == close(6.0533e-6, rel=1e-4)
    assert problem.pressure == close(8469.6e6, rel=1e-4)
    assert problem.depth == close(348.98e-9, rel=1e-4)
    assert problem.peak == 2


@pytest.mark.parametrize("p", [0.0, 0.002, 0.005, 0.01, 0.02, 0.5])
def test_the_table_of_the_elements_is_linear_between_its_points(p):
    strain, stress = [0.0, 0.005, 0.02], [2.5e9, 2.9e9, 3.2e9]
    value, slope = tabulated(strain, stress)(np.array([p]))
    assert value[0] == close(np.interp(p, strain, stress))
    assert slope[0] == close(8e10 if p < 0.005 else 2e10 if p < 0.02 else 0.0)


def test_elements_that_never_yield_are_in_the_units_of_hertz():
    """Depth 1 and pressure 1 in the middle, nothing that stays; order 3/2 in the size of the elements."""
    case = coarser(plastic_case("elastic", "never yields", [{"type": "perfect", "yield_stress": 1e12}]))
    found = case.reference(1, "fixed")
    assert found["depth"][2, 0] == close(1.0, rel=2e-2)
    assert found["pressure"][0, 0] == close(-1.0, rel=2e-2)
    assert np.abs(found["print"]).max() < 1e-6


# --- faults --------------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def sound():
    """Solutions of a case, each found once."""
    found = {}

    def of(name):
        if name not in found:
            found[name] = solved(coarser(CASES[name]))
        return found[name]

    return of


@pytest.mark.slow
@pytest.mark.parametrize("name", ["perfect", "prager", "damage", "damage-effective"])
def test_sound_code_does_not_disagree(sound, name):
    assert disagreeing(sound(name)) == set()


def after(changed):
    """Fault in what a point remembers: `changed(state, before, flow)` with the plastic strain of the step."""
    sound_after = j2.J2._end_state

    def faulty(self, drive, now, before):
        stress, state = sound_after(self, drive, now, before)
        return stress, state | changed(state, before, state["plastic_strain"] - before["plastic_strain"])

    return faulty


def back_stress_of_the_wrong_sign(state, before, flow):
    return {name: 2 * before[name] - state[name] for name in state if name.startswith("back_stress")}


def hardening_forgotten_on_reversal(state, before, flow):
    """What flows against the plastic strain that is there begins as a new material."""
    back = np.sum(flow * before["plastic_strain"], axis=0) < 0
    return {
        name: np.where(back, state[name] - before[name], state[name])
        for name in state
        if name.startswith("back_stress")
    }


def deviator_that_is_not_traceless(state, before, flow):
    swelling = 0.3 * np.linalg.norm(flow, axis=0)
    return {"plastic_strain": state["plastic_strain"] + swelling * np.array([[1], [1], [1], [0], [0], [0]])}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "fault"),
    [
        ("prager", back_stress_of_the_wrong_sign),
        ("chaboche", hardening_forgotten_on_reversal),
        ("perfect", deviator_that_is_not_traceless),
    ],
)
def test_a_law_that_remembers_wrongly_disagrees(sound, monkeypatch, name, fault):
    monkeypatch.setattr(j2.J2, "_end_state", after(fault))
    assert disagreeing(sound(name)) >= {"print"}


def test_an_elastic_deviator_that_is_not_traceless_is_refused(monkeypatch):
    """The law does not begin with the constants of its body."""
    sound_drive = j2.J2._drive

    def fault(self, strain, *given):
        drive = sound_drive(self, strain, *given)
        drive.tau[:3] += 0.1 * drive.tau[0]
        return drive

    monkeypatch.setattr(j2.J2, "_drive", fault)
    with pytest.raises(SceneError, match="a law with the elastic constants of body 1"):
        ec.plan(CASES["perfect"].problem.scene(4))


@pytest.mark.slow
@pytest.mark.parametrize("name", ["damage", "damage-effective"])
def test_nominal_and_effective_stress_exchanged_disagree(sound, monkeypatch, name):
    """A law that reads the one as the other."""
    table = CASES[name].parameters["law"]
    other = {"nominal": "effective", "effective": "nominal"}[table.get("yield_on", "nominal")]
    sound_law = j2.J2.of_body
    monkeypatch.setattr(j2.J2, "of_body", lambda self, E, nu: replace(sound_law(self, E, nu), yield_on=other))
    assert disagreeing(sound(name))


@pytest.mark.slow
def test_a_residual_displacement_that_is_dropped_disagrees(sound, monkeypatch):
    whole = Cells.mean_displacement
    monkeypatch.setattr(Cells, "mean_displacement", lambda self, eigenstrain: 0.0 * whole(self, eigenstrain))
    assert disagreeing(sound("perfect")) >= {"depth", "print"}


@pytest.mark.slow
@pytest.mark.parametrize("forgets", [False, True])
def test_a_history_that_is_not_restored_on_resume_disagrees(sound, monkeypatch, forgets):
    """The run is interrupted after the first unloading; nothing disagrees where it is resumed with its history."""
    load = ResultStore.load_step
    if forgets:
        monkeypatch.setattr(ResultStore, "load_step", lambda self, index: replace(load(self, index), history={}))
    found = sound("prager")
    resumed = replace(found.case, stop=3)
    outcomes = tuple((replace(task, case=resumed), outcome) for task, outcome in found.outcomes)
    assert bool(disagreeing(replace(found, case=resumed, outcomes=outcomes))) == forgets


def test_a_tangent_that_is_wrong_by_a_factor_is_found_by_the_kit(monkeypatch):
    """No comparison sees it: cells take another way to the same answer, and others take longer."""
    tangent = j2.J2._tangent
    law = ec.make("j2", hardening=[{"type": "linear", "yield_stress": 3e9, "modulus": 2e10}], **STEEL)
    assert "check_tangent" not in failing_checks(law)
    monkeypatch.setattr(j2.J2, "_tangent", lambda self, *given: 1.1 * tangent(self, *given))
    assert "check_tangent" in failing_checks(law)
