"""Inhomogeneities with one eigenstrain each: the cheap fidelity of a scene, against finite elements and cells."""

import numpy as np
import pytest

import eigencontact as ec
from bodies import STEEL_TABLE as STEEL
from close import close
from hz_1 import FRICTION, LOAD, P0, RADIUS, A, grain

WHOLE = {"inclusion-resolution": "whole"}


def run(*inclusions, cells=16, tolerance=1e-6, numerics=WHOLE, **tables):
    scene = {
        "body1": STEEL,
        "geometry": {"type": "sphere", "radius": RADIUS},
        "grid": {"cells": cells, "size": [3.2 * A, 3.2 * A]},
        "steps": {"normal-load": LOAD},
        "numerics": {"tolerance": tolerance, **numerics},
    }
    return ec.run(scene | {"inclusions": list(inclusions)} | tables)


# cases IC-3, IC-4, IC-5 where one eigenstrain does: ratio, radius, depth -> p(0) / p0 by finite elements; cells
BALLS = {
    "IC-3": (2.0, 0.17, 0.5, 1.054, 33),
    "IC-4, shallow": (2.0, 0.13, 0.3, 1.104, 49),
    "IC-4, middle": (2.0, 0.13, 0.4, 1.047, 33),
    "IC-4, deep": (2.0, 0.13, 0.5, 1.024, 33),
    "IC-5, small": (0.5, 0.17, 0.5, 0.948, 33),
}


@pytest.mark.parametrize("case", ["IC-3", *(pytest.param(name, marks=pytest.mark.slow) for name in BALLS)])
def test_pressure_above_a_ball(case):
    ratio, radius, depth, expected, cells = BALLS[case]
    pressure = run(grain(ratio, radius, depth), cells=cells).dataset["pressure"][-1].values
    assert pressure[cells // 2, cells // 2] / P0 == close(expected, rel=5e-3, abs=0)


@pytest.mark.parametrize("tables", [{}, pytest.param(FRICTION, marks=pytest.mark.slow)], ids=["normal", "friction"])
def test_the_material_of_the_body_changes_nothing(tables):
    bare = run(tolerance=1e-10, cells=12, **tables).dataset
    filled = run(grain(1.0, 0.3, 0.4, x=0.2), tolerance=1e-10, cells=12, **tables).dataset
    for name in ["pressure", "gap", *(["shear_x", "slip_x"] if tables else [])]:
        np.testing.assert_allclose(filled[name], bare[name], rtol=0, atol=1e-9 * float(np.abs(bare[name]).max()))


def test_both_resolutions_agree_on_what_a_small_ball_does():
    """Also beside a ball of prescribed eigenstrain, in the other body, and in the stress below the surface."""
    balls = grain(3.0, 0.16, 0.7, x=0.2), grain(1.0, 0.2, 0.7, x=-0.4, eigenstrain=1e-2) | {"material": None}
    tables = {
        "body2": STEEL,
        "cells": 32,
        "inclusions": [{k: v for k, v in ball.items() if v is not None} | {"body": 2} for ball in balls],
        "stress": {"name": "cut", "shape": "plane", "normal": "z", "position": 0.2 * A, "body": 2},
        "output": {"tangential-displacement": True},
    }
    cells, whole = run(numerics={}, **tables).dataset, run(**tables).dataset
    bounds = {"pressure": 0.01, "cut_stress": 0.01, "residual_displacement_z": 0.04, "residual_displacement_x": 0.04}
    for name, bound in bounds.items():  # finer cells do not come closer: the price of one eigenstrain
        assert float(np.abs(whole[name] - cells[name]).max()) < bound * float(np.abs(cells[name]).max()), name
    effect = float(np.abs(cells["residual_displacement_z"]).max())
    assert effect > 1e-3 * RADIUS * (A / RADIUS) ** 2


# changes of a ball that make it no whole
IN_CELLS = {
    "no closed form": {"type": "cylinder", "length": 0.3 * A, "axis": [0, 1, 0]},
    "a profile": {"eigenstrain": {"type": "depth-profile", "depths": [0.0, 1e-5], "values": [1e-3, 0.0]}},
}


@pytest.mark.parametrize("case", IN_CELLS)
def test_what_has_no_uniform_eigenstrain_stays_in_cells(case):
    ball = grain(2.0, 0.2, 0.5) | IN_CELLS[case]
    plan = ec.plan({"body1": STEEL, "inclusions": ball, "grid": {"cells": 8, "size": [A, A]}, "numerics": WHOLE})
    assert not plan.model.cells.inhomogeneities[0].whole


def test_a_cuboid_can_be_whole():
    brick = {"type": "cuboid", "center": [0, 0, 0.5 * A], "edges": [0.3 * A] * 3, "material": {"void": True}}
    degrees = ("whole", {"whole": 0}, {"whole": 2})
    found = [
        ec.plan({"body1": STEEL, "inclusions": brick, "numerics": {"inclusion-resolution": degree}})
        .model.cells.inhomogeneities[0].whole
        for degree in degrees
    ]  # fmt: skip
    assert found == [True, True, False]


def test_explain_tells_whole_from_cut():
    text = ec.plan({"body1": STEEL, "inclusions": grain(2.0, 0.2, 0.5), "numerics": WHOLE}).explain()
    assert "whole inhomogeneities, 1 region" in text
    assert "with one eigenstrain" in text
    assert "cells of 420" not in text
