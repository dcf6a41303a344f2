"""Plugins of a single file: a scene names it and it works like an installed one; results say which text it was."""

import hashlib
import json
import tomllib
from pathlib import Path
from textwrap import dedent
from types import SimpleNamespace

import numpy as np
import pytest

import eigencontact as ec
from close import close
from eigencontact.errors import PluginError, ResultsError
from eigencontact.reports.report import report
from eigencontact.scene.installed import installed_plugins
from eigencontact_verification.commands.check import _example
from eigencontact_verification.commands.verify import _of_files
from eigencontact_verification.crosscheck import cases
from eigencontact_verification.crosscheck.store import content_hash
from eigencontact_verification.crosscheck.worker import serve

BOWL = '''
from dataclasses import dataclass
from typing import ClassVar
from eigencontact.plugin import Geometry, Length, hookimpl, require

@dataclass(frozen=True, kw_only=True)
class Bowl(Geometry):
    """Paraboloid of one file."""

    key: ClassVar[str] = "bowl"
    references: ClassVar[tuple[str, ...]] = ("A. Stranger 2026, eq. (1)",)
    example: ClassVar = {"bend": 1e-4}
    bend: Length

    def __post_init__(self):
        require(0 < self.bend < float("inf"), self.key, "bend", self.bend, "positive and finite [m]")

    def separation(self, x, y):
        return (x**2 + y**2) / (2 * self.bend)

@hookimpl
def eigencontact_register():
    return [Bowl]
'''
BALL = '''
from dataclasses import dataclass
from typing import ClassVar
from eigencontact.plugin import InclusionShape, Length, Place, hookimpl, require

@dataclass(frozen=True, kw_only=True)
class Bead(InclusionShape):
    """Ball of one file."""

    key: ClassVar[str] = "bead"
    center: Place
    radius: Length

    def __post_init__(self):
        require(0 < self.radius < 1, self.key, "radius", self.radius, "positive, below 1 [m]")

    @property
    def bounds(self):
        return tuple(tuple(c + side * self.radius for c in self.center) for side in (-1, 1))

    def contains(self, x, y, z):
        return sum((t - c) ** 2 for t, c in zip((x, y, z), self.center)) <= self.radius**2

@hookimpl
def eigencontact_register():
    return [Bead]
'''

#: A second component for a file that has a registration.
DISC = '''
from eigencontact.plugin import InclusionShape

@dataclass(frozen=True, kw_only=True)
class Disc(InclusionShape):
    """Disc at the surface."""

    key: ClassVar[str] = "disc"
    radius: Length
    depth: Length

    @property
    def bounds(self):
        return (-self.radius, -self.radius, 0.0), (self.radius, self.radius, self.depth)

    def contains(self, x, y, z):
        return (x**2 + y**2 <= self.radius**2) & (z >= 0) & (z <= self.depth)

@hookimpl
def eigencontact_register():
    return [Bowl, Disc]
'''


@pytest.fixture(autouse=True)
def _known_to_this_test_alone():
    installed_plugins.cache_clear()
    yield
    installed_plugins.cache_clear()


@pytest.fixture
def bowl(scene_file, tmp_path):
    """A scene of a bowl, and the file beside it."""
    scene = scene_file(geometry='type = "bowl"\nbend = "105 um"')
    scene.write_text('plugins = ["bowl.py"]\n' + scene.read_text(encoding="utf-8"), encoding="utf-8")
    (tmp_path / "bowl.py").write_text(BOWL, encoding="utf-8")
    return scene


def test_a_scene_brings_its_own_plugins(bowl, scene_file, tmp_path, monkeypatch):
    """From any folder; the results name the file and the hash of its text; the installed ones stay as they are."""
    ours = ec.run(ec.load_scene(scene_file(name="ours")))
    monkeypatch.chdir("/")
    theirs = ec.run(ec.load_scene(bowl), tmp_path / "out")
    assert theirs.summary["max_pressure"] == close(ours.summary["max_pressure"], rel=1e-9)
    digest = hashlib.sha256(BOWL.encode()).hexdigest()[:16]
    assert theirs.summary["versions"]["plugin geometry bowl"] == f"bowl.py sha256:{digest}"
    assert "A. Stranger 2026, eq. (1)" in theirs.summary["references"]
    assert installed_plugins().named("bowl") == []
    assert sorted(path.name for path in tmp_path.iterdir()) == ["bowl.py", "ours.toml", "out", "small.toml"]


def test_a_file_that_is_not_named_is_thought_of(bowl):
    with pytest.raises(PluginError, match=r'one of your own: name its file in the scene, plugins = \["my.py"\]$'):
        ec.plan(ec.load_scene(bowl, ["plugins=[]"]))


def test_tables_name_files_too(bowl, tmp_path):
    tables = ec.load_scene(bowl).resolved()
    assert tables["plugins"] == [str(tmp_path / "bowl.py")]
    assert ec.run(tables).summary["converged"]


def test_another_text_is_another_scene(bowl, tmp_path):
    """A run is not continued with another text, and nothing is looked at in it afterwards."""
    first = ec.run(ec.load_scene(bowl), tmp_path / "out")
    region = {"name": "axis", "shape": "points", "points": [[0.0, 0.0, 1e-6]]}
    found = ec.region(tmp_path / "out", region)
    assert float(found["axis_von_mises"].max()) > 1e9
    (tmp_path / "bowl.py").write_text(BOWL.replace("2 * self.bend", "self.bend"), encoding="utf-8")
    with pytest.raises(ResultsError, match="another scene"):
        ec.run(ec.load_scene(bowl), tmp_path / "out", resume=True)
    with pytest.raises(ResultsError, match=r"of the plugin file as it is now, bowl.py sha256:\w{16} \(got bowl"):
        ec.region(tmp_path / "out", region)
    second = ec.run(ec.load_scene(bowl))
    assert second.summary["max_pressure"] == close(first.summary["max_pressure"] * 2 ** (2 / 3), rel=0.02)
    (tmp_path / "bowl.py").unlink()
    with pytest.raises(PluginError, match="no such file"):
        ec.region(tmp_path / "out", region)


#: Text of the file -> what is said of it.
BROKEN = {
    "import": ("import numpy\nimport nowhere_to_be_found\n", "bowl.py, line 2 is broken: ModuleNotFoundError: No"),
    "syntax": ("x = 1\ndef (\n", "bowl.py, line 2 is broken: SyntaxError: invalid syntax"),
    "raises": (f"{BOWL}\n1 / 0\n", "is broken: ZeroDivisionError: division by zero"),
    "leaves": ("import sys\nsys.exit(3)\n", "bowl.py, line 2 is broken: SystemExit: 3"),
    "no hook": (BOWL.partition("@hookimpl")[0], "is broken: it registers nothing: implement eigencontact_register"),
    "no dataclass": (
        BOWL.replace("@dataclass(frozen=True, kw_only=True)", ""),
        "bowl.py is broken: Bowl must be a frozen dataclass: its fields are its scene table",
    ),
    "hook": (BOWL.replace("[Bowl]", "[Bowle]"), "is broken: NameError: name 'Bowle' is not defined"),
    "hook leaves": (BOWL.replace("return [Bowl]", "raise SystemExit(0)"), "line 23 is broken: SystemExit: 0"),
    "import leaves": (f"{BOWL}\nraise SystemExit(0)\n", "is broken: SystemExit: 0"),
    "any exception": (f"{BOWL}\nraise BaseException('x')\n", "is broken: BaseException: x"),
    "sibling": ("import other\n", "a plugin file stands alone: several files make a package, see"),
    "bundled": (
        BOWL.replace('"bowl"', '"sphere"'),
        "plugin file bowl.py must register keys of its own (got geometry 'sphere', a bundled one)",
    ),
}


@pytest.mark.parametrize("case", BROKEN)
def test_a_broken_file_is_one_line(case, bowl, tmp_path, command):
    text, words = BROKEN[case]
    (tmp_path / "other.py").write_text("")
    (tmp_path / "bowl.py").write_text(text, encoding="utf-8")
    for arguments in (["run", bowl, "-o", tmp_path / "out"], ["plugins", tmp_path / "bowl.py"]):
        outcome = command(*arguments)
        assert outcome.code == 2
        assert outcome.err.count("\n") == 1
        assert words in outcome.err
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("bowel.py", "bowel.py', no such file); did you mean 'bowl.py'?"),
        ("small.toml", "small.toml', no Python file)"),
        (".", "no Python file)"),
    ],
)
def test_a_file_that_is_none(name, words, bowl):
    with pytest.raises(PluginError) as refused:
        ec.plan(ec.load_scene(bowl, [f"plugins=['{name}']"]))
    assert words in str(refused.value)


def test_a_link_to_itself_is_no_file(bowl, tmp_path, command):
    (tmp_path / "loop.py").symlink_to("loop.py")
    for arguments in (["run", bowl, "--set", "plugins=['loop.py']"], ["check", tmp_path / "loop.py"]):
        outcome = command(*arguments)
        assert outcome.code == 2
        assert outcome.err.startswith("eigencontact: plugin file must be a Python file (got ")
        assert outcome.err.count("\n") == 1


#: Where a plugin file changes the working directory.
MOVING = {
    "import": ("\n@hookimpl", "\nos.chdir('/')\n@hookimpl"),
    "hook": ("return [Bowl]", "os.chdir('/'); return [Bowl]"),
    "construction": ("        require", "        os.chdir('/'); require"),
    "method": ("        return (x", "        os.chdir('/'); return (x"),
}


@pytest.mark.parametrize("case", MOVING)
def test_a_plugin_does_not_move_the_results(case, bowl, tmp_path, command, quick, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "bowl.py").write_text("import os\n" + BOWL.replace(*MOVING[case]), encoding="utf-8")
    outcome = command("run", "small.toml", *quick, "-o", "out")
    assert outcome.code == 0, outcome.err
    assert (tmp_path / "out" / "summary.json").is_file()
    assert Path.cwd() == tmp_path


def test_a_plugin_that_leaves_does_not_end_the_run(bowl, tmp_path, command, quick):
    (tmp_path / "bowl.py").write_text(BOWL.replace("return (x", "raise SystemExit(0); return (x"), encoding="utf-8")
    outcome = command("run", bowl, *quick, "-o", tmp_path / "out")
    assert outcome.code == 2
    assert "separation of geometry 'bowl' must return without an exception (got SystemExit: 0, line 19" in outcome.err
    checked = command("check", tmp_path / "bowl.py")
    assert checked.code == 1
    assert "SystemExit: 0" in checked.out


def test_ctrl_c_in_a_plugin_is_the_users(bowl, tmp_path):
    text = BOWL.replace("return (x", "raise KeyboardInterrupt; return (x")
    (tmp_path / "bowl.py").write_text(text, encoding="utf-8")
    with pytest.raises(KeyboardInterrupt):
        ec.plan(ec.load_scene(bowl))


def test_two_files_with_one_key(bowl, tmp_path):
    (tmp_path / "dish.py").write_text(BOWL.replace("2 * self.bend", "4 * self.bend"), encoding="utf-8")
    both = "plugins=['bowl.py', 'dish.py']"
    with pytest.raises(PluginError, match=r"say 'bowl.py:bowl' or 'dish.py:bowl'$"):
        ec.plan(ec.load_scene(bowl, [both]))
    chosen = ec.plan(ec.load_scene(bowl, [both, "geometry.type=dish.py:bowl"]))
    assert chosen.model.interface.geometries[0].separation(1.0, 0.0) == close(1 / (4 * 105e-6), rel=1e-12)
    (tmp_path / "sub").mkdir()
    (tmp_path / "dish.py").rename(tmp_path / "sub" / "bowl.py")
    with pytest.raises(PluginError, match=r"geometry 'bowl' is already registered by bowl.py sha256:\w+; choose an"):
        ec.plan(ec.load_scene(bowl, ["plugins=['bowl.py', 'sub/bowl.py']"]))


def test_a_sweep_and_its_numbers_know_it(bowl):
    found = ec.sweep(bowl, {"geometry.bend": ["100 um", "200 um"]}).dataset
    assert found["geometry_bend"].attrs["units"] == "m"
    assert found["geometry_bend"].values.tolist() == [1e-4, 2e-4]
    ratio = float(found["max_pressure"][0] / found["max_pressure"][1])
    assert ratio == close(2 ** (2 / 3), rel=0.02)


@pytest.mark.slow
def test_processes_of_a_sweep_know_it(bowl, tmp_path):
    found = ec.sweep(bowl, {"steps.normal-load": ["0.1 N", "0.2 N"]}, tmp_path / "out", workers=2)
    assert found.failed == {}


@pytest.mark.slow
def test_pictures_and_report_need_results_alone(tmp_path):
    """A geometry and a worn coating of cells come from one file; without it, all pictures are the same."""
    file, folder = tmp_path / "own.py", tmp_path / "out"
    file.write_text(BOWL + DISC, encoding="utf-8")
    steel = {"young_modulus": 210e9, "poisson_ratio": 0.3}
    line = {"name": "axis", "shape": "line", "start": [0, 0, 0], "end": [0, 0, 8e-6], "count": 17}
    coating = {"type": "disc", "radius": 30e-6, "depth": 4e-6, "material": {**steel, "young_modulus": 420e9}}
    ec.run(
        {
            "plugins": [str(file)], "body1": steel, "body2": {"rigid": True},
            "geometry": {"type": "bowl", "bend": 200e-6}, "inclusions": [{**coating, "name": "hard disc"}],
            "grid": {"cells": [12, 12], "spacing": [6e-6, 6e-6]},
            "numerics": {"inclusion_pitch": 4e-6, "allow_coarse": True}, "output": {"pictures": False},
            "wear": {"type": "archard", "coefficient": 2.5e-16, "shares": {"body1": 0.7, "body2": 0.3}},
            "steps": [{"normal_load": 5.0}, {"normal_load": 5.0, "sliding_distance": 0.4, "increments": 2}],
            "stress": [{"name": "cut", "shape": "plane", "depth_max": 8e-6}, line],
        },
        folder,
    ).dataset.close()  # fmt: skip
    made = []
    for _ in range(2):
        installed_plugins.cache_clear()
        chosen = [ec.plot(folder, "equivalent_eigenstrain_1"), ec.plot(folder, "worn-coating")]
        page = report(folder).read_text(encoding="utf-8")
        made.append(([axes.figure.canvas.buffer_rgba().tobytes() for axes in chosen], page))
        file.unlink(missing_ok=True)
    assert "Worn surfaces over the interfaces" in page
    assert "Materials at the surface, by name" in page
    assert made[0] == made[1]


def test_it_is_listed(bowl, tmp_path, command):
    listed = command("plugins", tmp_path / "bowl.py")
    assert listed.code == 0
    assert "Paraboloid of one file.  (bowl.py sha256:" in listed.out
    assert "bend: a length [m]; required" in listed.out
    assert "sphere" not in listed.out


def test_editors_complete_its_keys(bowl, tmp_path, command):
    jsonschema = pytest.importorskip("jsonschema")
    scene = tomllib.loads(bowl.read_text(encoding="utf-8"))
    for files, accepted in (([], False), (["--plugin", tmp_path / "bowl.py"], True)):
        schema = json.loads(command("schema", "--json", *files).out)
        assert jsonschema.Draft202012Validator(schema).is_valid(scene) == accepted


def test_a_plugin_file_is_no_scene(bowl, tmp_path, command):
    assert 'a scene names a plugin file, plugins = ["bowl.py"]' in command("run", tmp_path / "bowl.py").err


# ---------------------------------------------------------------- the kit and the cross-check


def test_check_asks_the_kit(bowl, tmp_path, command):
    good = command("check", tmp_path / "bowl.py")
    assert good.code == 0, good.err
    assert "bowl.py:bowl" in good.out
    assert "kept   check_separation_arrays" in good.out
    assert "9 of 9 promises kept" in good.out
    (tmp_path / "bowl.py").write_text(BOWL.replace("return (x", "x += 0; return (x"), encoding="utf-8")
    installed_plugins.cache_clear()
    bad = command("check", tmp_path / "bowl.py", "--json")
    assert bad.code == 1
    failed = [one["check"] for one in json.loads(bad.out)["bowl.py:bowl"] if one["failed"]]
    assert "check_separation_pure" in failed


@pytest.mark.parametrize(
    ("answer", "words"),
    [
        ("np.ma.masked_less(x + y, 0)", "separation of geometry 'bowl' must return no masked values"),
        ("np.ma.masked_less(x + y, 0).astype(object)", "separation of geometry 'bowl' must return no masked values"),
        ("x + y > 0", "real numbers (got booleans of shape"),
        ("[1.0, 2.0, 3.0]", "broadcasts to shape"),
    ],
)
def test_check_finds_separations_that_are_no_numbers(answer, words, bowl, tmp_path, command):
    text = "import numpy as np\n" + BOWL.replace("return (x", f"return {answer}; return (x")
    (tmp_path / "bowl.py").write_text(text, encoding="utf-8")
    outcome = command("check", tmp_path / "bowl.py")
    assert outcome.code == 1
    assert words in outcome.out


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["bowl.py"], "geometry 'bowl' must have parameters for the check (got none); give --with b"),
        (["bolw"], "unknown plugin 'bolw'"),
        (["nowhere.py"], "no such file"),
    ],
)
def test_check_refuses(arguments, words, bowl, tmp_path, command, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "bowl.py").write_text(BOWL.replace("    example: ", "    sample: "), encoding="utf-8")
    outcome = command("check", *arguments)
    assert outcome.code == 2
    assert outcome.err.count("\n") == 1
    assert words in outcome.err


def test_check_knows_what_is_installed(command):
    outcome = command("check", "eigencontact:void")
    assert outcome.code == 0, outcome.err
    assert "kept   check_stiffness" in outcome.out


#: Files that a bundled plugin reads, which nobody can guess.
OF_FILES = {"map", "from-file", "gap-map", "polyhedron", "profile", "voxels"}


@pytest.mark.parametrize("entry", [entry for entry in installed_plugins() if entry.key not in OF_FILES], ids=str)
def test_bundled_plugins_have_an_example(entry):
    assert _example(entry, []).key == entry.key


@pytest.mark.parametrize(
    ("arguments", "kept"),
    [
        (["j2"], "kept   check_tangent"),
        (["j2", "--with", "hardening.yield-stress=300 MPa", "--with", "poisson-ratio=0.4"], "kept   check_tangent"),
        (["mazars", "--with", "A=0.5"], "kept   check_curve_slope"),
        (["void"], "kept   check_stiffness"),
        (["gap-map", "--with", "file=gap.npz"], "kept   check_separation_arrays"),
        (["bowl.py", "--with", "bend=2 mm"], "kept   check_separation_arrays"),
    ],
)
def test_check_takes_parameters(arguments, kept, bowl, tmp_path, command, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "bowl.py").write_text(BOWL.replace("    example: ", "    sample: "), encoding="utf-8")
    axis = np.linspace(-1e-6, 1e-6, 8)
    np.savez(tmp_path / "gap.npz", x=axis, y=axis, gap=axis**2 + axis[:, None] ** 2)
    outcome = command("check", *arguments)
    assert outcome.code == 0, outcome.out + outcome.err
    assert kept in outcome.out


@pytest.mark.parametrize(
    ("parameters", "words"),
    [
        ("poisson-ratio", "--with must be key=value"),
        ("poisson-ratio=2", "j2.poisson-ratio must be "),
        ("poison-ratio=0.3", "did you mean 'poisson-ratio'?"),
        ("hardening.yield-stress=-1 MPa", "j2.hardening.yield-stress must be "),
    ],
)
def test_check_refuses_parameters(parameters, words, command):
    outcome = command("check", "j2", "--with", parameters)
    assert outcome.code == 2
    assert words in outcome.err


def test_the_cross_check_knows_a_file_and_its_text(tmp_path):
    file = tmp_path / "bead.py"
    hashes = []
    for text in (BALL, BALL.replace("<= self.radius**2", "< self.radius**2"), BALL):
        installed_plugins.cache_clear()
        file.write_text(text, encoding="utf-8")
        assert _of_files([str(file)]) == (["bead"], [])
        hashes.append(content_hash(cases.cases_of("bead")[0], 0, "fixed"))
    assert hashes[0] == hashes[2] != hashes[1]


def test_processes_of_the_cross_check_know_it(tmp_path):
    (tmp_path / "bead.py").write_text(BALL, encoding="utf-8")
    serve(SimpleNamespace(recv=lambda: None), [str(tmp_path / "bead.py")])
    assert [entry.origin[:15] for entry in installed_plugins().named("bead")] == ["bead.py sha256:"]


def test_the_cross_check_wants_a_shape_or_a_law(bowl, tmp_path, command):
    for arguments in (["--plugin", tmp_path / "bowl.py"], [tmp_path / "bowl.py"]):
        installed_plugins.cache_clear()
        outcome = command("verify", *arguments)
        assert outcome.code == 2
        assert "--plugin must register a shape or a law (got geometry)" in outcome.err


def test_an_influence_of_a_file_takes_the_place_of_the_bundled_one(bowl, tmp_path):
    """A spring under each cell alone: by hand the pressure is its stiffness times what it is pressed by."""
    source = """
    from dataclasses import dataclass
    from typing import ClassVar
    import numpy as np
    from eigencontact.plugin import CornerInfluence, hookimpl

    @dataclass(frozen=True, kw_only=True)
    class Springs(CornerInfluence):
        key: ClassVar[str] = "springs"
        traction: ClassVar[str] = "p"

        def displacement_corner(self, components, x, y, z, material):
            return (np.sign(x) * np.sign(y) / 4 * 1e-6 / material.young_modulus)[None]

        def stress_corner(self, components, x, y, z, material):
            raise NotImplementedError

    @hookimpl
    def eigencontact_register():
        return [Springs]
    """
    (tmp_path / "springs.py").write_text(dedent(source), encoding="utf-8")
    plain = ec.run(ec.load_scene(bowl))
    result = ec.run(ec.load_scene(bowl, ["plugins=['bowl.py', 'springs.py']", "steps.normal-load=0.1 N"]))
    assert result.summary["versions"]["plugin surface-influence springs"].startswith("springs.py sha256:")
    assert "plugin surface-influence pressure" in plain.summary["versions"]
    x = result.dataset["x"].values[12]
    by_hand = 210e9 / 1e-6 * (result.summary["approach"] - 2 * x**2 / (2 * 105e-6))
    assert float(result.dataset["pressure"][0, 12, 12]) == close(by_hand, rel=1e-5)
