"""Are the lower bounds of pyproject.toml true? All at once, with the first run of README and a part of the tests.

Every package that pyproject.toml names, for running and for the tests, is installed at its lower bound, from wheels
alone, into an environment of its own, on the lowest Python that is declared; what those need comes at its newest.
Then the command of README's first block that solves something, and tests that touch each of these packages.
Their own warnings of what is deprecated do not count.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
#: Each package is used by one of them at least.
TESTS = (
    "tests/cli/test_commands.py",  # typer, rich, pydantic, pluggy
    "tests/convolution",  # numpy, scipy, pyfftw, numba
    "tests/core",  # pint
    "tests/hooks/test_plugin_files.py",
    "tests/results/test_store.py",  # xarray, h5netcdf, h5py, tomli-w
    "tests/results/test_formats.py",
    "tests/viz/test_figures.py",  # matplotlib
    "tests/viz/test_animation.py",  # pillow
    "tests/viz/test_vtk.py",  # pyvista
    "tests/reports",  # jinja2, markupsafe, pygments
    "tests/plugins/test_polyhedron.py",  # meshio
    "tests/solvers/test_hertz.py",
    "tests/solvers/test_subsurface.py",
    "tests/execution/test_friction_runs.py",
    "tests/execution/test_inhomogeneity_runs.py",
    "tests/verification/test_fem_solid.py",  # scikit-fem, pyamg
    "tests/test_library.py",
)
_REQUIREMENT = re.compile(r"([A-Za-z0-9._-]+)>=([0-9.]+)\s*(;.*)?")


def lowest(project: dict[str, object]) -> list[str]:
    """Every requirement for running and testing, at its lower bound."""
    extras = project["optional-dependencies"]
    found = []
    for text in (*project["dependencies"], *extras["test"]):
        match = _REQUIREMENT.fullmatch(text)
        if match is None:
            raise SystemExit(f"a requirement in pyproject.toml must be 'name>=version' (got {text!r})")
        name, version, marker = match.groups()
        found.append(f"{name}=={version}{marker or ''}")
    return found


def python_of(project: dict[str, object]) -> str:
    """Interpreter of the lowest version that is declared."""
    version = str(project["requires-python"]).removeprefix(">=")
    if version == "{}.{}".format(*sys.version_info[:2]):
        return sys.executable
    found = shutil.which(f"python{version}")
    if found is None:
        raise SystemExit(f"python{version}, the lowest that pyproject.toml declares, must be installed (got none)")
    return found


def first_run() -> str:
    """Command of README's first block that solves something, without the environment that the block makes."""
    block = re.search(r"<!-- command: run -->\s*```sh\n(.+?)\n```", (ROOT / "README.md").read_text("utf-8"), re.DOTALL)
    if block is None:
        raise SystemExit("README.md must have a fenced block after '<!-- command: run -->' (got none)")
    return block[1].split("&&")[-1].strip().removeprefix(".venv/bin/")


def main() -> None:
    """Install, run, test."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    pins = lowest(project)
    with tempfile.TemporaryDirectory() as folder:
        work = Path(folder)
        (work / "pins.txt").write_text("\n".join(pins) + "\n", encoding="utf-8")
        subprocess.run([python_of(project), "-m", "venv", work / "env"], check=True)
        bin_ = work / "env" / "bin"
        pip = [bin_ / "python", "-m", "pip", "install", "--quiet"]
        subprocess.run([*pip, "--only-binary=:all:", "-r", work / "pins.txt"], check=True)
        subprocess.run([*pip, "--no-deps", ROOT], check=True)
        here = {**os.environ, "PATH": f"{bin_}{os.pathsep}{os.environ['PATH']}"}
        (work / "run").mkdir()
        subprocess.run(first_run().split(), cwd=work / "run", env=here, check=True)
        for name in ("summary.json", "results.nc"):
            if not (work / "run" / name).stat().st_size:
                raise SystemExit(f"{name} of the first run must hold something (got an empty file)")
        ours = ["-n", "2", "-q", "-p", "no:cacheprovider", "-o", "filterwarnings=default"]
        subprocess.run([bin_ / "python", "-m", "pytest", *ours, *TESTS], cwd=ROOT, env=here, check=True)


if __name__ == "__main__":
    main()
