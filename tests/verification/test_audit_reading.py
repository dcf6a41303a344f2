"""What an audit reads of a run: bodies, signs, lines, own error, checks; no finite elements."""

from __future__ import annotations

import numpy as np
import pytest

import eigencontact as ec
from eigencontact_verification.audit.bodies import bodies_of_step, tractions_on
from eigencontact_verification.audit.checks import checked
from eigencontact_verification.audit.homogeneous import homogeneous_stress
from eigencontact_verification.audit.lines import middle_of, stress_lines, surface_lines
from eigencontact_verification.audit.stored import read_step


@pytest.fixture(scope="module")
def sliding(tmp_path_factory):
    """Two different bodies under pressure and shear, with an inclusion in body 2."""
    folder = tmp_path_factory.mktemp("sliding")
    scene = ec.Scene(
        name="sliding",
        body1={"young_modulus": "210 GPa", "poisson_ratio": 0.3},
        body2={"young_modulus": "70 GPa", "poisson_ratio": 0.2},
        geometry={"type": "sphere", "radius": "105 um"},
        friction={"type": "coulomb", "coefficient": 0.3},
        inclusions={
            "type": "sphere", "body": 2, "center": [0, 0, "4 um"], "radius": "1.5 um",
            "material": {"young_modulus": "140 GPa", "poisson_ratio": 0.3},
        },
        grid={"cells": 24, "spacing": ["0.8 um", "0.8 um"]},
        steps=[{"normal_load": "0.3 N"}, {"normal_load": "0.3 N", "tangential_load_x": "0.05 N"}],
        stress=[{"shape": "plane", "normal": "y", "body": 1, "depth_max": "6 um", "depth_cells": 12}],
        output={"pictures": False, "vtk": False},
    )  # fmt: skip
    ec.run(scene, folder / "run").dataset.close()
    return read_step(folder / "run")


def test_a_step_has_both_bodies_and_its_tractions_with_signs(sliding):
    bodies, gaps = bodies_of_step(sliding)
    assert [body.number for body in bodies] == [1, 2]
    assert [body.loaded.young_modulus for body in bodies] == [210e9, 70e9]
    assert [len(body.different) for body in bodies] == [0, 1]
    assert gaps == []
    first, second = (tractions_on(sliding, number).force for number in (1, 2))
    np.testing.assert_allclose(first[[0, 2]], (0.05, 0.3), rtol=1e-4)
    np.testing.assert_allclose(second, first * (-1.0, -1.0, 1.0), rtol=1e-12, atol=1e-12)


def test_surface_lines_hold_displacement_by_tractions_and_by_eigenstrain(sliding):
    line = surface_lines(sliding, middle_of(sliding))[0]
    assert line.profile.components == ("u_x", "u_y", "u_z")
    whole = sliding.surface["displacement_z"] + sliding.surface["residual_displacement_z"]
    np.testing.assert_array_equal(line.values[:, 2], whole[line.indices])
    touching = sliding.surface["pressure"][line.indices] > 0.0
    assert touching.any()
    assert not touching.all()


def test_stress_of_a_homogeneous_body_is_that_of_point_forces_on_its_cells(sliding):
    bodies, _ = bodies_of_step(sliding)
    lines, _ = stress_lines(sliding, bodies, middle_of(sliding), {})
    line = next(one for one in lines if one.body == 1)
    expected = homogeneous_stress(tractions_on(sliding, 1), line.profile.points, 0.3)
    np.testing.assert_allclose(line.values, expected, atol=0.01 * np.abs(expected).max())


def test_checks_hold_for_a_run_and_find_tractions_that_carry_another_load(sliding):
    assert {row.word for row in checked(sliding).rows} == {"agrees"}
    kept = sliding.surface["pressure"]
    sliding.surface["pressure"] = 1.02 * kept
    try:
        wrong = [row.component for row in checked(sliding).rows if row.word == "disagrees"]
    finally:
        sliding.surface["pressure"] = kept
    assert "F_z" in wrong
