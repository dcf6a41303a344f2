"""Packages of strangers: good ones work as ours do; broken ones are reported, named again, and stop nothing."""

import json
from textwrap import indent

import pytest

import eigencontact as ec
from eigencontact.app import installed_plugins

GOOD = '''
from dataclasses import dataclass
from typing import ClassVar
import numpy as np
from eigencontact.plugin import Geometry, Length, hookimpl, require

@dataclass(frozen=True, kw_only=True)
class Bowl(Geometry):
    """Paraboloid of a stranger."""

    key: ClassVar[str] = "bowl"
    references: ClassVar[tuple[str, ...]] = ("A. Stranger 2026, eq. (1)",)
    bend: Length
    lift: Length = 0.0

    def __post_init__(self):
        require(self.bend > 0, self.key, "bend", self.bend, "positive [m]")

    def separation(self, x, y):
        return (x**2 + y**2) / (2 * self.bend) + self.lift

@hookimpl
def eigencontact_register_geometries():
    return [Bowl]
'''
BOWL = ["geometry={type='bowl', bend='105 um'}", "stress=[]", "grid.cells-per-contact-radius=8"]


def test_a_geometry_of_a_stranger_is_used_like_ours(install):
    ours = ec.run(ec.load_scene("hertz", BOWL[1:]))
    install(GOOD)
    theirs = ec.run(ec.load_scene("hertz", BOWL))
    assert theirs.summary["max_pressure"] == pytest.approx(ours.summary["max_pressure"], rel=1e-6)
    assert theirs.summary["versions"]["plugin geometry bowl"] == "eigencontact-stranger 1.2.3"
    assert "A. Stranger 2026, eq. (1)" in theirs.summary["references"]
    assert ec.make("bowl", bend="1 mm").bend == 1e-3


def test_it_is_listed_and_explained(install, command):
    install(GOOD)
    listed = command("plugins")
    assert listed.code == 0
    assert "bowl" in listed.out
    assert "Paraboloid of a stranger.  (eigencontact-stranger 1.2.3)" in listed.out
    detailed = command("plugins", "bowl").out
    assert "bend [m]: required" in detailed
    assert "lift [m]: default 0.0" in detailed
    assert "A. Stranger 2026, eq. (1)" in detailed
    assert "sphere" not in detailed
    data = json.loads(command("plugins", "bowl", "--json").out)
    assert [entry["package"] for entry in data["plugins"]] == ["eigencontact-stranger"]
    assert "bowl" in command("explain", "hertz", "--set", BOWL[0], "--set", "stress=[]").out


def test_its_refusals_read_like_ours(install):
    install(GOOD)
    with pytest.raises(ec.EigencontactError, match=r"bowl.bend must be positive \[m\] \(got -1.0\)"):
        ec.plan(ec.load_scene("hertz", ["geometry={type='bowl', bend=-1.0}"]))
    with pytest.raises(ec.EigencontactError, match=r"unknown key 'bnd' in geometry \(bowl\); .* did you mean 'bend'\?"):
        ec.plan(ec.load_scene("hertz", ["geometry={type='bowl', bnd=1.0}"]))


HEAD = """
from dataclasses import dataclass
from typing import ClassVar
from eigencontact.plugin import Geometry, hookimpl
"""
CLASS = """
@dataclass(frozen=True, kw_only=True)
class Bowl(Geometry):
    key: ClassVar[str] = "bowl"
    def separation(self, x, y):
        return x + y
"""
HOOK = "\n@hookimpl\ndef eigencontact_register_geometries():\n    return [Bowl]\n"

# (module source, the reason that must be given)
BROKEN = {
    "import error": ("import nowhere_to_be_found\n", "ModuleNotFoundError: No module named 'nowhere_to_be_found'"),
    "syntax error": ("def (\n", "SyntaxError: "),
    "raises at import": ("raise RuntimeError('no licence')\n", "RuntimeError: no licence"),
    "silent exception": ("raise ValueError\n", "ValueError: (no message)"),
    "leaves the interpreter": ("import sys\nsys.exit(3)\n", "SystemExit: 3"),
    "no dataclass": (
        HEAD + CLASS.replace("@dataclass(frozen=True, kw_only=True)\n", "") + HOOK,
        "PluginError: Bowl must be a frozen dataclass: its fields are its scene table",
    ),
    "thawed dataclass": (
        HEAD + CLASS.replace("frozen=True, ", "") + HOOK,
        "PluginError: Bowl must be a frozen dataclass: its fields are its scene table",
    ),
    "abstract": (HEAD + CLASS.replace("separation", "other") + HOOK, "PluginError: Bowl must implement separation"),
    "key of ours": (
        HEAD + CLASS.replace('"bowl"', '"sphere"') + HOOK,
        "PluginError: geometry 'sphere' is already registered by eigencontact",
    ),
    "no key": (HEAD + CLASS.replace('"bowl"', '""') + HOOK, "PluginError: Bowl.key must be a non-empty text (got '')"),
    "registers nothing": (HEAD + CLASS, "PluginError: it registers nothing: implement one of eigencontact_register_"),
    "registers no class": (HEAD + CLASS + HOOK.replace("[Bowl]", "[Bowl()]"), "must be a subclass of Geometry"),
    "of another kind": (
        HEAD + CLASS + HOOK.replace("geometries", "observers"),
        "PluginError: Bowl must be a subclass of Observer to be a observer",
    ),
    "not iterable": (HEAD + CLASS + HOOK.replace("[Bowl]", "Bowl"), "TypeError: 'ABCMeta' object is not iterable"),
    "returns None": (HEAD + CLASS + HOOK.replace("return [Bowl]", "pass"), "TypeError: 'NoneType' object is not"),
    "unknown hook": (
        HEAD + CLASS + HOOK.replace("geometries", "geometrys"),
        "eigencontact_register_geometrys",
    ),
    "hook with arguments": (HEAD + CLASS + HOOK.replace("geometries()", "geometries(kind)"), "Argument(s) {'kind'}"),
}


@pytest.mark.parametrize("case", BROKEN)
def test_a_broken_package_is_reported_and_stops_nothing(case, install, command):
    source, reason = BROKEN[case]
    install(source)
    (broken,) = installed_plugins().broken
    assert (broken.name, broken.package) == ("stranger", "eigencontact-stranger 1.2.3")
    assert reason in broken.reason
    listed = command("plugins")
    assert listed.code == 0
    assert "sphere" in listed.out
    assert listed.out.count("broken, and why") == 1
    assert f"stranger of eigencontact-stranger 1.2.3: {broken.reason}" in listed.out
    assert json.loads(command("plugins", "--json").out)["broken"][0]["reason"] == broken.reason
    assert ec.run(ec.load_scene("hertz", BOWL[1:])).summary["converged"]
    asked = command("run", "hertz", "--set", BOWL[0])
    assert asked.code == 2
    assert asked.err.count("\n") == 1
    assert asked.err.startswith("eigencontact: geometry: unknown geometry 'bowl'; installed: 'cylinder'")
    assert "plugin 'stranger' of eigencontact-stranger 1.2.3 is broken: " in asked.err
    with pytest.raises(ec.EigencontactError, match=r"plugin 'stranger' of eigencontact-stranger 1\.2\.3 is broken"):
        ec.make("bowl")


def test_a_missing_module_is_reported(install):
    install(GOOD, target="eigencontact_stranger_moved")
    (broken,) = installed_plugins().broken
    assert "No module named 'eigencontact_stranger_moved'" in broken.reason


def test_a_package_registers_all_or_nothing(install):
    second = CLASS.replace("class Bowl", "class Dish").replace('"bowl"', '"sphere"')
    install(HEAD + CLASS + second + HOOK.replace("[Bowl]", "[Bowl, Dish]"))
    assert len(installed_plugins().broken) == 1
    assert installed_plugins().named("bowl") == []


def test_two_strangers_with_one_key(install):
    install(GOOD, name="a-first", entry="first")
    install(GOOD, name="b-second", entry="second")
    (broken,) = installed_plugins().broken
    assert broken.package == "b-second 1.2.3"
    assert "geometry 'bowl' is already registered by a-first 1.2.3; choose another key" in broken.reason


# Components that load but misbehave in use: (body of separation, words of the message)
MISBEHAVING = {
    "raises": ("raise KeyError('x')", "(got KeyError: 'x')"),
    "wrong type": ("return 'deep'", "(got UFuncTypeError: "),
    "wrong shape": ("return [1.0, 2.0, 3.0]", "to shape (8, 8) (got ValueError: operands could not be broadcast"),
    "complex": ("return 1j * x + y", "(got UFuncTypeError"),
}
GRID = "grid={cells=8, size=[1e-5, 1e-5]}"


@pytest.mark.parametrize("case", MISBEHAVING)
def test_a_component_that_misbehaves_is_named(case, install, command, tmp_path):
    body, words = MISBEHAVING[case]
    install(HEAD + CLASS.replace("        return x + y\n", indent(body, "        ") + "\n") + HOOK)
    folder = tmp_path / "out"
    changes = ["--set", "geometry={type='bowl'}", "--set", "stress=[]", "--set", GRID]
    outcome = command("run", "hertz", *changes, "-o", folder)
    assert outcome.code == 2
    assert outcome.err.startswith("eigencontact: ")
    assert outcome.err.count("\n") == 1
    assert "geometry 'bowl' must return numbers that broadcast to shape (8, 8) (got " in outcome.err
    assert words in outcome.err
    assert not folder.exists()


OBSERVER = '''
from dataclasses import dataclass
from typing import ClassVar
from eigencontact.plugin import Observer, hookimpl

@dataclass(frozen=True, kw_only=True)
class Watch(Observer):
    """Looks."""
    key: ClassVar[str] = "watch"
    def observe(self, step):
        BODY

@hookimpl
def eigencontact_register_observers():
    return [Watch]
'''


def test_an_observer_of_a_stranger_sees_read_only_fields(install):
    body = "step.fields['pressure'].flags.writeable and 1 / 0; return {'peak': step.fields['pressure'].max()}"
    install(OBSERVER.replace("BODY", body))
    result = ec.run(ec.load_scene("hertz", [*BOWL[1:], "observers=[{type='watch'}]"]))
    assert result.summary["observed"] == {"watch_peak": result.summary["max_pressure"]}
    assert float(result.dataset["watch_peak"][0]) == result.summary["max_pressure"]


@pytest.mark.parametrize("body", ["return 3", "return {'a': 'much'}", "return None", "return {'a': [1]}", "1 / 0"])
def test_an_observer_that_misbehaves_is_named(body, install, command, tmp_path):
    install(OBSERVER.replace("BODY", body))
    arguments = [part for change in [*BOWL[1:], "observers=[{type='watch'}]"] for part in ("--set", change)]
    outcome = command("run", "hertz", *arguments, "-o", tmp_path / "out")
    assert outcome.code == 2
    assert outcome.err.count("\n") == 1
    assert outcome.err.startswith("eigencontact: ")
    assert "observer 'watch'" in outcome.err
    assert not (tmp_path / "out").exists()
