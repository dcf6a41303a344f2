"""Audit of line contacts with layers, inclusions and eigenstrain: verdicts, convergence of cells, planted faults."""

from __future__ import annotations

from dataclasses import replace

import pytest

import eigencontact as ec
from eigencontact_verification.audit import contact_cases_of
from eigencontact_verification.crosscheck.judge import judge
from eigencontact_verification.crosscheck.run import Solved, tasks_of
from eigencontact_verification.crosscheck.worker import Outcome


def case_of(folder, scene):
    ec.run(scene, folder).dataset.close()
    (case,), gaps = contact_cases_of(folder)
    assert not gaps
    return case


def rows_of(case):
    """Verdicts of the quick audit, by profile and component."""
    outcomes = []
    for task in tasks_of(case):
        fields = case.judged() if task.level is None else case.reference(task.level, task.outer)
        outcomes.append((task, Outcome(status="done", fields=fields)))
    return {(row.profile, row.component): row for row in judge(Solved(case=case, outcomes=tuple(outcomes))).rows}


def largest(rows, kind):
    """Largest difference of a kind of profile by the largest value of its field."""
    return max(row.difference for (name, _), row in rows.items() if name.startswith(kind))


def with_region(case, number, **changes):
    """The case with the elements of a faulty scene: numbers of a region of the first body by which they differ."""
    body, *others = case.parameters["bodies"]
    regions = list(body["regions"])
    regions[number] = regions[number] | changes
    return replace(case, parameters=case.parameters | {"bodies": [body | {"regions": regions}, *others]})


@pytest.mark.slow
def test_coated_cylinder(tmp_path):
    """The bundled scene agrees; a coating of another modulus or thickness by a tenth is caught."""
    case = case_of(tmp_path / "run", ec.load_scene("coated-cylinder", ["output.pictures=false"]))
    rows = rows_of(case)
    assert {row.word for row in rows.values()} == {"agrees"}
    for kind, bound in (("half width", 1e-3), ("pressure", 2e-3), ("stress", 1e-3)):
        assert largest(rows, kind) < bound
    for fault in ({"young_modulus": 440e9}, {"bottom": 55e-6}):
        wrong = rows_of(with_region(case, 0, **fault))
        assert wrong["pressure, step 1", "s_zz"].word == "disagrees"
        assert sum(row.word == "disagrees" for (name, _), row in wrong.items() if name.startswith("stress")) >= 2
