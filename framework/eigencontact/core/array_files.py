"""Arrays of ``.npy``, ``.npz`` and NetCDF files: names, shapes and types first; the numbers are read on demand.

Compressed files may be a thousand times as large in memory. No array is unpacked before its size is known.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from math import prod
from pathlib import Path
from typing import IO, Any
from zipfile import ZipFile

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.memory import machine_bytes

__all__ = ["StoredArray", "arrays_of_file", "held_array"]

#: Part of the memory of the machine that one array of a file may fill: a run needs the rest.
_SHARE = 0.25


@dataclass(frozen=True, eq=False, slots=True)
class StoredArray:
    """Unread array of a file, with its attributes.

    Attributes
    ----------
    shape : tuple of int
    dtype : dtype
    load : callable
        Reads the numbers.
    axes : tuple of str
        Names of the axes, if the file has them.
    unit : str
        Unit, if the file has one.
    """

    shape: tuple[int, ...]
    dtype: np.dtype[Any]
    load: Callable[[], NDArray[Any]]
    axes: tuple[str, ...] = ()
    unit: str = ""

    @property
    def too_large(self) -> str:
        """Reason why the array does not fit into memory as float64; empty if it does."""
        size, room = 8.0 * prod(self.shape), _SHARE * machine_bytes()
        return f"{size / 2**30:.3g} GiB, of {room / 2**30:.3g} GiB that one array may fill" if size > room else ""

    def ordered(self, names: tuple[str, ...]) -> StoredArray:
        """Return the array with these axes last, in this order, if the file names them."""
        if not set(names) <= set(self.axes):
            return self
        order = (*(axis for axis in self.axes if axis not in names), *names)
        places = [self.axes.index(axis) for axis in order]
        shape = tuple(self.shape[place] for place in places)
        return replace(self, shape=shape, axes=order, load=lambda: self.load().transpose(places))


def held_array(values: NDArray[Any]) -> StoredArray:
    """Array in memory."""
    return StoredArray(values.shape, values.dtype, lambda: values)


def arrays_of_file(path: Path) -> dict[str, StoredArray]:
    """Arrays of a file by name; that of a ``.npy`` file has the name ``""``.

    Raises
    ------
    Exception
        Whatever the readers of damaged files raise.
    """
    if path.suffix.lower() not in (".npy", ".npz"):
        return _of_netcdf(path)
    with path.open("rb") as stream:
        if stream.read(2) == b"PK":
            return _of_archive(path)
        stream.seek(0)
        return {"": StoredArray(*_header(stream), partial(np.load, path, allow_pickle=False))}


def _of_archive(path: Path) -> dict[str, StoredArray]:
    out = {}
    with ZipFile(path) as archive:
        for member in archive.namelist():
            if member.endswith(".npy"):
                with archive.open(member) as stream:
                    out[member.removesuffix(".npy")] = StoredArray(*_header(stream), partial(_member, path, member))
    return out


def _member(path: Path, member: str) -> NDArray[Any]:
    with ZipFile(path) as archive, archive.open(member) as stream:
        return np.asarray(np.lib.format.read_array(stream, allow_pickle=False))


def _header(stream: IO[bytes]) -> tuple[tuple[int, ...], np.dtype[Any]]:
    version = np.lib.format.read_magic(stream)
    read = np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
    shape, _, dtype = read(stream)
    return shape, dtype


def _of_netcdf(path: Path) -> dict[str, StoredArray]:
    import xarray

    with xarray.open_dataset(path, decode_times=False) as data:
        return {
            str(name): StoredArray(
                item.shape,
                item.dtype,
                partial(_variable, path, str(name)),
                tuple(map(str, item.dims)),
                str(item.attrs.get("units", "")),
            )
            for name, item in data.variables.items()
        }


def _variable(path: Path, name: str) -> NDArray[Any]:
    import xarray

    with xarray.open_dataset(path, decode_times=False) as data:
        return np.asarray(data.variables[name].values)
