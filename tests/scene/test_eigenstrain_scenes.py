"""Scenes with inclusions and eigenstrain: what may be written, and what is refused in which words."""

import tomllib
from pathlib import Path

import numpy as np
import pytest
import tomli_w

from bodies import STEEL_TABLE as STEEL
from close import close
from eigencontact import EigencontactError, load_scene, make, plan
from one_line import one_line_error

BALL = {"type": "sphere", "center": [0.0, 0.0, "2 um"], "radius": "1 um", "eigenstrain": 1e-3}
GRID = {"cells": 8, "size": ["8 um", "8 um"]}


def scene(**changes):
    tables = {"body1": STEEL, "inclusions": [BALL], "grid": GRID} | changes
    return {name: table for name, table in tables.items() if table is not None}


def ball(**changes):
    return {name: value for name, value in (BALL | changes).items() if value is not None}


@pytest.mark.parametrize(
    ("value", "mandel"),
    [
        (1e-3, [1e-3, 1e-3, 1e-3, 0, 0, 0]),
        ([1e-3, 2e-3, -1e-3], [1e-3, 2e-3, -1e-3, 0, 0, 0]),
        ([[1.0, 2, 3], [2, 4, 5], [3, 5, 6]], [1, 4, 6, 5 * 2**0.5, 3 * 2**0.5, 2 * 2**0.5]),
        ({"type": "uniform", "value": 1e-3}, [1e-3, 1e-3, 1e-3, 0, 0, 0]),
        ({"type": "thermal", "expansion": "1e-5 / K", "temperature": "100 K"}, [1e-3, 1e-3, 1e-3, 0, 0, 0]),
    ],
)
def test_spellings_of_an_eigenstrain(value, mandel):
    (source,) = plan(scene(inclusions=ball(eigenstrain=value))).model.sources
    np.testing.assert_allclose(source.uniform_eigenstrain(1.0), mandel, rtol=1e-15)
    assert source.exact


def test_python_objects_and_arrays_are_tables_too():
    sphere = make("sphere", kind="inclusion-shape", center=(0.0, 0.0, 2e-6), radius=1e-6)
    field = make("uniform", value=1e-3)
    expected = plan(scene()).model.sources[0]
    for item in (
        {"type": sphere, "eigenstrain": 1e-3},
        ball(eigenstrain=field),
        ball(eigenstrain=np.full(3, 1e-3), center=np.array([0, 0, 2e-6])),
        ball(eigenstrain=1e-3 * np.eye(3)),
    ):
        (source,) = plan(scene(inclusions=[item])).model.sources
        assert source.shape == expected.shape
        np.testing.assert_array_equal(source.uniform_eigenstrain(1.0), expected.uniform_eigenstrain(1.0))


def test_the_resolved_scene_loads_as_the_same_scene():
    patch = {"type": "peened-layer", "peak": 1e-3, "peak-depth": 0.0, "width": "1 um", "depth": "3 um", "layers": 4}
    first = load_scene(scene(eigenstrain=patch, steps={"increments": 3}))
    assert load_scene(tomllib.loads(tomli_w.dumps(first.resolved()))) == first


def test_a_scene_without_contact_has_one_step_unless_told():
    assert plan(scene()).steps == 1
    assert plan(scene(steps=[{"increments": 2}, {}])).steps == 3


def test_many_of_a_kind_at_centers():
    planned = plan(scene(inclusions=ball(center=None, centers=[[0.0, 0.0, "2 um"], ["3 um", 0.0, "4 um"]])))
    assert [source.shape.center for source in planned.model.sources] == [(0.0, 0.0, 2e-6), (3e-6, 0.0, 4e-6)]
    assert [source.name for source in planned.model.sources] == ["sphere 1, 1", "sphere 1, 2"]


def test_centers_are_places_whatever_a_shape_calls_them():
    wedge = str(Path(__file__).parents[1] / "plugins" / "wedge.off")
    shape = {"type": "polyhedron", "file": wedge, "scale": "1 um", "eigenstrain": 1e-3}
    planned = plan(scene(inclusions={**shape, "centers": [[0.0, 0.0, "2 um"], ["3 um", 0.0, "4 um"]]}))
    assert [source.shape.offset for source in planned.model.sources] == [(0.0, 0.0, 2e-6), (3e-6, 0.0, 4e-6)]
    with pytest.raises(EigencontactError, match=r"inclusions must be at its offset, or at centers \(got both\)"):
        plan(scene(inclusions={**shape, "offset": [0, 0, 1e-6], "centers": [[0.0, 0.0, "2 um"]]}))


def test_relative_files_of_eigenstrain_count_from_the_scene(tmp_path, monkeypatch):
    axis = np.linspace(-1e-6, 4e-6, 3)
    np.savez(tmp_path / "field.npz", x=axis, y=axis, z=axis, eigenstrain=np.ones((3, 3, 3)))
    tables = scene(inclusions=ball(eigenstrain={"type": "from-file", "file": "field.npz"}))
    (tmp_path / "my.toml").write_text(tomli_w.dumps(tables), encoding="utf-8")
    monkeypatch.chdir("/")
    loaded = load_scene(tmp_path / "my.toml")
    assert loaded.resolved()["inclusions"][0]["eigenstrain"]["file"] == str(tmp_path / "field.npz")
    assert plan(loaded).scene.inclusions[0].eigenstrain["file"] == str(tmp_path / "field.npz")


def test_automatic_grids_follow_the_inclusions():
    grid = plan(scene(grid=None)).grid
    assert grid.center == (0.0, 0.0)
    assert (grid.nx, grid.ny) == (128, 128)
    assert grid.size[0] == close(2e-6 + 4 * 2e-6, rel=1e-12)
    off = plan(scene(grid=None, inclusions=[ball(center=["9 um", "1 um", "2 um"]), ball()])).grid
    assert off.center == close((4.5e-6, 0.5e-6))
    assert off.nx == 128
    assert off.ny < 128
    assert off.dx == off.dy


@pytest.mark.parametrize(("depth", "space"), [("1 um", "exact"), ("0.2 um", "full-space"), ("-3 um", "full-space")])
def test_shapes_may_touch_the_surface_and_cross_it_in_full_space(depth, space):
    inclusion = ball(center=[0, 0, depth])
    assert plan(scene(inclusions=inclusion, numerics={"half-space": space})).model.sources


PATCH = {"type": "peened-layer", "peak": 1e-3, "peak-depth": "1 um", "width": "1 um", "depth": "3 um"}
CONTACT = {"geometry": {"type": "sphere", "radius": "105 um"}, "steps": {"normal-load": "0.1 N"}}

REFUSED = {
    "nothing at all": ({"inclusions": []}, "the scene must have a geometry, inclusions or eigenstrain (got none"),
    "a load on nothing": (
        {"steps": {"normal-load": "1 N"}},
        "steps must not prescribe normal-load without a contact (got no geometry); add [geometry]",
    ),
    "a moment on nothing": ({"steps": [{}, {"tilt-x": 0.1}]}, "steps.1 must not prescribe tilt-x without a contact"),
    "a geometry without load": (
        {"geometry": CONTACT["geometry"], "steps": {}},
        "steps must be controlled by normal-load or approach: give one of them (got neither)",
    ),
    "a geometry without steps": ({"geometry": CONTACT["geometry"]}, "steps must be given"),
    "periodic": (
        {"numerics": {"boundary": "periodic"}},
        "numerics.boundary must be 'non-periodic' in a scene with inclusions or eigenstrain (got 'periodic')",
    ),
    "in a rigid body": ({"inclusions": [ball(body=2)]}, "inclusions.0 must lie in an elastic body (got a rigid body2)"),
    "a patch in a rigid body": (
        {"inclusions": [], "eigenstrain": PATCH | {"body": 2}},
        "eigenstrain.0 must lie in an elastic body (got a rigid body2)",
    ),
    "no eigenstrain": ({"inclusions": [ball(eigenstrain=None)]}, "inclusions.0 must be given an eigenstrain"),
    "two numbers": ({"inclusions": [ball(eigenstrain=[1, 2])]}, "eigenstrain must be a number, three, a symmetric 3 x"),
    "text": ({"inclusions": [ball(eigenstrain="big")]}, "eigenstrain must be a number, three, a symmetric 3 x"),
    "a table without type": ({"inclusions": [ball(eigenstrain={"value": 1.0})]}, 'or a table { type = "...", ... }'),
    "not symmetric": (
        {"inclusions": [ball(eigenstrain=[[0, 1, 0], [0, 0, 0], [0, 0, 0]])]},
        "inclusions.eigenstrain.value must be a number, three numbers or a symmetric 3 x 3 matrix",
    ),
    "not a number": ({"inclusions": [ball(eigenstrain=float("nan"))]}, "inclusions.eigenstrain.value must be a number"),
    "unknown field": (
        {"inclusions": [ball(eigenstrain={"type": "termal"})]},
        "inclusions.eigenstrain: unknown eigenstrain-field 'termal'; installed: ",
    ),
    "unknown field, nearest": ({"inclusions": [ball(eigenstrain={"type": "termal"})]}, "did you mean 'thermal'?"),
    "unknown shape": ({"inclusions": [ball(type="shpere")]}, "inclusions: unknown inclusion-shape 'shpere'; installed"),
    "unknown key of a shape": (
        {"inclusions": [ball(radus=1.0)]},
        "unknown key 'radus' in inclusions (sphere); known: center, radius, name, body, eigenstrain, material, centers",
    ),
    "missing key of a shape": (
        {"inclusions": [ball(radius=None)]},
        "inclusions.radius must be given (sphere needs it)",
    ),
    "numbered inclusion": ({"inclusions": [ball(), ball(radius="3 N")]}, "inclusions.1.radius must be a length [m]"),
    "above the surface": (
        {"inclusions": [ball(), ball(name="egg", center=[0, 0, "0.9 um"])]},
        "inclusion 'egg' (second) must lie below the surface, z >= 0 (got z from -1e-07 m to 1.9e-06 m); move",
    ),
    "a center and centers": (
        {"inclusions": [ball(centers=[[0, 0, 1]])]},
        "inclusions must be at its center, or at centers (got both); give one of them",
    ),
    "centers of a shape without a place": (
        {
            "inclusions": [
                {"type": "layer", "size": [1e-6, 1e-6], "thickness": 1e-6, "centers": [[0, 0, 1]], "eigenstrain": 0}
            ]
        },
        "inclusions.centers must be left out for 'layer', a shape without a field that says where it is (got 1 center",
    ),
    "a patch without size": (
        {"inclusions": [], "eigenstrain": PATCH, "grid": None},
        "eigenstrain.size must be given with an automatic grid (got neither)",
    ),
    "a patch without depth": (
        {"eigenstrain": {name: value for name, value in PATCH.items() if name != "depth"}},
        "eigenstrain.depth must be given",
    ),
    "a region of a body without eigenstrain": (
        {"body2": STEEL, "stress": {"shape": "plane", "depth-max": 1e-6, "body": 2}},
        "stress region 'plane_y2' must lie in a body with eigenstrain (body2 has none, and there is no contact)",
    ),
    "unknown field of a region": (
        {"stress": {"shape": "plane", "depth-max": 1e-6, "fields": ["strin"]}},
        "must be one of 'stress', 'strain' or 'displacement' (got 'strin'); did you mean 'strain'?",
    ),
    "no field of a region": (
        {"stress": {"shape": "plane", "depth-max": 1e-6, "fields": []}},
        "fields must be an array of length at least 1",
    ),
    "unknown treatment": (
        {"numerics": {"half-space": "exakt"}},
        "numerics.half-space must be one of ",
    ),
}


@pytest.mark.parametrize("case", REFUSED)
def test_refusals(case):
    changes, words = REFUSED[case]
    with one_line_error(words):
        plan(load_scene(scene(**changes)))
