"""Every bad input: one clear line that names field, rule, value and what to do; exit code; nothing written."""

import os
from pathlib import Path

import numpy as np
import pytest

from eigencontact import EigencontactError, load_scene, plan, run
from one_line import one_line_error

# (changes to the scene "hertz", words that the message must hold)
REFUSED = {
    "negative modulus": (["body1.young-modulus=-1"], "body1.young-modulus must be positive and finite [Pa] (got -1)"),
    "zero modulus": (["body1.young-modulus=0.0"], "body1.young-modulus must be positive and finite [Pa] (got 0.0)"),
    "NaN modulus": (["body1.young-modulus=nan"], "body1.young-modulus must be positive and finite [Pa] (got nan)"),
    "infinite modulus": (["body1.young-modulus=inf"], "body1.young-modulus must be positive and finite [Pa] (got inf)"),
    "ν above": (["body1.poisson-ratio=0.51"], "body1.poisson-ratio must be in (-1, 0.5] [-] (got 0.51)"),
    "ν below": (["body1.poisson-ratio=-1.0"], "body1.poisson-ratio must be in (-1, 0.5] [-] (got -1.0)"),
    "NaN ν": (["body1.poisson-ratio=nan"], "body1.poisson-ratio must be in (-1, 0.5] [-] (got nan)"),
    "half a material": (
        ["body2={poisson-ratio=0.3}"],
        "body2 must be rigid = true, or elastic with young-modulus given",
    ),
    "rigid and elastic": (["body1.rigid=true"], "body1 must be rigid without elastic constants, or elastic"),
    "both rigid": (["body1={rigid=true}"], "body1 and body2 must not both be rigid; give one of them young-modulus"),
    "negative load": (
        ["steps.normal-load=-0.5"],
        "steps.normal-load must be zero or positive, and finite [N] (got -0.5)",
    ),
    "NaN load": (["steps.normal-load=nan"], "steps.normal-load must be zero or positive, and finite [N] (got nan)"),
    "load and approach": (["steps.approach=1e-7"], "steps must be controlled by normal-load or approach, not both"),
    "no control": (["steps={increments=2}"], "steps must be controlled by normal-load or approach: give one of them"),
    "moment and tilt": (
        ["steps.moment-x=0.0", "steps.tilt-x=0.0"],
        "steps must be controlled by moment-x or tilt-x, not both",
    ),
    "no steps": (["steps=[]"], "steps must be an array of length at least 1 (got length 0)"),
    "zero increments": (["steps.increments=0"], "steps.increments must be 1 or more (got 0)"),
    "numbered step": (
        ['steps=[{normal-load=1.0}, {normal-load="-1 N"}]'],
        "steps.1.normal-load must be zero or positive, and finite [N] (got '-1 N')",
    ),
    "unknown scene key": (["colour=3"], "unknown key 'colour' in the scene; known: name, title"),
    "unknown table": (["bodi1.rigid=true"], "unknown key 'bodi1' in the scene; known: name, title, description, "),
    "nearest table": (["gird.cells=8"], "did you mean 'grid'?"),
    "unknown key of a table": (
        ["body1.poison-ratio=0.3"],
        "unknown key 'poison-ratio' in body1; known: rigid, young-modulus, poisson-ratio, medium, law, initial, bulk-s",
    ),
    "unknown key of an array": (
        ["stress.1.cuont=3"],
        "unknown key 'cuont' in stress 'axis' (second); known: name, shape",
    ),
    "unknown key of a component": (
        ["geometry.radus=1"],
        "unknown key 'radus' in geometry (sphere); known: radius, profile, center; did you mean 'radius'?",
    ),
    "missing key of a component": (["geometry={type='sphere'}"], "geometry.radius must be given (sphere needs it)"),
    "refused by a component": (["geometry.radius=-1"], "geometry.radius must be positive and finite [m] (got -1.0)"),
    "NaN of a component": (["geometry.radius=nan"], "geometry.radius must be positive and finite [m] (got nan)"),
    "unknown plugin": (
        ["geometry.type=shpere"],
        (
            "geometry: unknown geometry 'shpere'; installed: 'cylinder', 'ellipsoid', 'gap-map', 'profile', "
            "'random-rough', 'rounded-cone', 'rounded-punch', 'sphere', 'topography', 'wedge'; did you mean 'sphere'?"
        ),
    ),
    "unknown observer": (
        ["observers=[{type='prob'}]"],
        "unknown observer 'prob'; installed: 'dissipated-energy', 'fretting-loop', 'plastic-zone', 'probe', ",
    ),
    "component without type": (["geometry={radius=1.0}"], "geometry.type must name a geometry (got None); installed:"),
    "wrong dimension": (
        ["body1.young-modulus=210 um"],
        "body1.young-modulus must be a stress [Pa]; '210 um' has the dimension [length] (got '210 um')",
    ),
    "wrong dimension of a component": (
        ["geometry.radius=3 N"],
        "geometry.radius must be a length [m]; '3 N' has the dimension",
    ),
    "number without unit in text": (["geometry.radius='105'"], "geometry.radius must be a length [m]"),
    "misspelt unit": (
        ["body1.young-modulus=210 GPA"],
        "body1.young-modulus must be a stress [Pa]; there is no unit 'GPA'; did you mean 'GPa'? (got '210 GPA')",
    ),
    "misspelt prefix": (["geometry.radius=105 umm"], "there is no unit 'umm'; did you mean 'um'? (got '105 umm')"),
    "no number at all": (["geometry.radius=wide"], "geometry.radius must be a length [m], as a number or as text like"),
    "not a number": (["body1.poisson-ratio=soft"], "body1.poisson-ratio must be a number (got 'soft')"),
    "wrong choice": (
        ["numerics.boundary=periodc"],
        (
            "numerics.boundary must be one of 'non-periodic', 'periodic' or 'periodic-y' (got 'periodc'); did you mean "
            "'periodic'?"
        ),
    ),
    "tolerance": (["numerics.tolerance=0"], "numerics.tolerance must be in [1e-13, 0.1] [-] (got 0)"),
    "one of cells, size, spacing": (["grid={cells=8}"], "grid must be two of cells, size, spacing, or none of them"),
    "no cells": (["grid={cells=0, size=[1.0, 1.0]}"], "grid must be of at least 1 cell each way"),
    "NaN size": (["grid={cells=8, size=[nan, 1.0]}"], "grid.size.0 must be positive and finite [m] (got nan)"),
    "three cells": (["grid={cells=[1, 2, 3], size=[1.0, 1.0]}"], "grid.cells must be an array of length at most 2"),
    "same names": (["stress.1.name=section"], "stress regions must have different names (got 'section' twice)"),
    "stress in a rigid body": (
        ["stress.0.body=2"],
        "stress region 'section' must lie in an elastic body (got a rigid body2)",
    ),
    "negative depth": (
        ["stress.0.depth-max=-1"],
        "depth-max of stress 'section' (first) must be positive and finite [m] (got -1)",
    ),
    "a depth twice": (
        ["stress=[{shape='volume', depths=[0.0, 1e-6, 1e-6]}]"],
        "stress.0 must be given depths that ascend, each once",
    ),
    "no depth": (
        ["stress=[{shape='volume'}]"],
        "stress.0 must be given depths or depth-max (a volume needs one of them)",
    ),
    "line of a periodic scene": (
        ["numerics.boundary=periodic", "grid={cells=8, size=[1.0, 1.0]}"],
        "stress regions of a periodic scene must be planes or volumes (got a line or points)",
    ),
    "automatic grid of a periodic scene": (
        ["numerics.boundary=periodic", "stress=[]"],
        "grid must be given for a periodic scene (got automatic); its size is the period: give cells and size",
    ),
    "automatic grid without load": (["steps.normal-load=0"], "grid must be given for this scene (got automatic)"),
    "memory": (
        ["grid={cells=200000, size=[1e-4, 1e-4]}"],
        "grid.cells must make at most ",
    ),
    "moment": (
        ["grid={cells=16, size=[2e-5, 2e-5]}", "steps.moment-y=1e-3"],
        "steps.moment-y must be smaller than the load times half the window, 6.5e-06 N m (got 0.001)",
    ),
    "load beyond the window": (
        ["grid={cells=16, size=[2e-5, 2e-5]}", "steps.normal-load=50"],
        (
            "contact must stay inside the window (in load step 1, at normal load 50 N, it reaches its edge along x and "
            "y; the window is 20 um x 20 um, given in the scene); lower the normal load (about "
        ),
    ),
    "probe outside": (
        ["observers=[{type='probe', points=[[1.0, 0.0]]}]", "grid={cells=16, size=[2e-5, 2e-5]}"],
        "probe.points must be inside the window",
    ),
    "probe of nothing": (
        ["observers=[{type='probe', field='presure', points=[[0.0, 0.0]]}]", "grid={cells=16, size=[2e-5, 2e-5]}"],
        "probe.field must be one of 'displacement_z', 'gap', 'pressure'",
    ),
    "name with a slash": (["name=a/b"], "name must be a plain name: letters, digits, '_'"),
    "zero in a title": (['title="a\\u0000"'], "title must be text without control characters (got 'a\\x00')"),
    "bell in a description": (
        ['description="a\\u0007"'],
        "description must be text without control characters (got 'a\\x07')",
    ),
    "tables nested 60 deep": ([f"geometry.radius={'[' * 60}{']' * 60}"], "nested at most 32 deep (got more)"),
    "arrays nested 5000 deep": (
        [f"geometry.radius={'[' * 5000}{']' * 5000}"],
        "geometry.radius must be a length [m], as a number or as text",
    ),
    "missing topography": (
        ["geometry={type='topography', file='nowhere.npz'}"],
        "geometry.file must be an existing file (got 'nowhere.npz')",
    ),
    "unknown --set array entry": (
        ["stress.7.name=a"],
        "--set 'stress.7.name=a': stress is an array of 2; give a number",
    ),
    "--set into a value": (["body1.young-modulus.x.y=1"], "body1.young-modulus must be a number (got {'x': {'y': 1}})"),
    "--set of a number that is none": (["stress.².name=a"], "--set 'stress.².name=a': stress is an array of 2; give"),
    "--set of an entry of an empty array": (
        ["stress=[]", "stress.0.name=a"],
        "--set 'stress.0.name=a': stress is an array of 0; give all of it (got '0')",
    ),
    "--set without value": (["steps"], "--set must be key=value with a dotted key, like body1.poisson-ratio=0.3"),
}
CODES = {"load beyond the window": 4}


def refused(outcome, words, code=2):
    """One line on stderr, with the words; nothing on stdout."""
    assert outcome.err.startswith("eigencontact: ")
    assert outcome.err.count("\n") == 1, outcome.err
    assert "Traceback" not in outcome.err
    assert words in outcome.err
    assert outcome.out == ""
    assert outcome.code == code


@pytest.mark.parametrize("case", REFUSED)
def test_the_command_refuses_with_one_line_and_writes_nothing(case, command, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    changes, words = REFUSED[case]
    arguments = [part for change in changes for part in ("--set", change)]
    refused(command("run", "hertz", "-o", "out/deeper", *arguments), words, CODES.get(case, 2))
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("case", ["negative modulus", "unknown plugin", "moment", "load beyond the window"])
def test_the_python_call_refuses_with_the_same_words(case):
    changes, words = REFUSED[case]
    with one_line_error(words, CODES.get(case, 2)):
        run(plan(load_scene("hertz", [*changes, "stress=[]"])))


def test_several_findings_are_counted():
    with pytest.raises(EigencontactError, match=r"young-modulus must be .* \(and 1 more\)$"):
        load_scene("hertz", ["body1.young-modulus=-1", "body1.poisson-ratio=3"])


SOURCES = {
    "missing file": ("nothing.toml", None, "scene file must exist (got 'nothing.toml')"),
    "missing file near a bundled one": ("herz.toml", None, "did you mean 'hertz'?"),
    "unknown name": ("herz", None, "(got 'herz', and no such file); did you mean 'hertz'?; `eigencontact gallery`"),
    "unknown name, nearest": ("herz", None, "did you mean 'hertz'?"),
    "a folder": ("folder.toml", "folder", "scene file must be readable text (got 'folder.toml')"),
    "not TOML": ("bad.toml", b"title = \n", "bad.toml must be valid TOML: "),
    "not text": ("bytes.toml", b"\xff\xfe\x00", "scene file must be readable text (got 'bytes.toml')"),
    "empty": ("empty.toml", b"", "body1 must be given"),
    "arrays nested 5000 deep": (
        "deep.toml",
        b"title = " + 5000 * b"[" + 5000 * b"]",
        "deep.toml must be a scene (got tables or arrays nested hundreds deep)",
    ),
    "tables nested 5000 deep": ("deep.toml", b"[" + b".".join([b"a"] * 5000) + b"]\n", "nested"),
    "tables nested 300 deep": (
        "deep.toml",
        b"[" + b".".join([b"a"] * 300) + b"]\n",
        "nested at most 32 deep (got more)",
    ),
    "a number for a table": ("list.toml", b"body1 = 3\n", "body1 must be a table (got 3)"),
}


def test_a_missing_file_near_another_beside_it(tmp_path):
    (tmp_path / "coated.toml").touch()
    with pytest.raises(EigencontactError, match=r"must exist \(got '.*coatd.toml'\); did you mean 'coated.toml'\?"):
        load_scene(tmp_path / "coatd.toml")


@pytest.mark.parametrize("verb", ["run", "explain"])
@pytest.mark.parametrize("case", SOURCES)
def test_sources_that_are_no_scene(case, verb, command, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    name, content, words = SOURCES[case]
    if content == "folder":
        (tmp_path / name).mkdir()
    elif content is not None:
        (tmp_path / name).write_bytes(content)
    before = sorted(tmp_path.iterdir())
    refused(command(verb, name), words)
    assert sorted(tmp_path.iterdir()) == before


def test_heights_that_are_not_numbers_are_refused(command, scene_file, tmp_path):
    heights = np.zeros((24, 24))
    heights[3, 4] = np.nan
    np.savez(tmp_path / "rough.npz", heights=heights, dx=1e-6, dy=1e-6)
    path = scene_file(geometry='type = "topography"\nfile = "rough.npz"')
    outcome = command("run", path, "-o", tmp_path / "out")
    refused(outcome, "geometry.file must be without missing points (got ")
    assert "1 of 576 missing); set missing = 'far'" in outcome.err
    assert not (tmp_path / "out").exists()


def test_a_folder_that_is_a_file_is_refused(command, quick, tmp_path):
    (tmp_path / "out").write_text("mine")
    outcome = command("run", "hertz", *quick, "-o", tmp_path / "out")
    refused(outcome, "must be a folder that can be written", code=5)
    assert (tmp_path / "out").read_text() == "mine"


@pytest.mark.parametrize("folder", ["x" * 5000, "/dev/null/x"])
def test_a_name_that_no_folder_has_is_refused(folder, command, quick, tmp_path):
    refused(command("run", "hertz", *quick, "-o", folder), "must be a folder that can be written", code=5)
    assert "Traceback" not in command("plot", folder).err
    assert command("plot", folder).code == 5
    refused(command("new-plugin", "fibre", "-o", folder), "folder must be one that can be written")


@pytest.mark.skipif(os.geteuid() == 0, reason="root writes everywhere")
def test_a_folder_without_permission_is_refused(command, quick, tmp_path):
    locked = tmp_path / "locked"
    locked.mkdir()
    locked.chmod(0o500)
    refused(command("run", "hertz", *quick, "-o", locked / "out"), "choose another with -o", code=5)


@pytest.mark.skipif(not Path("/proc").is_dir(), reason="no /proc here")
def test_a_folder_that_cannot_be_made_is_refused(command, quick):
    refused(command("run", "hertz", *quick, "-o", "/proc/eigencontact"), "choose another with -o", code=5)
