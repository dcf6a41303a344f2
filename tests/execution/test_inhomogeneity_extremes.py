"""Inhomogeneities under a contact at their extremes: cells larger than them, thin ligaments, thousands, all scales."""

import numpy as np
import pytest

import eigencontact as ec
from close import close
from eigencontact.errors import SceneError
from eigencontact_verification.reporting.memory import PeakMemory
from hz_1 import LOAD, NU, P0, RADIUS, A, E

slow = pytest.mark.slow


def ball(ratio, radius, depth, x=0.0, y=0.0, scale=1.0):
    """A ball so many times as stiff as the body, 0 for a void; lengths in contact radii."""
    length = A * scale
    material = {"young-modulus": ratio * E, "poisson-ratio": NU} if ratio else {"void": True}
    center = [x * length, y * length, depth * length]
    return {"type": "sphere", "center": center, "radius": radius * length, "material": material}


def run(inclusions, cells=16, window=3.2, scale=1.0, **numerics):
    return ec.run(
        {
            "body1": {"young-modulus": E, "poisson-ratio": NU},
            "geometry": {"type": "sphere", "radius": RADIUS * scale},
            "grid": {"cells": cells, "size": [window * A * scale] * 2},
            "steps": {"normal-load": LOAD * scale**2},
            "inclusions": inclusions,
            "numerics": numerics,
            "output": {"pictures": False},
        }
    )


def pressure(*args, **more):
    return run(*args, **more).dataset["pressure"][-1].values / P0


# ---------------------------------------------------------------- cells larger than the inhomogeneity


@pytest.mark.parametrize("radius", [pytest.param(0.3, marks=slow), 0.15])
def test_cells_that_are_all_cut(radius):
    """No cell is whole: cells of 0.4 contact radii, four around the axis."""
    bare = pressure([], cells=10, window=4.0)
    found = pressure([ball(2.0, radius, 0.5)], cells=10, window=4.0, allow_coarse=True)
    assert found.sum() == close(bare.sum(), rel=1e-5)
    change = found[5, 5] / bare[5, 5] - 1
    # a ball far smaller than a cell acts by its volume alone
    assert 0.3 * radius**3 < change < 8 * radius**3


def test_balls_too_small_for_the_cells_are_refused():
    with pytest.raises(SceneError, match=r"must have at least 1 cell across its narrowest extent \(got 0.12 of"):
        run([ball(2.0, 0.02, 0.5)], cells=10)
    with pytest.raises(SceneError, match="fine enough to find 'sphere 1'"):
        run([ball(2.0, 0.02, 0.5)], cells=10, allow_coarse=True)


# ---------------------------------------------------------------- thin ligaments and extreme stiffness


@slow
@pytest.mark.parametrize(("ratio", "low", "high"), [(0.0, 0.1, 0.3), (1e6, 2.2, 3.5)])
def test_a_void_and_a_rigid_ball_a_twentieth_below_the_surface(ratio, low, high):
    """Their tops are 0.05 contact radii deep; the pressure above them settles as cells are refined."""
    results = [run([ball(ratio, 0.2, 0.25)], cells=cells) for cells in (17, 33, 49)]
    above = [float(r.dataset["pressure"][-1, n // 2, n // 2]) / P0 for r, n in zip(results, (17, 33, 49), strict=True)]
    assert all(low < one < high for one in above)
    assert abs(above[2] - above[1]) < abs(above[1] - above[0])
    for result in results:
        assert result.summary["coupling_residual"] <= 1e-6
        assert result.summary["coupling_iterations"] < 30


@slow
def test_rigid_cubes_and_balls_of_all_contrasts_keep_their_order():
    """The stiffer, the larger the pressure above; from 1e4 on all are rigid."""
    above = [pressure([ball(ratio, 0.3, 0.5)], cells=17)[8, 8] for ratio in (0.0, 1e-3, 0.1, 1.0, 10.0, 1e4, 1e6)]
    assert np.all(np.diff(above) > 0)
    assert above[1] == close(above[0], rel=0.02)
    assert above[6] == close(above[5], rel=1e-3)


# ---------------------------------------------------------------- overlap and numbers


@slow
def test_overlap_is_resolved_by_order():
    """A stiff ball with a hollow: the void comes later. The other way round the ball fills the hollow.

    Where a void is written, cells are solved as a whole, without it they are swept: alike to the tolerance.
    """
    stiff, hollow = ball(2.0, 0.4, 0.6), ball(0.0, 0.2, 0.6)
    cases = ([stiff, hollow], [hollow, stiff], [stiff])
    last, first, alone = (pressure(some, tolerance=1e-11)[8, 8] for some in cases)
    assert first == close(alone, rel=1e-9)
    assert last < 0.97 * alone


def swarm(count, layers, radius, spacing, ratio):
    places = (np.arange(count) - 0.5 * (count - 1)) * spacing
    return [
        ball(ratio, radius, 0.15 + spacing * layer, x, y) for layer in range(layers) for y in places for x in places
    ]


@slow
def test_two_thousand_balls_in_cells():
    """They take a quarter of the volume: stiffer by less than a body of which the same part is stiffer in series."""
    inclusions = swarm(20, 5, 0.08, 0.2, 2.0)
    assert len(inclusions) == 2000
    memory = PeakMemory()
    result = run(inclusions, cells=40, window=4.0)
    found = float(result.dataset["pressure"].max()) / P0
    assert 1.03 < found < 2.0 ** (2 / 3)
    assert result.summary["coupling_residual"] <= 1e-6
    assert (memory.peak() or 0) < 1.5e9


# ---------------------------------------------------------------- scale and precision


@slow
@pytest.mark.parametrize("scale", [1e-9 / A, 1.0 / A])
def test_nanometres_and_metres(scale):
    expected = pressure([ball(2.0, 0.2, 0.4)], cells=12)
    np.testing.assert_allclose(pressure([ball(2.0, 0.2, 0.4, scale=scale)], cells=12, scale=scale), expected, atol=1e-5)


@slow
@pytest.mark.parametrize("cells", [12, 120])
def test_single_precision(cells):
    """The larger grid leaves the solves within a round no digit to spare.

    A gap of the tolerance 1e-6, a part of the deflection, left in single cells of edge h changes their pressure by
    about E* δ / h times it: 1e-6 (π/2) a/h of the peak pressure.
    """
    double, single = (pressure([ball(2.0, 0.2, 0.4)], cells=cells, precision=name) for name in ("double", "single"))
    np.testing.assert_allclose(single, double, rtol=0, atol=1e-6 * 0.5 * np.pi * cells / 3.2)
    assert np.any(single != double)
