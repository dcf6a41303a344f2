"""Shared fixtures: finished runs, the command line called in process, plugin packages in a folder of the test."""

import gc
import json
import os
import pickle
import shutil
import sys
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from hashlib import sha256
from pathlib import Path
from textwrap import dedent

import pytest
from hypothesis import settings

# Examples have no time limit: the machine may be busy.
settings.register_profile("without-deadline", deadline=None)
settings.load_profile("without-deadline")
# Several test processes share the cores; threads of BLAS that spin in each of them would stand in each other's way.
os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
# A process that a test starts need not compile all modules anew, which takes it a second or more.
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
# A test computes its own tables, whatever the user or another test has kept; those of the cache name a folder.
os.environ["EIGENCONTACT_CACHE"] = "off"

#: A package of its own: `test_third_party` installs it and runs its tests.
collect_ignore = ["sample_package"]


@pytest.hookimpl(wrapper=True)
def pytest_collection():
    """Collect tests without searches for garbage, which take a third of that time: what is collected stays."""
    gc.disable()
    try:
        return (yield)
    finally:
        gc.enable()


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_setup(item):
    """Leave collected tests and imported modules out of searches for garbage: at each test file, and after imports.

    Drawing and measurements of memory collect garbage, which takes a third of a second with all of them in the search.
    """
    state = item.path, len(sys.modules) // 50
    if _searched[:] != [state]:
        _searched[:] = [state]
        gc.collect()
        gc.freeze()


#: Test file and rough number of modules at the last search for garbage.
_searched = []


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config, log):
    """Give all tests of a file to one process, which makes once what they share, unless the call says otherwise."""
    if config.getoption("dist") != "load":
        return None
    from xdist.scheduler import LoadFileScheduling

    return LoadFileScheduling(config, log)


@pytest.fixture(scope="session")
def finished(tmp_path_factory):
    """Run each scene once for all tests and test processes: ``finished(scene, *changes)`` gives its `RunResult`.

    With ``stored=True`` the run has a folder of its own, with the pictures and files that the scene asks for.
    """
    import eigencontact as ec

    shared = tmp_path_factory.getbasetemp()
    shared = (shared.parent if "PYTEST_XDIST_WORKER" in os.environ else shared) / "finished"
    shared.mkdir(exist_ok=True)
    results = {}

    def run(scene, *changes, stored=False):
        # A scene counts as what it holds: another one at the same place in memory has another text.
        text = scene if isinstance(scene, str) else json.dumps(scene.resolved(), default=str)
        key = sha256(repr((text, changes, stored)).encode()).hexdigest()[:24]
        if key not in results:
            file = shared / f"{key}.pickle"
            with only_process(shared / f"{key}.lock"):
                if not file.exists():
                    result = ec.run(ec.load_scene(scene, list(changes)), shared / key if stored else None)
                    assert result.summary["converged"] is True
                    file.write_bytes(pickle.dumps(result))
            while len(results) >= 8:  # their arrays need not stay in memory
                results.pop(next(iter(results)))
            results[key] = pickle.loads(file.read_bytes())
        return results[key]

    return run


@contextmanager
def only_process(lock):
    """Hold a lock among processes, which the system takes back from one that dies; none where there is no such lock."""
    with lock.open("w") as file:
        try:
            import fcntl
        except ImportError:  # Windows: two processes may then run the same scene
            pass
        else:
            fcntl.flock(file, fcntl.LOCK_EX)
        yield


@pytest.fixture(scope="module")
def small_pictures():
    """Store small empty pictures from here on to the end of the test file, where their contents do not matter."""
    from eigencontact.viz import figures, style

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(style, "save", partial(save_small, save=style.save))
        patch.setattr(figures, "save", style.save)
        yield


def save_small(_figure, path, _dpi=None, caption="", *, save):
    """Store an empty picture as `save` stores a figure."""
    from eigencontact.viz.style import new_figure

    figure = new_figure(1.0, 1.0)
    figure.add_subplot().set_axis_off()
    save(figure, path, 20, caption)


@dataclass(frozen=True)
class Outcome:
    """What a command returned and printed."""

    code: int
    out: str
    err: str


@pytest.fixture(scope="session")
def program():
    """Program of the command line, put together once: that takes longer than most refusals."""
    from typer.main import get_command

    from eigencontact.cli import app

    return get_command(app)


@pytest.fixture
def command(capsys, program):
    """Call the command line as the console script does: ``command("run", "hertz", "-o", folder)``."""

    def call(*arguments):
        capsys.readouterr()
        try:
            program(args=[str(item) for item in arguments], prog_name="eigencontact")
            code = 0
        except SystemExit as leaving:
            code = leaving.code or 0
        return Outcome(code, *capsys.readouterr())

    return call


#: Changes that make a bundled scene quick where its numbers do not matter.
QUICK = ["stress=[]", "grid.cells-per-contact-radius=8", "output.pictures=false", "output.vtk=false"]


@pytest.fixture
def quick():
    """Arguments ``--set ...`` that make the scene ``hertz`` quick."""
    return [part for change in QUICK for part in ("--set", change)]


@pytest.fixture
def scene_file(tmp_path):
    """Write a small TOML scene; the text given is added to it."""

    def write(extra="", *, geometry='type = "sphere"\nradius = "105 um"', load='normal-load = "0.65 N"', name="small"):
        text = f"""
[body1]
young-modulus = "210 GPa"
poisson-ratio = 0.3

[geometry]
{geometry}

[grid]
cells = 24
size = ["16 um", "16 um"]

[steps]
{load}

[numerics]
threads = 1

[output]
pictures = false

{dedent(extra)}
"""
        path = tmp_path / f"{name}.toml"
        path.write_text(text, encoding="utf-8")
        return path

    return write


@pytest.fixture
def install(tmp_path, monkeypatch):
    """Install a package with an entry point the way pip leaves it: a module and its ``.dist-info`` on ``sys.path``."""
    from eigencontact.scene.installed import installed_plugins

    site = tmp_path / "site"
    site.mkdir()
    monkeypatch.syspath_prepend(str(site))
    names = []

    def package(source, *, name="eigencontact-stranger", version="1.2.3", entry="stranger", target=None):
        module = name.replace("-", "_")
        names.append(module)
        (site / f"{module}.py").write_text(dedent(source), encoding="utf-8")
        info = site / f"{module}-{version}.dist-info"
        info.mkdir()
        (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: {version}\n", encoding="utf-8")
        points = f"[eigencontact]\n{entry} = {target or module}\n"
        (info / "entry_points.txt").write_text(points, encoding="utf-8")
        installed_plugins.cache_clear()
        return site

    installed_plugins.cache_clear()
    yield package
    installed_plugins.cache_clear()
    for module in names:
        sys.modules.pop(module, None)
    shutil.rmtree(site)


@pytest.fixture(scope="session")
def root():
    """Root of the checkout."""
    return Path(__file__).resolve().parent.parent
