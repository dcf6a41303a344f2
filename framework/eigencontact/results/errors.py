"""Additional variables of a finished results file: evaluations of all steps, and errors of fields."""

from __future__ import annotations

import shutil
from itertools import chain
from typing import TYPE_CHECKING

import numpy as np

from eigencontact.results.atomic import partial_name, replacing

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

    from eigencontact.results.layout import Variable

__all__ = ["append"]


def append(results: Path, variables: Iterable[Variable]) -> None:
    """Add variables with existing dimensions to a results file, atomically.

    Those that it has already are replaced.

    Raises
    ------
    ResultsError
        When the file cannot be stored.
    """
    import h5netcdf

    remaining = iter(variables)
    first = next(remaining, None)
    if first is None:
        return
    with replacing(results, "fields of the whole run") as sink:
        with results.open("rb") as source:
            shutil.copyfileobj(source, sink)
        with h5netcdf.File(partial_name(results), "r+") as file:
            for variable in chain([first], remaining):
                if variable.name in file.variables:
                    target = file.variables[variable.name]
                else:
                    target = file.create_variable(variable.name, variable.dims, variable.values.dtype)
                target[...] = variable.values
                for name, value in variable.attrs.items():
                    target.attrs[name] = value if isinstance(value, str) else np.atleast_1d(value)
