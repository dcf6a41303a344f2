"""The author's page: its Python runs, its scene is solved with its shape, its tables name what there is."""

import re
import sys
import types

import numpy as np
import pytest

import eigencontact as ec
from close import close
from eigencontact.cli import app
from eigencontact.plugin import KINDS
from eigencontact_verification.conformance import ConformanceError, checks_for

#: What a module has around the law of the page.
BEFORE = """from dataclasses import dataclass
from typing import ClassVar
import numpy as np
from eigencontact.plugin import Stress, hookimpl, require
"""
AFTER = """
@hookimpl
def eigencontact_register():
    return [CrushingFoam]
"""


@pytest.fixture(scope="module")
def page(root):
    return (root / "plugins" / "README.md").read_text(encoding="utf-8")


def blocks(page, language):
    return re.findall(rf"^```{language}\n(.*?)^```", page, re.DOTALL | re.MULTILINE)


@pytest.fixture(scope="module")
def names(page):
    """What the Python blocks define, run one after the other as one module."""
    module = types.ModuleType("author_page")
    sys.modules["author_page"] = module
    for number, block in enumerate(blocks(page, "python")):
        exec(compile(block, f"block {number} of plugins/README.md", "exec"), module.__dict__)
    yield module.__dict__
    del sys.modules["author_page"]


def test_the_numbers_in_the_text(page, names):
    (lift,) = re.findall(r"rises above the shell by ([\d.]+) nm", page)
    assert -names["exact_lift"][0, 2] * 1e9 == close(float(lift), abs=0.005)


def test_all_three_shells_are_one(names):
    points = [[1e-6, 0.5e-6, 0.0], [0.0, 0.0, 4.5e-6], [0.0, 0.0, 3e-6], [2e-6, 1e-6, 6e-6]]
    fields = [
        ec.inclusion_field(names[name], names["swelling"], points, quantity="stress", **names["steel"])
        for name in ("exact_shell", "fast_shell")
    ]
    assert abs(fields[0] - fields[1]).max() < 1e-9 * abs(fields[0]).max()


def test_the_test_of_the_page_has_all_checks(names):
    """The block with `parametrize_with_checks`: every case but the registration passes."""
    (mark,) = names["test_conformance"].pytestmark
    assert mark.args[0] == ("component", "check")
    failed = set()
    for case in mark.args[1]:
        component, check = case.values
        try:
            check(component)
        except ConformanceError:
            failed.add(check.__name__)
    assert failed == {"check_registered"}


def test_the_scene_runs_with_the_shape_of_the_first_block(page, install, tmp_path):
    install(blocks(page, "python")[0], name="eigencontact-hollow-ball", entry="hollow-ball")
    text, *_ = blocks(page, "toml")
    (tmp_path / "shell.toml").write_text(text, encoding="utf-8")
    plan = ec.plan(ec.load_scene(tmp_path / "shell.toml"))
    assert "plugin 'hollow-ball'" in plan.explain()
    assert "cells" in plan.explain()
    result = ec.run(plan)
    assert result.summary["versions"]["plugin inclusion-shape hollow-ball"] == "eigencontact-hollow-ball 1.2.3"


def test_the_scene_runs_with_the_law_of_its_block(page, install, tmp_path):
    """Foam below the ball is crushed as it is loaded, and stays so."""
    (foam,) = (block for block in blocks(page, "python") if "class CrushingFoam" in block)
    install(BEFORE + foam + AFTER, name="eigencontact-crushing-foam", entry="crushing-foam")
    (tmp_path / "foam.toml").write_text(blocks(page, "toml")[1], encoding="utf-8")
    result = ec.run(ec.load_scene(tmp_path / "foam.toml"))
    crushed = result.dataset["crushed_1"]
    assert crushed.attrs["units"] == "1"
    loaded, unloaded = (float(crushed.sel(history_step=step).max()) for step in (1, 2))
    assert loaded > 1e-3
    assert unloaded == close(loaded, rel=1e-6)


def test_the_scene_runs_with_the_wear_law_of_its_block(page, install, tmp_path):
    """Below the hard skin the same path wears more."""
    (skin,) = (block for block in blocks(page, "python") if "class HardSkin" in block)
    before = BEFORE.replace("Stress, hookimpl", "Length, Stress, hookimpl")
    install(before + skin + AFTER.replace("CrushingFoam", "HardSkin"), name="eigencontact-hard-skin", entry="hard-skin")
    (tmp_path / "skin.toml").write_text(blocks(page, "toml")[2], encoding="utf-8")
    result = ec.run(ec.load_scene(tmp_path / "skin.toml"))
    depth = result.dataset["max_worn_depth"].values
    more = np.diff(depth)
    assert depth[1] == close(1e-14 * 0.125e-3 * float(result.dataset["max_pressure"][1]), rel=0.1)
    assert depth[-1] > 20e-9
    assert more[-1] > 2 * more[0]


def hyperbolic(names):
    return names["Hyperbolic"](yield_stress=1e9, gain=5e8, half=0.01)


def test_the_hardening_law_of_the_page_passes_its_checks(names):
    for check in checks_for(hyperbolic(names)):
        if check.__name__ != "check_registered":
            check(hyperbolic(names))


def hard_skin(names):
    return names["HardSkin"](wear=1e-4, skin=2e-7, hardness=1e10, core_hardness=1e9)


def test_the_wear_law_of_the_page_passes_its_checks(names):
    for check in checks_for(hard_skin(names)):
        if check.__name__ != "check_registered":
            check(hard_skin(names))


def test_every_check_is_explained_and_no_other(page, names):
    rows = [line.split("|")[1] for line in page.splitlines() if line.startswith("| `check_")]
    explained = {name for row in rows for name in re.findall(r"`(check_\w+)`", row)}
    components = (names["fast_shell"], names["crushing"], hyperbolic(names), hard_skin(names))
    assert explained == {c.__name__ for item in components for c in checks_for(item, finite_elements=True)}


def test_every_kind_is_in_the_table_with_a_file_that_exists(page, root):
    lines = page.split("# Other kinds")[1].splitlines()
    rows = [line.split("|") for line in lines if line.startswith("| ") and not line.startswith("| to write")]
    kinds = {row[2].strip(" `") for row in rows}
    assert kinds == set(KINDS)
    for row in rows:
        assert (root / "plugins" / row[4].strip(" `")).is_file(), row[4]


def test_every_command_exists(page):
    known = {command.name or command.callback.__name__ for command in app.registered_commands} | {"gallery", "verify"}
    asked = set(re.findall(r"eigencontact (new-plugin|plugins|explain|run|verify|[a-z]+-[a-z]+)\b(?! =)", page)) - {
        "hollow-ball"
    }
    assert asked
    assert asked <= known


def test_lines_are_of_a_readable_length(page):
    for block in blocks(page, "python"):
        assert max(len(line) for line in block.splitlines()) <= 120
