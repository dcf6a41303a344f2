"""Scenes from files, names, mappings and Python objects; changes with --set; units."""

import tomllib

import pytest
import tomli_w

from close import close
from eigencontact import EigencontactError, Scene, load_scene, make
from eigencontact.scene.loader import apply_changes, bundled_names, bundled_text


def small(**changes):
    tables = {
        "body1": {"young-modulus": "210 GPa", "poisson-ratio": 0.3},
        "geometry": {"type": "sphere", "radius": "105 um"},
        "steps": {"normal-load": "0.65 N"},
    }
    return tables | changes


def test_a_python_scene_equals_the_file(scene_file):
    path = scene_file('[[observers]]\ntype = "probe"\npoints = [[0.0, "1 um"]]')
    scene = Scene(
        name="small",
        body1={"young_modulus": 210e9, "poisson_ratio": 0.3},
        geometry=make("sphere", radius=105e-6),
        grid={"cells": [24, 24], "size": (16e-6, 16e-6)},
        steps=[{"normal_load": 0.65}],
        numerics={"threads": 1},
        output={"pictures": False},
        observers=[{"type": "probe", "points": [[0.0, "1 um"]]}],
    )
    loaded = load_scene(path)
    assert scene.body1 == loaded.body1
    assert scene.grid == loaded.grid
    assert scene.steps == loaded.steps
    assert (scene.numerics, scene.stress, scene.output) == (loaded.numerics, loaded.stress, loaded.output)
    from eigencontact import plan

    assert plan(scene).model.interface.geometries == plan(loaded).model.interface.geometries
    assert plan(scene).model.observers == plan(loaded).model.observers
    assert plan(scene).grid == plan(loaded).grid


@pytest.mark.parametrize("name", bundled_names())
def test_the_resolved_scene_loads_as_the_same_scene(name):
    scene = load_scene(name)
    again = load_scene(tomllib.loads(tomli_w.dumps(scene.resolved())))
    assert again == scene


@pytest.mark.parametrize("name", bundled_names())
def test_bundled_scenes_say_what_they_show(name):
    scene = load_scene(name)
    assert scene.name == name
    assert 20 < len(scene.title) < 100
    assert len(scene.description.split()) > 20


def test_snake_and_kebab_case_are_the_same():
    kebab, snake = small(), small(body1={"young_modulus": "210 GPa", "poisson_ratio": 0.3})
    assert load_scene(kebab) == load_scene(snake)


@pytest.mark.parametrize(
    ("text", "value"),
    [("0.65 N", 0.65), ("650 mN", 0.65), (0.65, 0.65), ("6.5e-4 kN", 0.65), ("0.65 kg m/s^2", 0.65)],
)
def test_loads_with_units(text, value):
    load = load_scene(small(steps={"normal-load": text})).steps[0].normal_load
    assert load == close(value, rel=1e-15)


def test_angles_and_moments_with_units():
    step = load_scene(small(steps={"approach": "1 um", "tilt-x": "90 deg", "moment-y": "2 N*mm"})).steps[0]
    assert step.tilt_x == close(1.5707963267948966, rel=1e-15)
    assert step.moment_y == close(2e-3, rel=1e-15)


def test_a_bare_number_of_cells_is_square():
    assert load_scene(small(grid={"cells": 5, "spacing": [1e-6, 2e-6]})).grid.cells == (5, 5)


def test_auto_is_the_default_grid():
    assert load_scene(small(grid="auto")) == load_scene(small())
    assert load_scene(small()).grid.automatic


@pytest.mark.parametrize(
    ("change", "path", "value"),
    [
        ("steps.normal-load=2 N", ("steps", 0, "normal-load"), "2 N"),
        ("steps.0.normal_load=3", ("steps", 0, "normal-load"), 3),
        ("stress.1.body=2", ("stress", 1, "body"), 2),
        ("stress=[]", ("stress",), []),
        ("grid.cells=[3, 4]", ("grid", "cells"), [3, 4]),
        ("numerics.precision=single", ("numerics", "precision"), "single"),
        ('numerics.precision="single"', ("numerics", "precision"), "single"),
        ("output.vtk=true", ("output", "vtk"), True),
        ("title=a = b", ("title",), "a = b"),
        ("grid.size=auto", ("grid", "size"), "auto"),
    ],
)
def test_changes(change, path, value):
    tables = {"steps": [{"normal-load": 1.0}], "stress": [{"body": 1}, {"body": 1}], "grid": "auto"}
    before = repr(tables)
    found = apply_changes(tables, [change])
    for part in path:
        found = found[part]
    assert found == value
    assert type(found) is type(value)
    assert repr(tables) == before


def test_later_changes_win():
    assert load_scene("hertz", ["steps.normal-load=1", "steps.normal-load=2"]).steps[0].normal_load == 2.0


def test_a_scene_object_can_be_changed():
    scene = load_scene(load_scene("hertz"), ["body1.poisson-ratio=0.4"])
    assert scene.body1.poisson_ratio == 0.4
    assert load_scene(scene) is scene


def test_relative_files_count_from_the_scene(scene_file, tmp_path, monkeypatch):
    import numpy as np

    from eigencontact import plan

    np.savez(tmp_path / "flat.npz", heights=np.zeros((4, 6)), dx=1e-6, dy=1e-6)
    path = scene_file(geometry='type = "topography"\nfile = "flat.npz"')
    monkeypatch.chdir("/")
    grid = plan(load_scene(path, ["grid=auto"])).grid
    assert (grid.nx, grid.ny) == (6, 4)


def test_a_scene_cannot_be_altered_in_place():
    with pytest.raises(ValueError, match="frozen"):
        load_scene("hertz").body1.poisson_ratio = 0.1


def test_labels_come_from_the_title_where_there_is_no_name():
    assert load_scene(small(title="Ball on steel, no. 3")).label == "ball-on-steel-no-3"
    assert load_scene(small()).label == "scene"


def test_unknown_bundled_text():
    with pytest.raises(EigencontactError, match=r"scene 'herz'; did you mean 'hertz'\?; `eigencontact gallery`"):
        bundled_text("herz")


def test_impacts_are_written_out():
    """Moved without load where the load is a ramp of several increments; the same places for more of them."""
    steps = [{"normal_load": 1.0, "increments": 2, "impacts": {"count": 3, "seed": 4, "size": [2e-6, 1e-6]}}]
    given = {"body1": {"young_modulus": 1e9, "poisson_ratio": 0.3}, "geometry": {"type": "sphere", "radius": 1e-3}}
    scene = Scene(**given, steps=steps)
    assert [(step.normal_load, step.increments) for step in scene.steps] == [(0.0, 1), (1.0, 2), (0.0, 1)] * 3
    places = [(step.travel_x, step.travel_y) for step in scene.steps]
    assert len(set(places)) == 3
    assert all(abs(x) <= 1e-6 and abs(y) <= 0.5e-6 for x, y in places)
    assert places[0] == places[1] == places[2]
    steps[0]["impacts"]["count"] = 5
    assert [(step.travel_x, step.travel_y) for step in Scene(**given, steps=steps).steps][:9] == places
    assert Scene(**scene.resolved()) == scene
    with pytest.raises(EigencontactError, match="impacts and normal-load, and nothing else"):
        Scene(**given, steps=[{**steps[0], "travel_x": 1e-6}])
