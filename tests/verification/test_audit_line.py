"""Audit of whole line contacts: stored runs against finite elements with contact and friction of their own."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import eigencontact as ec
from close import close
from eigencontact.results.reader import open_results
from eigencontact_verification.audit import contact_cases_of
from eigencontact_verification.audit.line_cases import line_steps
from eigencontact_verification.audit.line_grids import values_at
from eigencontact_verification.audit.line_model import line_model
from eigencontact_verification.audit.line_profiles import line_profiles
from eigencontact_verification.audit.line_scene import read_line
from eigencontact_verification.audit.table import halved_in_words
from eigencontact_verification.crosscheck.case import HALVED, error_key
from eigencontact_verification.crosscheck.judge import JudgedCase
from eigencontact_verification.crosscheck.worker import Task, perform
from eigencontact_verification.fem import line_contact
from eigencontact_verification.fem.line_contact import LineStep, solve_line_contact
from verdicts import rows_of

NU, MU, P = 0.3, 0.5, np.pi / 4
BODY = {"young-modulus": 2 * (1 - NU**2), "poisson-ratio": NU}
SCENE = {
    "name": "line",
    "body1": BODY,
    "body2": BODY,
    "geometry": {"type": "cylinder", "radius": 1.0, "length": "infinite"},
    "friction": {"type": "coulomb", "coefficient": MU},
    "grid": {"length": "infinite", "cells": 96, "size": 3.0},
    "steps": [{"normal-load": P}, {"tangential-load-x": 0.5 * MU * P}, {"tangential-load-x": -0.5 * MU * P}],
    "stress": [{"shape": "plane", "name": "section", "normal": "y", "depth-max": 1.5, "depth-cells": 20}],
    "output": {"pictures": False},
}


def case_of(folder, **tables):
    ec.run(SCENE | tables, folder).dataset.close()
    (case,), gaps = contact_cases_of(folder)
    assert not gaps
    return case


def differences(case, reference):
    """Largest difference on each line by its largest value, both errors known."""
    judged = case.judged()
    values = {name: value for name, value in reference.items() if name != HALVED}
    return {name: float(np.abs(judged[name] - value).max() / np.abs(value).max()) for name, value in values.items()}


@pytest.fixture(scope="module")
def fretted(tmp_path_factory):
    case = case_of(tmp_path_factory.mktemp("line") / "run")
    return case, case.reference(1, "fixed")


def test_a_run_agrees_with_the_elements(fretted):
    """On the medium mesh of the quick audit: stress, pressure; slip with its sign, and the shear in the mean."""
    case, reference = fretted
    found = differences(case, reference)
    assert {line.kind for line in case.lines} == {"half width", "pressure", "shear", "slip", "stress"}
    for line in case.lines:
        bound = {"half width": 1e-3, "pressure": 0.006, "stress": 0.005, "shear": 0.02, "slip": 0.02}[line.kind]
        assert found[line.profile.name] < bound, line.profile.name
        own = case.judged()[error_key(line.profile.name)]
        assert np.all(own > 0)
    shear, stored = (fields["shear, step 2"] for fields in (reference, case.judged()))
    assert stored.mean() == close(shear.mean(), rel=0.01)


def test_halved_increments_are_in_the_report(fretted, monkeypatch):
    """The first increment of shear has no solution as a whole."""
    case, reference = fretted
    assert reference[HALVED] == [0]
    newton = line_contact._Solver.newton

    def failing(solver, before, step, *more):
        return None if step.shear - before.step.shear > 0.3 * MU * P else newton(solver, before, step, *more)

    monkeypatch.setattr(line_contact._Solver, "newton", failing)
    task = Task(case=case, level=0)
    outcome = perform(task)
    assert outcome.status == "done", outcome.reason
    judged = JudgedCase(case=case, rows=(), outcomes=((task, outcome),), judged={}, estimates={})
    (words,) = halved_in_words([judged])
    assert words.startswith("line: the elements halved 1 increment that had no solution as a whole; ")
    assert not halved_in_words([replace(judged, outcomes=((task, replace(outcome, fields=reference)),))])


@pytest.mark.slow
def test_friction_that_was_another_is_caught(fretted, tmp_path):
    """The elements of the first scene, and a run with four fifths of its friction."""
    case, reference = fretted
    fault = case_of(tmp_path / "run", friction={"type": "coulomb", "coefficient": 0.8 * MU})
    before, after = differences(case, reference), differences(fault, reference)
    assert after["slip, step 2"] > 3 * before["slip, step 2"]
    assert after["pressure, step 1"] == close(before["pressure, step 1"], rel=1e-3)


def crossland(stress, slope):
    """Crossland's parameter of paths (steps, 4, n) of xx, yy, zz, xz: the ball's centre walks to its farthest point.

    M. Badoiu and K. L. Clarkson 2003, Proc. 14th ACM-SIAM Symposium on Discrete Algorithms, 801.
    """
    mean = stress[:, :3].sum(axis=1) / 3
    path = stress * np.array([1, 1, 1, np.sqrt(2)])[:, None]
    path[:, :3] -= mean[:, None]
    centre = path[0].copy()
    for k in range(1, 2000):
        farthest = ((path - centre) ** 2).sum(axis=1).argmax(axis=0)
        centre += (path[farthest, :, np.arange(centre.shape[1])].T - centre) / (k + 1)
    return np.sqrt(((path - centre) ** 2).sum(axis=1).max(axis=0) / 2) + slope * mean.max(axis=0)


@pytest.mark.slow
def test_a_criterion_on_the_stress_of_the_elements(tmp_path):
    """`[[fatigue]]` of the run against the elements' own history; a component that is a step late is caught."""
    table = {"type": "crossland", "slope": 0.3, "limit-amplitude": 1.0, "cycle": "all", "region": "section"}
    steps = [*SCENE["steps"], {"normal-load": 0.5 * P, "tangential-load-x": 0.0}]
    case = case_of(tmp_path / "run", steps=steps, fatigue=[table])
    with open_results(tmp_path / "run") as data:
        x, z = np.meshgrid(data.section_x.values, data.section_z.values)
        damage = data.section_fatigue_crossland.values
    chosen = (np.abs(x) < 1.2) & (z > 0.25) & (z < 1.4)
    loads = [LineStep(normal=p, shear=q) for p, q, *_ in case.parameters["steps"]]
    solution = solve_line_contact(line_model(case.parameters, 4, "fixed"), loads)
    points = np.stack((x[chosen], z[chosen]), axis=1)
    stress = np.stack([solution.stress(points, k) for k in range(len(loads))])
    error = np.abs(crossland(stress, 0.3) - damage[chosen]).max() / damage[chosen].max()
    late = stress.copy()
    late[:, 2] = np.roll(stress[:, 2], 1, axis=0)
    fault = np.abs(crossland(late, 0.3) - damage[chosen]).max() / damage[chosen].max()
    assert error < 0.01
    assert fault > 0.2


def root_mean_squares(case, reference):
    """Of the difference on each line, by the largest value of the reference there."""
    judged = case.judged()
    return {
        name: float(np.sqrt(((judged[name] - value) ** 2).mean()) / np.abs(value).max())
        for name, value in reference.items()
        if name != HALVED
    }


def gallery_case(name, changes, folder):
    """Case of a bundled scene without pictures."""
    ec.run(ec.load_scene(name, [*changes, "output.pictures=false"]), folder).dataset.close()
    (case,), gaps = contact_cases_of(folder)
    assert not gaps
    return case


#: The bundled scene with fewer cells and increments, and one cycle.
FRETTED = [
    "grid.cells-per-contact-radius=12",
    "steps.0.increments=6",
    *(f"steps.1.cycle.{part}.increments={count}" for part, count in ((0, 2), (1, 4), (2, 2))),
    "steps.1.repeat=1",
    "steps.2.increments=2",
]


@pytest.mark.slow
def test_friction_with_plasticity_agrees_with_the_elements(tmp_path):
    """In the mean, on coarse cells; a yield stress that was another by a tenth is caught in the plastic strain."""
    case = gallery_case("cylinder-fretting-plastic", FRETTED, tmp_path / "run")
    reference = case.reference(1, "fixed")
    found = root_mean_squares(case, reference)
    bounds = {"half width": 0.03, "pressure": 0.005, "shear": 0.06, "stress": 0.04, "plastic strain": 0.04}
    for line in case.lines:  # the slip is that of one increment, and its edge is uncertain by half a cell
        assert found[line.profile.name] < bounds.get(line.kind, 0.2), line.profile.name
    lines = {line.profile.name: line.profile for line in case.lines}
    stronger = [*FRETTED, "body1.law.hardening.yield-stress=550 MPa"]
    fault = gallery_case("cylinder-fretting-plastic", stronger, tmp_path / "fault")
    for line in fault.lines:
        if line.kind == "plastic strain":
            name = line.profile.name
            wrong = np.interp(lines[name].along, line.profile.along, line.values[:, 0])
            error = float(np.sqrt(((wrong - reference[name][:, 0]) ** 2).mean()) / reference[name].max())
            assert error > 3 * found[name]


@pytest.mark.slow
def test_damage_agrees_with_the_elements(tmp_path):
    """Halved elements halve the difference and more; a run without damage is caught in the residual stress."""
    coarser = ["grid.cells-per-contact-radius=12", "numerics.inclusion-pitch=32 um"]
    case = gallery_case("cylinder-on-bone", coarser, tmp_path / "run")
    sound = gallery_case("cylinder-on-bone", [*coarser, "body1.law.damage.saturation=0"], tmp_path / "sound")
    coarse, fine = (case.reference(level, "fixed") for level in (0, 1))
    before, found = root_mean_squares(case, coarse), root_mean_squares(case, fine)
    assert found["pressure, step 13"] < 0.01
    middle, edge = "stress in the middle, step 19, section", "stress near the edge, step 19, section"
    assert found[middle] < 0.01
    assert found[middle] < before[middle] / 2
    assert found[edge] < 0.02
    strain = "plastic strain in the middle, step 19, body 1"
    assert found[strain] < 0.01
    common = len(sound.judged()[middle])  # without damage fewer layers of cells yield
    depths = [next(line.points[:common] for line in one.profiles if line.name == middle) for one in (case, sound)]
    np.testing.assert_allclose(depths[0], depths[1], rtol=0, atol=1e-12)
    assert root_mean_squares(sound, {middle: fine[middle][:common]})[middle] > 5 * found[middle]


#: A cylinder that rolls from one half width before the middle to one behind it, in steps of a third.
ROLLING = {
    "friction": None,
    "grid": {"length": "infinite", "cells": 128, "size": 4.5},
    "steps": [{"normal-load": P, "travel-x": -1.0}, {"normal-load": P, "travel-x": 1.0, "increments": 6}],
}


@pytest.fixture(scope="module")
def rolled(tmp_path_factory):
    return case_of(tmp_path_factory.mktemp("rolling") / "run", **ROLLING)


def moved(case, shift):
    """The case with the elements of a geometry that is elsewhere in every step."""
    steps = [[*loads, place + shift] for *loads, place in case.parameters["steps"]]
    return replace(case, parameters=case.parameters | {"steps": steps})


@pytest.mark.slow
def test_a_geometry_that_travels_is_judged(rolled):
    """Within half a per cent; the quick meshes leave the pressure at its edges uncertain by up to 4 %."""
    rows = rows_of(rolled)
    for (name, _), row in rows.items():
        assert row.word == "agrees" or (row.word == "inconclusive" and name.startswith("pressure")), name
    kinds = {line.kind for line in rolled.lines}
    assert kinds == {"half width", "pressure", "stress", "history of stress"}
    assert max(row.difference for row in rows.values()) < 5e-3


@pytest.mark.slow
def test_half_a_cell_of_travel_is_caught(rolled):
    """In the pressure of every compared step, and in the stress over the steps."""
    rows = rows_of(moved(rolled, 4.5 / 128 / 2))
    names = [name for name, _ in rows if name.startswith("pressure")]
    assert len(names) == 3
    for key in [*((name, "s_zz") for name in names), ("history of stress, section", "s_xz")]:
        assert rows[key].word == "disagrees", key


@pytest.mark.slow
def test_a_radius_of_travel_that_was_another_is_caught(rolled):
    """By 3 %, in half width and pressure."""
    profile = [{**rolled.parameters["profile"][0], "radius": 1.03}]
    rows = rows_of(replace(rolled, parameters=rolled.parameters | {"profile": profile}))
    assert rows["half width", "a"].word == "disagrees"
    assert rows["pressure, step 4", "s_zz"].word == "disagrees"


@pytest.mark.slow
def test_a_coarser_run_tells_the_error_of_cells_that_yield(tmp_path):
    """Of 12 cells per half width against 36, at nearly all points; second differences do not."""
    cells = "grid.cells-per-contact-radius", "numerics.inclusion-pitch"
    coarse, fine = ([f"{cells[0]}={n}", f"{cells[1]}={180 / n} um"] for n in (12, 36))
    case = gallery_case("plastic-line-contact", coarse, tmp_path / "run")
    ec.run(ec.load_scene("plastic-line-contact", [*fine, "output.pictures=false"]), tmp_path / "fine").dataset.close()
    rule = {line.profile.name: line.error for line in line_profiles(read_line(tmp_path / "run"))}
    better = values_at(read_line(tmp_path / "fine"), case.lines)
    within = {}
    for line in case.lines:
        if line.kind != "half width":
            error, name = np.abs(better[line.profile.name] - line.values), line.profile.name
            slack = 1e-6 * np.abs(line.values).max()
            within[name] = [float(np.nanmean(error <= own + slack)) for own in (line.error, rule[name])]
    assert min(found for found, _ in within.values()) > 0.95
    assert within["pressure, step 14"][1] < 0.5
    assert within["stress near the edge, step 14, section"][1] < 0.5


@pytest.mark.slow
def test_increments_of_a_body_that_yields_stay_whole(tmp_path, monkeypatch):
    """The first of unloading, too, in which the iteration fails at first: the elements take the steps of the run."""
    coarse = ["grid.cells-per-contact-radius=12", "numerics.inclusion-pitch=15 um"]
    case = gallery_case("plastic-line-contact", coarse, tmp_path / "run")
    honest, failures = line_contact._Solver.newton, []

    def watched(self, *args):
        solution = honest(self, *args)
        failures.append(solution is None)
        return solution

    monkeypatch.setattr(line_contact._Solver, "newton", watched)
    moments = solve_line_contact(line_model(case.parameters, 1, "fixed"), line_steps(case.parameters)).moments
    assert [moment.increments for moment in moments] == [1] * len(moments)
    assert any(failures)


NONLOCAL = {
    "type": "j2",
    "hardening": {"type": "perfect", "yield-stress": 10.0},
    "damage": {"type": "exponential", "saturation": 0.5, "strain": 0.02, "length": 0.3},
}
BRITTLE = {"type": "brittle", "damage": {"type": "mazars", "threshold": 1.0, "A": 0.9, "B": 2.0}}


@pytest.mark.parametrize(
    ("tables", "reason"),
    [
        ({"friction": {"type": "shear-cap", "coefficient": MU, "cap": 1.0}}, "no friction"),
        (
            {"friction": None, "steps": [{"normal-load": 0.1 * P}], "body1": BODY | {"law": NONLOCAL}},
            "averaged over a length",
        ),
        ({"friction": None, "steps": [{"normal-load": 0.1 * P}], "body1": BODY | {"law": BRITTLE}}, "no law 'brittle'"),
        pytest.param(
            {"steps": [{"normal-load": P}, {"shift-x": 3.0}], "grid": SCENE["grid"] | {"datum-depth": 3.0}},
            "gross slip", marks=pytest.mark.slow,
        ),
    ],
)  # fmt: skip
def test_what_is_not_covered_is_said(tables, reason, tmp_path):
    ec.run(SCENE | {"stress": []} | tables, tmp_path / "run").dataset.close()
    cases, (gap,) = contact_cases_of(tmp_path / "run")
    assert not cases
    assert reason in gap.reason
