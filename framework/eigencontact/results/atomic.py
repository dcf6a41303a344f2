"""Atomic files: written under a temporary name, flushed to the disk, renamed."""

from __future__ import annotations

import json
import os
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, BinaryIO

from eigencontact.errors import ResultsError

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

__all__ = [
    "DAMAGE",
    "Sink",
    "of_this_version",
    "open_hdf5",
    "partial_name",
    "read_json",
    "reason",
    "replacing",
    "writable_folder",
]


#: What the HDF5 libraries raise on files that are damaged or not what they should be.
DAMAGE = (OSError, RuntimeError, LookupError, ValueError, TypeError, AttributeError, ArithmeticError, MemoryError)


@contextmanager
def of_this_version(file: Path, damage: tuple[type[Exception], ...] = DAMAGE) -> Iterator[None]:
    """Run code that relies on the contents of a results file; exceptions that mean damage raise one clear error."""
    try:
        yield
    except damage as problem:
        raise ResultsError(
            f"{file} must hold results as this version writes them (got {type(problem).__name__}: {reason(problem)}); "
            "run the scene again with --overwrite"
        ) from problem


class Sink:
    """Binary file that stores the error of a failed write instead of raising it.

    The HDF5 library cannot close a file whose last bytes did not fit on the disk; it may then bring the interpreter
    down. Written through a sink it always closes; `replacing` looks at ``error`` afterwards and discards the file.
    """

    def __init__(self, raw: BinaryIO) -> None:
        self._raw = raw
        self.error: BaseException | None = None

    def write(self, data: bytes | memoryview) -> int:
        """Write all of `data`; after a failure, nothing more."""
        view = memoryview(data)
        view = view.cast("B") if view.nbytes else view
        written_bytes = 0
        try:
            while self.error is None and written_bytes < len(view):
                written_bytes += self._raw.write(view[written_bytes:])
        except BaseException as error:  # noqa: BLE001 - an interrupt in here must not reach HDF5 either
            self.error = error
        return len(view)

    def readinto(self, buffer: memoryview) -> int:
        """Fill `buffer` from the present position; returns the number of bytes."""
        return int(self._raw.readinto(buffer))  # type: ignore[attr-defined]

    def read(self, size: int = -1) -> bytes:
        """Read `size` bytes."""
        return self._raw.read(size)

    def seek(self, offset: int, whence: int = 0) -> int:
        """Move to a position."""
        return self._raw.seek(offset, whence)

    def tell(self) -> int:
        """Present position."""
        return self._raw.tell()

    def truncate(self, size: int | None = None) -> int:
        """Cut or extend the file."""
        try:
            return self._raw.truncate(size)
        except OSError as error:
            self.error = self.error or error
            return size or 0

    def check(self) -> None:
        """Raise the error of a failed write."""
        if self.error is not None:
            raise self.error

    def flush(self) -> None:
        """Do nothing: writes are not buffered."""


def open_hdf5(file: Path | Sink, mode: str) -> Any:
    """Open a plain HDF5 file (h5py.File); `mode` is ``"r"``, ``"r+"`` or ``"w"``."""
    import h5py  # type: ignore[import-not-found,import-untyped,unused-ignore]

    return h5py.File(file, mode)


def partial_name(path: Path) -> Path:
    """Temporary name in the same folder for writing `path`."""
    return path.with_name(f".{path.name}.partial")


def reason(error: BaseException) -> str:
    """Words of the operating system for an error, without its number and path."""
    return (getattr(error, "strerror", None) or str(error) or type(error).__name__).strip()


def writable_folder(folder: Path) -> None:
    """Make a folder with its parents if missing, and check that it is writable.

    Raises
    ------
    ResultsError
        A file of that name, a folder that cannot be made or written.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        probe = partial_name(folder / "probe")
        probe.touch()
        probe.unlink()
    except (OSError, ValueError) as error:  # ValueError: a zero in the path
        raise ResultsError(
            f"output folder {folder} must be a folder that can be written (got: {reason(error)}); "
            "choose another with -o"
        ) from error


@contextmanager
def replacing(
    path: Path, content: str, *, lasting: bool = True, consequence: str = "--resume keeps the steps that are stored"
) -> Iterator[Sink]:
    """Open a temporary file that replaces `path` when the block succeeds, and is removed otherwise.

    Parameters
    ----------
    path : Path
        Final name; an older file of that name stays untouched until the new one is complete and on the disk.
    content : str
        Name of the content for the message: ``"step 3"``.
    lasting : bool
        Whether it has to be on the disk when the block ends, so that it outlives a loss of power; a process that is
        killed loses nothing in either case.
    consequence : str
        What the message says is not lost.

    Raises
    ------
    ResultsError
        When the disk is full or the folder cannot be written.
    """
    partial = partial_name(path)
    try:
        with partial.open("w+b", buffering=0) as raw:
            sink = Sink(raw)
            try:
                yield sink
            except Exception as error:  # HDF5 may trip over what a failed write left; the failed write is the cause
                sink.check()
                raise _Inside from error
            sink.check()
            if lasting:
                os.fsync(raw.fileno())
        partial.replace(path)
        if lasting:
            _sync_folder(path.parent)
    except OSError as error:
        _discard(partial)
        raise ResultsError(
            f"{content} must be stored in {path.parent} (got: {reason(error)}); free space or make the folder "
            f"writable; {consequence}"
        ) from error
    except _Inside as error:
        _discard(partial)
        raise error.__cause__ or error from None
    except BaseException:
        _discard(partial)
        raise


def read_json(path: Path) -> dict[str, Any]:
    """Table in a JSON file; empty if the file is missing or unreadable."""
    try:
        return dict(json.loads(path.read_text(encoding="utf-8")))
    except (OSError, ValueError, TypeError, RecursionError):
        return {}


class _Inside(Exception):
    """Carries an error of the block past the handler for errors of the file."""


def _discard(partial: Path) -> None:
    try:
        partial.unlink(missing_ok=True)
    except OSError:  # the folder itself is gone or was never there: nothing of ours is left in it
        return


def _sync_folder(folder: Path) -> None:
    """Flush the rename to the disk, on systems that can (POSIX)."""
    if os.name != "posix":
        return
    handle = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
