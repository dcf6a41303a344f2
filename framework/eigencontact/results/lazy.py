"""Results files as xarray datasets whose arrays are read when they are used, by h5py alone.

The library that xarray reads netCDF-4 with asks the file for the dimensions of each variable again and again: it takes
several times as long to open a run.
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr
from xarray.backends import BackendArray, BackendEntrypoint, CachingFileManager
from xarray.core import indexing

from eigencontact.results.atomic import open_hdf5
from eigencontact.results.stored import stored_variables

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

__all__ = ["open_lazily"]


def open_lazily(file: Path) -> xr.Dataset:
    """Open a results file as xarray opens a netCDF-4 file."""
    return xr.open_dataset(file, engine=_ResultsFile)


class _ResultsFile(BackendEntrypoint):
    """Results files for xarray."""

    def open_dataset(
        self, filename_or_obj: Any, *, drop_variables: str | Iterable[str] | None = None, **_: Any
    ) -> xr.Dataset:
        manager = CachingFileManager(open_hdf5, filename_or_obj, mode="r")
        try:
            attrs, stored = stored_variables(manager.acquire())
        except BaseException:
            manager.close()
            raise
        dropped = {drop_variables} if isinstance(drop_variables, str) else set(drop_variables or ())
        coordinates: set[str] = set()
        variables = {}
        for name, variable in stored.items():
            lazy = indexing.LazilyIndexedArray(_LazyArray(manager, name, variable))
            array = variable.values if variable.is_text else lazy
            variables[name] = xr.Variable(variable.dims, array, variable.attrs, variable.encoding)
            coordinates.update(variable.coordinates.split())
        dataset = xr.Dataset(
            {name: variable for name, variable in variables.items() if name not in dropped}, attrs=attrs
        )
        dataset = dataset.set_coords(coordinates & set(dataset.variables))
        dataset.set_close(partial(manager.close, needs_lock=False))
        return dataset


class _LazyArray(BackendArray):
    """Array of the file."""

    def __init__(self, manager: CachingFileManager[Any], name: str, variable: Any) -> None:
        self._manager, self._name = manager, name
        self.shape = variable.shape
        self.dtype = variable.dtype

    def __getitem__(self, key: indexing.ExplicitIndexer) -> Any:
        support = indexing.IndexingSupport.OUTER_1VECTOR
        return indexing.explicit_indexing_adapter(key, self.shape, support, self._read)

    def _read(self, key: tuple[Any, ...]) -> Any:
        return np.asarray(self._manager.acquire()[self._name][key])
