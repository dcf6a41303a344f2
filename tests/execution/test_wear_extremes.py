"""Wear at its extremes: coefficients from nothing to absurd, a million cycles, lost stick, lifted contacts; turns."""

from functools import cache
from typing import Any

import numpy as np
import pytest

import eigencontact as ec
from close import close
from eigencontact.errors import SceneError
from eigencontact.execution.wear import jumps

RADIUS, LOAD, CONTACT = 200e-6, 12.307, 20e-6
GENTLE = 2.7e-12  # m³/J


def fretting(coefficient=GENTLE, cycles=20, *, amplitude=0.025, along="x", wear=None, margin=1.5, **changes):
    """A rigid sphere on steel, 8 cells a radius, moved to and fro by an amplitude in contact radii."""
    name, way = f"shift-{along}", amplitude * CONTACT
    cycle = [{name: way, "increments": 2}, {name: -way, "increments": 4}, {name: 0.0, "increments": 2}]
    scene: dict[str, Any] = {
        "body1": {"young-modulus": "210 GPa", "poisson-ratio": 0.3},
        "body2": {"rigid": True},
        "geometry": {"type": "sphere", "radius": RADIUS},
        "friction": {"type": "coulomb", "coefficient": 0.5},
        "wear": {"type": "dissipated-energy", "coefficient": coefficient, **(wear or {})},
        "grid": {"cells-per-contact-radius": 8, "margin": margin},
        "numerics": {"coupling": "none"},
        "steps": [{"normal-load": LOAD}, {"cycle": cycle, "repeat": cycles}],
    }
    return {**scene, **changes}


@cache
def a_million():
    return ec.run(fretting(GENTLE, 10**6)).summary


def ends(result):
    """Numbers of the ends of the solved cycles, by number of cycle."""
    rows = result.summary["history"]
    return {round(row["cycles"]): row for row in rows if row["time"] == int(row["time"]) and row["time"] % 3 == 1}


def test_next_to_no_wear_is_in_proportion():
    little, less = (ec.run(fretting(value, 4)).summary for value in (1e-26, 1e-30))
    assert less["worn_volume"] == close(1e-4 * little["worn_volume"], rel=1e-9)
    assert less["max_pressure"] == close(little["max_pressure"], rel=1e-9)


def test_absurd_wear_is_refused():
    with pytest.raises(SceneError, match=r"^wear law 'dissipated-energy' must wear less than 1e\+08 times .*lower its"):
        ec.run(fretting(1e30, 2))


@pytest.mark.slow
@pytest.mark.parametrize("coefficient", [1e-9, 1e-6])
def test_strong_wear_ends_at_the_limit_of_gentle_wear(coefficient):
    """Partial slip comes to rest: the place is the same where one cycle would wear a thousand times as deep.

    With the load kept the limit is not free of history, and its volume changes ten times as much as the stick radius,
    which is known to a cell of an eighth of the contact radius.
    """
    strong = ec.run(fretting(coefficient, 8)).summary
    gentle = a_million()
    assert gentle["cycles"] == 10**6
    assert gentle["steps"] < 1000
    assert strong["stick_radius"] == close(gentle["stick_radius"], rel=0.05)
    assert strong["worn_volume"] == close(gentle["worn_volume"], rel=0.25)
    assert gentle["contact_radius"] == close(gentle["stick_radius"], rel=0.15)  # no pressure is left outside


@pytest.mark.slow
def test_wear_that_empties_the_stick_zone():
    """The stick circle shrinks as the contact flattens; in the end everything slips, and wears on."""
    found = ends(ec.run(fretting(cycles=400, amplitude=0.075, margin=3.0)))
    first, last = found[2], found[400]
    assert first["slip_fraction"] < 1.0
    assert last["slip_fraction"] == 1.0
    assert last["worn_volume"] > 100 * first["worn_volume"]
    assert last["wear_error"] < 0.02


@pytest.mark.slow
def test_a_contact_that_is_lifted_in_each_cycle_wears():
    """Pressed, pushed, lifted, pulled back: the load at the end of a cycle is zero, and so is all pressure there."""
    cycle = [
        {"normal-load": LOAD},
        {"shift-x": 1e-6, "increments": 4},
        {"normal-load": 0.0, "increments": 2},
        {"shift-x": 0.0},
    ]
    steps = [{"normal-load": LOAD}, {"cycle": cycle, "repeat": 10}]
    gentle, strong = (ec.run(fretting(value, margin=4.0, steps=steps)).summary for value in (GENTLE, 1000 * GENTLE))
    assert 0 < gentle["worn_volume"] < strong["worn_volume"]
    assert gentle["energy_volume_residual"] < 1e-10
    assert strong["max_worn_depth"] < 3e-6  # one deflection of a cell a cycle at most, and not a thousand


@pytest.mark.slow
def test_mirrored_and_turned_scenes_agree():
    change = {"cycles": 4, "numerics": {"coupling": "partial", "tolerance": 1e-10}}
    cycle = [{"shift-x": -5e-7, "increments": 2}, {"shift-x": 5e-7, "increments": 4}, {"shift-x": 0.0, "increments": 2}]
    mirrored = [{"normal-load": LOAD}, {"cycle": cycle, "repeat": 4}]
    one, other = ec.run(fretting(**change)), ec.run(fretting(along="y", **change))
    third = ec.run(fretting(**change, steps=mirrored))
    depth = one.dataset["worn_depth"].values[-1]
    scale = 1e-10 * depth.max()
    np.testing.assert_allclose(other.dataset["worn_depth"].values[-1], depth.T, rtol=0, atol=scale)
    np.testing.assert_allclose(third.dataset["worn_depth"].values[-1], depth[:, ::-1], rtol=0, atol=scale)


@pytest.mark.slow
def test_an_error_that_is_planted_into_the_jumps_is_seen(monkeypatch):
    """Jumps by three halves of the rate: cycles that are solved tell, the stated error grows, and the jumps shrink."""
    sound = ec.run(fretting(cycles=40)).summary
    known = jumps.ahead

    def wrong(memory, cycles):
        rate = known(memory, cycles)
        return jumps.Rate(pressed=1.5 * rate.pressed, steady=rate.steady)

    monkeypatch.setattr(jumps, "ahead", wrong)
    monkeypatch.setattr("eigencontact.execution.wear.surface.ahead", wrong)
    planted = ec.run(fretting(cycles=40)).summary
    off = abs(planted["worn_volume"] / sound["worn_volume"] - 1.0)
    assert planted["wear_error"] > off
    assert planted["wear_error"] > 5 * sound["wear_error"]
    assert planted["steps"] > sound["steps"]


@pytest.mark.slow
def test_plastic_flow_and_wear_are_solved_together():
    body = {
        "young-modulus": "210 GPa",
        "poisson-ratio": 0.3,
        "law": {"type": "j2", "hardening": {"type": "perfect", "yield-stress": "7344 MPa"}},
    }
    yields = ec.run(fretting(cycles=2, body1=body, numerics={"coupling": "none", "tolerance": 1e-4})).summary
    elastic = ec.run(fretting(cycles=2, numerics={"coupling": "none", "tolerance": 1e-4})).summary
    assert yields["max_plastic_strain"] > 1e-3
    assert yields["max_pressure"] < 0.97 * elastic["max_pressure"]
    assert yields["worn_volume"] == close(elastic["worn_volume"], rel=0.2)
    assert yields["worn_volume"] != close(elastic["worn_volume"], rel=1e-3)
    assert yields["energy_volume_residual"] < 1e-10


@pytest.mark.parametrize("coefficient", [GENTLE, pytest.param(10 * GENTLE, marks=pytest.mark.slow)])
def test_the_number_of_increments_does_not_matter(coefficient):
    """What a cycle wears follows from its ends and turns, with a load that is kept: 1 increment a quarter, and 3."""
    volumes = []
    for count in (1, 3):
        way = 0.025 * CONTACT
        cycle = [
            {"shift-x": way, "increments": count},
            {"shift-x": -way, "increments": 2 * count},
            {"shift-x": 0.0, "increments": count},
        ]
        steps = [{"normal-load": LOAD}, {"cycle": cycle, "repeat": 3}]
        volumes.append(ec.run(fretting(coefficient, steps=steps)).summary["worn_volume"])
    assert volumes[0] == close(volumes[1], rel=1e-5)
