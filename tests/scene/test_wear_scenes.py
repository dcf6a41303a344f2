"""Scenes that wear: the table of wear, steps in cycles, sliding over a distance, and what is refused."""

import tomllib
from math import inf, nan

import pytest
import tomli_w

from bodies import rubbed
from close import close
from eigencontact import load_scene, make, plan
from eigencontact.errors import SceneError
from one_line import one_line_error

PRESSED = {"normal-load": "0.65 N"}
CYCLE = [{"shift-x": "20 nm"}, {"shift-x": 0.0}]
ENERGY = {"type": "dissipated-energy", "coefficient": "1e-3 mm^3/J"}
ARCHARD = {"type": "archard", "coefficient": "1e-13 m^3/(N m)"}
AMPLITUDE = {"type": "amplitude-scaled", "coefficient": "1e4 mm^3/(J mm)"}
SLIDING = PRESSED | {"sliding-distance": "1 mm"}


def scene(**changes):
    grid = {"cells": 16, "size": ["16 um", "16 um"]}
    steps = [PRESSED, {"cycle": CYCLE, "repeat": 3}]
    return rubbed(**{"wear": ENERGY, "grid": grid, "steps": steps, **changes})


def within(step):
    """Load history whose cycle has this step second."""
    return {"steps": [PRESSED, {"cycle": [CYCLE[0], step], "repeat": 3}]}


def test_the_law_is_a_table_a_component_or_a_change():
    law = make("archard", coefficient=1e-4, hardness="2 GPa")
    assert plan(load_scene(scene(wear=law))).model.wear.law == law
    assert plan(load_scene(scene())).model.wear.law == make("dissipated-energy", kind="wear-law", coefficient=1e-12)
    changed = load_scene(scene(), ["wear.coefficient='2e-3 mm^3/J'"])
    assert plan(changed).model.wear.law.coefficient == close(2e-12, rel=1e-15)
    assert plan(load_scene(scene(wear=None))).model.wear is None


def test_laws_of_wear_are_listed(command):
    listed = command("plugins").out.split("wear-law")[1]
    for key in ("amplitude-scaled", "archard", "dissipated-energy", "threshold-energy"):
        assert f"\n  {key} " in listed
    assert "hardness" in command("plugins", "archard").out


# table of wear, parts of the bodies, error that jumps may make
TABLES = [
    ({}, {1: 1.0}, 1e-2),
    ({"body": 2}, {2: 1.0}, 1e-2),
    ({"shares": {"body1": 0.7, "body2": 0.3}}, {1: 0.7, 2: 0.3}, 1e-2),
    ({"shares": {"body2": 1.0}}, {2: 1.0}, 1e-2),
    ({"jump-error": 1e-3}, {1: 1.0}, 1e-3),
    ({"cycles-per-update": 5}, {1: 1.0}, None),
]


@pytest.mark.parametrize(("table", "parts", "error"), TABLES)
def test_who_wears_and_by_which_error(table, parts, error):
    wear = load_scene(scene(wear=ENERGY | table)).wear
    assert wear.parts == parts
    assert wear.error == error


@pytest.mark.parametrize("steps", [[PRESSED, {"cycle": CYCLE[0], "repeat": 2}], [SLIDING | {"sliding-direction": "y"}]])
def test_the_resolved_scene_loads_as_the_same_scene(steps):
    first = load_scene(scene(steps=steps, wear=AMPLITUDE | {"shares": {"body1": 0.5, "body2": 0.5}}))
    again = load_scene(tomllib.loads(tomli_w.dumps(first.resolved())))
    assert again.resolved() == first.resolved()
    assert again.steps == first.steps


# changes to the scene, words of the refusal
REFUSED = {
    "unknown law": ({"wear": {"type": "archrad"}}, "wear: unknown wear-law 'archrad'; installed: 'amplitude-scaled', "),
    "unknown law, nearest": ({"wear": {"type": "archrad"}}, "; did you mean 'archard'?"),
    "no type": ({"wear": {"coefficient": 1e-13}}, "wear must be given a type, 'amplitude-scaled' or 'archard' or '"),
    "a number": ({"wear": 0.3}, "wear must be a table (got 0.3)"),
    "two laws": ({"wear": [ENERGY, ENERGY]}, "wear must be a table (got [{"),
    "typo of the table": ({"waer": ENERGY}, "unknown key 'waer' in the scene; known: name, title"),
    "typo of a field": (
        {"wear": {"type": "archard", "coeficient": 1e-13}},
        "unknown key 'coeficient' in wear (archard); known: coefficient, hardness, body, shares, jump-error, ",
    ),
    "typo beside the fields": ({"wear": ENERGY | {"jump-eror": 0.1}}, "update; did you mean 'jump-error'?"),
    "no coefficient": ({"wear": {"type": "archard"}}, "wear.coefficient must be given (archard needs it)"),
    "negative": (
        {"wear": ENERGY | {"coefficient": -1e-3}},
        "wear.coefficient must be zero or positive, and finite [m^3/J] (got -0.001)",
    ),
    "NaN": ({"wear": ARCHARD | {"coefficient": nan}}, "wear.coefficient must be zero or positive, and finite (got"),
    "infinite": (
        {"wear": AMPLITUDE | {"coefficient": inf}},
        "wear.coefficient must be zero or positive, and finite [m^2/J] (got inf)",
    ),
    "negative threshold": (
        {"wear": {"type": "threshold-energy", "coefficient": 1e-12, "threshold": -1.0}},
        "wear.threshold must be zero or positive, and finite [J/m^2] (got -1.0)",
    ),
    "hardness": ({"wear": ARCHARD | {"hardness": 0.0}}, "wear.hardness must be positive and finite [Pa] (got 0.0)"),
    "words": ({"wear": ENERGY | {"coefficient": "much"}}, "wear.coefficient must be a worn volume by work of friction"),
    "unit": ({"wear": ENERGY | {"coefficient": "1 mm^3/m"}}, "'1 mm^3/m' has the dimension [length] ** 2"),
    "unit of amplitude": ({"wear": AMPLITUDE | {"coefficient": "1e-3 mm^3/J"}}, "friction and amplitude [m^2/J]; '1e-"),
    "body 3": ({"wear": ENERGY | {"body": 3}}, "wear.body must be one of 1 or 2 (got 3)"),
    "shares beyond 1": (
        {"wear": ENERGY | {"shares": {"body1": 0.7, "body2": 0.7}}},
        "wear.shares must be of sum 1 and not 1.4, as body1 = 0.7, body2 = 0.3 (got {",
    ),
    "half a share": ({"wear": ENERGY | {"shares": {"body1": 0.7}}}, "wear.shares must be of sum 1 and not 0.7, as "),
    "negative share": (
        {"wear": ENERGY | {"shares": {"body1": 1.2, "body2": -0.2}}},
        "wear.shares.body2 must be zero or positive, and finite [-] (got -0.2)",
    ),
    "NaN of a share": ({"wear": ENERGY | {"shares": {"body1": nan}}}, "wear.shares.body1 must be zero or positive, an"),
    "typo of a share": (
        {"wear": ENERGY | {"shares": {"body1": 0.7, "bdoy2": 0.3}}},
        "unknown key 'bdoy2' in wear.shares; known: body1, body2; did you mean 'body2'?",
    ),
    "shares in a row": ({"wear": ENERGY | {"shares": [0.7, 0.3]}}, "wear.shares must be a table (got [0.7, 0.3])"),
    "body and shares": (
        {"wear": ENERGY | {"body": 1, "shares": {"body2": 1.0}}},
        "wear must be given body or shares, not both (got {",
    ),
    "error and number": (
        {"wear": ENERGY | {"jump-error": 0.1, "cycles-per-update": 5}},
        "wear must be given jump-error or cycles-per-update, not both (got {",
    ),
    "error": ({"wear": ENERGY | {"jump-error": 2.0}}, "wear.jump-error must be in [1e-06, 1] [-] (got 2.0)"),
    "no cycles": ({"wear": ENERGY | {"cycles-per-update": 0}}, "wear.cycles-per-update must be 1 or more (got 0)"),
    "half cycles": (
        {"wear": ENERGY | {"cycles-per-update": 2.5}},
        "wear.cycles-per-update must be a whole number (got 2.5)",
    ),
    "update": (
        {"wear": ENERGY | {"update": "increments"}},
        "wear.update must be one of 'cycle' or 'increment' (got 'increments'); did you mean 'increment'?",
    ),
    "nothing touches": (
        {"geometry": None, "friction": None, "eigenstrain": {"type": "uniform", "value": 1e-3, "depth": 1e-6},
         "steps": None},
        "wear must not be given without a geometry (got no contact that wears); add [geometry]",
    ),
    "nothing slides": (
        {"wear": ARCHARD, "friction": None, "steps": PRESSED},
        "wear must be of surfaces that slide (got a contact without friction, and no step that slides); give a step ",
    ),
    "energy without friction": (
        {"friction": None, "steps": SLIDING},
        "wear.type must name a law of pressure and path in a contact without friction, 'archard' (got 'dissipated-ener",
    ),
    "amplitude without cycles": (
        {"wear": AMPLITUDE, "steps": [PRESSED, {"shift-x": "1 um"}]},
        "steps must have a cycle with wear.type = 'amplitude-scaled', which uses the slip amplitude of a cycle (go",
    ),
    "amplitude of increments": (
        {"wear": AMPLITUDE | {"update": "increment"}},
        "wear.update must be 'cycle' with 'amplitude-scaled', which uses the slip amplitude of a cycle (got 'incr",
    ),
    "travel in a cycle": (
        {"wear": ARCHARD, "friction": None, "steps": {"cycle": [PRESSED | {"travel-x": "1 um"}], "repeat": 3}},
        "wear.update must be 'increment' where a cycle moves the geometry, by travel-x, travel-y or impacts (got 'cycl",
    ),
    "typo in a cycle": (within({"shfit-x": 0.0}), "unknown key 'shfit-x' in steps.1.cycle.1; known: normal-load, "),
    "typo in a cycle, nearest": (within({"shfit-x": 0.0}), "; did you mean 'shift-x'?"),
    "load in a cycle": (
        within({"normal-load": -1.0}),
        "steps.1.cycle.1.normal-load must be zero or positive, and finite [N] (got -1.0)",
    ),
    "unit in a cycle": (within({"shift-x": "1 N"}), "steps.1.cycle.1.shift-x must be a length [m]; '1 N' has the dime"),
    "NaN in a cycle": (within({"shift-x": nan}), "steps.1.cycle.1.shift-x must be finite [m] (got nan)"),
    "increments in a cycle": (within({"increments": 0}), "steps.1.cycle.1.increments must be 1 or more (got 0)"),
    "both in a cycle": (
        within({"shift-x": 0.0, "tangential-load-x": 1.0}),
        "steps.1.cycle.1 must be controlled by tangential-load-x or shift-x, not both (got {",
    ),
    "cycle of numbers": (within(3.0), "steps.1.cycle.1 must be a table (got 3.0)"),
    "cycle of text": ({"steps": [PRESSED, {"cycle": "fretting"}]}, "steps.1.cycle must be an array (got 'fretting')"),
    "empty cycle": ({"steps": [PRESSED, {"cycle": []}]}, "steps.1.cycle must be one step or more (got [])"),
    "cycle in a cycle": (
        within({"cycle": CYCLE, "repeat": 2}),
        "steps.1 must be a cycle of plain steps: a cycle inside another must be written out (got {",
    ),
    "cycle and load": (
        {"steps": [PRESSED, {"cycle": CYCLE, "normal-load": 1.0}]},
        "steps.1 must be a cycle and nothing else but repeat: leave out normal-load (got {",
    ),
    "never pressed": (
        {"steps": {"cycle": CYCLE, "repeat": 3}},
        "steps.cycle.0 must be controlled by normal-load or approach: give one of them (got shift-x)",
    ),
    "repeat alone": (
        {"steps": PRESSED | {"repeat": 4}},
        "steps must be given a cycle beside repeat: cycle = [{ ... }], or leave repeat out (got {",
    ),
    "no repeat": ({"steps": [PRESSED, {"cycle": CYCLE, "repeat": 0}]}, "steps.1.repeat must be in [1, 1e+09] cycles ("),
    "part of a repeat": ({"steps": [PRESSED, {"cycle": CYCLE, "repeat": 2.5}]}, "steps.1.repeat must be a whole numbe"),
    "typo of repeat": ({"steps": [PRESSED, {"cycle": CYCLE, "repaet": 3}]}, "; did you mean 'repeat'?"),
    "many repeats": (
        {"wear": None, "steps": [PRESSED, {"cycle": CYCLE, "repeat": 60_000}]},
        "is solved and stored (got 60000, which gives 120001); the largest value is 49999",
    ),
    "many updates": (
        {"wear": ENERGY | {"cycles-per-update": 1}, "steps": [PRESSED, {"cycle": CYCLE, "repeat": 60_000}]},
        "the largest value is 49999, or set a larger wear.cycles-per-update",
    ),
    "many increments": (
        {"steps": [PRESSED, {"cycle": [CYCLE[0], {"shift-x": 0.0, "increments": 200_000}], "repeat": 2}]},
        "steps.1.cycle.1.increments must give at most 100000 load steps in total, because each is solved and stored",
    ),
    "no distance": ({"steps": SLIDING | {"sliding-distance": 0.0}}, "steps.sliding-distance must be positive and fini"),
    "distance back": ({"steps": SLIDING | {"sliding-distance": "-1 m"}}, "sliding-distance must be positive and finit"),
    "unit of a distance": ({"steps": SLIDING | {"sliding-distance": "1 N"}}, "steps.sliding-distance must be a length"),
    "direction": (
        {"steps": SLIDING | {"sliding-direction": "z"}},
        "steps.sliding-direction must be one of 'x', 'y' or 'circular' (got 'z')",
    ),
    "direction alone": (
        {"steps": PRESSED | {"sliding-direction": "x"}},
        "steps must be given a sliding-distance beside sliding-direction (got {",
    ),
    "distance and shift": (
        {"steps": [PRESSED, SLIDING | {"shift-x": "1 um"}]},
        "steps.1 must prescribe either sliding-distance or shift-x (got both); use two steps",
    ),
    "distance and travel": (
        {"wear": ARCHARD, "friction": None, "steps": SLIDING | {"travel-x": "1 um"}},
        "steps must prescribe either sliding-distance or travel-x (got both); use two steps",
    ),
    "sliding that does nothing": (
        {"wear": None, "friction": None, "steps": SLIDING},
        "steps.sliding-distance must be used with friction, wear, or both (got neither); add [friction] or [wear]",
    ),
    "travel with friction alone": (
        {"wear": None, "steps": PRESSED | {"travel-x": "1 um"}},
        "steps must not move the geometry (travel-x, travel-y) in a contact with friction (got both); remove [fric",
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", REFUSED)
def test_refusals_are_one_line(case):
    changes, words = REFUSED[case]
    with one_line_error(words):
        plan(load_scene(scene(**changes)))


def test_the_most_steps_that_are_named_are_allowed():
    """What a refusal names as the most is taken."""
    assert load_scene(scene(wear=None, steps=[PRESSED, {"cycle": CYCLE, "repeat": 49_999}]))
    with pytest.raises(SceneError, match="the largest value is 49999"):
        load_scene(scene(wear=None, steps=[PRESSED, {"cycle": CYCLE, "repeat": 50_000}]))


def test_cycles_that_wear_may_be_many():
    planned = plan(load_scene(scene(steps=[PRESSED, {"cycle": CYCLE, "repeat": 10**6}])))
    assert planned.steps < 200
