"""Stored results for pictures and VTK files: the interface of an xarray dataset, by h5py.

Importing xarray, and pandas with it, takes longer than most pictures.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol, Self

import numpy as np

from eigencontact.results.atomic import open_hdf5
from eigencontact.results.reader import opened_whole

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["Results", "StoredArray", "open_stored", "widest_edge"]

#: Attributes of variables that belong to the format.
_INNER = {"CLASS", "NAME", "REFERENCE_LIST", "DIMENSION_LIST", "_FillValue", "_Netcdf4Dimid", "coordinates"}


class Variable(Protocol):
    """Variable of results."""

    @property
    def values(self) -> Any:
        """Array of all its values."""

    @property
    def dims(self) -> tuple[Any, ...]:
        """Names of its dimensions."""

    @property
    def shape(self) -> tuple[int, ...]:
        """Length of each."""

    @property
    def ndim(self) -> int:
        """Their number."""

    @property
    def attrs(self) -> Mapping[Any, Any]:
        """Attributes: units, long name, role."""

    def __getitem__(self, index: Any) -> Any: ...
    def __float__(self) -> float: ...


class Results(Protocol):
    """Interface of results for pictures; `open_stored` and xarray provide it."""

    @property
    def attrs(self) -> Mapping[Any, Any]:
        """Provenance, regions, cells."""

    @property
    def sizes(self) -> Mapping[Any, int]:
        """Length of every dimension."""

    @property
    def variables(self) -> Mapping[Any, Any]:
        """Variables by name."""

    @property
    def data_vars(self) -> Mapping[Any, Variable]:
        """Variables that are not coordinates."""

    def __contains__(self, name: object) -> bool: ...
    def __iter__(self) -> Iterator[Any]: ...
    def __getitem__(self, name: str) -> Variable: ...


def widest_edge(dataset: Results) -> float:
    """Largest edge of the cells of the surface [m]; of a line contact their width, for strips have no ends."""
    edges = np.atleast_1d(dataset.attrs["cell_size"])
    return float(np.max(edges[:1] if dataset.attrs.get("line") else edges))


def open_stored(path: str | Path) -> _Stored:
    """Open the results of a finished run for pictures; close it, or use it in a ``with`` block.

    Raises
    ------
    ResultsError
        As `eigencontact.results.reader.open_results` does.
    """
    return opened_whole(path, lambda file: _Stored(open_hdf5(file, "r")))


@dataclass(slots=True)
class StoredArray:
    """Values of a variable in memory."""

    values: NDArray[Any]

    def __float__(self) -> float:
        return float(self.values)

    def __int__(self) -> int:
        return int(self.values)


class _Variable:
    """Variable of the file; indexing reads the selected values."""

    def __init__(self, array: Any) -> None:
        text = array.dtype.kind == "O"
        self._array = array.asstr() if text else array
        self._text = text
        self._stored = array
        self.shape: tuple[int, ...] = array.shape
        self.ndim: int = array.ndim

    def __getitem__(self, index: Any) -> StoredArray:
        values = np.asarray(self._array[index])
        return StoredArray(values.astype(str) if self._text else values)

    def __float__(self) -> float:
        return float(self.values)

    @cached_property
    def values(self) -> NDArray[Any]:
        """All values."""
        return self[()].values

    @cached_property
    def dims(self) -> tuple[str, ...]:
        """Names of its dimensions."""
        array = self._stored
        if array.is_scale:
            return (array.name.lstrip("/"),)
        return tuple(dim[0].name.lstrip("/") for dim in array.dims)

    @cached_property
    def attrs(self) -> dict[str, Any]:
        """Attributes: units, long name, role."""
        stored = self._stored.attrs
        return {name: _plain(stored[name]) for name in stored if name not in _INNER}

    @property
    def coordinates(self) -> str:
        """Names of coordinates that are not dimensions."""
        return str(self._stored.attrs.get("coordinates", ""))


class _Stored:
    """All variables of a results file."""

    def __init__(self, file: Any) -> None:
        self._file = file
        self.attrs = {name: _plain(value) for name, value in file.attrs.items() if name != "_NCProperties"}
        self.variables = {
            name: _Variable(array)
            for name, array in file.items()
            if not (array.is_scale and array.attrs["NAME"].startswith(b"This is a netCDF dimension"))
        }

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Close the file."""
        self._file.close()

    def __contains__(self, name: object) -> bool:
        return name in self.variables

    def __iter__(self) -> Iterator[str]:
        return iter(self.data_vars)

    def __getitem__(self, name: str) -> _Variable:
        return self.variables[name]

    @cached_property
    def sizes(self) -> dict[str, int]:
        """Length of every dimension."""
        return {name: array.shape[0] for name, array in self._file.items() if array.is_scale}

    @cached_property
    def data_vars(self) -> dict[str, _Variable]:
        """Variables that are not coordinates."""
        coordinate_names = {name for variable in self.variables.values() for name in variable.coordinates.split()}
        return {
            name: variable
            for name, variable in self.variables.items()
            if name not in coordinate_names | self.sizes.keys()
        }


def _plain(value: Any) -> Any:
    """Number of a list with one element; text unchanged."""
    return value.item() if isinstance(value, np.ndarray) and value.size == 1 else value
