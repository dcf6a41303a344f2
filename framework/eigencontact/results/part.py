"""One step as named arrays, in memory or in a file, read alike.

A part has the face of an HDF5 file: a mapping of names to arrays that are read when they are indexed, each with its
attributes (``dims`` among them), and the attributes of the whole. A stored step is one file: a line with a mark and a
header of JSON under a checksum, which holds single numbers too, then the arrays, each under a checksum of its own. It
costs little more than its bytes. Steps of earlier versions are HDF5 files, ``.h5``; they are read as they are.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any
from zlib import crc32

import numpy as np

from eigencontact.results.atomic import open_hdf5
from eigencontact.results.layout import TEXT

if TYPE_CHECKING:
    from io import BufferedReader
    from pathlib import Path

    from numpy.typing import NDArray

    from eigencontact.results.atomic import Sink
    from eigencontact.results.layout import Variable

__all__ = ["Stored", "StoredPart", "open_part", "part_of", "write_part"]

_MARK = "eigencontact-step-1"
#: Longest first line [bytes]: the mark, the length of the header and its checksum.
_LINE = 80


@dataclass(kw_only=True, slots=True)
class Stored:
    """Array of a part; `read` reads it completely."""

    attrs: dict[str, Any]
    shape: tuple[int, ...]
    dtype: np.dtype[Any]
    read: Callable[[], NDArray[Any]]

    def __getitem__(self, place: Any) -> Any:
        """Values at a place."""
        return self.read()[place]

    def __len__(self) -> int:
        """Return the length of the first dimension."""
        return self.shape[0]


class StoredPart(dict[str, Stored]):
    """Arrays by name; `attrs` are the attributes of the whole."""

    def __init__(self, attrs: Mapping[str, Any], arrays: Mapping[str, Stored]) -> None:
        super().__init__(arrays)
        self.attrs = dict(attrs)


def part_of(attrs: Mapping[str, Any], variables: Sequence[Variable], *, copied: bool = True) -> StoredPart:
    """Part in memory, with copies or with the arrays themselves, which then must not change while it is used."""

    def stored_copy(variable: Variable) -> Stored:
        values = np.array(variable.values) if copied else variable.values
        return Stored(attrs=_described(variable), shape=values.shape, dtype=values.dtype, read=values.view)

    return StoredPart(attrs, {variable.name: stored_copy(variable) for variable in variables})


def write_part(sink: Sink, attrs: Mapping[str, Any], variables: Sequence[Variable]) -> None:
    """Write variables, and attributes of the whole, as one file."""
    listed: list[dict[str, Any]] = []
    blocks: list[memoryview] = []
    for variable in variables:
        values, text = variable.values, variable.values.dtype.kind == "O"
        item: dict[str, Any] = {"name": variable.name, "attrs": _described(variable), "shape": values.shape}
        item["dtype"] = "text" if text else values.dtype.str
        if text or values.size == 1:  # most of the arrays of a step are single numbers
            item["values"] = values.tolist()
        else:
            blocks.append(np.ascontiguousarray(values).reshape(-1).view(np.uint8).data)
            item |= {"bytes": len(blocks[-1]), "checksum": crc32(blocks[-1])}
        listed.append(item)
    header = json.dumps({"attrs": attrs, "arrays": listed}, default=_plain).encode()
    sink.write(f"{_MARK} {len(header)} {crc32(header)}\n".encode() + header)
    for block in blocks:
        sink.write(block)


@contextmanager
def open_part(path: Path) -> Iterator[Any]:
    """Open a stored step or joined results: a `StoredPart`, or the HDF5 file.

    Raises
    ------
    ValueError, OSError, LookupError, TypeError
        When the file is damaged; where an array is damaged, when that is read (`eigencontact.results.atomic.DAMAGE`).
    """
    with path.open("rb") as file:
        if file.read(len(_MARK)) == _MARK.encode():
            file.seek(0)
            yield _read(file)
            return
    with open_hdf5(path, "r") as file:
        yield file


def _read(file: BufferedReader) -> StoredPart:
    line = file.readline(_LINE)
    _, length, checksum = line.split()
    header = json.loads(_checked(file.read(int(length)), int(checksum), "the header"))
    arrays, at = {}, len(line) + int(length)
    for item in header["arrays"]:
        dtype = TEXT if item["dtype"] == "text" else np.dtype(item["dtype"])
        values = item.get("values")
        read = partial(_array, file, at, item) if values is None else partial(np.array, values, dtype)
        arrays[item["name"]] = Stored(attrs=item["attrs"], shape=tuple(item["shape"]), dtype=dtype, read=read)
        at += item.get("bytes", 0)
    return StoredPart(header["attrs"], arrays)


def _array(file: BufferedReader, at: int, item: Mapping[str, Any]) -> NDArray[Any]:
    file.seek(at)
    block = bytearray(item["bytes"])  # whose array can be written to, unlike that of bytes
    file.readinto(block)
    return np.frombuffer(_checked(block, item["checksum"], item["name"]), item["dtype"]).reshape(item["shape"])


def _checked(block: Any, checksum: int, name: str) -> Any:
    if crc32(block) != checksum:
        raise ValueError(f"the checksum of {name} does not fit")
    return block


def _described(variable: Variable) -> dict[str, Any]:
    return {**variable.attrs, "dims": " ".join(variable.dims)}


def _plain(value: Any) -> Any:
    """Plain values of numpy arrays and numbers."""
    return value.tolist()
