"""A geometry that rolls along the surface without friction: the contact moves with it and stays the same."""

import numpy as np
import pytest

import eigencontact as ec
from close import close
from eigencontact.viz.style import save

BODY = {"young_modulus": "210 GPa", "poisson_ratio": 0.3}
BALL = {"type": "sphere", "radius": "105 um"}
LOAD = "0.65 N"
#: Window of whole cells of 0.5 um, and a travel of whole cells.
GRID = {"cells": [96, 48], "spacing": ["0.5 um", "0.5 um"]}


def scene(*steps, grid=GRID, **more):
    return ec.Scene(body1=BODY, geometry=BALL, grid=grid, steps=list(steps), **more)


def test_contact_is_carried_along():
    ramp = {"normal_load": LOAD, "travel_x": "8 um", "increments": 4}
    with ec.run(scene({"normal_load": LOAD, "travel_x": "-8 um"}, ramp)).dataset as found:
        assert found["travel_x"].values == close(np.array([-8, -4, 0, 4, 8]) * 1e-6)
        pressure = found["pressure"].values
        reference = found["reference_pressure"].values
    for number, cells in enumerate((-16, -8, 0, 8, 16)):
        moved = np.roll(pressure[2], cells, axis=1)
        assert np.abs(pressure[number] - moved).max() <= 1e-5 * pressure.max()
        assert np.linalg.norm(pressure[number] - reference[number]) <= 0.03 * np.linalg.norm(reference[number])
    # the path is along x: mirror images of each other at both ends
    assert np.abs(pressure[0] - pressure[4][:, ::-1]).max() <= 1e-5 * pressure.max()


def test_place_is_kept_by_steps_that_do_not_mention_it():
    steps = [{"normal_load": LOAD, "travel_y": "2 um"}, {"normal_load": "0.1 N"}]
    with ec.run(scene(*steps)).dataset as found:
        assert found["travel_y"].values == close([2e-6, 2e-6])
        y = found["y"].values
        weights = found["pressure"].values.sum(axis=2)
    assert (weights @ y) / weights.sum(axis=1) == close([2e-6, 2e-6], abs=1e-9)


def test_automatic_window_holds_the_whole_path():
    steps = [{"normal_load": LOAD, "travel_x": "-9 um"}, {"normal_load": LOAD, "travel_x": "21 um"}]
    grid = ec.plan(scene(*steps, grid={"cells_per_contact_radius": 12})).grid
    still = ec.plan(scene(steps[0], grid={"cells_per_contact_radius": 12})).grid
    assert grid.dx == close(still.dx, rel=1e-6)
    assert grid.center == close((6e-6, 0.0), abs=2 * grid.dx)
    assert grid.size[0] >= 30e-6 + 2 * 6.05e-6
    assert grid.size[1] == close(still.size[1], rel=1e-6)


def test_scene_without_travel_stores_no_place():
    with ec.run(scene({"normal_load": LOAD}, grid={"cells_per_contact_radius": 8})).dataset as found:
        assert "travel_x" not in found


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ({"friction": {"type": "coulomb", "coefficient": 0.1}}, "steps must not move the geometry .* friction"),
        ({"numerics": {"boundary": "periodic"}}, "steps must not move the geometry .* periodic"),
    ],
)
def test_travel_is_refused_where_it_has_no_meaning(more, words):
    with pytest.raises(ec.EigencontactError, match=words):
        scene({"normal_load": LOAD, "travel_x": "1 um"}, **more)


@pytest.mark.slow
def test_picture_of_the_passing(tmp_path, monkeypatch):
    def save_passing(figure, path, *options):
        if path.name == "passing.png":
            save(figure, path, *options)

    monkeypatch.setattr("eigencontact.viz.figures.save", save_passing)
    points = {"shape": "points", "points": [[0, 0, "3 um"], ["4 um", 0, "3 um"]]}
    ramp = {"normal_load": LOAD, "travel_x": "8 um", "increments": 4}
    case = scene({"normal_load": LOAD, "travel_x": "-8 um"}, ramp, stress=[points])
    ec.run(case, tmp_path / "run").dataset.close()
    assert (tmp_path / "run" / "passing.png").stat().st_size > 10_000
    with ec.open_results(tmp_path / "run") as found:
        mises = found["points_body1_von_mises"].values
    # the load is nearest to each point when it is above it, and passes both alike
    assert mises.argmax(axis=0).tolist() == [2, 3]
    assert mises[2, 0] == close(mises[3, 1], rel=1e-5)
