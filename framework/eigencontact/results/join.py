"""Steps joined along ``step``: into one results file, a few steps in memory at a time, or into a dataset in memory.

The steps of an unfinished run are joined elsewhere as if it were finished; the run itself is left as it is.
"""

from __future__ import annotations

from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact.errors import ResultsError
from eigencontact.results.atomic import DAMAGE, open_hdf5, reason, replacing
from eigencontact.results.history import HISTORY_STEP, history_name
from eigencontact.results.netcdf import fill, lay_out
from eigencontact.results.ownership import RESULTS, STEPS
from eigencontact.results.part import StoredPart, open_part

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence
    from pathlib import Path

    import xarray as xr
    from numpy.typing import NDArray

__all__ = ["dataset_of", "join_steps", "join_unfinished", "stored_files"]

#: Largest size of a variable [bytes] in the group of steps that are joined together.
_GROUP_BYTES = 2**25
#: Most steps of a group: their files are all open.
_GROUP = 64


@dataclass(slots=True)
class Column:
    """Joined variable: its form in a step, the number of steps, and the number of steps with it."""

    dims: tuple[str, ...]
    shape: tuple[int, ...]
    dtype: Any
    attrs: dict[str, Any]
    steps: int
    count: int = 0
    values: Any = None

    @property
    def stepped(self) -> bool:
        """Whether the variable changes from step to step."""
        return self.dims[:1] in (("step",), (HISTORY_STEP,))

    @property
    def missing(self) -> bool:
        """Whether it is missing in some steps, which have NaN."""
        return self.stepped and self.count < self.steps

    @property
    def whole(self) -> tuple[int, ...]:
        """Shape of the joined variable."""
        return (self.steps, *self.shape[1:]) if self.stepped else self.shape


def join_steps(target: Path, steps: Sequence[Path | StoredPart], histories: Sequence[Path | StoredPart] = ()) -> None:
    """Join steps, and histories after some of them, in order, into one netCDF-4 file, atomically.

    A variable that occurs in some steps only (a quantity that becomes available later) is NaN in the others. Numbers
    are stored as they are, but for bands of large fields that are zero, which are left out. The layout was chosen by
    ``python -m eigencontact_verification.benchmarks store``: compression takes 4 to 10 times as long as writing.

    Raises
    ------
    ResultsError
        When a step is damaged (named), when the sub-surface points differ between steps, or when the disk is full.
    """
    plain, history_columns, attrs = _columns(steps, histories)
    sizes = {dim: n for c in (plain | history_columns).values() for dim, n in zip(c.dims, c.whole, strict=True)}
    with replacing(target, "results") as sink, open_hdf5(sink, "w") as out:
        lay_out(out, sizes, plain | history_columns, attrs)
        for parts, columns in ((steps, plain), (histories, history_columns)):
            largest = max((c.dtype.itemsize * int(np.prod(c.shape)) for c in columns.values()), default=1)
            group = max(1, min(_GROUP, _GROUP_BYTES // max(1, largest)))
            for at in range(0, len(parts), group):
                for name, values in _values(parts[at : at + group], columns):
                    if columns[name].stepped:
                        fill(out[name], at, values)
                    else:
                        out[name][...] = values


def dataset_of(steps: Sequence[StoredPart], histories: Sequence[StoredPart] = ()) -> xr.Dataset:
    """Join steps into a dataset in memory, equal to the file of `join_steps` opened by xarray.

    Raises
    ------
    ResultsError
        When the sub-surface points differ between steps.
    """
    import xarray as xr

    plain, history_columns, attrs = _columns(steps, histories)
    variables = {}
    for parts, columns in ((steps, plain), (histories, history_columns)):
        for name, values in _values(parts, columns):
            column = columns[name]
            missing = {"_FillValue": column.dtype.type(np.nan)} if column.missing else {}
            read = values.astype(str) if values.dtype.kind == "O" else values
            variables[name] = xr.Variable(column.dims, read, _attributes(column.attrs) | missing)
            for arrays in parts if column.stepped else ():
                arrays.pop(name, None)
    in_order = {name: variables[name] for name in sorted(variables)}  # as a file lists them
    return xr.decode_cf(xr.Dataset(in_order, attrs=_attributes(attrs))).load()


def _attributes(attrs: Mapping[str, Any]) -> dict[str, Any]:
    """Texts, numpy numbers and arrays, as xarray reads them."""
    return {name: value if isinstance(value, str) else np.asarray(value)[()] for name, value in attrs.items()}


def _columns(
    steps: Sequence[Path | StoredPart], histories: Sequence[Path | StoredPart]
) -> tuple[dict[str, Column], dict[str, Column], dict[str, Any]]:
    """All variables of the steps and of the last history, and the attributes of the last step."""
    columns: dict[str, Column] = {}
    regions: set[str] = set()
    attrs: dict[str, Any] = {}
    for step in steps:
        with _opened(step) as arrays, _damage_named(step):
            attrs = dict(arrays.attrs)
            regions.add(attrs.get("regions", ""))
            for name, variable in arrays.items():
                column = columns.setdefault(name, _column(variable, len(steps)))
                if column.shape != variable.shape:
                    regions.add(f"{name} {variable.shape}")
                column.count += 1
    if len(regions) != 1:
        raise ResultsError(
            f"sub-surface points must be the same in all steps (got {len(regions)} different sets); "
            "give every step the same regions"
        )
    history_columns: dict[str, Column] = {}
    for history in histories[-1:]:  # the cells of a body only grow
        with _opened(history) as arrays, _damage_named(history):
            history_columns = {name: _column(variable, len(histories)) for name, variable in arrays.items()}
            for name, column in history_columns.items():
                column.count = len(histories)
                if column.dims == (name,):
                    column.values = arrays[name][...]
    return columns, history_columns, attrs


def _column(variable: Any, steps: int) -> Column:
    attrs = dict(variable.attrs)
    dims = tuple(str(attrs.pop("dims")).split())
    return Column(dims, tuple(variable.shape), np.dtype(variable.dtype), attrs, steps)


def _values(sources: Sequence[Path | StoredPart], columns: Mapping[str, Column]) -> Iterator[tuple[str, NDArray[Any]]]:
    """Values of each variable in some steps, joined; constant variables from the last step."""
    with ExitStack() as stack:
        parts = [(source, stack.enter_context(_opened(source))) for source in sources]
        for name, column in columns.items():
            holders = [(source, arrays) for source, arrays in parts if name in arrays]
            if not column.stepped or (len(parts) == 1 and holders and holders[0][1][name].shape == column.shape):
                for source, arrays in holders[-1:]:
                    with _damage_named(source):
                        values = arrays[name][...]
                    yield name, values
                continue
            values = np.full((len(parts), *column.shape[1:]), np.nan if column.missing else 0, column.dtype)
            for at, (source, arrays) in enumerate(parts):
                if name in arrays:
                    with _damage_named(source):
                        values[(at, *_place(arrays, arrays[name], column, columns))] = arrays[name][0]
            yield name, values


def _place(arrays: Any, variable: Any, column: Column, columns: Mapping[str, Column]) -> tuple[Any, ...]:
    """Position of the cells of an earlier, smaller box in the box of the last step."""
    if variable.shape[1:] == column.shape[1:]:
        return ()
    places = []
    for dim in column.dims[1:]:
        if dim not in arrays or arrays[dim].dtype.kind == "O":
            places.append(slice(None))
            continue
        start = int(np.argmin(np.abs(columns[dim].values - arrays[dim][0])))
        places.append(slice(start, start + len(arrays[dim])))
    return tuple(places)


@contextmanager
def _opened(source: Path | StoredPart) -> Iterator[Any]:
    """Open a step for reading, if it is a file."""
    if isinstance(source, StoredPart):
        yield source
        return
    with ExitStack() as stack:
        with _damage_named(source):
            arrays = stack.enter_context(open_part(source))
        yield arrays


@contextmanager
def _damage_named(source: Path | StoredPart) -> Iterator[None]:
    """Report damage by the name of its file."""
    try:
        yield
    except DAMAGE as error:
        raise ResultsError(
            f"{source} must be a complete step (got: {reason(error)}); --resume computes it and those after it again "
            "and keeps the steps before it"
        ) from error


def stored_files(folder: Path) -> list[Path]:
    """Files of the steps 1, 2, ... of an unfinished run, up to the first gap; empty for a finished run."""
    steps = folder / STEPS
    if (folder / RESULTS).exists() or not steps.is_dir():
        return []
    files: list[Path] = []
    while True:
        candidates = [steps / f"{len(files) + 1:04d}.{ending}" for ending in ("step", "h5")]  # .h5 of earlier versions
        existing = [path for path in candidates if path.exists()]
        if not existing:
            return files
        files.append(existing[0])


def join_unfinished(folder: Path, target: Path) -> int:
    """Join the stored steps of an unfinished run, and the history after the last, into another file.

    Returns the number of steps; nothing is written where it is 0. `ResultsError` when a step is damaged, or the file
    cannot be stored.
    """
    steps = stored_files(folder)
    if steps:
        history_path = history_name(steps[-1])
        join_steps(target, steps, [history_path] if history_path.exists() else [])
    return len(steps)
