"""Audit of whole line contacts: stored runs against finite elements with contact and friction of their own."""

from __future__ import annotations

import numpy as np
import pytest

import eigencontact as ec
from close import close
from eigencontact_verification.audit import contact_cases_of
from eigencontact_verification.crosscheck.case import own_error

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
    return {name: float(np.abs(judged[name] - value).max() / np.abs(value).max()) for name, value in reference.items()}


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
        bound = {"half width": 1e-3, "pressure": 0.006, "stress": 0.035, "shear": 0.02, "slip": 0.02}[line.kind]
        assert found[line.profile.name] < bound, line.profile.name
        own = case.judged()[own_error(line.profile.name)]
        assert np.all(own > 0)
    shear, stored = (fields["shear, step 2"] for fields in (reference, case.judged()))
    assert stored.mean() == close(shear.mean(), rel=0.01)


@pytest.mark.slow
def test_friction_that_was_another_is_caught(fretted, tmp_path):
    """The elements of the first scene, and a run with four fifths of its friction."""
    case, reference = fretted
    fault = case_of(tmp_path / "run", friction={"type": "coulomb", "coefficient": 0.8 * MU})
    before, after = differences(case, reference), differences(fault, reference)
    assert after["slip, step 2"] > 3 * before["slip, step 2"]
    assert after["pressure, step 1"] == close(before["pressure, step 1"], rel=1e-3)


@pytest.mark.parametrize(
    ("tables", "reason"),
    [
        ({"friction": {"type": "shear-cap", "coefficient": MU, "cap": 1.0}}, "no friction"),
        ({"steps": [{"normal-load": P}, {"shift-x": 3.0}], "grid": SCENE["grid"] | {"datum-depth": 3.0}}, "slides"),
    ],
)
def test_what_is_not_covered_is_said(tables, reason, tmp_path):
    ec.run(SCENE | {"stress": []} | tables, tmp_path / "run").dataset.close()
    cases, (gap,) = contact_cases_of(tmp_path / "run")
    assert not cases
    assert reason in gap.reason
