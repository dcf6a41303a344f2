"""Pictures of histories: what changes is drawn from the unloaded start, what stays as it is is left out."""

from pathlib import Path

import numpy as np
import pytest
from matplotlib.colors import to_rgb

import eigencontact as ec
from bodies import STEEL
from close import close
from eigencontact.viz.figures import draw_all
from eigencontact.viz.history import Strand, draw_strands, first_touch, history_panels, history_words, load_history
from eigencontact.viz.rolling import passes, passing_history
from eigencontact.viz.style import new_figure
from viz.test_figures import overlaps

RADIUS = 200e-6


def scene(**more):
    return {
        "body1": STEEL, "body2": {"rigid": True}, "geometry": {"type": "sphere", "radius": RADIUS},
        "grid": {"cells": [24, 16], "spacing": [3e-6, 3e-6]}, "numerics": {"allow_coarse": True}, **more,
    }  # fmt: skip


@pytest.fixture(scope="module")
def runs():
    """Runs on few cells by name."""
    scenes = {
        "loaded": scene(steps=[{"normal_load": 3.0, "increments": 3}, {"normal_load": 1.0}]),
        "approached": scene(steps=[{"approach": 0.6e-6, "increments": 3}]),
        "tilted": scene(
            geometry={"type": "rounded-punch", "flat_radius": 18e-6, "edge_radius": 1e-3},
            steps=[{"normal_load": 0.1}, {"normal_load": 0.1, "moment_y": 2e-7, "increments": 2}],
        ),
        "rolled": scene(
            steps=[
                {"normal_load": 3.0, "travel_x": -9e-6},
                {"normal_load": 3.0, "travel_x": 9e-6, "increments": 3},
                {"normal_load": 3.0, "travel_x": -9e-6, "increments": 3},
                {"normal_load": 0.0, "travel_x": -9e-6},
                {"normal_load": 3.0, "travel_x": -9e-6},
                {"normal_load": 3.0, "travel_x": 9e-6, "increments": 3},
            ],
            stress=[{"name": "spot", "shape": "points", "points": [[0.0, 0.0, 6e-6]]}],
        ),
        "worn": scene(
            wear={"type": "archard", "coefficient": 1e-15},
            steps=[{"approach": 0.6e-6}, {"approach": 0.6e-6, "sliding_distance": 0.5, "increments": 3}],
        ),
    }
    known = {}

    def run(name):
        if name not in known:
            known[name] = ec.run(scenes[name]).dataset
        return known[name]

    return run


@pytest.fixture
def drawn(runs, monkeypatch):
    """Names of the pictures of a run."""
    monkeypatch.setattr("eigencontact.viz.figures.save", lambda *_: None)
    return lambda name: set(draw_all(runs(name), Path()))


def test_load_over_approach_begins_at_the_first_touch(runs):
    """Cells lie half a cell from the tip of the sphere: the first touch is that high."""
    dataset = runs("loaded")
    x, y = (float(np.abs(dataset[axis].values).min()) for axis in "xy")
    assert first_touch(dataset) == close((x**2 + y**2) / (2 * RADIUS), abs=1e-15)
    left, right = load_history(dataset).axes
    curve = left.get_lines()[0]
    assert left.get_xlabel() == "Approach [nm]"
    assert 1e-9 * curve.get_xdata() == close([first_touch(dataset), *dataset["approach"].values], abs=1e-15)
    assert curve.get_ydata() == close([0.0, 1.0, 2.0, 3.0, 1.0], rel=1e-6, abs=1e-12)
    assert left.get_xlim()[0] == left.get_ylim()[0] == right.get_xlim()[0] == right.get_ylim()[0] == 0.0
    assert history_words(history_panels(dataset)) == "Normal load over approach and contact area over normal load."


@pytest.mark.slow
def test_a_prescribed_constant_is_no_axis(runs, drawn):
    """An approach that is held while the body wears: the load falls along the path of sliding."""
    dataset = runs("worn")
    (panel,) = history_panels(dataset)
    assert (panel.x.words, panel.y.words) == ("Sliding distance", "Normal load")
    assert panel.y.values[-1] < 0.9 * panel.y.values[0]
    assert "history.png" in drawn("worn")
    constant = dataset.assign(normal_load=0.0 * dataset["normal_load"] + 1.0)
    assert history_panels(constant) == []


def test_an_area_that_changes_by_few_cells_is_left_out(runs):
    dataset = runs("tilted")
    assert np.ptp(dataset["contact_area"].values) < np.sqrt(np.pi * float(dataset["contact_area"][0]) * 9e-12)
    (panel,) = history_panels(dataset)
    assert (panel.x.words, panel.y.words) == ("Tilt about y", "Moment about y")
    assert len(load_history(dataset).axes) == 1


def test_passes_end_at_turns_and_lifts():
    place = np.array([0.0, 1, 2, 1, 0, 0, 0, 1, 2, 2])
    pressed = np.array([1, 1, 1, 1, 1, 0, 1, 1, 1, 0], dtype=bool)
    ends = [(run.first, run.last, run.number) for run in passes(place, pressed)]
    assert ends == [(0, 2, 1), (2, 4, 2), (6, 8, 3)]


def test_passes_have_colours_and_names_and_no_step_without_contact(runs, drawn):
    dataset = runs("rolled")
    assert "passing.png" in drawn("rolled")
    assert "history.png" not in drawn("rolled")
    figure = passing_history(dataset)
    left, right, bar = figure.axes
    curves = [line.get_xdata() for line in left.get_lines()]
    assert [curve[[0, -1]].round(6).tolist() for curve in curves] == [[-9, 9], [9, -9], [-9, 9]]
    assert len({line.get_color() for line in left.get_lines()}) == 3
    assert all(line.get_ydata().min() > 0 for line in left.get_lines())
    assert left.get_xlabel() == "Position of the moving body along x [µm]"
    assert bar.get_ylabel() == "Pass"
    assert [text.get_text() for text in figure.legends[0].get_texts()] == ["spot, at (x, y, z) = (0, 0, 6) µm"]
    assert right.get_title() == "Stress at fixed points of the body"
    assert left.get_ylim()[0] == 0.0  # the body is the same everywhere: no zoom into the noise of the cells
    assert overlaps(figure) == []


def test_passes_over_a_body_that_is_the_same_everywhere_are_left_out(runs, monkeypatch):
    monkeypatch.setattr("eigencontact.viz.figures.save", lambda *_: None)
    dataset = runs("rolled")
    attrs = {**dataset.attrs, "regions": "{}"}
    assert "passing.png" not in draw_all(dataset.assign_attrs(attrs), Path())


@pytest.mark.parametrize(("numbers", "scale"), [([1, 2, 3, 4, 10, 30], "log"), ([1, 2, 3, 4, 5], "linear")])
def test_early_cycles_have_colours_that_differ(numbers, scale):
    """Cycles chosen at even ratios: on a linear scale the first ones would look alike."""
    figure = new_figure(4, 3)
    strands = [Strand(n, n + 1, number) for n, number in enumerate(numbers)]
    x = np.arange(len(numbers) + 1.0)
    draw_strands(figure, figure.add_subplot(), x, x, strands, "Cycle")
    lines, bar = figure.axes[0].get_lines(), figure.axes[1]
    assert bar.get_yscale() == scale
    colours = np.array([to_rgb(line.get_color()) for line in lines])
    assert np.linalg.norm(np.diff(colours, axis=0), axis=1).min() > 0.08
    ticks = [float(label.get_text()) for label in bar.get_yticklabels()]
    assert ticks[-1] == numbers[-1]
    assert set(ticks) <= set(numbers)
