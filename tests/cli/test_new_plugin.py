"""``eigencontact new-plugin``: what it writes registers and passes its own tests as it stands."""

import os
import re
import subprocess
import sys
import tomllib

import pytest

from eigencontact.errors import PluginError
from eigencontact.hooks.files import with_files
from eigencontact.plugin import KINDS
from eigencontact.scene.installed import installed_plugins
from eigencontact.skeleton import TEMPLATES, write_package


def pretend_installed(package, site):
    """Leave the metadata that ``pip install -e`` leaves; the folder that is returned goes on the path."""
    project = tomllib.loads((package.folder / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    info = site / f"{project['name'].replace('-', '_')}-{project['version']}.dist-info"
    info.mkdir(parents=True)
    (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {project['name']}\nVersion: {project['version']}\n")
    points = "\n".join(f"{name} = {module}" for name, module in project["entry-points"]["eigencontact"].items())
    (info / "entry_points.txt").write_text(f"[eigencontact]\n{points}\n")
    return package.folder / "src"


@pytest.mark.slow
def test_every_kind_passes_its_tests_as_written(tmp_path):
    packages = [write_package(f"my-{kind}", kind=kind, folder=tmp_path / kind) for kind in TEMPLATES]
    site = tmp_path / "site"
    paths = [str(site), *(str(pretend_installed(package, site)) for package in packages)]
    done = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-W", "error", "--import-mode=importlib", "-p", "no:cacheprovider",
         *(str(package.folder / "tests") for package in packages)],
        cwd=tmp_path, env=os.environ | {"PYTHONPATH": os.pathsep.join(paths)},
        capture_output=True, text=True, check=False, timeout=120,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout
    # 27 checks for each of two balls, 19 for each of two laws, 10 for each of two fields, some for all others
    passed = int(re.search(r"(\d+) passed", done.stdout)[1])
    assert passed >= 80
    assert "skipped" not in done.stdout


@pytest.mark.parametrize("kind", TEMPLATES)
def test_what_is_written(kind, tmp_path):
    package = write_package("hollow-ball", kind=kind, folder=tmp_path / "new")
    assert {str(path.relative_to(package.folder)) for path in package.files} == {
        "pyproject.toml", "README.md", "src/eigencontact_hollow_ball/__init__.py", "tests/test_conformance.py",
    }  # fmt: skip
    for path in package.files:
        text = path.read_text(encoding="utf-8")
        assert not re.search(r"<(package|module|class|key|version)>", text), path
        assert "hollow-ball" in text or "HollowBall" in text
        if path.suffix == ".py":
            compile(text, str(path), "exec")
            assert max(len(line) for line in text.splitlines()) <= 120
    project = tomllib.loads((package.folder / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert project["name"] == "eigencontact-hollow-ball"
    assert project["entry-points"]["eigencontact"] == {"hollow-ball": "eigencontact_hollow_ball"}
    module = (package.folder / "src/eigencontact_hollow_ball/__init__.py").read_text(encoding="utf-8")
    assert "def eigencontact_register():" in module
    assert f"The example is {TEMPLATES[kind]};" in module


def test_templates_are_of_kinds_that_exist():
    assert set(TEMPLATES) <= set(KINDS)
    assert TEMPLATES["geometry"] == "a bowl of fourth order"


def test_the_command_says_what_to_do_next(command, tmp_path):
    done = command("new-plugin", "hollow-ball", "-o", tmp_path / "here")
    assert done.code == 0
    assert "a package with one inclusion-shape, 'hollow-ball'" in done.out
    assert f'pip install -e "{tmp_path / "here"}[test]"' in done.out
    assert "python -m pytest" in done.out


def test_the_prefix_is_not_doubled(tmp_path):
    assert write_package("eigencontact-fibre", folder=tmp_path / "a").key == "fibre"


# (arguments, words of the refusal)
REFUSED = [
    (("Hollow Ball",), "(got 'Hollow Ball'); say 'hollow-ball'"),
    (("hollow_ball",), "(got 'hollow_ball'); say 'hollow-ball'"),
    (("3d",), "name must be of lower-case letters, digits and single hyphens (got '3d'); say 'd'"),
    (("a--b",), "say 'a-b'"),
    (("../up",), "say 'up'"),
    (("",), "(got '')"),
    (("none",), "name must not stand for a word of Python, None (got 'none')"),
    (("cuboid",), "name must be new (got 'cuboid', the inclusion-shape of eigencontact"),
    (("fibre", "--kind", "shape"), "(got 'shape')"),
    (("fibre", "--kind", "geometri"), "did you mean 'geometry'?"),
]


@pytest.mark.parametrize(("arguments", "words"), REFUSED)
def test_refusals(arguments, words, command, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    done = command("new-plugin", *arguments)
    assert done.code == 2
    assert words in done.err
    assert done.err.count("\n") == 1
    assert not list(tmp_path.iterdir())


def test_nothing_is_overwritten(command, tmp_path):
    (tmp_path / "mine.txt").write_text("mine")
    done = command("new-plugin", "fibre", "-o", tmp_path)
    assert done.code == 2
    assert "folder must be new or empty" in done.err
    assert [path.name for path in tmp_path.iterdir()] == ["mine.txt"]
    with pytest.raises(PluginError, match="folder must be new or empty"):
        write_package("fibre", folder=tmp_path / "mine.txt")


@pytest.mark.parametrize("kind", TEMPLATES)
def test_a_single_file_is_one_plugin_that_a_scene_can_name(kind, tmp_path, monkeypatch, command):
    monkeypatch.chdir(tmp_path)
    written = command("new-plugin", "my-own", "--kind", kind, "--file")
    assert written.code == 0, written.err
    assert 'plugins = ["my_own.py"]' in written.out
    (entry,) = set(with_files(installed_plugins(), [tmp_path / "my_own.py"])) - set(installed_plugins())
    assert (entry.kind, entry.key) == (kind, "my-own")
    assert kind == "inclusion-shape" or entry.component(**entry.component.example)
    again = command("new-plugin", "my-own", "--kind", kind, "--file")
    assert again.code == 2
    assert "file must be new, where it can be written (got " in again.err
