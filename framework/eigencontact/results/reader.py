"""Stored results opened as an xarray dataset."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from eigencontact.errors import ResultsError, shown
from eigencontact.results.atomic import DAMAGE, reason
from eigencontact.results.layout import FORMAT
from eigencontact.results.ownership import RESULTS, STEPS

if TYPE_CHECKING:
    from collections.abc import Callable

    import xarray as xr

    from eigencontact.results.stored import _Stored

Opened = TypeVar("Opened", "xr.Dataset", "_Stored")

__all__ = ["open_results", "opened_whole", "results_file"]


def open_results(path: str | Path) -> xr.Dataset:
    """Open the results of a finished run; arrays are read on demand.

    Parameters
    ----------
    path : str or Path
        The folder of a run or its ``results.nc``.

    Returns
    -------
    xarray.Dataset
        Dimensions ``step, y, x`` and those of the regions, coordinates [m], ``units`` and ``long_name`` on every
        variable, provenance in the attributes. Close it, or use it in a ``with`` block.

    Raises
    ------
    ResultsError
        No results, only the steps of an interrupted run, or a file that is damaged, edited or of another origin.

    Examples
    --------
    >>> import tempfile, eigencontact as ec
    >>> small = ["stress=[]", "grid.cells-per-contact-radius=8", "output.pictures=false", "output.vtk=false"]
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     ec.run(ec.load_scene("hertz", small), folder).dataset.close()
    ...     with ec.open_results(folder) as data:
    ...         print(data.pressure.dims, data.pressure.attrs["units"])
    ('step', 'y', 'x') Pa
    """
    import xarray as xr

    return opened_whole(path, lambda file: xr.open_dataset(file, engine="h5netcdf"))


def opened_whole(path: str | Path, opener: Callable[[Path], Opened]) -> Opened:
    """Open the results of a finished run; refuse files of another format, or without the listed variables."""
    file = results_file(path)
    try:
        dataset = opener(file)
    except DAMAGE as error:
        raise ResultsError(
            f"{file} must be a complete results file (got: {reason(error)}); run the scene again with --overwrite"
        ) from error
    file_format = dataset.attrs.get("format")
    if file_format != FORMAT:
        dataset.close()
        raise ResultsError(f"{file} must be a file of format {FORMAT!r} (got {file_format!r}); it is not one of ours")
    missing = _missing(dataset)
    if missing:
        dataset.close()
        raise ResultsError(
            f"{file} must hold what it says of its regions (got {missing}); it was changed: run the scene again with "
            "--overwrite"
        )
    return dataset


def results_file(path: str | Path) -> Path:
    """Results file of a path: the path itself, or the file in this folder.

    Raises
    ------
    ResultsError
        When there is nothing, or only the steps of an interrupted run.
    """
    try:
        folder_or_file = Path(path)
        file = folder_or_file / RESULTS if folder_or_file.is_dir() else folder_or_file
        exists = file.exists()
    except (OSError, TypeError, ValueError) as error:
        raise ResultsError(f"results must be a file or folder (got {shown(path)}); {reason(error)}") from None
    if not exists:
        steps = (folder_or_file if folder_or_file.is_dir() else folder_or_file.parent) / STEPS
        if steps.is_dir():
            count = len({path.name.partition(".")[0] for path in steps.glob("[0-9]*")})
            raise ResultsError(
                f"{file} must be the results of a finished run (got an interrupted run with {count} stored steps); "
                "continue it with --resume"
            )
        raise ResultsError(f"{file} must exist (got nothing there); give the folder of a run or its {RESULTS}")
    return file


def _missing(dataset: xr.Dataset | _Stored) -> str:
    """Error of the attribute ``regions``, as text: no list, or a variable that is missing in the file."""
    try:
        regions = json.loads(dataset.attrs["regions"])
        names = [
            f"{name}_{suffix}"
            for name, region in regions.items()
            for suffix in (*"xyz", *region["fields"])
            if region["shape"] and region["body"] in (1, 2) and region["dims"]
        ]
    except DAMAGE as error:
        return f"no list of them: {reason(error)}"
    return next((f"no {name!r}" for name in names if name not in dataset.variables), "")
