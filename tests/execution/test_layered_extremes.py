"""Layered bodies at their extremes, pressed by a rigid ball: against the integral equation of the coated contact."""

import numpy as np
import pytest

import eigencontact as ec
from eigencontact_verification.oracles.coated_contact import contact_of_radius

E, NU, A = 210e9, 0.3, 1e-6
SUBSTRATE = (E, NU)


def medium(layers, substrate=SUBSTRATE):
    rows = [{"thickness": h, "young-modulus": modulus, "poisson-ratio": nu} for h, modulus, nu in layers]
    return {
        "type": "bonded-layers",
        "layers": rows,
        "substrate": {"young-modulus": substrate[0], "poisson-ratio": substrate[1]},
    }


def scene(body, load, *, a=A, cells=15, half=1.35, **more):
    """A ball of twenty contact radii."""
    return {
        "body1": body,
        "geometry": {"type": "sphere", "radius": 20 * a},
        "grid": {"cells": cells, "size": [2 * half * a] * 2},
        "steps": {"normal-load": load},
        "output": {"pictures": False},
        **more,
    }


def errors(layers, substrate=SUBSTRATE, *, a=A, **more):
    """Largest pressure and approach relative to those of the integral equation for a contact of radius a."""
    contact = contact_of_radius(a, 20 * a, layers, substrate)
    summary = ec.run(scene({"medium": medium(layers, substrate)}, contact.load, a=a, **more)).summary
    assert summary["converged"] is True
    return summary["max_pressure"] / contact.max_pressure - 1, summary["approach"] / contact.approach - 1


def graded(count):
    """So many layers, together as thick as the contact is wide, of moduli and Poisson's ratios at random."""
    rng = np.random.default_rng(6)
    return [(A / count, E * 2 ** float(rng.uniform(-1, 1)), float(rng.uniform(0.1, 0.5))) for _ in range(count)]


slow = pytest.mark.slow
#: Layers and substrate.
CASES = {
    "30 layers": (graded(30), SUBSTRATE),
    "contrast 1e-4": ([(A, 1e-4 * E, NU)], SUBSTRATE),
    "contrast 1e4": ([(A, 1e4 * E, NU)], SUBSTRATE),
    "incompressible layer": ([(A, 0.1 * E, 0.5)], SUBSTRATE),
    "incompressible substrate": ([(A, 2 * E, NU)], (E, 0.5)),
    "all incompressible": ([(A, 2 * E, 0.5)], (E, 0.5)),
    "a hundredth, stiff": ([(A / 100, 10 * E, NU)], SUBSTRATE),
    "a hundredth, soft": ([(A / 100, 0.1 * E, NU)], SUBSTRATE),
    "a tenth, contrast 1e-4": ([(A / 10, 1e-4 * E, NU)], SUBSTRATE),
    "a tenth, contrast 10": ([(A / 10, 10 * E, NU)], SUBSTRATE),
    "30 thin layers in turn": ([(A / 100, (4 if k % 2 else 0.25) * E, NU) for k in range(30)], SUBSTRATE),
}
FAST = ("contrast 1e4",)


@pytest.mark.parametrize("case", [name if name in FAST else pytest.param(name, marks=slow) for name in CASES])
def test_extreme_layers_under_a_ball(case):
    peak, approach = errors(*CASES[case])
    assert abs(peak) < 0.003
    assert abs(approach) < 0.003


@pytest.mark.parametrize("contrast", [1e4, pytest.param(1e5, marks=slow)])
def test_a_thin_layer_of_great_stiffness(contrast):
    """A plate on a soft ground, whose pressure stands at the rim: the approach follows with second order."""
    tight = {"tolerance": 1e-8}
    found = [abs(errors([(A / 10, contrast * E, NU)], cells=cells, numerics=tight)[1]) for cells in (31, 63)]
    assert found[0] < 1e-4
    assert 3.0 < found[0] / found[1] < 7.0


@slow
def test_the_rim_pressure_of_a_thin_layer_of_great_stiffness():
    assert abs(errors([(A / 10, 1e4 * E, NU)], cells=256)[0]) < 0.003


@slow
@pytest.mark.parametrize(("ratio", "share"), [(2.0, 1e-4), (0.5, 1e-4)])
def test_a_coating_of_a_ten_thousandth_is_all_but_none(ratio, share):
    """Thickness h moves the surface under the pressure by a part h/a of its displacement, and no more."""
    load = 4 * E / (1 - NU**2) * A**2 / 60
    bare = ec.run(scene({"young-modulus": E, "poisson-ratio": NU}, load)).dataset
    coated = ec.run(scene({"medium": medium([(share * A, ratio * E, NU)])}, load)).dataset
    change = float(abs(coated.pressure - bare.pressure).max() / bare.pressure.max())
    assert 1e-6 < change < 20 * share
    assert np.sign(float(coated.approach[-1] - bare.approach[-1])) == (-1 if ratio > 1 else 1)


@slow
def test_thirty_like_layers_under_friction_are_one():
    """Shear, slip and work of the graded layers' sliding with all displacements coupled, cut in 30 or not at all."""
    load = 4 * E / (1 - NU**2) * A**2 / 60
    more = {
        "friction": {"type": "coulomb", "coefficient": 0.4},
        "steps": [{"normal-load": load}, {"tangential-load-x": 0.2 * load}],
        "numerics": {"tolerance": 1e-8},
        "cells": 10,
    }
    found = [
        ec.run(scene({"medium": medium([(A / count, 2 * E, NU)] * count)}, load, **more)).dataset for count in (1, 30)
    ]
    for name in ("pressure", "shear_x", "slip_x"):
        largest = float(abs(found[0][name]).max())
        assert largest > 0
        np.testing.assert_allclose(found[1][name], found[0][name], rtol=0, atol=1e-5 * largest, err_msg=name)


@slow
@pytest.mark.parametrize("scale", [1e-9 / A, 1.0 / A])
def test_nanometres_and_metres(scale):
    expected = errors([(A, 2 * E, NU)])
    found = errors([(A * scale, 2 * E, NU)], a=A * scale)
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-6)


@slow
def test_single_precision():
    double, single = (errors([(A, 2 * E, NU)], numerics={"precision": name}) for name in ("double", "single"))
    np.testing.assert_allclose(single, double, rtol=0, atol=5e-5)
    assert single != double
