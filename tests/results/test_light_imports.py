import subprocess
import sys

import pytest

HEAVY = {"h5py", "h5netcdf", "xarray", "pandas", "matplotlib", "pyvista", "vtk", "vtkmodules", "scipy.sparse"}


@pytest.mark.parametrize(
    "modules", ["results.store results.summary results.reader", "viz.figures viz.vtk"], ids=["results", "viz"]
)
def test_heavy_libraries_wait_until_they_are_used(modules):
    names = ", ".join(f"eigencontact.{module}" for module in modules.split())
    code = f"import sys, {names}; print(sorted({HEAVY!r} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
