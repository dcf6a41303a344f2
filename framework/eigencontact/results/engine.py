"""Results files as xarray opens them: the attributes and dimensions of all variables by h5py, the values on demand.

The engine ``h5netcdf`` of xarray asks the file about groups, filters and chunks of every variable, too, which takes
three times as long. This module imports xarray; nothing imports it before results are opened as a dataset.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from xarray.backends import BackendArray, BackendEntrypoint, CachingFileManager
from xarray.core import indexing

from eigencontact.results.atomic import open_hdf5
from eigencontact.results.stored import _Stored, _Variable

__all__ = ["ResultsEngine"]


class ResultsEngine(BackendEntrypoint):
    """Engine of `xarray.open_dataset` for ``results.nc``."""

    def open_dataset(  # type: ignore[override]
        self, filename_or_obj: str | Path, *, drop_variables: Any = None
    ) -> xr.Dataset:
        """Open a file; a dataset, and a copy of it in another process, opens the file again where it has to."""
        files = CachingFileManager(open_hdf5, Path(filename_or_obj), mode="r")
        stored = _Stored(files.acquire())
        variables = {
            name: xr.Variable(item.dims, _values(files, name, item), item.attrs)
            for name, item in stored.variables.items()
            if name not in (drop_variables or ())
        }
        coordinates = {name: variables.pop(name) for name in list(variables) if name not in stored.data_vars}
        dataset = xr.Dataset(variables, coordinates, stored.attrs)
        dataset.set_close(files.close)
        return dataset


def _values(files: CachingFileManager[Any], name: str, variable: _Variable) -> Any:
    """Values of a variable: text at once, numbers where they are used."""
    if variable.dtype.kind == "O":
        return variable.values
    return indexing.LazilyIndexedArray(_Values(files, name, variable))


class _Values(BackendArray):
    """Numbers of a variable that a file holds."""

    def __init__(self, files: CachingFileManager[Any], name: str, variable: _Variable) -> None:
        self.files, self.name, self.shape, self.dtype = files, name, variable.shape, variable.dtype

    def __getitem__(self, key: indexing.ExplicitIndexer) -> Any:
        return indexing.explicit_indexing_adapter(key, self.shape, indexing.IndexingSupport.BASIC, self._read)

    def _read(self, key: Any) -> Any:
        return np.asarray(self.files.acquire()[self.name][key])
