"""Names of tables in a scene: unique, in messages in place of numbers, in `explain` and in results."""

import json

import pytest

import eigencontact as ec
from bodies import STEEL_TABLE as STEEL
from close import close
from eigencontact.scene.labels import labelled, ordinal

BALL = {"type": "sphere", "radius": "1 um", "center": [0, 0, "3 um"], "eigenstrain": 1e-3}
LAYERS = [{"name": "TiN", "thickness": "1 um", **STEEL}, {"thickness": "2 um", **STEEL}]


def scene(*inclusions, layers=(), stress=()):
    """A sphere on steel, with inclusions or under layers."""
    body = {"medium": {"type": "bonded-layers", "layers": list(layers), "substrate": STEEL}} if layers else STEEL
    return {
        "body1": body,
        "geometry": {"type": "sphere", "radius": "105 um"},
        "grid": {"cells": 16, "size": "16 um"},
        "steps": {"normal-load": "0.65 N"},
        "inclusions": list(inclusions),
        "stress": list(stress),
    }


def named(name, **more):
    return BALL | {"name": name, "center": [0, 0, f"{3 + 3 * len(name)} um"]} | more


LINE = {"shape": "line", "start": [0, 0, 0], "end": [0, 0, "1 um"]}
MESSAGES = {
    "a key of a region": (
        scene(stress=[LINE, LINE | {"name": "axis", "count": 1}]),
        "count of stress 'axis' (second) must be in [2, 1e+07] points (got 1)",
    ),
    "a region": (
        scene(stress=[LINE, {"shape": "points", "name": "axis"}]),
        "stress 'axis' (second) must be given points",
    ),
    "a region without a name": (scene(stress=[LINE, LINE | {"count": 1}]), "stress.1.count must be in [2, 1e+07]"),
    "an unknown key": (
        scene(BALL, named("void", colour=1)),
        "unknown key 'colour' in inclusion 'void' (second) (sphere); known: center, radius,",
    ),
    "a plugin's own rule": (
        scene(BALL, named("void", radius=-1.0)),
        "radius of inclusion 'void' (second) must be positive and finite [m] (got -1.0)",
    ),
    "above the surface": (
        scene(BALL, named("void", center=[0, 0, 0])),
        "inclusion 'void' (second) must lie below the surface",
    ),
    "a layer": (
        scene(layers=[LAYERS[0] | {"thickness": -1.0}, LAYERS[1]]),
        "thickness of layer 'TiN' (first) of body1 must be positive and finite [m] (got -1.0)",
    ),
    "a layer's unknown key": (
        scene(layers=[LAYERS[1], LAYERS[0] | {"thicknes": 1.0}]),
        "unknown key 'thicknes' in layer 'TiN' (second) of body1; known: young-modulus,",
    ),
    "inclusions of one name": (
        scene(named("void"), BALL, named("void")),
        "inclusions must have different names (got 'void' twice, the first and third); rename one, or give one table c",
    ),
    "the name that another has by default": (
        scene(named("sphere 2"), BALL),
        "inclusions must have different names (got 'sphere 2' twice, the first and second)",
    ),
    "layers of one name": (
        scene(layers=[LAYERS[0], LAYERS[0]]),
        "body1.medium.layers must be of different names; rename one of the layers (got 'TiN')",
    ),
}


@pytest.mark.parametrize("case", MESSAGES)
def test_messages_name_what_has_a_name(case):
    tables, words = MESSAGES[case]
    with pytest.raises(ec.EigencontactError) as refused:
        ec.plan(tables)
    assert str(refused.value).startswith(words)


def test_nothing_else_is_taken_for_a_table():
    tables = scene(named("void"))
    for text in ("steps.0.increments", "my-inclusions.0 and body.stress.0", "inclusions.7", "inclusions.0x", "stress."):
        assert labelled(text, tables) == text


def test_ordinals():
    assert [ordinal(n) for n in (0, 9, 10, 11, 12, 20, 100, 110)] == [
        "first", "tenth", "11th", "12th", "13th", "21st", "101st", "111th",
    ]  # fmt: skip


def test_explain_and_results_name_layers():
    made = ec.plan(scene(layers=LAYERS))
    assert "1 um of 'TiN', E = 210 GPa, ν = 0.3; 2 um of E = 210 GPa" in made.explain()
    kept = json.loads(ec.run(made).dataset.attrs["layers"])
    assert [layer["name"] for layer in kept["1"]] == ["TiN", "layer 2"]
    assert [(layer["top"], layer["bottom"]) for layer in kept["1"]] == [(0.0, 1e-6), (1e-6, 3e-6)]


def test_explain_and_results_name_inclusions():
    made = ec.plan(scene(named("void"), BALL))
    assert "void" in made.explain()
    first, second = json.loads(ec.run(made).dataset.attrs["inclusions"])
    assert (first["name"], first["plugin"], first["body"], first["material"]) == ("void", "sphere", 1, None)
    assert second["name"] == "sphere 2"
    assert second["bounds"] == [close([-1e-6, -1e-6, 2e-6], rel=1e-12), close([1e-6, 1e-6, 4e-6], rel=1e-12)]
