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


@pytest.mark.parametrize("name", ["rectangle_field", "make", "load_scene", "plan", "run", "open_results"])
def test_public_names_load_no_drawing_and_no_finite_elements(name):
    modules = loaded(f"import eigencontact; eigencontact.{name}")
    assert not modules & {"vtk", "pyvista", "matplotlib", "skfem", "scipy.sparse", "meshio", "xarray"}


def test_the_import_takes_less_than_300_ms():
    code = "from time import perf_counter as now; began = now(); import eigencontact; print(now() - began)"
    times = [float(fresh(code)) for _ in range(5)]
    assert min(times) < 0.3


def test_the_command_line_starts_without_numpy():
    assert not loaded("import eigencontact.cli") & HEAVY


QUICK = """
import eigencontact as ec
scene = ec.load_scene("hertz", ["stress={stress}", "grid.cells-per-contact-radius=8", "output.vtk=false"])
ec.run(scene)
"""


def test_a_run_without_stress_loads_nothing_about_stress():
    modules = loaded(QUICK.format(stress="[]"))
    assert "eigencontact.solvers.normal" in modules
    assert "eigencontact.solvers.subsurface" not in modules
    assert not modules & {"vtk", "pyvista", "matplotlib", "skfem", "meshio"}


def test_a_run_with_stress_loads_it():
    """The test above can fail: the module has this name, and is loaded where it is needed."""
    request = "[{shape='plane', normal='z', position=1e-6}]"
    assert "eigencontact.solvers.subsurface" in loaded(QUICK.format(stress=request))


SLIDING = """
import eigencontact as ec
changes = ["stress=[]", "grid.cells-per-contact-radius=8", "output.vtk=false", "steps.sliding-distance='1 mm'",
           "friction={{type='coulomb', coefficient=0.3}}"]
ec.run(ec.load_scene("hertz", [*changes, {wear}]))
"""
OF_WEAR = {"eigencontact.execution.wear.blocks", "eigencontact.solvers.moving_surface"}


def test_a_run_without_wear_loads_nothing_of_wear():
    modules = loaded(SLIDING.format(wear=""))
    assert "eigencontact.solvers.tangential.solver" in modules
    assert not [name for name in modules if name.startswith("eigencontact.execution.wear")]
    assert not modules & (OF_WEAR | {"scipy.ndimage"})


def test_a_run_with_wear_loads_it():
    """The test above can fail: the modules have these names, and are loaded where they are needed."""
    modules = loaded(SLIDING.format(wear="\"wear={type='archard', coefficient=1e-18}\""))
    assert modules >= OF_WEAR


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
    assert "pyfftw" in loaded(alone)
    assert not [name for name in loaded(alone) if name.startswith(("pyfftw.interfaces", "dask", "scipy"))]
    asked = "\nimport numpy, pyfftw; assert pyfftw.interfaces.numpy_fft.fft(numpy.ones(4))[0] == 4"
    assert "pyfftw.interfaces.numpy_fft" in loaded(alone + asked)
    imported = "\nfrom pyfftw.interfaces import numpy_fft, cache; cache.enable()"
    assert "pyfftw.interfaces.cache" in loaded(alone + imported)
    first = start + "import pyfftw; from eigencontact.convolution.backends import backend; backend('pyfftw')"
    assert {"pyfftw.interfaces", "dask"} <= loaded(first)
