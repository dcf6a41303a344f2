"""The stored steps of a run that is not finished, joined elsewhere as if it were; the run itself is left as it is."""

from __future__ import annotations

from typing import TYPE_CHECKING

from eigencontact.results.history import history_name
from eigencontact.results.join import join_steps
from eigencontact.results.ownership import RESULTS, STEPS

if TYPE_CHECKING:
    from pathlib import Path

__all__ = ["join_unfinished", "stored_files"]


def stored_files(folder: Path) -> list[Path]:
    """Files of the steps 1, 2, ... of an unfinished run, up to the first gap; none where a run is finished."""
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
    """Join the stored steps of an unfinished run, and what its bodies remember after the last, into a results file.

    Parameters
    ----------
    folder : Path
        That of the run.
    target : Path
        The results file, outside of it.

    Returns
    -------
    int
        Number of steps; nothing is written where it is 0.

    Raises
    ------
    ResultsError
        When a step is damaged, or the file cannot be stored.
    """
    steps = stored_files(folder)
    if steps:
        beside = history_name(steps[-1])
        join_steps(target, steps, [beside] if beside.exists() else [])
    return len(steps)
