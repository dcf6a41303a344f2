"""A netCDF-4 file laid out with plain HDF5: variables, dimensions as scales, attributes.

Readers find what the netCDF library itself would write. A library on top of HDF5 takes several times as long: it asks
the file for its own dimensions again and again.

References
----------
NetCDF-4 format specification, https://docs.unidata.ucar.edu/netcdf-c/current/file_format_specifications.html, "Creating
netCDF-4 files with HDF5"; HDF5 dimension scale specification.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact.results.layout import TEXT

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import DTypeLike, NDArray

    from eigencontact.results.join import Column

__all__ = ["fill", "lay_out"]

#: Size of fields [bytes] from which on they are stored in bands; smaller ones are written faster whole.
_LARGE = 2**22
#: Size of a band [bytes], about.
_BAND = 2**20

#: Name of a scale that is a dimension and no variable; its size takes ten places.
_NO_VARIABLE = "This is a netCDF dimension but not a netCDF variable.{:10d}"


def lay_out(
    file: Any, dimensions: Mapping[str, int], variables: Mapping[str, Column], attrs: Mapping[str, Any]
) -> None:
    """Make all variables of an empty HDF5 file, with the size of every dimension, to be filled later.

    A variable that bears the name of a dimension is its coordinate.
    """
    import h5py  # type: ignore[import-not-found,import-untyped,unused-ignore]

    describe = _describer(h5py)
    describe(file, {"_NCProperties": f"version=2,h5py={h5py.__version__},hdf5={h5py.version.hdf5_version}", **attrs})
    for name, variable in variables.items():
        shape = tuple(dimensions[dim] for dim in variable.dims)
        empty = np.nan if variable.missing else None
        variable_in_file = file.create_dataset(
            name, shape, variable.dtype, fillvalue=empty, chunks=_bands(shape, variable.dtype)
        )
        missing = {"_FillValue": np.array([np.nan], variable.dtype)} if variable.missing else {}
        describe(variable_in_file, {**missing, **variable.attrs})
    for number, (dim, size) in enumerate(dimensions.items()):
        scale = file[dim] if dim in file else file.create_dataset(dim, (size,), ">f4")
        h5py.h5ds.set_scale(scale.id, (dim if dim in variables else _NO_VARIABLE.format(size)).encode())
        describe(scale, {"_Netcdf4Dimid": np.array(number, np.int32)})
    _attach(h5py, file, {name: variable.dims for name, variable in variables.items()})


def fill(target: Any, start: int, values: NDArray[Any]) -> None:
    """Write values into an array of `lay_out`, from an index of its first dimension on.

    Bands that are zero throughout are left out of the file: what is not there is read as zero. Most of a surface is
    free of pressure and shear.
    """
    if target.chunks is None or target.fillvalue != 0:
        target[start : start + len(values)] = values
        return
    rows = target.chunks[-2]
    for at, field in enumerate(values):
        for place in np.ndindex(field.shape[:-2]):
            for row in range(0, field.shape[-2], rows):
                band = field[place][row : row + rows]
                if band.any():
                    target[(start + at, *place, slice(row, row + rows))] = band


def _bands(shape: tuple[int, ...], dtype: DTypeLike) -> tuple[int, ...] | None:
    """Chunk shape of whole rows for a large array of fields; None for contiguous storage."""
    if len(shape) < 3:
        return None
    row = np.dtype(dtype).itemsize * shape[-1]
    if row * shape[-2] < _LARGE:
        return None
    return (*(1 for _ in shape[:-2]), max(1, min(shape[-2], _BAND // row)), shape[-1])


def _describer(h5py: Any) -> Any:
    """Function that writes attributes, numbers as lists as netCDF requires, in a fifth of h5py's time."""
    text, scalar = h5py.h5t.py_create(h5py.string_dtype(), logical=True), h5py.h5s.create(h5py.h5s.SCALAR)

    def describe(target: Any, attrs: Mapping[str, Any]) -> None:
        for name, value in attrs.items():
            if isinstance(value, str):
                created = h5py.h5a.create(target.id, name.encode(), text, scalar)
                created.write(np.array(value, dtype=TEXT))
            else:
                values = np.asarray(value) if name.startswith("_") else np.atleast_1d(value)
                space = h5py.h5s.create_simple(values.shape) if values.ndim else scalar
                h5py.h5a.create(target.id, name.encode(), h5py.h5t.py_create(values.dtype), space).write(values)

    return describe


def _attach(h5py: Any, file: Any, dims: Mapping[str, tuple[str, ...]]) -> None:
    """Attach dimension scales to all variables at once, like H5DSattach_scale.

    One by one, the list of a scale would be read and written again for each of its variables.
    """
    reference = {name: h5py.h5r.create(file.id, name.encode(), h5py.h5r.OBJECT) for name in file}
    entry = np.dtype([("dataset", h5py.ref_dtype), ("dimension", np.int32)])
    several = h5py.h5t.vlen_create(h5py.h5t.STD_REF_OBJ)
    used: dict[str, list[tuple[Any, int]]] = {}
    for name, dims_of_variable in dims.items():
        if not dims_of_variable or dims_of_variable == (name,):  # a scale has no scales
            continue
        listed = np.empty(len(dims_of_variable), dtype=h5py.vlen_dtype(h5py.ref_dtype))
        for axis, dim in enumerate(dims_of_variable):
            listed[axis] = np.array([reference[dim]], dtype=h5py.ref_dtype)
            used.setdefault(dim, []).append((reference[name], axis))
        space = h5py.h5s.create_simple(listed.shape)
        h5py.h5a.create(file[name].id, b"DIMENSION_LIST", several, space).write(listed)
    for dim, users in used.items():
        file[dim].attrs.create("REFERENCE_LIST", np.array(users, dtype=entry))
