"""Scenes with whole inhomogeneities of polynomial eigenstrain: contact pressure, stress, errors, what is refused."""

from types import SimpleNamespace

import numpy as np
import pytest

import eigencontact as ec
from bodies import STEEL_TABLE as STEEL
from close import close
from eigencontact.errors import SceneError
from eigencontact.warnings_.after import _degree
from hz_1 import LOAD, NU, P0, RADIUS, A, E

VOID = {"void": True}
YIELDS = {
    "type": "j2", "young-modulus": E, "poisson-ratio": NU, "hardening": {"type": "perfect", "yield-stress": 1e9},
}  # fmt: skip


def stiff(ratio):
    return {"young-modulus": ratio * E, "poisson-ratio": NU}


def ball(material, radius, depth, x=0.0, **more):
    return {"type": "sphere", "center": [x * A, 0.0, depth * A], "radius": radius * A, "material": material, **more}


def scene(*inclusions, whole=3, cells=41, error=None, **tables):
    resolution = {"whole": whole, **({} if error is None else {"error": error})}
    basis = {
        "body1": STEEL,
        "geometry": {"type": "sphere", "radius": RADIUS},
        "grid": {"cells": cells, "size": [2.6 * A, 2.6 * A]},
        "steps": {"normal-load": LOAD},
        "numerics": {"tolerance": 1e-7, "inclusion-resolution": resolution},
    }
    return basis | {"inclusions": list(inclusions)} | tables


def run(*inclusions, **options):
    return ec.run(scene(*inclusions, **options))


def center(result):
    pressure = result.dataset["pressure"][-1].values
    return pressure[pressure.shape[0] // 2, pressure.shape[1] // 2] / P0


# p(0)/p0 of the theory page, degree 16 by an axisymmetric solution with an exact contact: ratio, radius, depth in a
ROWS = {
    "void": (VOID, 0.33, 0.5, 0.23068),
    "twice": (stiff(2), 0.33, 0.5, 1.34198),
    "half": (stiff(0.5), 0.33, 0.5, 0.70527),
}


@pytest.mark.parametrize(
    ("case", "degree", "bound"),
    [pytest.param("void", 6, 1e-3, marks=pytest.mark.slow), ("twice", 4, 1e-3), ("half", 4, 1e-3)],
)
def test_pressure_above_a_ball(case, degree, bound):
    """On cells of a 32nd of the contact radius."""
    material, radius, depth, expected = ROWS[case]
    assert center(run(ball(material, radius, depth), whole=degree, cells=83)) == close(expected, rel=0, abs=bound)


@pytest.mark.slow
@pytest.mark.parametrize("case", ROWS)
def test_pressure_above_a_ball_on_fine_cells(case):
    material, radius, depth, expected = ROWS[case]
    assert center(run(ball(material, radius, depth), whole=8, cells=151)) == close(expected, rel=0, abs=3e-4)


@pytest.mark.slow
def test_errors_fall_and_are_stated():
    results = {degree: run(ball(VOID, 0.33, 0.5), whole=degree) for degree in (2, 4, 6)}
    best = results[6].dataset["pressure"][-1].values
    for degree in (2, 4):
        result = results[degree]
        true = np.abs(result.dataset["pressure"][-1].values - best)[18:23, 18:23].max()
        stated = result.summary["degree_pressure_error"]
        assert 0.1 * stated < true < 2 * stated
    stated = [results[degree].summary["inclusion_degree_error"] for degree in (2, 4, 6)]
    assert stated[0] > 3 * stated[1] > 9 * stated[2] > 0


def test_the_material_of_the_body_changes_nothing():
    numerics = {"tolerance": 1e-12, "inclusion-resolution": {"whole": 2}}
    bare = run(cells=21, numerics=numerics).dataset["pressure"]
    filled = run(ball(stiff(1.0), 0.3, 0.4), cells=21, numerics=numerics).dataset["pressure"]
    np.testing.assert_allclose(filled, bare, rtol=0, atol=1e-10 * P0)


def test_stress_is_smooth_and_a_void_bears_none():
    points = {"shape": "points", "points": [[0, 0, 0.5 * A], [0.2 * A, 0, 0.55 * A], [0.34 * A, 0, 0.5 * A]]}
    found = run(ball(VOID, 0.33, 0.5), cells=15, whole=4, stress=points).dataset["points_body1_von_mises"][-1].values
    assert not found[:2].any()
    assert found[2] > 0.5 * P0


@pytest.mark.slow
def test_friction_two_bodies_and_a_prestrain_agree_with_cells():
    steps = [{"normal-load": LOAD}, {"tangential-load-x": 0.15 * LOAD}]
    inclusions = [
        ball(stiff(3), 0.3, 0.6, x=0.2, eigenstrain=1e-4),
        ball(stiff(0.3), 0.25, 0.5, x=-0.4, body=2),
    ]
    options = {"friction": {"type": "coulomb", "coefficient": 0.3}, "steps": steps, "body2": STEEL}
    options["grid"] = {"cells": 37, "size": [3.2 * A, 3.2 * A]}
    whole = run(*inclusions, **options)
    cells = ec.run(scene(*inclusions, **options) | {"numerics": {"tolerance": 1e-6, "inclusion-pitch": 0.05 * A}})
    for name, bound in (("max_pressure", 0.02), ("approach", 0.005), ("shift_x", 0.01)):
        assert whole.summary[name] == close(cells.summary[name], rel=bound)


def test_the_degree_follows_the_error_that_is_allowed():
    near, far = ball(VOID, 0.2, 0.3, x=-0.6), ball(VOID, 0.2, 1.0, x=0.6)
    explained = ec.explain(scene(near, far, whole="auto", error=0.01))
    assert "2 inhomogeneities of polynomial eigenstrain of degrees 3 to 5, 210 unknowns, foretold error" in explained
    for degree in (3, 5):
        assert f"nothing (a void), with one polynomial eigenstrain of degree {degree}" in explained


def test_a_uniform_eigenstrain_states_no_error():
    """There is no lower degree to compare with."""
    summary = run(ball(VOID, 0.33, 0.5), whole=0, cells=21).summary
    assert not {"inclusion_degree_error", "degree_pressure_error"} & set(summary)


def test_alone_in_full_space_nothing_reflects():
    numerics = {"half-space": "full-space", "inclusion-resolution": {"whole": "auto"}}
    result = run(ball(VOID, 0.33, 0.5), cells=21, numerics=numerics)
    below = run(ball(VOID, 0.33, 0.5), cells=21)
    assert result.summary["max_pressure"] != close(below.summary["max_pressure"], rel=1e-3)
    assert "polynomial eigenstrain of degree 3" in ec.explain(scene(ball(VOID, 0.33, 0.5), cells=21, numerics=numerics))


def test_an_error_that_no_degree_reaches_is_refused():
    with pytest.raises(SceneError, match=r"must be farther from the surface .* falls by a factor 0.8\d per degree"):
        ec.plan(scene(ball(VOID, 0.33, 0.335), whole="auto"))
    pair = [ball(stiff(1e6), 0.2, 1.0, x=x) for x in (-0.202, 0.202)]
    with pytest.raises(SceneError, match=r"must be farther from 'sphere 2'"):
        ec.plan(scene(*pair, whole="auto"))


def test_a_degree_that_misses_the_error_is_refused_or_warned_of():
    with pytest.raises(SceneError, match=r"with error = 0.001 .* with degree 2; .* set a higher degree"):
        ec.plan(scene(ball(VOID, 0.33, 0.5), whole=2, error=1e-3))
    codes = {caution["code"]: caution["error"] for caution in run(ball(VOID, 0.33, 0.4), whole=2).summary["warnings"]}
    assert codes["inclusion-degree"] > 0.05


@pytest.mark.parametrize(
    ("error", "words"), [(0.2, "their eigenstrain is 20 %"), (112.36, "does not resolve their eigenstrain")]
)
def test_an_error_above_one_is_not_told_in_parts(error, words):
    record = SimpleNamespace(scalars={"inclusion_degree_error": error})
    (caution,) = _degree(ec.plan(scene(ball(VOID, 0.33, 0.5), whole=2)).model, record)
    assert words in caution.words
    assert "11236" not in caution.words


@pytest.mark.parametrize(
    "inclusion",
    [{"type": "cuboid", "center": [0, 0, A], "edges": [A, A, A], "material": VOID}, ball(YIELDS, 0.2, 0.5)],
    ids=["shape", "law"],
)
def test_what_is_no_whole_stays_in_cells(inclusion):
    (source,) = ec.plan(scene(inclusion)).model.sources
    assert source.lattice is not None
    assert "cells of" in source.how


def test_a_degree_out_of_range_is_refused():
    with pytest.raises(SceneError, match="inclusion-resolution"):
        ec.plan(scene(ball(VOID, 0.2, 0.5), whole=40))


@pytest.mark.slow
@pytest.mark.parametrize(("gap", "close_by"), [(0.5, False), (0.05, True)])
def test_the_load_by_prescribed_eigenstrain_is_checked(gap, close_by, monkeypatch):
    """An edge of a hot cube close to a void asks for more points; a rule of four times the points judges."""
    from eigencontact.execution.interiors import checked_work

    edge = 0.2 * A
    middle = [0.33 * A + gap * 0.33 * A + 0.5 * edge, 0, 0.6 * A]
    cube = {"name": "hot", "type": "cuboid", "center": middle, "edges": [edge] * 3, "eigenstrain": 1e-3}

    def found(*factors):
        monkeypatch.setattr(checked_work, "_FACTORS", factors)
        result = run(ball(VOID, 0.33, 0.6), cube, whole=2, cells=15)
        return result.dataset["equivalent_eigenstrain_1"][-1].values, result.summary["inclusion_load_error"]

    (refined, stated), (first, _), (judge, _) = found(1.0, 1.5, 2.25), found(1.0), found(1.0, 4.0)
    largest = np.abs(judge).max()
    errors = [np.abs(values - judge).max() / largest for values in (first, refined)]
    assert bool(errors[0] > 1e-5) == close_by
    assert errors[1] < 0.2 * errors[0]
    assert errors[1] < stated < 1e-2
