"""Tables on disk that several runs share, with a hash of their inputs as key.

A table is a few arrays in one ``.npz`` file, named by a hash of all that determines them: numbers, names, and the code
that computed them (`address`). The folder is bounded; tables used longest ago go first. Files are written under another
name and renamed, so that processes may share the folder. Each file holds a checksum of its arrays: a file that is
damaged or altered counts as absent, with a warning. Nothing depends on the folder: where it cannot be read or written,
tables are computed.
"""

from __future__ import annotations

import contextlib
import dataclasses
import os
import struct
import sys
import tempfile
import time
import warnings
from collections.abc import Mapping
from functools import cache
from hashlib import sha256
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact.core.array_types import FloatArray
from eigencontact.errors import require

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["DEFAULT_LIMIT", "VARIABLE", "Entry", "TableCache", "address", "table_cache"]

#: Names the folder; empty or "off" for none.
VARIABLE = "EIGENCONTACT_CACHE"
#: Bytes that the folder may hold if nobody says otherwise.
DEFAULT_LIMIT = 1_000_000_000
#: A full folder is emptied down to this part of its limit, so that it need not be searched for each new table.
_EVICTION_SHARE = 0.8
#: Unfinished files older than this are left over from processes that were killed [s].
_ABANDONED = 3600.0
_TABLE = ".npz"
_UNFINISHED = ".unfinished"
_LIMIT = "limit"
#: Name of the checksum among the arrays of a file.
_CHECKSUM = "sha256"


@dataclasses.dataclass(frozen=True, slots=True)
class Entry:
    """File of the folder: its size [bytes] and time of last use [s since 1970]."""

    path: Path
    size: int
    used: float


class TableCache:
    """Tables in one folder.

    Parameters
    ----------
    folder : Path
        Made when the first table is kept.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._size: int | None = None

    def find(self, key: str, *names: str) -> dict[str, FloatArray] | None:
        """Arrays stored under a key, with these names; None if the file is absent, damaged or altered.

        Warns
        -----
        UserWarning
            The file is not a table, or its arrays do not match its checksum.
        """
        path = self._path(key)
        try:
            with path.open("rb") as file, np.load(file, allow_pickle=False) as archive:
                arrays = {name: archive[name] for name in archive.files}
            checksum = arrays.pop(_CHECKSUM, None)
            if checksum is None or checksum.shape or checksum.item() != _checksum(key, arrays):
                raise ValueError("arrays that do not match the checksum")  # noqa: TRY301 - like any other damage
        except OSError:  # no file, or one that another user may read
            return None
        except Exception as damage:  # noqa: BLE001 - a damaged file raises errors of any type
            # The place of a warning is a source line, which says nothing here: a name without source keeps one line.
            warnings.warn_explicit(
                f"cache table {path} must be as the program stored it (got {' '.join(str(damage).split())}); "
                "the program computes it anew",
                UserWarning, filename="eigencontact", lineno=1,
            )  # fmt: skip
            return None
        with contextlib.suppress(OSError):  # the folder may be there to read only
            os.utime(path)
        return arrays if arrays.keys() >= set(names) else None

    def keep(self, key: str, arrays: Mapping[str, FloatArray]) -> None:
        """Store arrays under a key; a disk error skips the storage."""
        with contextlib.suppress(OSError):
            path = self._path(key)
            self.folder.mkdir(mode=0o700, parents=True, exist_ok=True)
            handle, name = tempfile.mkstemp(suffix=_UNFINISHED, dir=self.folder)
            try:
                with os.fdopen(handle, "wb") as file:
                    np.savez(file, **arrays, **{_CHECKSUM: np.array(_checksum(key, arrays))})  # type: ignore[arg-type]
                Path(name).replace(path)
            finally:
                Path(name).unlink(missing_ok=True)
            self._count(path.stat().st_size)

    @property
    def limit(self) -> int:
        """Largest total size of the tables [bytes]."""
        try:
            return int((self.folder / _LIMIT).read_text(encoding="ascii"))
        except (OSError, ValueError):
            return DEFAULT_LIMIT

    def set_limit(self, limit: int) -> None:
        """Set the largest total size for every process [bytes].

        Raises
        ------
        SceneError
            Not positive.
        OSError
            The folder cannot be written.
        """
        require(limit > 0, "cache", "limit", limit, f"positive [bytes]; to keep nothing set {VARIABLE}=off")
        self.folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        with tempfile.NamedTemporaryFile("w", suffix=_UNFINISHED, dir=self.folder, delete=False) as file:
            file.write(str(limit))
        Path(file.name).replace(self.folder / _LIMIT)
        self._evict(limit, limit)

    def entries(self) -> list[Entry]:
        """All tables, least recently used first."""
        return sorted((entry for entry in self._files() if entry.path.suffix == _TABLE), key=lambda entry: entry.used)

    def clear(self) -> None:
        """Remove all tables and unfinished files."""
        for entry in self._files():
            with contextlib.suppress(OSError):
                entry.path.unlink(missing_ok=True)
        self._size = None

    def _path(self, key: str) -> Path:
        return self.folder / f"{key}{_TABLE}"

    def _files(self) -> Iterator[Entry]:
        """Tables and unfinished files, without those that another process removes meanwhile."""
        with contextlib.suppress(OSError), os.scandir(self.folder) as entries:
            for file in entries:
                if file.name.endswith((_TABLE, _UNFINISHED)):
                    with contextlib.suppress(OSError):
                        about = file.stat()
                        yield Entry(Path(file.path), about.st_size, about.st_mtime)

    def _count(self, new_bytes: int) -> None:
        """Add the size of a new table; search the folder at the first table, and when it may be full."""
        self._size = None if self._size is None else self._size + new_bytes
        limit = self.limit
        if self._size is None or self._size > limit:
            self._evict(limit, int(_EVICTION_SHARE * limit))

    def _evict(self, limit: int, target: int) -> None:
        """Remove the tables used longest ago down to the target size, if the tables exceed the limit."""
        for file in self._files():
            if file.path.suffix == _UNFINISHED and file.used < time.time() - _ABANDONED:
                file.path.unlink(missing_ok=True)
        entries = self.entries()
        size = sum(entry.size for entry in entries)
        if size > limit:
            for entry in entries:
                if size <= target:
                    break
                entry.path.unlink(missing_ok=True)
                size -= entry.size
        self._size = size


def table_cache() -> TableCache | None:
    """Cache of this user in the platform's folder; None if the user switched it off."""
    setting = os.environ.get(VARIABLE)
    if setting is not None:
        return None if setting.strip().lower() in ("", "off") else _of_folder(Path(setting).expanduser())
    base = os.environ.get("XDG_CACHE_HOME", "")
    try:
        folder = Path(base) if base and Path(base).is_absolute() else _usual_folder()
    except RuntimeError:  # a user without a home
        return None
    return _of_folder(folder / "eigencontact")


def _usual_folder() -> Path:
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA") or Path.home() / "AppData" / "Local")
    return Path.home() / ("Library/Caches" if sys.platform == "darwin" else ".cache")


@cache
def _of_folder(folder: Path) -> TableCache:
    """Cache object of a folder, one per folder, which stores its contents."""
    return TableCache(folder)


def address(*parts: Any, code: tuple[object, ...] = ()) -> str | None:
    """Key of a table: a hash of all its inputs, or None if an input has no hash.

    Parameters
    ----------
    parts
        Text, paths, numbers, None, arrays, sequences of these, and dataclasses with fields of these.
    code : tuple of (str or object)
        Whose source determines the table: modules by name, and objects for the modules of their classes. Modules of a
        package count with those beside them.
    """
    sources = {item if isinstance(item, str) else type(item).__module__ for item in code}
    try:
        encoded = _encoded((np.__version__, sorted(_source(name) for name in sources), parts))
    except TypeError:
        return None
    return sha256(encoded).hexdigest()


def _checksum(key: str, arrays: Mapping[str, FloatArray]) -> str:
    """Hash of the key and the arrays of a table: names, types, shapes and values."""
    return sha256(_encoded([key, *((name, arrays[name]) for name in sorted(arrays))])).hexdigest()


def _encoded(value: Any) -> bytes:
    """Bytes of a value; different values have different bytes."""
    match value:
        case bool() | int() | None:
            kind, body = "whole", repr(value).encode()
        case str():
            kind, body = "text", value.encode()
        case bytes():
            kind, body = "bytes", value
        case float():
            kind, body = "number", struct.pack("<d", value)
        case np.ndarray() | np.generic() if value.dtype != object:
            kind, body = f"array {value.dtype.str} {value.shape}", np.ascontiguousarray(value).tobytes()
        case Path():
            kind, body = "path", str(value).encode()
        case tuple() | list():
            kind, body = "sequence", b"".join(map(_encoded, value))
        case _ if dataclasses.is_dataclass(value) and not isinstance(value, type):
            values = [getattr(value, field.name) for field in dataclasses.fields(value) if field.compare]
            kind, body = f"{type(value).__module__}.{type(value).__qualname__}", _encoded(values)
        case _:
            raise TypeError(f"a part of an address must be text, numbers or dataclasses (got {type(value).__name__})")
    return f"{kind}, {len(body)}: ".encode() + body


@cache
def _source(name: str) -> bytes:
    """Hash of the source of a module, and of the other modules of its package."""
    module = import_module(name)
    file = getattr(module, "__file__", None)
    if not file or not Path(file).suffix == ".py":
        raise TypeError(f"module {name!r} must have a source file")
    files = sorted(Path(file).parent.glob("*.py")) if module.__package__ else [Path(file)]
    return sha256(b"".join(_encoded([path.name, path.read_bytes()]) for path in files)).digest()
