"""Other readers open what is stored, and what earlier versions stored is read and continued."""

import h5py
import numpy as np
import pytest
import xarray as xr

from eigencontact.errors import ResultsError
from eigencontact.results.history import history_variables
from eigencontact.results.layout import FORMAT, attributes, variables
from eigencontact.results.memory import MemoryStore
from eigencontact.results.part import open_part
from eigencontact.results.store import ResultStore
from results import synthetic
from results.test_history import assert_same, remembered, step
from results.test_store import same_record


def write_hdf5(path, listed, attrs):
    """A stored step as versions before 2026-11-22 wrote it."""
    with h5py.File(path, "w") as file:
        for variable in listed:
            checked = variable.values.size > 1 and variable.values.dtype.kind != "O"
            options = {"chunks": variable.values.shape, "fletcher32": True} if checked else {}
            made = file.create_dataset(variable.name, data=variable.values, dtype=variable.values.dtype, **options)
            made.attrs.update({**variable.attrs, "dims": " ".join(variable.dims)})
        file.attrs.update(attrs)


def store_before(folder, info, records):
    """An unfinished run of an earlier version."""
    store = ResultStore.create(folder, info)
    for record in records:
        path = folder / "steps" / f"{record.index:04d}.h5"
        write_hdf5(path, variables(info, record), attributes(info, record))
        mark = {"format": FORMAT, "scene_hash": info.scene_hash}
        write_hdf5(path.with_suffix(".history.h5"), list(history_variables(record)), mark)
    return store


def test_a_run_of_an_earlier_version_is_continued(tmp_path):
    info = synthetic.info(steps=3)
    records = [step(info, n) for n in (1, 2, 3)]
    store_before(tmp_path, info, records[:2])
    store = ResultStore.create(tmp_path, info, resume=True)
    assert store.accepted() == [1, 2]
    same_record(records[1], store.load_step(2))
    assert_same(store.load_step(2).history, remembered(2))
    store.write_step(records[2])
    store.finish()
    memory = MemoryStore(info)
    for record in records:
        memory.write_step(record)
    with store.dataset() as found:
        expected = memory.dataset()
        found.attrs.pop("created")
        expected.attrs.pop("created")
        xr.testing.assert_identical(found.load(), expected)
    assert not (tmp_path / "steps").exists()


def test_a_damaged_step_of_an_earlier_version_is_replaced(tmp_path):
    info = synthetic.info(steps=3)
    store_before(tmp_path, info, [step(info, n) for n in (1, 2)])
    (tmp_path / "steps" / "0002.h5").write_bytes(b"\x89HDF")
    store = ResultStore.create(tmp_path, info, resume=True)
    assert store.accepted() == [1]
    for n in (2, 3):
        store.write_step(step(info, n))
    assert store.accepted() == [1, 2, 3]
    store.finish()
    assert [path.name for path in tmp_path.iterdir()] == ["results.nc"]


@pytest.mark.parametrize("engine", ["h5netcdf", "netcdf4"])
def test_readers_of_netcdf_find_dimensions_and_coordinates(tmp_path, engine):
    if engine == "netcdf4":
        pytest.importorskip("netCDF4")
    info = synthetic.info(nx=7, ny=5, steps=2)
    store, memory = ResultStore.create(tmp_path, info), MemoryStore(info)
    for n in (1, 2):
        record = synthetic.step(info, n, regions=("plane", "points"), reference=n > 1)
        store.write_step(record)
        memory.write_step(record)
    with xr.open_dataset(store.finish(), engine=engine) as found:
        expected = memory.dataset()
        found.attrs.pop("created")
        expected.attrs.pop("created")
        xr.testing.assert_identical(found.load(), expected)


def test_vtk_reads_the_file_as_netcdf(tmp_path):
    """The reader of ParaView: the netCDF library of the wheel of VTK."""
    netcdf = pytest.importorskip("vtkmodules.vtkIONetCDF")
    info = synthetic.info(nx=7, ny=5, steps=2)
    store = ResultStore.create(tmp_path, info)
    for n in (1, 2):
        store.write_step(synthetic.step(info, n, regions=()))
    reader = netcdf.vtkNetCDFCFReader()
    reader.SetFileName(str(store.finish()))
    reader.UpdateMetaData()
    names = {reader.GetVariableArrayName(n) for n in range(reader.GetNumberOfVariableArrays())}
    assert {"pressure", "gap", "displacement_z"} <= names
    dimensions = {reader.GetVariableDimensions().GetValue(n) for n in range(len(names))}
    assert "(step, y, x)" in dimensions


@pytest.mark.parametrize("scale", ["x", "y", "step"])
def test_scales_know_their_variables(tmp_path, scale):
    info = synthetic.info(steps=1)
    store = ResultStore.create(tmp_path, info)
    store.write_step(synthetic.step(info))
    with h5py.File(store.finish(), "r") as file:
        assert h5py.h5ds.is_scale(file[scale].id)
        listed = {
            (h5py.h5r.get_name(ref, file.id).decode()[1:], int(axis))
            for ref, axis in file[scale].attrs["REFERENCE_LIST"]
        }
        expected = {
            (name, axis)
            for name, variable in file.items()
            for axis in range(variable.ndim)
            if not variable.is_scale and h5py.h5ds.is_attached(variable.id, file[scale].id, axis)
        }
        assert expected
        assert listed == expected


@pytest.mark.parametrize("place", [0, 25, 300, -3000, -1])
def test_every_changed_byte_is_noticed(tmp_path, place):
    info = synthetic.info()
    store = ResultStore.create(tmp_path, info)
    store.write_step(synthetic.step(info))
    path = tmp_path / "steps" / "0001.step"
    data = bytearray(path.read_bytes())
    data[place] ^= 0x01
    path.write_bytes(bytes(data))

    def read():
        with open_part(path) as part:
            return {name: variable[...] for name, variable in part.items()}

    with pytest.raises((ValueError, OSError)):
        read()
    with pytest.raises(ResultsError, match=r"0001\.step must be a complete step"):
        store.finish()


def test_numbers_that_are_not_finite_and_empty_arrays_come_back(tmp_path):
    info = synthetic.info()
    object.__setattr__(info, "outlines", {"": np.zeros((0, 2, 2))})
    record = synthetic.step(info)
    record.scalars.update({"approach": np.nan, "iterations": np.inf, "tilt_x": -0.0, "load_residual": 5e-324})
    store = ResultStore.create(tmp_path, info)
    store.write_step(record)
    found = store.load_step(1).scalars
    assert np.isnan(found["approach"])
    assert [found[name] for name in ("iterations", "load_residual")] == [np.inf, 5e-324]
    assert np.signbit(found["tilt_x"])
    with store.finish().open("rb"), store.dataset() as data:
        assert data["outline"].shape == (0, 2, 2)
