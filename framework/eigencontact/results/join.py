"""Steps joined along ``step`` into one results file, one step in memory at a time."""

from __future__ import annotations

from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact.errors import ResultsError
from eigencontact.results.atomic import DAMAGE, open_hdf5, reason, replacing
from eigencontact.results.history import HISTORY_STEP

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

__all__ = ["join_steps"]

#: Variables above this size [bytes] are compressed (gzip 1 after a byte shuffle).
COMPRESS_ABOVE = 2**20
#: Target size of one chunk [bytes]; a chunk never spans two steps.
CHUNK_BYTES = 2**22


@dataclass(slots=True)
class _Column:
    """A variable of the joined file: what it looks like in a step, how many steps there are, and in how many it is."""

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


def join_steps(target: Path, steps: Sequence[Path], histories: Sequence[Path] = ()) -> None:
    """Join stored steps into one file.

    A variable that occurs in some steps only (a quantity that becomes available later) is NaN in the others.

    Parameters
    ----------
    target : Path
        The results file; replaced atomically.
    steps : sequence of Path
        Files of the steps, in order.
    histories : sequence of Path
        Files of what the bodies remember after some of them, in order.

    Raises
    ------
    ResultsError
        When a step is damaged (named), when the sub-surface points differ between steps, or when the disk is full.
    """
    import h5netcdf

    columns, attrs = _columns(steps)
    if histories:
        columns |= _columns(histories[-1:], len(histories))[0]  # the cells of a body only grow
    with replacing(target, "results") as sink:
        with h5netcdf.File(sink, "w") as out:
            sizes = {dim: n for c in columns.values() for dim, n in zip(c.dims, c.shape, strict=True)}
            out.dimensions = sizes | {"step": len(steps)} | ({HISTORY_STEP: len(histories)} if histories else {})
            for name, column in columns.items():
                _create(out, name, column)
            out.attrs.update(attrs)
        sink.check()
        with open_hdf5(sink, "r+") as out:  # plain HDF5 fills ten times faster
            for at, path in enumerate(steps):
                _fill(out, at, path, columns)
            for at, path in enumerate(histories):
                _fill(out, at, path, columns, last=at == len(histories) - 1)


@contextmanager
def _step(path: Path) -> Iterator[Any]:
    """Open a stored step for reading; damage is reported by the name of its file."""
    try:
        with open_hdf5(path, "r") as file:
            yield file
    except DAMAGE as error:
        raise ResultsError(
            f"{path} must be a complete step (got: {reason(error)}); --resume computes it and those after it again "
            "and keeps the steps before it"
        ) from error


def _fill(out: Any, at: int, path: Path, columns: dict[str, _Column], *, last: bool | None = None) -> None:
    """Copy one step into its place, and what does not change: from the first, or if said from the last."""
    with _step(path) as file:
        for name, values in file.items():
            column = columns[name]
            if not column.stepped:
                if at == 0 if last is None else last:
                    out[name][...] = values[...]
            elif values.shape[1:] == column.shape[1:]:
                out[name][at] = values[0]
            else:
                out[name][(at, *_part(file, column, columns))] = values[0]


def _part(file: Any, column: _Column, columns: dict[str, _Column]) -> tuple[slice, ...]:
    """Where the fewer cells of an earlier step lie among those of the last; the others are zero: at rest."""
    parts = []
    for dim in column.dims[1:]:
        if dim not in file or file[dim].dtype.kind == "O":
            parts.append(slice(None))
            continue
        first, whole = file[dim][0], columns[dim].values
        start = int(np.argmin(np.abs(whole - first)))
        parts.append(slice(start, start + len(file[dim])))
    return tuple(parts)


def _columns(steps: Sequence[Path], count: int | None = None) -> tuple[dict[str, _Column], dict[str, Any]]:
    """Everything that occurs in the steps, and the attributes of the last one."""
    columns: dict[str, _Column] = {}
    regions: set[str] = set()
    attrs: dict[str, Any] = {}
    for path in steps:
        with _step(path) as file:
            attrs = dict(file.attrs)
            regions.add(attrs.get("regions", ""))
            for name, v in file.items():
                if name not in columns:
                    own = dict(v.attrs)
                    dims = tuple(str(own.pop("dims")).split())
                    columns[name] = _Column(dims, v.shape, v.dtype, own, count or len(steps))
                    if dims == (name,):
                        columns[name].values = v[...]
                if columns[name].shape != v.shape:
                    regions.add(f"{name} {v.shape}")
                columns[name].count += 1 if count is None else count
    if len(regions) != 1:
        raise ResultsError(
            f"sub-surface points must be the same in all steps (got {len(regions)} different sets); "
            "give every step the same regions"
        )
    return columns, attrs


def _create(out: Any, name: str, column: _Column) -> None:
    shape = (column.steps, *column.shape[1:]) if column.stepped else column.shape
    options: dict[str, Any] = {}
    if column.stepped and column.count < column.steps:
        options["fillvalue"] = np.nan
    dtype = np.dtype(column.dtype)
    if int(np.prod(shape)) * dtype.itemsize > COMPRESS_ABOVE:
        options |= {"chunks": _chunks(shape, dtype.itemsize), "compression": "gzip", "compression_opts": 1}
        options |= {"shuffle": True}
    variable = out.create_variable(name, column.dims, column.dtype, **options)
    variable.attrs.update(column.attrs)


def _chunks(shape: tuple[int, ...], itemsize: int) -> tuple[int, ...]:
    """One step and leading indices at a time, whole rows, about `CHUNK_BYTES`."""
    chunks = [1] * len(shape)
    room = max(1, CHUNK_BYTES // itemsize)
    for axis in range(len(shape) - 1, 0, -1):
        chunks[axis] = min(shape[axis], room)
        room = max(1, room // chunks[axis])
    if len(shape) == 1:
        chunks[0] = min(shape[0], room)
    return tuple(chunks)
