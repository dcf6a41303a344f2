"""Fretting over a coating, a bundled scene, on coarser cells: what a stiff and a soft coating change (case CMC-2)."""

import numpy as np
import pytest

import eigencontact as ec
from close import close

#: Young's modulus of the coatings [Pa]; the substrate has 210 GPa.
COATINGS = {"stiff": 420e9, "none": 210e9, "soft": 105e9}
#: The same for all, with room for the widest contact.
GRID = {"cells": 22, "size": [2.86 * 20e-6, 2.86 * 20e-6]}
#: Case CM-2, the bare substrate: load at the turns [N], stick radius there [m], work of friction in a cycle [J].
BARE = (3.378, 15.340e-6, 2.942e-7)
#: Increments of the quarter and of the halves of the cycle.
FEW = (2, 4, 4)


@pytest.fixture
def finished(finished):
    """Run the scene with a coating and a coupling."""

    def run(coating, coupling="none", increments=FEW):
        table = ec.load_scene("coated-fretting").resolved()
        table["body1"]["medium"]["layers"][0]["young-modulus"] = COATINGS[coating]
        table["numerics"]["coupling"] = coupling
        table["grid"] = GRID
        for step, count in zip(table["steps"][1:], increments, strict=True):
            step["increments"] = count
        return finished(ec.Scene(**table))

    return run


def turns(increments):
    """Numbers of the steps at which the motion turns, and of the last."""
    return np.cumsum(increments)


def loop(result, increments=FEW):
    """Load at the last turn [N], stick radius there [m], energy of the last cycle [J]."""
    data, steps = result.dataset, turns(increments)
    energy = float(data.dissipated_energy[steps[2]] - data.dissipated_energy[steps[0]])
    return float(data.tangential_load_x[steps[2]]), float(data.stick_radius[steps[2]]), energy


def test_the_scene_is_the_one_described():
    scene = ec.load_scene("coated-fretting")
    assert [step.increments for step in scene.steps] == [1, 8, 16, 16]
    assert {observer["type"] for observer in scene.observers} == {"fretting-loop", "stick-radius", "dissipated-energy"}
    assert scene.body1.medium["layers"][0]["thickness"] == "20 um"


@pytest.mark.parametrize("coating", ["stiff", "soft", pytest.param("none", marks=pytest.mark.slow)])
def test_the_motion_of_mindlins_sphere_over_a_coating(coating, finished):
    """Case CMC-2: a stiff coating takes more load and work and sticks less than the bare substrate; a soft one less."""
    result = finished(coating)
    data, steps = result.dataset, turns(FEW)
    for residual in ("gap", "penetration", "load", "bound", "stick", "alignment"):
        assert float(data[f"{residual}_residual"].max()) <= 1e-6
    load = data.tangential_load_x.values
    assert load[steps[1]] == close(-load[steps[0]], rel=1e-3)
    assert load[steps[2]] == close(load[steps[0]], rel=1e-3)
    taken, stick, work = (found / bare for found, bare in zip(loop(result), BARE, strict=True))
    if coating == "stiff":
        assert taken > 1.25
        assert stick < 0.75
        assert work > 1.6
    elif coating == "soft":
        assert taken < 0.8
        assert stick > 1.25
        assert work < 0.6
    else:
        assert taken == close(1.0, rel=0.01)
        assert stick == close(1.0, abs=0.5 * GRID["size"][0] / GRID["cells"] / BARE[1])
        assert work == close(1.0, rel=0.1)


@pytest.mark.slow
@pytest.mark.parametrize("coupling", ["partial", "full"])
def test_the_order_is_the_same_however_displacements_are_coupled(coupling, finished):
    increments = (8, 16, 16)
    stiff, none, soft = (loop(finished(coating, coupling, increments), increments) for coating in COATINGS)
    assert stiff[0] > none[0] > soft[0]
    assert stiff[1] < none[1] < soft[1]
    assert stiff[2] > none[2] > soft[2]
