"""What importing costs: the package itself stays light, and a run loads only what its scene needs."""

import json
import subprocess
import sys

import pytest

#: Never loaded by ``import eigencontact``.
HEAVY = {"vtk", "pyvista", "matplotlib", "skfem", "meshio", "scipy", "numpy", "xarray", "h5netcdf", "h5py", "pydantic"}


def fresh(code):
    """Standard output of a fresh interpreter."""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False, timeout=120)
    assert done.returncode == 0, done.stderr
    return done.stdout


def loaded(code):
    """Modules in memory after `code`."""
    return set(json.loads(fresh(f"{code}\nimport json, sys; print(json.dumps(sorted(sys.modules)))").splitlines()[-1]))


def test_the_package_loads_nothing_heavy():
    modules = loaded("import eigencontact")
    assert not modules & HEAVY
    assert {name for name in modules if name.startswith("eigencontact")} == {"eigencontact"}


def test_public_names_load_no_drawing_and_no_finite_elements():
    names = ["rectangle_field", "make", "load_scene", "plan", "run", "open_results"]
    modules = loaded("import eigencontact" + "".join(f"\neigencontact.{name}" for name in names))
    assert not modules & {"vtk", "pyvista", "matplotlib", "skfem", "scipy.sparse", "meshio", "xarray"}


def test_the_import_takes_less_than_300_ms():
    code = "from time import perf_counter as now; began = now(); import eigencontact; print(now() - began)"
    assert any(float(fresh(code)) < 0.3 for _ in range(5))


def test_the_command_line_starts_without_numpy():
    assert not loaded("import eigencontact.cli") & HEAVY


RUNS = """
import eigencontact as ec
import json, sys
quick = ["grid.cells-per-contact-radius=8", "output.vtk=false"]
plain, sliding = ["stress=[]"], ["steps.sliding-distance='1 mm'", "friction={type='coulomb', coefficient=0.3}"]
wear, stress = ["wear={type='archard', coefficient=1e-18}"], ["stress=[{shape='plane', normal='z', position=1e-6}]"]
modules = []
for changes in (plain, plain + sliding, plain + sliding + wear, stress):
    ec.run(ec.load_scene("hertz", quick + changes))
    modules.append(sorted(sys.modules))
print(json.dumps(modules))
"""


def test_a_run_loads_what_its_scene_needs():
    """In one process, the lightest scene first; the last scenes load the modules that the first leave out."""
    plain, sliding, wear, stress = (set(modules) for modules in json.loads(fresh(RUNS).splitlines()[-1]))
    assert "eigencontact.solvers.normal" in plain
    assert not plain & {"vtk", "pyvista", "matplotlib", "skfem", "meshio"}
    assert "eigencontact.solvers.tangential.solver" in sliding
    assert not [name for name in sliding if name.startswith("eigencontact.execution.wear")]
    of_wear = {"eigencontact.execution.wear.blocks", "eigencontact.solvers.moving_surface"}
    assert not sliding & (of_wear | {"scipy.ndimage"})
    assert wear >= of_wear
    assert "eigencontact.solvers.subsurface" not in wear
    assert "eigencontact.solvers.subsurface" in stress


def test_plugins_are_listed_without_scipy():
    modules = loaded("from eigencontact.scene.installed import installed_plugins; installed_plugins()")
    assert not modules & {"scipy", "matplotlib", "vtk", "pyvista", "skfem", "xarray"}


COMMAND = """
import sys
from eigencontact.cli import app
changes = ["--set", "grid.cells-per-contact-radius=8"]
try:
    app(args=[{words}, "hertz", *changes], prog_name="eigencontact")
except SystemExit:
    print()
"""
SLOW = {"xarray", "pandas", "pint", "pyvista", "vtkmodules", "vtk", "matplotlib", "numba", "skfem", "meshio", "dask"}


def test_explain_loads_nothing_that_runs_or_draws():
    modules = loaded(COMMAND.format(words="'explain'"))
    assert "eigencontact.planning.planner" in modules
    assert not modules & (SLOW | {"h5py", "h5netcdf", "scipy.sparse", "scipy.optimize", "scipy.ndimage"})
    assert not [name for name in modules if name.startswith("eigencontact.viz")]


def test_a_run_with_pictures_loads_what_draws_in_another_process_only(tmp_path):
    """With a second core; the files of VTK are written without it."""
    words = f"'run', '-q', '-o', {str(tmp_path)!r}"
    code = "import eigencontact.viz.painter as painter; painter.available_threads = lambda: 2\n"
    modules = loaded(code + COMMAND.format(words=words))
    assert {path.suffix for path in tmp_path.iterdir()} >= {".png", ".vti", ".nc", ".json"}
    assert "h5py" in modules
    assert not modules & (
        SLOW | {"h5netcdf", "scipy.sparse", "scipy.optimize", "scipy.ndimage", "scipy.fft", "scipy.special"}
    )


def test_pyfftw_is_loaded_without_what_stands_for_other_ffts(tmp_path):
    """Its interfaces import dask where that is installed; whoever wants them still finds them."""
    pytest.importorskip("pyfftw")
    (tmp_path / "dask").mkdir()
    (tmp_path / "dask" / "__init__.py").write_text("")
    start = f"import sys; sys.path.insert(0, {str(tmp_path)!r})\n"
    alone = start + "from eigencontact.convolution.backends import backend; backend('pyfftw')"
    before = "\nimport sys; assert 'pyfftw' in sys.modules"
    before += "\nassert not [n for n in sys.modules if n.startswith(('pyfftw.interfaces', 'dask', 'scipy'))]"
    asked = "\nimport numpy, pyfftw; assert pyfftw.interfaces.numpy_fft.fft(numpy.ones(4))[0] == 4"
    assert "pyfftw.interfaces.numpy_fft" in loaded(alone + before + asked)
    imported = "\nfrom pyfftw.interfaces import numpy_fft, cache; cache.enable()"
    assert "pyfftw.interfaces.cache" in loaded(alone + imported)
    first = start + "import pyfftw; from eigencontact.convolution.backends import backend; backend('pyfftw')"
    assert {"pyfftw.interfaces", "dask"} <= loaded(first)
