"""The folder of a run: each accepted step stored at once, one results file at the end."""

from __future__ import annotations

import json
import re
from dataclasses import dataclass, field, replace
from math import inf
from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING, Any

from eigencontact.errors import ResultsError, SceneError
from eigencontact.results.atomic import partial_name, reason, replacing, writable_folder
from eigencontact.results.history import history_name
from eigencontact.results.join import join_steps
from eigencontact.results.ownership import REPORT, RESULTS, STEPS, SUMMARY, is_ours, listed_files
from eigencontact.results.reader import open_results
from eigencontact.results.stepfile import (
    history_part,
    names_remembered,
    read_attributes,
    read_history,
    read_step,
    step_part,
    stored_rows,
    stored_steps,
    write_step,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    import xarray as xr

    from eigencontact.results.layout import Variable
    from eigencontact.results.memory import MemoryStore
    from eigencontact.results.records import RunInfo, StepRecord

__all__ = ["ResultStore"]

_MARK = "run.json"
_STEP_FILE = re.compile(r"(\d{4,})\.(step|h5)")  # .h5 of earlier versions
_HISTORY_FILE = re.compile(r"(\d{4,})\.history\.(step|h5)")
_FILE_NAME = r"(\d{4,}(\.history)?\.(step|h5)|run\.json)"
_FILE_NAME_IN_STEPS = re.compile(rf"{_FILE_NAME}|\.{_FILE_NAME}\.partial")
#: Histories that an unfinished run keeps: should the last step be damaged, the one before can still be continued.
_HISTORY_COUNT = 2
#: Steps are put on the disk for good at this distance [s]: each of them costs some 10 ms. What is written is safe from
#: a killed process at once.
_LASTING = 1.0


@dataclass(slots=True)
class ResultStore:
    """Results of one run in one folder.

    While a run is under way the folder holds ``steps/0001.step ...``, and where bodies remember something
    ``0001.history.step ...`` of the last two steps (of all, if the scene wants that); `finish` joins them into
    ``results.nc``. A run killed at any moment leaves complete steps only, and a store created with ``resume=True``
    continues them. The step of a run that has no other becomes ``results.nc`` at once.

    Attributes
    ----------
    folder : Path
        Where the run is stored.
    info : RunInfo
        What holds for all steps.
    problems : list of str
        Stored steps that `accepted` could not use, in words, to be shown to the user; they are computed again.
    new_folders : list of Path
        Folders that `create` made, innermost first.
    """

    folder: Path
    info: RunInfo
    problems: list[str] = field(default_factory=list)
    new_folders: list[Path] = field(default_factory=list)
    _lasting: float = -inf

    @classmethod
    def create(cls, folder: Path, info: RunInfo, *, resume: bool = False, overwrite: bool = False) -> ResultStore:
        """Open a folder for a run.

        Parameters
        ----------
        folder : Path
            Made with its parents where missing; other files in it are left alone.
        info : RunInfo
            What holds for all steps.
        resume : bool
            Continue the run stored there; the scene must be the same. With nothing stored, start.
        overwrite : bool
            Remove what an earlier run stored there, damaged or not: only files that this package wrote
            (`eigencontact.results.ownership`).

        Raises
        ------
        SceneError
            Both choices at once.
        ResultsError
            When the folder cannot be written, or holds results that neither choice covers.
        """
        folder = Path(folder)
        store = cls(folder, info)
        if resume and overwrite:
            raise SceneError("results must be continued or replaced, not both; give --resume or --overwrite")
        try:
            hashes = tuple(
                _kept_hash(path, read, overwrite=overwrite)
                for path, read in ((folder / STEPS / _MARK, _stored_hash), (folder / RESULTS, _results_hash))
            )
            _refuse_foreign_steps(folder / STEPS)
            if not overwrite:
                _refuse_conflict(folder, info, hashes, resume=resume)
            store.new_folders = [path for path in (folder, *folder.parents) if not path.exists()]
            writable_folder(folder)
            if overwrite:
                _remove_own(folder)
            if not (resume and store.finished):
                store._begin()
        except (OSError, ValueError) as error:  # ValueError: a zero in the path
            raise ResultsError(
                f"output folder {folder} must be a folder that can be written (got: {reason(error)}); "
                "choose another with -o"
            ) from error
        return store

    @property
    def finished(self) -> bool:
        """Whether the folder holds the results of this run and no steps of an unfinished run."""
        path = self.folder / RESULTS
        unfinished = (self.folder / STEPS / _MARK).exists() or not path.exists()
        return not unfinished and _results_hash(path) == self.info.scene_hash

    def _begin(self) -> None:
        steps = self.folder / STEPS
        steps.mkdir(exist_ok=True)
        mark = {"scene_hash": self.info.scene_hash, "name": self.info.name, "load_steps": self.info.steps}
        with replacing(steps / _MARK, "the mark of the run") as sink:
            sink.write(json.dumps(mark).encode())

    def abandon(self) -> None:
        """Leave no trace of a run that failed before its first step was accepted; with a step stored, do nothing."""
        if _step_files(self.folder / STEPS):
            return
        _remove_steps(self.folder)
        for path in self.new_folders:
            if any(path.iterdir()):
                break
            path.rmdir()

    def write_step(self, record: StepRecord) -> None:
        """Store one accepted step: complete when this returns, and on the disk within a second of computing.

        Raises
        ------
        ResultsError
            When it cannot be stored (full disk, folder gone); earlier steps stay, nothing torn is left behind.
        """
        if self.info.steps == 1:
            # A file of its own for the only step would be written, read and removed.
            histories = [history_part(self.info, record, copied=False)] if record.history else []
            join_steps(self.folder / RESULTS, [step_part(self.info, record, copied=False)], histories)
            _remove_steps(self.folder)
            return
        lasting = monotonic() - self._lasting > _LASTING
        write_step(self.folder / STEPS / f"{record.index:04d}.step", self.info, record, lasting=lasting)
        self._lasting = monotonic() if lasting else self._lasting
        if record.history and not self.info.every_history:
            history_name(self.folder / STEPS / f"{record.index - _HISTORY_COUNT:04d}.step").unlink(missing_ok=True)

    def accepted(self) -> list[int]:
        """Indices 1, 2, ... n of the stored steps from which the run can continue.

        Every file is read through. The list ends before the first missing or damaged step, because a step
        continues the one before it; `problems` says what was found.
        """
        self.problems = []
        if self.finished:
            return stored_steps(self.folder / RESULTS)
        files = _step_files(self.folder / STEPS)
        usable: list[int] = []
        for index in sorted(files):
            if index != len(usable) + 1:
                self.problems.append(f"step {len(usable) + 1} is missing; it and the steps after it are computed again")
                break
            try:
                read_step(files[index], self.info.scene_hash, index)
            except ResultsError as error:
                self.problems.append(f"{error}; step {index} and those after it are computed again")
                break
            usable.append(index)
        while usable and not self._remembers(usable[-1]):
            usable.pop()
        return usable

    def _remembers(self, index: int) -> bool:
        """Whether the run can continue from a step: its history is readable, if it has one."""
        path = self._path(index)
        try:
            if not names_remembered(path) or read_history(path, self.info.scene_hash, index):
                return True
            problem = f"what the bodies remember after step {index} is missing"
        except ResultsError as error:
            problem = str(error)
        self.problems.append(f"{problem}; step {index} is computed again")
        return False

    def load_step(self, index: int) -> StepRecord:
        """Read a stored step back.

        Raises
        ------
        ResultsError
            When it is missing, damaged, or of another scene.
        """
        path = self.folder / RESULTS if self.finished else self._path(index)
        if not path.exists():
            raise ResultsError(f"{self.folder} must hold step {index} (got steps {self.accepted()}); compute it again")
        record = read_step(path, self.info.scene_hash, index)
        return replace(record, history=read_history(path, self.info.scene_hash, index))

    def finish(self) -> Path:
        """Join the steps into ``results.nc``, remove the folder of steps, and return the path.

        Raises
        ------
        ResultsError
            When no step is stored, one is missing or damaged, or the disk is full; the steps are then kept.
        """
        target = self.folder / RESULTS
        if self.finished:
            return target
        files = _step_files(self.folder / STEPS)
        if not files or sorted(files) != list(range(1, len(files) + 1)):
            raise ResultsError(
                f"{self.folder / STEPS} must hold steps 1, 2, ... without a gap (got {sorted(files)}); "
                "--resume computes the missing ones"
            )
        histories = _files(self.folder / STEPS, _HISTORY_FILE)
        history_indices = (
            sorted(histories) if self.info.every_history else [index for index in histories if index == max(files)]
        )
        join_steps(target, [files[index] for index in sorted(files)], [histories[index] for index in history_indices])
        _remove_steps(self.folder)
        return target

    def opened(self) -> Any:
        """Variables of the finished results, in a ``with`` block."""
        from eigencontact.results.stored import open_stored

        return open_stored(self.folder)

    def append(self, variables: Iterable[Variable]) -> None:
        """Add variables of all steps, or of the run, to the finished results; `ResultsError` on failure."""
        from eigencontact.results.errors import append

        append(self.folder / RESULTS, variables)

    def adopt(self, memory: MemoryStore) -> None:
        """Store the steps of a run in memory as the finished results.

        Raises
        ------
        ResultsError
            When they cannot be stored.
        """
        memory.join(self.folder / RESULTS)
        _remove_steps(self.folder)

    def history(self, last: StepRecord) -> list[dict[str, Any]]:
        """Numbers of all stored steps in order, the last one from memory."""
        results = self.folder / RESULTS
        paths = [results] if results.exists() else list(_step_files(self.folder / STEPS).values())
        rows = [row for path in paths for row in stored_rows(path) if row["step"] != last.index]
        return sorted([*rows, last.row()], key=lambda row: float(row["step"]))

    def dataset(self) -> xr.Dataset:
        """Open the finished results; `ResultsError` if results of another scene have replaced them."""
        results = open_results(self.folder)
        if results.attrs["scene_hash"] != self.info.scene_hash:
            results.close()
            raise ResultsError(
                f"{self.folder} must hold the results of {self.info.name!r} (got those of another scene)"
            )
        return results

    def _path(self, index: int) -> Path:
        path = self.folder / STEPS / f"{index:04d}.step"
        earlier = path.with_suffix(".h5")
        return earlier if earlier.exists() and not path.exists() else path


def _step_files(steps: Path) -> dict[int, Path]:
    return _files(steps, _STEP_FILE)


def _files(steps: Path, pattern: re.Pattern[str]) -> dict[int, Path]:
    """Files of a pattern by the number of their step."""
    paths = sorted(steps.iterdir()) if steps.is_dir() else ()  # .h5 first: one of this version counts
    return {int(match[1]): path for path in paths if (match := pattern.fullmatch(path.name))}


def _kept_hash(path: Path, read: Callable[[Path], str], *, overwrite: bool) -> str | None:
    """Scene hash of stored files; None without files, or for damaged files that the run overwrites."""
    if not path.exists():
        return None
    try:
        return read(path)
    except ResultsError as problem:
        ours = is_ours(path)
        if ours and overwrite:
            return None
        choice = "--overwrite replaces it" if ours else "move it away"
        raise ResultsError(f"{problem}; {choice}, or choose another folder with -o") from None


def _stored_hash(mark: Path) -> str:
    """Scene hash of an unfinished run."""
    try:
        return str(json.loads(mark.read_text(encoding="utf-8"))["scene_hash"])
    except (ValueError, KeyError, TypeError, RecursionError) as error:
        raise ResultsError(f"{mark} must be the mark of a run of ours (got: {reason(error)})") from error


def _results_hash(path: Path) -> str:
    """Scene hash of finished results."""
    return str(read_attributes(path)["scene_hash"])


def _refuse_foreign_steps(steps: Path) -> None:
    if steps.exists() and not (steps / _MARK).exists():
        strange = sorted(path.name for path in steps.iterdir() if not _FILE_NAME_IN_STEPS.fullmatch(path.name))
        if strange:
            raise ResultsError(
                f"{steps} must be a folder that this package made (got {strange[0]!r} in it); choose another with -o"
            )


def _refuse_conflict(folder: Path, info: RunInfo, hashes: tuple[str | None, ...], *, resume: bool) -> None:
    choices = "--overwrite replaces them, another -o keeps them"
    if any(stored_hash not in (None, info.scene_hash) for stored_hash in hashes):
        also = "; --resume continues the same scene only" if resume else ""
        raise ResultsError(
            f"{folder} must be empty or of the scene {info.name!r} as it is now (got results of another scene, "
            f"or of this one before it was changed){also}; {choices}"
        )
    if hashes[0] is not None and not resume and _step_files(folder / STEPS):
        raise ResultsError(
            f"{folder} must not hold an unfinished run (got steps {sorted(_step_files(folder / STEPS))} of "
            f"{info.name!r}); --resume continues it, {choices}"
        )


def _remove_own(folder: Path) -> None:
    """Remove the files of an earlier run: steps, results, summary, report, and the files in the list of the summary."""
    _remove_steps(folder)
    names = [*listed_files(folder), *(name for name in (SUMMARY, REPORT) if is_ours(folder / name))]
    inside = folder.resolve()
    for name in (*names, RESULTS, *(partial_name(folder / name).name for name in (RESULTS, SUMMARY))):
        path = folder / name
        if path.is_file() and path.parent.resolve().is_relative_to(inside):
            path.unlink()


def _remove_steps(folder: Path) -> None:
    """Remove the folder of steps, its mark first, so that an interruption leaves no steps to resume."""
    steps = folder / STEPS
    if not steps.is_dir():
        return
    (steps / _MARK).unlink(missing_ok=True)
    for path in list(steps.iterdir()):
        if _FILE_NAME_IN_STEPS.fullmatch(path.name):
            path.unlink()
    if not any(steps.iterdir()):
        steps.rmdir()
