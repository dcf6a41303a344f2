import xml.etree.ElementTree as ET

import numpy as np
import pytest
import pyvista as pv

from eigencontact import __version__
from eigencontact.errors import ResultsError
from eigencontact.results.atomic import replacing
from eigencontact.results.reader import open_results
from eigencontact.results.store import ResultStore
from eigencontact.viz import vtk_xml
from eigencontact.viz.vtk import write_vtk
from results import synthetic

SHAPES = ("plane", "depth", "volume", "line", "points")


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    folder = tmp_path_factory.mktemp("run")
    info = synthetic.info(nx=6, ny=4, size_x=12e-6, size_y=10e-6, steps=2)
    store = ResultStore.create(folder, info)
    records = [synthetic.step(info, n, n * 0.3, SHAPES) for n in (1, 2)]
    for record in records:
        store.write_step(record)
    store.finish()
    return info, records, write_vtk(folder, folder / "vtk")


def read(written, name):
    return pv.read(next(path for path in written if path.name == name))


def test_files_and_series(run):
    _, _, written = run
    names = [path.name for path in written]
    assert names[:3] == ["surface_0001.vti", "surface_0002.vti", "surface.pvd"]
    assert {"plane_0_0002.vti", "depth_1_0002.vti", "volume_2_0001.vti", "line_3_0001.vtp", "points_4.pvd"} <= set(
        names
    )
    assert all(path.exists() for path in written)
    assert not [path for path in written[0].parent.iterdir() if path not in written]
    rows = ET.parse(written[2]).getroot().findall("Collection/DataSet")
    assert [(row.get("timestep"), row.get("file")) for row in rows] == [
        ("1.0", "surface_0001.vti"),
        ("2.0", "surface_0002.vti"),
    ]
    assert pv.get_reader(written[2]).time_values == [1.0, 2.0]


def test_surface_is_cells_in_place(run):
    info, records, written = run
    mesh = read(written, "surface_0002.vti")
    np.testing.assert_allclose(mesh.bounds, (-6e-6, 6e-6, -5e-6, 5e-6, 0, 0), atol=1e-20)
    assert mesh.n_cells == 24
    centres = mesh.cell_centers().points
    y, x = info.grid.axes()
    np.testing.assert_allclose(centres[:, 0], (x + 0 * y).ravel(), rtol=1e-6, atol=1e-12)
    np.testing.assert_allclose(centres[:, 1], (y + 0 * x).ravel(), rtol=1e-6, atol=1e-12)
    for name, values in records[1].fields.items():
        np.testing.assert_array_equal(mesh.cell_data[name], values.ravel())


@pytest.mark.parametrize(("shape", "name"), [(s, f"{s}_{n}") for n, s in enumerate(SHAPES)])
def test_regions_hold_their_points_and_tensors(run, shape, name):
    _, records, written = run
    region = records[0].regions[name]
    mesh = read(written, f"{name}_0001.{'vtp' if region.dims == ('point',) else 'vti'}")
    axes = [np.atleast_1d(region.coords[axis]) for axis in "xyz"]
    expected = [limit for axis in axes for limit in (axis.min(), axis.max())]
    np.testing.assert_allclose(mesh.bounds, expected, rtol=1e-6, atol=1e-12)
    assert mesh.bounds[5] > 0  # z increases into the body
    point = mesh.n_points // 2 + 1 if shape != "points" else 1
    x, y, z = mesh.points[point]
    a, p0 = synthetic.hertz(synthetic.LOAD)[0], synthetic.hertz(0.3)[1]
    xx, yy, zz, yz, xz, xy = synthetic.made_up_stress(x, y, z, a, p0)
    np.testing.assert_allclose(mesh.point_data["stress"][point], [xx, yy, zz, xy, yz, xz], rtol=1e-5, atol=1e-6 * p0)
    np.testing.assert_array_equal(mesh.point_data["von_mises"], region.fields["von_mises"].ravel())
    np.testing.assert_array_equal(mesh.point_data["principal"].T, region.fields["principal"].reshape(3, -1))
    assert mesh.n_cells == {"line": 1, "points": 3, "plane": 640, "depth": 256, "volume": 5120}[shape]


def test_uneven_spacing_is_a_rectilinear_grid(tmp_path):
    info = synthetic.info(nx=3, ny=3)
    record = synthetic.step(info, regions=("plane",))
    region = record.regions["plane_0"]
    region.coords["z"] = np.linspace(0, 1, 21) ** 2 * 5e-6
    store = ResultStore.create(tmp_path, info)
    store.write_step(record)
    with open_results(store.finish()) as dataset:
        written = write_vtk(dataset, tmp_path / "vtk")
    mesh = read(written, "plane_0_0001.vtr")
    np.testing.assert_allclose(mesh.z, region.coords["z"], rtol=1e-6)
    np.testing.assert_array_equal(mesh.point_data["von_mises"], region.fields["von_mises"].ravel())


def test_files_name_their_maker_and_the_components(run):
    _, _, written = run
    mesh = read(written, "plane_0_0001.vti")
    assert list(mesh.field_data["eigencontact"]) == [__version__]
    array = mesh.point_data.GetArray("stress")
    assert [array.GetComponentName(n) for n in range(6)] == ["XX", "YY", "ZZ", "XY", "YZ", "XZ"]
    assert mesh.active_scalars_name == next(iter(mesh.point_data))


@pytest.mark.parametrize("dtype", ["f8", "f4", "i1", "u1", "i4", "i8", "u8", "?"])
def test_numbers_of_any_type_are_read_as_they_were(tmp_path, dtype):
    """What VTK itself reads: all bytes of every array and of one behind another of odd length."""
    name = 'a < b & "c"'
    mesh = vtk_xml.image((3, 2, 1), (0.1, 1e-9, 1.0), (-1.0 / 3.0, 0.0, 2.0))
    mesh.point_data["odd"] = np.arange(6).astype("u1")
    mesh.point_data[name] = np.linspace(-3, 200, 12).reshape(2, 6).T.astype(dtype)
    mesh.cell_data["two"] = np.array([np.nan, -np.inf])
    path = tmp_path / f"mesh{mesh.suffix}"
    with replacing(path, "mesh") as sink:
        mesh.write(sink)
    found = pv.read(path)
    assert (found.dimensions, found.spacing, found.origin) == ((3, 2, 1), (0.1, 1e-9, 1.0), (-1.0 / 3.0, 0.0, 2.0))
    np.testing.assert_array_equal(found.point_data["odd"], np.arange(6))
    np.testing.assert_array_equal(found.point_data[name], mesh.point_data[name])
    assert found.point_data[name].dtype == np.dtype("u1" if dtype == "?" else dtype)
    np.testing.assert_array_equal(found.cell_data["two"], mesh.cell_data["two"])


def test_folder_that_cannot_be_made(run, tmp_path):
    (tmp_path / "file").write_text("x")
    with pytest.raises(ResultsError, match=r"must be a folder that can be written .*; choose another$"):
        write_vtk(run[2][0].parents[1], tmp_path / "file" / "vtk")
