"""What a shell is offered: names of commands, scenes, plugins, tables; and that no key press waits for numpy."""

import json
import os
import subprocess
import sys

import pytest

from eigencontact import completion
from eigencontact.reference.tables import all_tables
from eigencontact.scene.installed import installed_plugins
from eigencontact.scene.loader import bundled_names


def offered(words, folder):
    """Offers for the last of these words, and whether anything heavy was loaded, in a process of its own."""
    code = (
        "import json, sys, atexit\nfrom eigencontact.cli import main\n"
        "atexit.register(lambda: print(json.dumps([m in sys.modules for m in ('numpy', 'pluggy')])))\nmain()"
    )
    shell = {
        "_EIGENCONTACT_COMPLETE": "complete_bash", "COMP_WORDS": " ".join(words), "COMP_CWORD": str(len(words) - 1),
    }  # fmt: skip
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=False, timeout=60, cwd=folder,
        env={**os.environ, **shell},
    )  # fmt: skip
    *lines, loaded = done.stdout.splitlines()
    return lines, json.loads(loaded), done.stderr


CASES = {
    "commands": (["eigencontact", ""], {"run", "sweep", "verify", "check"}),
    "a scene": (["eigencontact", "run", "cattaneo"], {"cattaneo-mindlin"}),
    "a plugin": (["eigencontact", "plugins", "archa"], {"archard"}),
    "a command of another package": (["eigencontact", "sweep", "cattaneo"], {"cattaneo-mindlin"}),
}


@pytest.mark.parametrize("case", CASES)
def test_a_shell_is_offered(case, tmp_path):
    words, expected = CASES[case]
    lines, heavy, errors = offered(words, tmp_path)
    assert set(lines) >= expected if words[-1] == "" else set(lines) == expected
    assert heavy == [False, False]
    assert errors == ""


def test_names_are_those_that_there_are():
    assert completion.bundled("") == bundled_names()
    assert sorted(completion.tables("")) == sorted(name for name in all_tables(installed_plugins()) if name)
    bundled = {entry.key for entry in installed_plugins() if entry.bundled}
    assert bundled <= set(completion.plugin_keys(""))
    assert completion.kinds("friction") == ["friction-law"]


def test_files_and_folders_are_offered_as_they_are_typed(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mine" / "deep").mkdir(parents=True)
    for name in ("mine.toml", "mine.txt", "mine/results.nc", ".hidden.toml"):
        (tmp_path / name).write_text("")
    assert completion.scenes("mi") == ["mine/", "mine.toml"]
    assert completion.scenes(f"{tmp_path}/mi") == [f"{tmp_path}/mine/", f"{tmp_path}/mine.toml"]
    assert completion.results("mine/") == ["mine/deep/", "mine/results.nc"]
    assert completion.results("no/such/") == []
