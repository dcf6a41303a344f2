"""The reference of a scene: every key has a meaning, the words are those of the rules, editors can check a scene."""

import json
import tomllib

import jsonschema
import pytest

import eigencontact as ec
from eigencontact.errors import EigencontactError, SceneError
from eigencontact.reference.command import schema_text
from eigencontact.reference.docstrings import meanings
from eigencontact.reference.json_schema import json_schema
from eigencontact.reference.keys import keys_of
from eigencontact.reference.tables import all_tables
from eigencontact.reference.text import as_markdown
from eigencontact.scene.installed import installed_plugins
from eigencontact.scene.loader import bundled_names, bundled_text
from eigencontact.scene.schema import Numerics


@pytest.fixture(scope="module")
def registry():
    return installed_plugins()


@pytest.fixture(scope="module")
def tables(registry):
    return all_tables(registry)


@pytest.fixture(scope="module")
def schema(registry):
    return json_schema(registry)


@pytest.fixture(scope="module")
def editor(schema):
    return jsonschema.Draft202012Validator(schema)


def a_sentence(text):
    return len(text) > 5 and text.rstrip("`'\")").endswith((".", "?"))


def test_every_key_of_every_table_has_a_sentence(tables):
    keys = [(place, key) for place, table in tables.items() for key in table.keys]
    bare = [f"{place}.{key.name}" for place, key in keys if not a_sentence(key.meaning)]
    assert bare == []
    assert all(a_sentence(table.summary) for table in tables.values())


def test_every_parameter_of_every_plugin_has_a_sentence(registry):
    bare = []
    for entry in registry:
        for key in keys_of(entry.component):
            inner = [] if key.table is None else [(f"{key.name}.{part.name}", part) for part in keys_of(key.table)]
            bare += [f"{entry.key}.{name}" for name, part in [(key.name, key), *inner] if not part.meaning]
    assert bare == []


def test_no_docstring_explains_a_key_that_is_none(tables, registry):
    """A meaning without its key is one of a key that was renamed or taken away."""
    classes = {entry.component for entry in registry} | {Numerics}
    for cls in classes:
        names = {key.name.replace("-", "_") for key in keys_of(cls)}
        own = meanings(cls)
        stray = {name for name in own if name not in names and not hasattr(cls, name)}
        assert stray == set(), cls


def test_words_are_those_of_the_rules(tables):
    numerics = {key.name: key for key in tables["numerics"].keys}
    assert numerics["tolerance"].valid_values == "a number, in [1e-13, 0.1]"
    assert numerics["boundary"].valid_values == (
        'one of "non-periodic", "periodic", "periodic-y", ["non-periodic", "periodic"], '
        '["non-periodic", "non-periodic"], ["periodic", "periodic"]'
    )
    assert numerics["tolerance"].to_dict()["default"] == 1e-6
    body = {key.name: key for key in tables["body1"].keys}
    assert body["young-modulus"].valid_values == "a stress [Pa], positive and finite"
    assert body["young-modulus"].unit == "Pa"
    grid = {key.name: key for key in tables["grid"].keys}
    assert grid["spacing"].valid_values == "a length [m], positive and finite; or an array of 2 of them"
    assert {name for name, _ in tables["geometry"].plugins} >= {"sphere", "topography"}
    assert next(key for key in tables["stress"].keys if key.name == "shape").required


@pytest.mark.parametrize("place", [None, "numerics", "steps.impacts", "[steps]", "inclusions.material", "wear.shares"])
def test_lines_fit_a_terminal(registry, place):
    text = schema_text(registry, place, as_json=False)
    assert max(map(len, text.splitlines())) <= 100
    assert "``" not in text


def test_a_table_as_data(registry):
    data = json.loads(schema_text(registry, "output", as_json=True))["output"]
    history = next(key for key in data["keys"] if key["name"] == "history")
    assert history["choices"] == ["last", "all"]
    assert history["default"] == "last"


def test_an_unknown_table_names_the_nearest(registry):
    with pytest.raises(SceneError, match=r"a scene has no table 'numeric'; .* did you mean 'numerics'\?"):
        schema_text(registry, "numeric", as_json=False)


def test_unknown_keys_point_to_the_reference():
    with pytest.raises(SceneError, match=r"; `eigencontact schema numerics` explains them$"):
        ec.load_scene("hertz", ["numerics.tolerence=1"])
    with pytest.raises(SceneError, match=r"; `eigencontact plugins sphere` explains them$"):
        ec.plan(ec.load_scene("hertz", ["geometry.radus=1"]))


def test_the_schema_is_one(schema):
    jsonschema.Draft202012Validator.check_schema(schema)
    assert schema["properties"]["numerics"]["description"].startswith("Numerical settings: accuracy, time and memory.")


@pytest.mark.parametrize("name", bundled_names())
def test_bundled_scenes_keep_to_the_schema(editor, name):
    editor.validate(tomllib.loads(bundled_text(name)))


SPHERE = {"type": "sphere", "radius": 1.0}
BODY = {"young-modulus": "210 GPa", "poisson-ratio": 0.3}
REFUSED = {
    "unknown key": {"bodi2": {}},
    "unknown key of a table": {"body2": {"poison-ratio": 0.3}},
    "unknown parameter": {"geometry": {**SPHERE, "radus": 1.0}},
    "unknown plugin": {"geometry": {"type": "spere"}},
    "parameter that is missing": {"geometry": {"type": "sphere"}},
    "choice": {"numerics": {"boundary": "open"}},
    "pair of axes": {"numerics": {"boundary": ["periodic", "non-periodic"]}},
    "type": {"output": {"vtk": "perhaps"}},
    "length of an array": {"grid": {"size": [1.0, 1.0, 1.0]}},
}
TAKEN = {
    "one table or several": {"geometry": [SPHERE, SPHERE]},
    "pair of axes": {"grid": {"size": "1 mm", "cells": 8}, "numerics": {"boundary": ["non-periodic", "periodic"]}},
    "one value for both": {"grid": {"size": "1 mm", "cells": 8}},
    "word": {"grid": "auto"},
    "law without a type": {"inclusions": {**SPHERE, "center": [0, 0, 2.0], "material": {**BODY}}},
    "void": {"inclusions": {**SPHERE, "center": [0, 0, 2.0], "material": {"void": True}}},
    "matrix": {"inclusions": {**SPHERE, "center": [0, 0, 2.0], "eigenstrain": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]}},
}


@pytest.mark.parametrize("tables", REFUSED.values(), ids=list(REFUSED))
def test_editors_mark_what_is_wrong(editor, tables):
    scene = {"body1": BODY, **tables}
    with pytest.raises(jsonschema.ValidationError):
        editor.validate(scene)
    with pytest.raises(EigencontactError):
        ec.plan(ec.Scene(**scene, **({} if "geometry" in tables else {"geometry": SPHERE}), steps={"normal-load": 1.0}))


@pytest.mark.parametrize("tables", TAKEN.values(), ids=list(TAKEN))
def test_editors_take_what_is_right(editor, tables):
    scene = {"body1": BODY, "geometry": SPHERE, "steps": {"normal-load": 1.0}, **tables}
    editor.validate(scene)
    ec.Scene(**scene)


def test_one_value_stands_for_both_directions():
    grid = ec.load_scene("hertz", ['grid={size = "3 mm", spacing = "0.5 um"}']).grid
    assert grid.size == (3e-3, 3e-3)
    assert grid.spacing == (0.5e-6, 0.5e-6)
    assert ec.load_scene("hertz", ["grid={size = 1.0, cells = 3}"]).grid.cells == (3, 3)


def test_the_page_names_every_table_and_key(tables):
    page = as_markdown(tables.values())
    for place, table in tables.items():
        assert f"`[{place}]`" in page or not place
        assert all(f"| `{key.name}` |" in page for key in table.keys)
