"""Inhomogeneities from scene to results: under contacts, without one, in either body, with friction and history."""

import numpy as np
import pytest

import eigencontact as ec
from bodies import STEEL_TABLE as STEEL
from close import close
from eigencontact.errors import DomainTooSmall, NotConverged
from eigencontact.execution.mechanics.coupled import Coupled
from hz_1 import FRICTION, LOAD, MODULUS, NU, P0, RADIUS, A, E, grain


def run(*inclusions, cells=16, window=3.2, tolerance=1e-6, **tables):
    scene = {
        "body1": STEEL,
        "geometry": {"type": "sphere", "radius": RADIUS},
        "grid": {"cells": cells, "size": [window * A, window * A]},
        "steps": {"normal-load": LOAD},
        "numerics": {"tolerance": tolerance, **tables.pop("numerics", {})},
    }
    return ec.run(scene | {"inclusions": list(inclusions)} | tables)


def same(one, other, names, rtol):
    for name in names:
        largest = float(np.abs(one[name]).max())
        np.testing.assert_allclose(one[name], other[name], rtol=0, atol=rtol * largest, err_msg=name)


BOTH = pytest.mark.parametrize(
    "tables", [{}, pytest.param(FRICTION, marks=pytest.mark.slow)], ids=["normal", "friction"]
)


@pytest.mark.parametrize("tables", [{}, FRICTION], ids=["normal", "friction"])
def test_the_material_of_the_body_changes_nothing(tables):
    region = {"stress": {"name": "cut", "shape": "plane", "depth-max": A, "depth-cells": 4}}
    bare = run(tolerance=1e-11, cells=12, **tables, **region)
    filled = run(grain(1.0, 0.3, 0.4, x=0.2), tolerance=1e-11, cells=12, **tables, **region)
    names = ["pressure", "gap", "displacement_z", "cut_stress"]
    names += ["shear_x", "slip_x", "displacement_x"] if tables else []
    same(bare.dataset, filled.dataset, names, 1e-10)
    assert float(np.abs(filled.dataset["residual_displacement_z"]).max()) < 1e-12 * RADIUS


# cases IC-3, IC-4, IC-5: ratio, radius, depth -> p(0) / p0 by finite elements; cells
BALLS = {
    "IC-3": (2.0, 0.17, 0.5, 1.054, 33),
    "IC-4, shallow": (2.0, 0.13, 0.3, 1.104, 49),
    "IC-4, middle": (2.0, 0.13, 0.4, 1.047, 49),
    "IC-4, deep": (2.0, 0.13, 0.5, 1.024, 33),
    "IC-5, small": (0.5, 0.17, 0.5, 0.948, 33),
    "IC-5, large": (0.5, 0.5, 1.0, 0.876, 33),
}


@pytest.mark.parametrize("case", ["IC-3", "IC-5, small", *(pytest.param(n, marks=pytest.mark.slow) for n in BALLS)])
def test_pressure_above_a_ball(case):
    ratio, radius, depth, expected, cells = BALLS[case]
    result = run(grain(ratio, radius, depth), cells=cells)
    middle = float(result.dataset["pressure"][-1, cells // 2, cells // 2]) / P0
    assert middle == close(expected, rel=5e-3, abs=0)
    assert result.summary["coupling_residual"] <= 1e-6
    assert result.summary["inclusion_residual"] <= 1e-6
    # Cells are swept, not solved; the last round may find the eigenstrain as it was, and applies nothing.
    assert 2 <= result.summary["inclusion_iterations"] <= 8
    assert result.summary["coupling_iterations"] <= result.summary["inclusion_iterations"] + 1


# ratio, half window in thicknesses, cells -> pmax / p0 of case CO-1 (0.25: no more than "about 0.5"), tolerance
COATINGS = {
    "stiffer": (2.0, 2.0, 16, 1.4754, 0.05),
    "softer": (0.5, 3.0, 18, 0.7047, 0.03),
    "much softer": (0.25, 4.0, 20, 0.51, 0.03),
}


@pytest.mark.parametrize("case", ["stiffer", *(pytest.param(name, marks=pytest.mark.slow) for name in COATINGS)])
def test_coatings_reach_neither_one_point_nor_no_end(case):
    """Case CO-1 by enrichment of the coating, case CO-2 of the stiff one; the window ends, and is coarse."""
    ratio, half, cells, expected, tolerance = COATINGS[case]
    pressure, _ = coated(ratio, half, cells)
    assert float(pressure.max()) == close(expected, rel=tolerance, abs=0)


@pytest.mark.slow
def test_no_oscillation_under_a_stiff_coating():
    """Case CO-2: the pressure falls outwards cell by cell, on either of two grids, which agree."""
    peaks = []
    for cells in (12, 18):
        pressure, rounds = coated(4.0, 1.5, cells)
        row = pressure[cells // 2, cells // 2 :]
        assert np.all(np.diff(row) <= 1e-6 * row[0])
        assert np.count_nonzero(pressure) > 12
        assert rounds < 20
        peaks.append(float(pressure.max()))
    assert peaks[1] == close(peaks[0], rel=0.1, abs=0)


def coated(ratio, half, cells):
    """Pressure over p0 of a rigid ball of ten thicknesses, loaded to a0 = h on the substrate; rounds."""
    h = 1e-6
    load = 4.0 * MODULUS * h**2 / 30.0
    window = 2 * half * h
    coating = {
        "type": "cuboid",
        "center": [0.0, 0.0, 0.5 * h],
        "edges": [window, window, h],
        "material": {"young-modulus": ratio * E, "poisson-ratio": NU},
    }
    result = run(
        coating,
        geometry={"type": "sphere", "radius": 10 * h},
        grid={"cells": cells, "size": [window, window]},
        steps={"normal-load": load},
    )
    peak = 1.5 * load / (np.pi * h**2)
    return result.dataset["pressure"][-1].values / peak, result.summary["coupling_iterations"]


@pytest.mark.slow
def test_void_and_nearly_rigid_ball_near_the_surface():
    void, rigid = (run(grain(ratio, 0.2, 0.3), cells=17).dataset["pressure"][-1].values / P0 for ratio in (0.0, 1e6))
    assert 0.0 <= void[8, 8] < 0.5 < void.max()
    assert rigid[8, 8] == rigid.max() > 1.5
    for pressure in (void, rigid):
        np.testing.assert_allclose(pressure, pressure[:, ::-1], atol=1e-5)
        np.testing.assert_allclose(pressure, pressure.T, atol=1e-5)


@pytest.mark.slow
def test_a_ball_on_either_side_gives_mirrored_contacts():
    left, right = (run(grain(2.0, 0.2, 0.4, x=x)).dataset["pressure"][-1].values for x in (0.3, -0.3))
    np.testing.assert_allclose(left, right[:, ::-1], rtol=0, atol=1e-5 * P0)
    assert np.abs(left - left[:, ::-1]).max() > 1e-2 * P0


@BOTH
def test_body_2_is_body_1_seen_from_the_other_side(tables):
    """The load along x is then the opposite one, and everything is mirrored in x."""
    one = run(grain(2.0, 0.25, 0.4), cells=12, body2=STEEL, tolerance=1e-8, **tables).dataset
    other = run(grain(2.0, 0.25, 0.4, body=2), cells=12, body2=STEEL, tolerance=1e-8, **tables).dataset
    for name in ["pressure", "displacement_z", "residual_displacement_z", *(["shear_x", "slip_x"] if tables else [])]:
        largest = float(np.abs(one[name]).max())
        np.testing.assert_allclose(one[name][-1], other[name][-1, :, ::-1], rtol=0, atol=1e-5 * largest, err_msg=name)


def test_prestrain_of_a_ball_of_another_stiffness():
    """Eshelby's ball with a dilatation of its own: 3 K e / (3 K + 4 G) is left of it."""
    ratio, dilatation = 3.0, 1e-3
    bulk, shear = ratio * E / (3 * (1 - 2 * NU)), E / (2 * (1 + NU))
    strain = dilatation * 3 * bulk / (3 * bulk + 4 * shear)
    ball = {
        "type": "sphere",
        "center": [0.0, 0.0, 4e-6],
        "radius": 1e-6,
        "eigenstrain": dilatation,
        "material": {"young-modulus": ratio * E, "poisson-ratio": NU},
    }
    data = ec.run(
        {
            "body1": STEEL,
            "inclusions": [ball],
            "grid": {"cells": 24, "size": [3e-6, 3e-6]},
            "numerics": {"half-space": "full-space"},
            "stress": {
                "name": "spot",
                "shape": "points",
                "points": [[1e-7, 1e-7, 4.1e-6]],
                "fields": ["stress", "strain"],
            },
        }
    ).dataset
    expected = 3 * bulk * (strain - dilatation)
    for k in range(3):
        assert float(data["spot_stress"][0, k, 0]) == close(expected, rel=0.022, abs=0)
        assert float(data["spot_strain"][0, k, 0]) == close(strain, rel=0.006, abs=0)
    assert "pressure" not in data


@pytest.mark.slow
def test_prescribed_eigenstrain_in_an_inhomogeneity_is_its_prestrain():
    ball = {"type": "sphere", "center": [0.0, 0.0, 2e-6], "radius": 1e-6}
    stiff = {"material": {"young-modulus": 2 * E, "poisson-ratio": NU}}
    tables = {"body1": STEEL, "grid": {"cells": 20, "size": [3e-6, 3e-6]}}
    own = ec.run({**tables, "inclusions": [{**ball, **stiff, "eigenstrain": 1e-3}]})
    beside = ec.run({**tables, "inclusions": [{**ball, **stiff}, {**ball, "eigenstrain": 1e-3}]})
    lift = "residual_displacement_z"
    same(own.dataset, beside.dataset, [lift], 0.02)  # a closed form, and cells
    assert own.summary["max_uplift"] > 0


def test_where_inhomogeneities_overlap_the_later_one_wins():
    soft, stiff = grain(0.5, 0.3, 0.5), grain(2.0, 0.3, 0.5)
    first, last, only = (run(*some, cells=12).dataset for some in ([stiff, soft], [soft, stiff], [stiff]))
    same(last, only, ["pressure"], 1e-12)
    assert float(first["pressure"].max()) < P0 < float(last["pressure"].max())


@pytest.mark.slow
def test_contact_that_only_the_way_there_brings_to_the_edge():
    """Under a stiff coating the contact is smaller than on the substrate, where it would pass the edge."""
    pressure, _ = coated(4.0, 1.0, 12)
    assert not pressure[0].any()
    with pytest.raises(DomainTooSmall):
        coated(0.5, 1.0, 12)


@pytest.mark.slow
def test_a_resumed_run_repeats(tmp_path):
    """Steps after the first take everything from what is stored."""
    tables = {"tolerance": 1e-6, "cells": 12, **FRICTION}
    whole = run(grain(0.5, 0.3, 0.4, x=0.2), **tables).dataset
    planned = ec.plan(
        {
            "body1": STEEL,
            "geometry": {"type": "sphere", "radius": RADIUS},
            "grid": {"cells": 12, "size": [3.2 * A, 3.2 * A]},
            "numerics": {"tolerance": 1e-6},
            "inclusions": [grain(0.5, 0.3, 0.4, x=0.2)],
            **FRICTION,
        }
    )
    from eigencontact.execution.run.driver import drive

    first = next(iter(drive(planned)))
    last = list(drive(planned, stored_steps={1: lambda: first}))[-1]
    for name in ("pressure", "shear_x", "shear_y", "residual_displacement_z", "slip_distance"):
        np.testing.assert_array_equal(last.fields[name], whole[name][-1].values, err_msg=name)


@BOTH
def test_a_step_too_large_is_halved(tables, monkeypatch):
    """With friction the halves are steps of the history, else the first is but a start for the whole."""
    ball, last = grain(0.5, 0.3, 0.4), {"tangential-load-x": 0.2 * LOAD} if tables else {"normal-load": 2.0 * LOAD}
    halves = {**tables, "steps": [{"normal-load": LOAD}, {**last, "increments": 2}]}
    expected = run(ball, cells=12, tolerance=1e-8, **halves)
    solve, calls = Coupled.solve, []

    def stubborn(self, increment, memory, before):
        calls.append(increment.times[1])
        if len(calls) == 2:
            raise NotConverged("as the test wants")
        return solve(self, increment, memory, before)

    monkeypatch.setattr(Coupled, "solve", stubborn)
    found = run(ball, cells=12, tolerance=1e-8, **{**tables, "steps": [{"normal-load": LOAD}, last]})
    assert calls == [1.0, 2.0, 1.5, 2.0]
    for name in ["pressure", "residual_displacement_z", *(["shear_x", "dissipated_energy_density"] if tables else [])]:
        largest = float(np.abs(expected.dataset[name]).max())
        np.testing.assert_allclose(
            found.dataset[name][-1], expected.dataset[name][-1], rtol=0, atol=1e-5 * largest, err_msg=name
        )
    if tables:
        assert found.summary["history"][1]["substeps"] == 2
        slips = expected.dataset["slip_x"][-2:].sum("step")
        np.testing.assert_allclose(found.dataset["slip_x"][-1], slips, rtol=0, atol=1e-5 * float(np.abs(slips).max()))
