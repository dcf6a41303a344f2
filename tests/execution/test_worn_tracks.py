"""Geometries that travel over a body while either wears: the flat in a track, the geometry where it touches."""

import numpy as np
import pytest

import eigencontact as ec
from close import close
from eigencontact.execution.wear.state import WornState, carried
from execution.test_cycles import Stop, Stopped, same

#: Sphere of 200 um on steel under 12.307 N: contact radius [m], p0 [Pa]; worn volume by load and path [1/Pa].
A, LOAD = 20e-6, 12.307
P0, RATE = 1.5 * LOAD / (np.pi * A * A), 3e-13
CELL = 4e-6
MILD = 1e-18


def travelling(places, wear, **tables):
    """Results of the sphere, pressed at the first place and moved from there to each of the others."""
    return ec.run(scene(places, wear, **tables)).dataset


def scene(places, wear, **tables):
    places = [{"normal-load": LOAD, "travel-x": x, "increments": n} for x, n in places]
    return ec.load_scene(
        {
            "body1": {"young-modulus": 210e9, "poisson-ratio": 0.3},
            "body2": {"rigid": True},
            "geometry": {"type": "sphere", "radius": 200e-6},
            "grid": {"cells": [33, 17], "spacing": [CELL, CELL]},
            "wear": {"type": "archard", "coefficient": RATE, **wear},
            "steps": places,
            "output": {"pictures": False},
            **tables,
        }
    )


#: To and fro by 24 um each way, in cells.
STROKES = [(-6 * CELL, 1), (6 * CELL, 12), (-6 * CELL, 12)]


def in_place(distance, increments, wear):
    steps = [{"normal-load": LOAD}, {"normal-load": LOAD, "sliding-distance": distance, "increments": increments}]
    return travelling([], wear, steps=steps)


@pytest.mark.slow
def test_a_sphere_that_wears_alone_does_not_know_how_far_it_has_travelled():
    """On a flat that does not wear all places are alike; whole cells are passed."""
    wear = {"body": 2}
    moved = travelling([(-3 * CELL, 1), (3 * CELL, 6), (-3 * CELL, 6)], wear)
    still = in_place(12 * CELL, 12, wear)
    assert float(moved.worn_volume[-1]) == close(RATE * LOAD * 12 * CELL, rel=1e-5)
    assert float(still.max_worn_depth[-1]) > 0.1e-6  # of an approach of 2 um
    for name in ("max_worn_depth", "max_pressure", "worn_volume"):
        assert float(moved[name][-1]) == close(float(still[name][-1]), rel=1e-4)
    depth = moved.worn_depth_2.values[-1]
    np.testing.assert_allclose(np.roll(depth, 3, axis=1), still.worn_depth_2.values[-1], atol=1e-4 * depth.max())


def test_parts_of_cells_smear_what_is_worn_by_less_than_a_cell_and_keep_its_volume():
    wear = {"body": 2}
    moved = travelling([(-6.3 * CELL, 1), (6.1 * CELL, 12)], wear)
    still = in_place(12.4 * CELL, 12, wear)
    assert float(moved.worn_volume[-1]) == close(RATE * LOAD * 12.4 * CELL, rel=1e-5)
    assert float(moved.max_worn_depth[-1]) == close(float(still.max_worn_depth[-1]), rel=0.06)


@pytest.mark.slow
def test_a_flat_that_wears_alone_has_a_track_that_is_the_sum_of_the_passes():
    """Mild wear: below every pass the depth is the integral of Hertz's pressure along it, p0 π/2 (a² - y²)/a."""
    one = travelling(STROKES[:2], {"coefficient": MILD})
    two = travelling(STROKES, {"coefficient": MILD})
    pressed = two.pressure.values[1:]
    summed = MILD * CELL * np.sum(pressed, axis=0)
    np.testing.assert_allclose(two.worn_depth_1.values[-1], summed, atol=1e-4 * summed.max())
    middle = two.x.values.size // 2
    y = two.y.values
    expected = MILD * P0 * 0.5 * np.pi * np.clip(A * A - y * y, 0.0, None) / A
    np.testing.assert_allclose(one.worn_depth.values[-1][:, middle], expected, atol=0.03 * expected.max())
    # There and back, but for the two ends of the stroke.
    np.testing.assert_allclose(two.worn_depth.values[-1][:, middle], 2 * expected, atol=0.06 * expected.max())


def test_both_wear_each_in_its_own_place():
    """Half each: the sphere's spot moves with it, the flat's track stays."""
    data = travelling(STROKES[:2], {"shares": {"body1": 0.5, "body2": 0.5}, "coefficient": MILD})
    volume = float(data.worn_volume[-1])
    spot, track = (data[f"worn_depth_{body}"].values[-1] for body in (2, 1))
    assert [spot.sum() * CELL**2, track.sum() * CELL**2] == close([0.5 * volume] * 2, rel=1e-12)
    x = data.x.values
    assert float((spot.sum(axis=0) * x).sum() / spot.sum()) == close(6 * CELL, abs=0.02 * CELL)
    assert float((track.sum(axis=0) * x).sum() / track.sum()) == close(0.5 * CELL, abs=0.02 * CELL)
    np.testing.assert_allclose(data.worn_depth.values[-1], spot + track, atol=1e-12 * spot.max())


@pytest.mark.slow
@pytest.mark.parametrize(
    "shares",
    [{"body1": 1.0}, {"body2": 1.0}, {"body1": 0.5, "body2": 0.5}],
)
def test_cycles_that_are_skipped_wear_each_body_in_its_own_place(shares):
    """Mild wear is the same from cycle to cycle."""
    there = [{"normal-load": LOAD, "travel-x": x, "increments": 2} for x in (2 * CELL, -2 * CELL)]
    start = {"normal-load": LOAD, "travel-x": -2 * CELL}

    def after(**wear):
        wear = {"shares": shares, "coefficient": 1e-3 * MILD, "update": "increment", **wear}
        return travelling([], wear, steps=[start, {"cycle": there, "repeat": 10}])

    skipped, solved = after(**{"cycles-per-update": 4}), after(**{"cycles-per-update": 1})
    assert skipped.sizes["step"] < 0.6 * solved.sizes["step"]
    assert float(skipped.worn_volume[-1]) == close(float(solved.worn_volume[-1]), rel=1e-5)
    assert float(skipped.cycles[-1]) == 10
    for name in ("worn_depth", *(f"worn_depth_{body[-1]}" for body in shares)):
        found, known = skipped[name].values[-1], solved[name].values[-1]
        np.testing.assert_allclose(found, known, atol=2e-4 * known.max())


@pytest.mark.slow
def test_a_run_that_ends_on_the_track_is_resumed_to_the_bit(tmp_path):
    """What body 2 has lost is known from stored records alone, between cells too; so is the way to skipped cycles."""
    there = [{"normal-load": LOAD, "travel-x": x, "increments": 2} for x in (1.7 * CELL, -2.1 * CELL)]
    wear = {"shares": {"body1": 0.3, "body2": 0.7}, "coefficient": MILD, "update": "increment", "cycles-per-update": 4}
    planned = scene([], wear, steps=[{"normal-load": LOAD}, {"cycle": there, "repeat": 9}])
    with pytest.raises(Stopped):
        ec.run(planned, tmp_path / "out", watcher=Stop(11))
    same(ec.run(planned, tmp_path / "out", resume=True).dataset, ec.run(planned).dataset)


def test_what_is_carried_keeps_its_sum_and_comes_back_by_the_adjoint():
    rng = np.random.default_rng(0)
    one, other = rng.random((2, 5, 7))
    for cells in ((0.0, 0.0), (2.0, -3.0), (1.3, -0.6), (-8.25, 11.5)):
        there, back = carried(one, cells), carried(other, (-cells[0], -cells[1]))
        assert there.sum() == close(one.sum(), rel=1e-14)
        assert (there * other).sum() == close((one * back).sum(), rel=1e-14)
        assert there.min() >= 0


def test_volume_is_kept_wherever_body_2_is():
    state = WornState(depth={1: np.zeros((6, 6)), 2: np.zeros((6, 6))}, energy=np.zeros((6, 6)), cells=(1.4, 0.7))
    added = np.random.default_rng(1).random((6, 6))
    state.wear(added, {1: 0.25, 2: 0.75})
    assert [state.total.sum(), state.sum_of_depths.sum()] == close([added.sum()] * 2, rel=1e-14)
