"""Packages of strangers: good ones work as ours do; broken ones are reported, named again, and stop nothing."""

import json
from textwrap import indent

import pytest

import eigencontact as ec
from close import close
from eigencontact.plugin import KINDS
from eigencontact.scene.installed import installed_plugins

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
def eigencontact_register():
    return [Bowl]
'''
BOWL = ["geometry={type='bowl', bend='105 um'}", "stress=[]", "grid.cells-per-contact-radius=8"]


def test_a_geometry_of_a_stranger_is_used_like_ours(install):
    ours = ec.run(ec.load_scene("hertz", BOWL[1:]))
    install(GOOD)
    theirs = ec.run(ec.load_scene("hertz", BOWL))
    assert theirs.summary["max_pressure"] == close(ours.summary["max_pressure"], rel=1e-6)
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
    assert "bend: a length [m]; required" in detailed
    assert "lift: a length [m]; default 0.0" in detailed
    assert "A. Stranger 2026, eq. (1)" in detailed
    assert "sphere" not in detailed
    data = json.loads(command("plugins", "bowl", "--json").out)
    assert [entry["package"] for entry in data["plugins"]] == ["eigencontact-stranger"]
    assert "bowl" in command("explain", "hertz", "--set", BOWL[0], "--set", "stress=[]").out


def test_its_refusals_read_like_ours(install):
    install(GOOD)
    with pytest.raises(ec.EigencontactError, match=r"geometry.bend must be positive \[m\] \(got -1.0\)"):
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
HOOK = "\n@hookimpl\ndef eigencontact_register():\n    return [Bowl]\n"

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
    "one key twice": (
        HEAD + CLASS + CLASS.replace("class Bowl", "class Dish") + HOOK.replace("[Bowl]", "[Bowl, Dish]"),
        "PluginError: geometry 'bowl' is already registered by eigencontact-stranger 1.2.3; choose another key",
    ),
    "no key": (HEAD + CLASS.replace('"bowl"', '""') + HOOK, "PluginError: Bowl.key must be a non-empty text without"),
    "key with a colon": (HEAD + CLASS.replace('"bowl"', '"a:b"') + HOOK, "without blanks and ':' (got 'a:b')"),
    "registers nothing": (
        HEAD + CLASS,
        "PluginError: it registers nothing: implement eigencontact_register and return",
    ),
    "registers no class": (
        HEAD + CLASS + HOOK.replace("[Bowl]", "[Bowl()]"),
        "must be a subclass of one of ConstitutiveLaw, DamageLaw, Eigenstrain",
    ),
    "of no kind": (
        HEAD + CLASS.replace("(Geometry)", "") + HOOK,
        "PluginError: Bowl must be a subclass of one of ConstitutiveLaw, DamageLaw, EigenstrainField, Fatigue",
    ),
    "of a kind that is none": (
        HEAD + CLASS.replace("    key:", "    kind: ClassVar[str] = 'dish'\n    key:") + HOOK,
        "PluginError: Bowl must be a subclass of one of ConstitutiveLaw, DamageLaw, EigenstrainField",
    ),
    "annotation unknown": (
        "from __future__ import annotations\n" + HEAD + CLASS + "    depth: Nowhere = 1.0\n" + HOOK,
        "PluginError: annotations of Bowl must be known when it runs (got NameError: name 'Nowhere' is not defined)",
    ),
    "not iterable": (HEAD + CLASS + HOOK.replace("[Bowl]", "Bowl"), "TypeError: 'ABCMeta' object is not iterable"),
    "returns None": (HEAD + CLASS + HOOK.replace("return [Bowl]", "pass"), "TypeError: 'NoneType' object is not"),
    "unknown hook": (
        HEAD + CLASS + HOOK.replace("_register", "_register_geometrys"),
        "eigencontact_register_geometrys",
    ),
    "hook with arguments": (HEAD + CLASS + HOOK.replace("register()", "register(kind)"), "Argument(s) {'kind'}"),
}


@pytest.mark.parametrize("case", BROKEN)
def test_a_broken_package_is_reported(case, install):
    source, reason = BROKEN[case]
    install(source)
    (broken,) = installed_plugins().broken
    assert (broken.name, broken.package) == ("stranger", "eigencontact-stranger 1.2.3")
    assert reason in broken.reason
    with pytest.raises(ec.EigencontactError, match=r"plugin 'stranger' of eigencontact-stranger 1\.2\.3 is broken"):
        ec.make("bowl")


def test_a_broken_package_stops_nothing(install, command):
    install(BROKEN["leaves the interpreter"][0])
    (broken,) = installed_plugins().broken
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


def test_a_missing_module_is_reported(install):
    install(GOOD, target="eigencontact_stranger_moved")
    (broken,) = installed_plugins().broken
    assert "No module named 'eigencontact_stranger_moved'" in broken.reason


def test_a_package_registers_all_or_nothing(install):
    second = CLASS.replace("class Bowl", "class Dish").replace('"bowl"', '""')
    install(HEAD + CLASS + second + HOOK.replace("[Bowl]", "[Bowl, Dish]"))
    assert len(installed_plugins().broken) == 1
    assert installed_plugins().named("bowl") == []


# ---------------------------------------------------------------- one hook


def test_one_hook_may_return_classes_of_several_kinds(install):
    watch = OBSERVER.replace("BODY", "return {}").partition("@dataclass")[2].partition("@hookimpl")[0]
    source = GOOD.replace("import Geometry", "import Observer, Geometry").replace("[Bowl]", "[Bowl, Watch]")
    install(source.replace("@hookimpl", f"@dataclass{watch}\n@hookimpl"))
    assert installed_plugins().broken == []
    assert (ec.make("bowl", bend=1.0).kind, ec.make("watch").kind) == ("geometry", "observer")


def test_every_kind_comes_from_its_exported_class():
    assert set(KINDS) >= {
        "constitutive-law", "damage-law", "eigenstrain-field", "friction-law", "geometry", "hardening-law",
        "inclusion-shape", "layered-medium", "observer", "surface-influence", "wear-law",
    }  # fmt: skip
    for kind, cls in KINDS.items():
        assert cls.__name__ == "".join(map(str.capitalize, kind.split("-")))
        assert getattr(ec.plugin, cls.__name__) is cls


# ---------------------------------------------------------------- one key, several packages


def as_sphere(lift):
    """The stranger's paraboloid under the key of ours, with another default to tell it by."""
    source = GOOD.replace('"bowl"', '"sphere"').replace("bend", "radius")
    return source.replace("lift: Length = 0.0", f"lift: Length = {lift}")


@pytest.mark.parametrize("entry", ["a-first", "sphere", "z-last"])
def test_a_key_of_ours_stays_ours(entry, install, command):
    """Whatever the name of its entry point, and however that sorts, both stay installed."""
    before = ec.run(ec.load_scene("hertz", BOWL[1:]))
    install(as_sphere(1e-3), entry=entry)
    assert installed_plugins().broken == []
    assert type(ec.make("sphere", radius=1.0)).__module__ == "eigencontact_plugins.geometries.sphere"
    after = ec.run(ec.load_scene("hertz", BOWL[1:]))
    assert after.summary["scene_hash"] == before.summary["scene_hash"]
    assert after.summary["max_pressure"] == before.summary["max_pressure"]
    theirs = ec.make("eigencontact-stranger:sphere", radius="1 mm")
    assert (theirs.key, theirs.lift) == ("sphere", 1e-3)
    listed = command("plugins")
    assert listed.code == 0
    assert "broken" not in listed.out
    keys = [line.split()[0] for line in listed.out.splitlines() if "sphere" in line.split()[:1] or ":sphere" in line]
    assert keys == ["sphere", "eigencontact-stranger:sphere", "sphere"]  # two geometries and our inclusion shape
    shown = command("plugins", "sphere")
    assert "lift: a length [m]; default 0.001" in shown.out
    assert 'profile: one of "parabola", "circle"; default' in shown.out
    asked = command("plugins", "eigencontact-stranger:sphere", "--json")
    assert [entry["type"] for entry in json.loads(asked.out)["plugins"]] == ["eigencontact-stranger:sphere"]


def test_a_scene_names_the_package(install, tmp_path, command):
    install(as_sphere(0.0))
    changes = ["geometry={type='eigencontact_stranger:sphere', radius='105 um'}", *BOWL[1:]]
    plain = ec.run(ec.load_scene("hertz", BOWL[1:]))
    theirs = ec.run(ec.load_scene("hertz", [*changes, "output.pictures=false"]), tmp_path / "out")
    assert theirs.summary["max_pressure"] == close(plain.summary["max_pressure"], rel=1e-6)
    versions = theirs.summary["versions"]
    assert versions["plugin geometry eigencontact-stranger:sphere"] == "eigencontact-stranger 1.2.3"
    assert "plugin geometry sphere" not in versions
    assert theirs.summary["scene_hash"] != plain.summary["scene_hash"]
    assert "A. Stranger 2026, eq. (1)" in theirs.summary["references"]
    bundled = ec.plan(ec.load_scene("hertz", ["geometry.type='eigencontact:sphere'", *BOWL[1:]]))
    assert type(bundled.model.interface.geometries[0]).__module__ == "eigencontact_plugins.geometries.sphere"
    unknown = command("explain", "hertz", "--set", "geometry.type='nobody:sphere'")
    assert unknown.code == 2
    assert (
        "geometry: unknown geometry 'nobody:sphere'; installed: 'cylinder', 'eigencontact-stranger:sphere', "
        in unknown.err
    )


def test_an_object_of_a_class_means_that_class(install):
    install(as_sphere(0.0))
    theirs = ec.make("eigencontact-stranger:sphere", radius="105 um")
    tables = ec.load_scene("hertz", BOWL[1:]).resolved()
    assert ec.plan(ec.load_scene(tables | {"geometry": theirs})).model.interface.geometries == (theirs,)
    ours = ec.make("sphere", radius="105 um")
    scene = ec.load_scene(tables | {"geometry": [ours]})
    assert ec.plan(scene).model.interface.geometries == (ours,)
    assert scene.geometry[0]["type"] == "sphere"


def test_two_strangers_with_one_key(install, command):
    install(GOOD, name="a-first", entry="bowl")
    install(GOOD.replace("lift: Length = 0.0", "lift: Length = 1.0"), name="b-second", entry="bowl")
    assert installed_plugins().broken == []
    for action in (
        lambda: ec.make("bowl", bend=1.0),
        lambda: ec.make("bowl", kind="geometry", bend=1.0),
        lambda: ec.plan(ec.load_scene("hertz", BOWL)),
    ):
        with pytest.raises(
            ec.EigencontactError,
            match=r"geometry 'bowl' must be of one package \(got a-first 1.2.3 and b-second 1.2.3\); "
            r"say 'a-first:bowl' or 'b-second:bowl'$",
        ):
            action()
    assert ec.make("a-first:bowl", bend=1.0).lift == 0.0
    assert ec.make("B_Second:bowl", bend=1.0).lift == 1.0
    assert (
        ec.plan(ec.load_scene("hertz", [BOWL[0].replace("bowl", "a-first:bowl")])).model.interface.geometries[0].lift
        == 0.0
    )
    listed = command("plugins")
    assert listed.code == 0
    assert "  a-first:bowl" in listed.out
    assert "  b-second:bowl" in listed.out
    assert ec.run(ec.load_scene("hertz", BOWL[1:])).summary["converged"]


def test_two_observers_with_one_key_keep_their_numbers_apart(install):
    for name, value in (("a-first", 1.0), ("b-second", 2.0)):
        install(OBSERVER.replace("BODY", f"return {{'value': {value}}}"), name=name, entry="watch")
    wanted = "observers=[{type='a-first:watch'}, {type='b-second:watch'}]"
    result = ec.run(ec.load_scene("hertz", [*BOWL[1:], wanted]))
    assert result.summary["observed"] == {"watch_1_value": 1.0, "watch_2_value": 2.0}


def test_a_cuboid_of_a_stranger_is_not_our_cell(install):
    install(
        """
        from eigencontact.plugin import hookimpl
        from eigencontact_plugins.shapes.cuboid import Cuboid as Ours

        class Cuboid(Ours):
            pass

        @hookimpl
        def eigencontact_register():
            return [Cuboid]
        """
    )
    assert installed_plugins().broken == []
    scene = ec.load_scene("prestressed-bars")
    assert ec.plan(scene).blocks


def test_a_class_that_cannot_be_described_stops_no_list(install, command):
    install(GOOD.replace('("A. Stranger 2026, eq. (1)",)', "None"))
    for arguments in (["plugins"], ["plugins", "bowl"], ["plugins", "--json"]):
        listed = command(*arguments)
        assert listed.code == 0
        assert "it cannot be described: TypeError: 'NoneType' object is not iterable" in listed.out


BOWLS = "separation of geometry 'bowl'"
NUMBERS = "must be an array that broadcasts to shape (8, 8)"
# Components that load but misbehave in use: (body of separation, words of the message)
MISBEHAVING = {
    "raises": ("raise KeyError('x')", f"{BOWLS} must return without an exception (got KeyError: 'x', line 10 of "),
    "leaves": ("raise SystemExit(0)", f"{BOWLS} must return without an exception (got SystemExit: 0, line 10 of "),
    "stops": ("raise BaseException('x')", f"{BOWLS} must return without an exception (got BaseException: x, line 10"),
    "wrong type": ("return 'deep'", f"{BOWLS} {NUMBERS}, real numbers (got text of shape ())"),
    "wrong shape": ("return [1.0, 2.0, 3.0]", f"{BOWLS} {NUMBERS} (got shape (3,))"),
    "complex": ("return 1j * x + y", f"{BOWLS} {NUMBERS}, real numbers (got complex numbers of shape (8, 8))"),
    "booleans": ("return x + y > 0", f"{BOWLS} {NUMBERS}, real numbers (got booleans of shape (8, 8))"),
    "masked": (
        "import numpy as np; return np.ma.masked_less(x + y, 0)",
        f"{BOWLS} must return no masked values (got 28)",
    ),
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
def eigencontact_register():
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
    outcome = command("run", "hertz", "--quiet", *arguments, "-o", tmp_path / "out")
    assert outcome.code == 2
    assert outcome.err.count("\n") == 1
    assert outcome.err.startswith("eigencontact: ")
    assert "observer 'watch'" in outcome.err
    assert not (tmp_path / "out").exists()
