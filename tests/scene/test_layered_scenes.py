"""Scenes with layered bodies: every refusal names the field, the rule and the value; tables and components agree."""

from copy import deepcopy

import pytest

import eigencontact as ec
from eigencontact.errors import EigencontactError
from eigencontact.hooks.manager import load_plugins
from eigencontact.model.bodies import bodies_of
from eigencontact.plugin import KINDS
from eigencontact_plugins.layered.stack import BondedLayers, Layer, Substrate

COATED = {
    "type": "bonded-layers",
    "layers": [
        {"thickness": "1 um", "young-modulus": "420 GPa", "poisson-ratio": 0.25},
        {"thickness": 2e-6, "young-modulus": "300 GPa", "poisson-ratio": 0.5},
    ],
    "substrate": {"young-modulus": "210 GPa", "poisson-ratio": 0.3},
}
STACK = BondedLayers(
    layers=(
        Layer(thickness=1e-6, young_modulus=420e9, poisson_ratio=0.25),
        Layer(thickness=2e-6, young_modulus=300e9, poisson_ratio=0.5),
    ),
    substrate=Substrate(young_modulus=210e9, poisson_ratio=0.3),
)


def changed(*path_and_value):
    """Table of the medium with the value at a path replaced, or taken away where it is None."""
    *path, last, value = path_and_value
    table = deepcopy(COATED)
    inner = table
    for part in path:
        inner = inner[part]
    if value is None:
        del inner[last]
    else:
        inner[last] = value
    return table


def scene(medium, body="body1", **more):
    bodies = {"body1": {"rigid": True}, "body2": {"rigid": True}} | {body: {"medium": medium}}
    return ec.Scene(**bodies, **{"geometry": {"type": "sphere", "radius": 1e-4}, "steps": {"normal-load": 0.1}, **more})


def bodies(made):
    return bodies_of(made, load_plugins(KINDS))


@pytest.mark.parametrize(("body", "index"), [("body1", 0), ("body2", 1)])
@pytest.mark.parametrize("medium", [COATED, STACK], ids=["table", "component"])
def test_a_medium_is_read_from_its_table_or_taken_as_it_is(medium, body, index):
    made = scene(medium, body)
    assert bodies(made)[index] == STACK
    assert bodies(made)[1 - index] is None


def test_the_resolved_scene_is_the_same_scene():
    made = scene(STACK)
    again = ec.Scene(**made.resolved())
    assert bodies(again) == bodies(made)
    assert again.resolved() == made.resolved()


def test_one_layer_may_be_a_single_table():
    assert bodies(scene(changed("layers", COATED["layers"][0])))[0].interfaces == (1e-6,)


REFUSED = {
    "unknown plugin": (
        changed("type", "bonded-layer"),
        "body1.medium: unknown layered-medium 'bonded-layer'; installed: 'bonded-layers'; did you mean",
    ),
    "no plugin": (changed("type", None), "body1.medium.type must name a layered-medium (got None); installed: 'bonded"),
    "plugin of another kind": (changed("type", "sphere"), "body1.medium: unknown layered-medium 'sphere'"),
    "no substrate": (changed("substrate", None), "body1.medium.substrate must be given (bonded-layers needs it)"),
    "no layers": (changed("layers", []), "body1.medium.layers must hold at least one layer (got none)"),
    "unknown key": (
        changed("layers", 1, "thicknes", 1e-6),
        "unknown key 'thicknes' in body1.medium.layers.1; known: young-modulus, poisson-ratio, thickness, name",
    ),
    "unknown key of the medium": (
        changed("sub-strate", {}),
        "unknown key 'sub-strate' in body1.medium (bonded-layers); known: layers, substrate; did you mean 'substrate'",
    ),
    "half a layer": (changed("layers", 0, "young-modulus", None), "body1.medium.layers.0.young-modulus must be given"),
    "wrong unit": (changed("layers", 0, "thickness", "1 GPa"), "body1.medium.layers.0.thickness must be"),
    "no number": (changed("layers", 0, "poisson-ratio", "a third"), "body1.medium.layers.0.poisson-ratio must be"),
    "no thickness": (
        changed("layers", 1, "thickness", 0.0),
        "body1.medium.layers.1.thickness must be positive and finite [m] (got 0.0)",
    ),
    "beyond incompressible": (
        changed("layers", 0, "poisson-ratio", 0.51),
        "body1.medium.layers.0.poisson-ratio must be in (-1, 0.5] [-] (got 0.51)",
    ),
    "soft substrate": (
        changed("substrate", "young-modulus", -1.0),
        "body1.medium.substrate.young-modulus must be positive and finite [Pa] (got -1.0)",
    ),
    "no table": ("bonded-layers", "body1.medium must be a table (got 'bonded-layers')"),
}


@pytest.mark.parametrize(("medium", "words"), REFUSED.values(), ids=REFUSED)
def test_what_a_medium_refuses(medium, words):
    with pytest.raises(EigencontactError) as refused:
        bodies(scene(medium))
    assert str(refused.value).startswith(words)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize(
    "more", [{"rigid": True}, {"young-modulus": 210e9}, {"young-modulus": 210e9, "poisson-ratio": 0.3}]
)
def test_a_medium_stands_alone(more):
    with pytest.raises(EigencontactError, match="body1 must be a medium alone: leave out medium or " + ", ".join(more)):
        ec.Scene(body1={"medium": COATED, **more}, geometry={"type": "sphere", "radius": 1e-4}, steps={"approach": 0.0})


@pytest.mark.parametrize(
    "inside",
    [
        {"inclusions": {"type": "sphere", "center": [0, 0, 2e-6], "radius": 1e-6, "eigenstrain": 1e-3}},
        {"eigenstrain": {"type": "uniform", "value": 1e-3, "depth": 1e-6}},
    ],
    ids=lambda table: next(iter(table)),
)
def test_eigenstrain_in_a_layered_body_is_refused(inside):
    with pytest.raises(EigencontactError) as refused:
        scene(COATED, **inside)
    name = next(iter(inside))
    assert f"{name}.0 must lie in a homogeneous body (body1 is a layered medium" in str(refused.value)
    assert "set body, leave the medium out" in str(refused.value)
