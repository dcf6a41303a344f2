"""Files of numbers on a lattice: three kinds of file, units, orders of axes, and what is refused in which words."""

import tracemalloc
from contextlib import contextmanager
from io import BytesIO
from zipfile import ZIP_DEFLATED, ZipFile

import numpy as np
import pytest
import xarray

from close import close
from eigencontact.plugin import SceneError, read_arrays, read_columns, read_gridded

X, Y, Z = np.array([0.0, 1.0, 3.0, 4.0]), np.array([-1.0, 2.0]), np.array([0.5, 1.0, 2.5])
SHAPE = (3, 2, 4)
E = 1e9 * (1 + np.arange(24.0).reshape(SHAPE))
NU = 0.01 * np.arange(24.0).reshape(SHAPE)
WANTED = {"young_modulus": "Pa", "poisson_ratio": "1"}
GOOD = {"x": X, "y": Y, "z": Z, "young_modulus": E, "poisson_ratio": NU}


def read(file, **options):
    return read_gridded("map.file", str(file), WANTED, **options)


@pytest.fixture
def written(tmp_path):
    """Write the same lattice as a file of some kind."""

    def write(name, **changes):
        path, arrays = tmp_path / name, GOOD | changes
        if path.suffix == ".npz":
            np.savez(path, **arrays)
        elif path.suffix == ".nc":
            values = {key: (("z", "y", "x"), arrays[key]) for key in WANTED}
            xarray.Dataset(values, {key: arrays[key] for key in "xyz"}).to_netcdf(path)
        else:
            z, y, x = np.meshgrid(Z, Y, X, indexing="ij")
            rows = np.column_stack([values.ravel() for values in (x, y, z, E, NU)])
            np.savetxt(path, np.random.default_rng(1).permutation(rows), fmt="%.17g", header="x y z E nu")
        return path

    return write


@pytest.mark.parametrize("name", ["a.npz", "a.nc", "a.txt"])
def test_every_kind_of_file_gives_the_same_lattice(written, name):
    data = read(written(name))
    assert data.names == ("z", "y", "x")
    assert data.shape == SHAPE
    for axis, expected in zip(data.axes, (Z, Y, X), strict=True):
        assert np.array_equal(axis, expected)
    assert np.array_equal(data.values["young_modulus"], E)
    assert np.array_equal(data.values["poisson_ratio"], NU)


def test_units_of_the_file_count_and_others_are_given(tmp_path, written):
    assert np.array_equal(read(written("a.npz"), unit=1e-6).axes[2], 1e-6 * X)
    dataset = xarray.Dataset(
        {"young_modulus": (("z", "y", "x"), E / 1e9, {"units": "GPa"}), "poisson_ratio": 0.3},
        {"x": ("x", X, {"units": "um"}), "y": ("y", Y, {"units": "mm"}), "z": Z},
    )
    dataset.to_netcdf(tmp_path / "units.nc")
    data = read(tmp_path / "units.nc", unit=2.0)
    assert data.axes[2] == close(1e-6 * X, rel=1e-14, abs=0.0)
    assert data.axes[1] == close(1e-3 * Y, rel=1e-14, abs=0.0)
    assert np.array_equal(data.axes[0], 2.0 * Z)
    assert data.values["young_modulus"] == close(E, rel=1e-14, abs=0.0)
    assert np.array_equal(data.values["poisson_ratio"], np.full(SHAPE, 0.3))  # one number holds everywhere


def test_named_axes_are_turned_into_the_order_asked_for(tmp_path):
    values = {"young_modulus": (("x", "z", "y"), np.moveaxis(E, 2, 0)), "poisson_ratio": 0.3}
    xarray.Dataset(values, {"x": X, "y": Y, "z": Z}).to_netcdf(tmp_path / "a.nc")
    assert np.array_equal(read(tmp_path / "a.nc").values["young_modulus"], E)
    tensor = np.arange(144.0).reshape(6, *SHAPE)
    stored = {"strain": (("z", "component", "y", "x"), np.moveaxis(tensor, 0, 1))}
    xarray.Dataset(stored, {"x": X, "y": Y, "z": Z}).to_netcdf(tmp_path / "b.nc")
    data = read_gridded("a.file", str(tmp_path / "b.nc"), {"strain": "1"}, components={"strain": 6})
    assert np.array_equal(data.values["strain"], tensor)


def test_values_between_the_points_and_beyond_them(written):
    data = read(written("a.npz"))
    plane = data.axes[0][:, None, None] + 2.0 * data.axes[1][:, None] - data.axes[2]
    data = type(data)(names=data.names, axes=data.axes, values={"a": plane, "two": np.stack([plane, -plane])})
    z, y, x = np.array([0.7, 2.0]), np.array([[0.3], [1.9]]), 2.2
    assert data.at("a", z, y, x) == close(z + 2 * y - x, rel=1e-13)
    assert data.at("two", z, y, x) == close(np.stack([z + 2 * y - x, x - z - 2 * y]), rel=1e-13)
    assert data.at("a", -1.0, 9.0, 3.5) == close(0.5 + 4.0 - 3.5)
    assert data.at("a", -1.0, 0.0, 3.5, outside="zero") == 0.0
    assert data.at("a", 0.6, -0.9, 0.1, method="nearest") == close(0.5 - 2.0)


REFUSED = {
    "names": ({"young_modulus": None, "z": None}, "a file with z and young_modulus", "it holds x, y, poisson_ratio"),
    "descending": ({"x": X[::-1]}, "z, y, x of two numbers or more each, finite and ascending [m]", "x is not"),
    "one plane": ({"z": Z[:1]}, "z, y, x of two numbers or more each", "z is not"),
    "an axis of two dimensions": ({"y": np.ones((2, 2))}, "z, y, x of two numbers or more each", "y is not"),
    "an axis without end": ({"y": np.array([0.0, np.inf])}, "two numbers or more each, finite", "y is not"),
    "shape": ({"young_modulus": E.T}, "young_modulus of shape (z, y, x) = (3, 2, 4), or one number", "shape (4, 2, 3)"),
    "infinite": (
        {"young_modulus": np.full(SHAPE, np.inf)},
        "finite young_modulus [Pa]",
        "24 of 24 are not, the first is inf",
    ),
    "NaN": ({"poisson_ratio": NU * np.nan}, "finite poisson_ratio [1]", "24 of 24 are not, the first is nan"),
    "complex": ({"young_modulus": E + 1j}, "an array of real numbers", "young_modulus is complex128"),
    "text": ({"poisson_ratio": np.array("steel")}, "an array of real numbers", "poisson_ratio is <U5"),
    "truth": ({"poisson_ratio": NU > 0}, "an array of real numbers", "poisson_ratio is bool"),
    "objects": ({"young_modulus": np.full(SHAPE, None)}, "an array of real numbers", "young_modulus is object"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_refused_contents(case, tmp_path):
    changes, rule, reason = REFUSED[case]
    np.savez(tmp_path / "a.npz", **{name: values for name, values in (GOOD | changes).items() if values is not None})
    with pytest.raises(SceneError) as caught:
        read(tmp_path / "a.npz")
    before, _, after = str(caught.value).partition(f" (got {str(tmp_path / 'a.npz')!r}); ")
    assert before.startswith("map.file must be ")
    assert rule in before
    assert reason in after
    assert "\n" not in after


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("a.npz", b""), ("a.npz", b"no archive"), ("a.npz", b"PK\x03\x04 cut"), ("a.npy", b""), ("a.nc", b""),
        ("a.nc", b"no netCDF"), ("a.npz", "half"), ("a.nc", "half"), ("a.txt", b"# nothing\n"), ("a.txt", b"1 2 3\n"),
        ("a.txt", b"1 2 3 4 high\n"), ("a.txt", b"\xff\xfe\x00"), ("a.txt", b"0 0 0 1 0\n1 0 0 1 0\n0 1 0 1 0\n"),
        ("a.bin", b"what"),
    ],
)  # fmt: skip
def test_files_that_cannot_be_read_are_refused_in_one_line(tmp_path, written, name, content):
    if content == "half":
        whole = written(name).read_bytes()
        content = whole[: len(whole) // 2]
    (tmp_path / name).write_bytes(content)
    with pytest.raises(SceneError, match=rf"^map\.file must be .* \(got '.*{name}'\); [^\n]+$"):
        read(tmp_path / name)


def test_a_unit_of_another_kind_is_refused(tmp_path):
    values = {"young_modulus": (("z", "y", "x"), E, {"units": "m"}), "poisson_ratio": 0.3}
    xarray.Dataset(values, {"x": X, "y": Y, "z": Z}).to_netcdf(tmp_path / "a.nc")
    with pytest.raises(SceneError, match=r"map.file must be a file with young_modulus in units of Pa \(got"):
        read(tmp_path / "a.nc")


def test_arrays_and_columns_of_a_file(tmp_path):
    np.savez(tmp_path / "a.npz", a=np.arange(3), name=np.array("steel"))
    arrays = read_arrays("shape.file", str(tmp_path / "a.npz"))
    assert list(arrays) == ["a", "name"]
    assert arrays["a"].dtype == float
    with pytest.raises(SceneError, match=r"shape.file must be an array of real numbers \(got .*; name is <U5"):
        _ = arrays["name"]
    np.save(tmp_path / "a.npy", np.eye(2))
    assert np.array_equal(read_arrays("shape.file", str(tmp_path / "a.npy"))[""], np.eye(2))
    (tmp_path / "a.csv").write_text("# a, b\n1, 2\n3, 4\n", encoding="utf-8")
    a, b = read_columns("law.file", str(tmp_path / "a.csv"), ("a", "b"))
    assert (a.tolist(), b.tolist()) == ([1.0, 3.0], [2.0, 4.0])
    with pytest.raises(SceneError, match=r"law.file must be an existing file \(got 'nowhere.txt'\)"):
        read_columns("law.file", "nowhere.txt", ("a", "b"))


def _archive(path, shape, **arrays):
    """Write an archive of these arrays, and one more, of 8 GB in 8 kB: zeros that nobody needs."""
    np.savez_compressed(path, **arrays)
    header = BytesIO()
    np.lib.format.write_array_header_1_0(header, {"descr": "<f8", "fortran_order": False, "shape": shape})
    with ZipFile(path, "a", ZIP_DEFLATED) as archive:
        archive.writestr("young_modulus.npy", header.getvalue() + bytes(8192))


@pytest.mark.parametrize("shape", [(10**6, 1000), (10**9,)])
def test_what_is_too_large_is_never_unpacked(shape, tmp_path, monkeypatch):
    """Neither where its names are wrong nor where its shape is; what has both right must fit into memory."""
    monkeypatch.setattr("eigencontact.core.array_files.machine_bytes", lambda: 2.0**30)
    with allocating_at_most(2**20):
        _archive(tmp_path / "a.npz", shape, x=X, y=Y)
        with pytest.raises(SceneError, match=r"a file with z and poisson_ratio .*; it holds x, y, young_modulus$"):
            read(tmp_path / "a.npz")
        _archive(tmp_path / "a.npz", shape, x=X, y=Y, z=Z, poisson_ratio=0.3)
        with pytest.raises(SceneError, match=r"young_modulus of shape .*; young_modulus has the shape \(1000"):
            read(tmp_path / "a.npz")
        words = r"fit into memory \(got .*; young_modulus has the shape .* fills 7.45 GiB, of 0.25 GiB that one"
        with pytest.raises(SceneError, match=words):
            _ = read_arrays("map.file", str(tmp_path / "a.npz"))["young_modulus"]


def test_netcdf_that_is_too_large_is_never_unpacked(tmp_path, monkeypatch):
    monkeypatch.setattr("eigencontact.core.array_files.machine_bytes", lambda: 2.0**20)
    big = xarray.Dataset({"young_modulus": (("z", "y", "x"), np.zeros((64, 64, 64))), "poisson_ratio": 0.3})
    big.to_netcdf(tmp_path / "a.nc", encoding={"young_modulus": {"zlib": True}}, engine="h5netcdf")
    with pytest.raises(SceneError, match=r"fills 0.00195 GiB, of 0.000244 GiB that one array may fill"):
        _ = read_arrays("map.file", str(tmp_path / "a.nc"))["young_modulus"]


@contextmanager
def allocating_at_most(limit):
    """Fail where NumPy and Python together hold more than this at a time [bytes]."""
    tracemalloc.start()
    yield
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < limit
