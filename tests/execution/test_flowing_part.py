"""Sweeps over the part of a box that flows: the same results as over the whole box, and nothing outside is missed."""

import numpy as np
import pytest

import eigencontact as ec
from eigencontact.execution.interiors.swept_cells import SweptCells
from eigencontact.solvers import flowing_part
from eigencontact.solvers.flowing_part import FlowingPart

TOLERANCE = 1e-8
RESULTS = ("pressure", "plastic_strain_1", "equivalent_plastic_strain_1", "residual_displacement_z")


def pressed(grid, geometry, loads, **more):
    law = {"type": "j2", "hardening": {"type": "linear", "yield-stress": "500 MPa", "modulus": "5 GPa"}}
    return ec.load_scene(
        {
            "body1": {"young-modulus": "210 GPa", "poisson-ratio": 0.3, "law": law},
            "body2": {"rigid": True},
            "geometry": geometry,
            "grid": grid,
            "steps": [{"normal-load": load, "increments": 2} for load in loads],
            "numerics": {"tolerance": TOLERANCE, "threads": 1, **more},
            "output": {"pictures": False},
        }
    )  # fmt: skip


def cylinder():
    """Twice the load of first yield, away, and four times that load."""
    line = {"length": "infinite", "cells": 64, "size": "1 mm"}
    loads = ["250 N/mm", "0 N/mm", "400 N/mm"]
    return pressed(line, {"type": "cylinder", "radius": "10 mm"}, loads)


def ball():
    return pressed({"cells": 24, "size": "0.25 mm"}, {"type": "sphere", "radius": "2 mm"}, ["8 N", "16 N", "0 N"])


@pytest.fixture
def parts(monkeypatch):
    """Parts in boxes of any size; the windows that were chosen, and the sweeps over them."""
    noted = {"windows": [], "sweeps": 0}
    follow, sweep = FlowingPart.follow, FlowingPart.sweep

    def following(part, active):
        before = part.window
        follow(part, active)
        if part.window is not None and part.window is not before:
            noted["windows"].append(part.window)

    def sweeping(part, *given):
        noted["sweeps"] += 1
        return sweep(part, *given)

    monkeypatch.setattr(flowing_part, "_FEWEST", 0)
    monkeypatch.setattr(FlowingPart, "follow", following)
    monkeypatch.setattr(FlowingPart, "sweep", sweeping)
    return noted


def whole(scene, monkeypatch):
    with monkeypatch.context() as patch:
        patch.setattr(flowing_part, "_FEWEST", np.inf)
        return ec.run(scene).dataset


def assert_same(found, expected):
    for name in RESULTS:
        largest = float(np.abs(expected[name]).max())
        np.testing.assert_allclose(found[name], expected[name], rtol=0, atol=2e-6 * largest, err_msg=name)
    assert float(found["law_residual"].max()) < 1e-6


@pytest.mark.parametrize("scene", [cylinder, pytest.param(ball, marks=pytest.mark.slow)])
def test_a_part_gives_the_results_of_the_whole_box_in_as_many_rounds(scene, parts, monkeypatch):
    expected = whole(scene(), monkeypatch)
    assert parts["sweeps"] == 0
    found = ec.run(scene()).dataset
    assert parts["sweeps"] > 10
    assert_same(found, expected)
    rounds = [float(data["coupling_iterations"].sum()) for data in (found, expected)]
    assert rounds[0] <= rounds[1] + 3


@pytest.mark.slow
def test_cells_that_begin_to_flow_outside_are_found_by_the_last_sweep_alone(parts, monkeypatch):
    """Margins of one cell, and rims not looked at: only the sweep that confirms an increment extends a window."""
    expected = whole(cylinder(), monkeypatch)
    monkeypatch.setattr(flowing_part, "_MARGIN", 0.0)
    monkeypatch.setattr(FlowingPart, "_reaches_rim", lambda *_: False)
    found = ec.run(cylinder()).dataset
    sizes = [np.prod([span.stop - span.start for span in window]) for window in parts["windows"]]
    assert len(sizes) >= 3
    assert sizes[-1] > 2 * sizes[0]
    assert_same(found, expected)


def test_an_increment_is_accepted_by_a_sweep_over_the_whole_box_only(parts, monkeypatch):
    """The last image of each increment is that of the whole box: its memory is what the increment leaves."""
    images, image = [], SweptCells.image

    def noting(cells, tractions, tolerance):
        before = parts["sweeps"], cells._sweeps.applications, id(cells._after)
        answer = image(cells, tractions, tolerance)
        images.append((cells._time, max(answer[1], tolerance) <= TOLERANCE, id(cells._after) != before[2]))
        return answer

    monkeypatch.setattr(SweptCells, "image", noting)
    ec.run(cylinder())
    assert sum(not whole for _, _, whole in images) > 10
    assert all(whole for _, holds, whole in images if holds)
    ends = [here for here, after in zip(images, [*images[1:], (None, True, True)], strict=True) if here[0] != after[0]]
    assert len(ends) == 7  # the rest state and six increments
    assert all(holds and whole for _, holds, whole in ends)


def part_of(shape):
    return FlowingPart(shape, lambda window: window, lambda cells: cells)


def test_a_window_follows_what_flows_and_never_shrinks(monkeypatch):
    monkeypatch.setattr(flowing_part, "_FEWEST", 0)
    part, active = part_of((20, 1, 40)), np.zeros((20, 1, 40), dtype=bool)
    part.follow(active)
    assert part.window is None
    active[4:8, 0, 10:21] = True
    part.follow(active)
    assert part.window == (slice(3, 9), slice(0, 1), slice(8, 23))
    active[:, 0, 12:] = False
    part.follow(active)
    assert part.window == (slice(3, 9), slice(0, 1), slice(8, 23))
    active[3, 0, 12] = True  # the rim: neighbours outside come next
    part.follow(active)
    assert part.window[0] == slice(2, 9)
    active[:] = True  # more than half of the box
    part.follow(active)
    assert part.window is None
    active[1:] = False
    part.follow(active)
    assert part.window is None


def test_the_rim_of_the_box_itself_is_no_rim(monkeypatch):
    monkeypatch.setattr(flowing_part, "_FEWEST", 0)
    part, active = part_of((20, 1, 40)), np.zeros((20, 1, 40), dtype=bool)
    active[:5, 0, :10] = True  # in the corner of the box
    part.follow(active)
    assert part.window == (slice(0, 6), slice(0, 1), slice(0, 12))
    assert not part._reaches_rim(active[part.window])
    active[5] = active[4]
    assert part._reaches_rim(active[part.window])
