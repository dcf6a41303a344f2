"""Whose a file is: a run and ``plot`` replace only files that this package wrote.

Everything that it writes says so: results and stored steps by their format, ``summary.json`` by the hash of its scene,
pictures, animations and VTK files by the name of the package inside, reports in any format by their generator, tables
by the names of their columns. Files of an earlier version that do not are known by the ``files`` of the summary beside
them. Any other file is left alone, and what would have its name is refused before anything is computed.
"""

from __future__ import annotations

import re
from pathlib import Path

from eigencontact.core.names import ANIMATION, OF_REGIONS, PICTURES, SURFACE
from eigencontact.errors import ResultsError
from eigencontact.results.atomic import read_json

__all__ = [
    "REPORT", "RESULTS", "STEPS", "SUMMARY", "is_ours", "listed_files", "refuse_foreign", "refuse_foreign_file",
    "refuse_results",
]  # fmt: skip

#: Results of a finished run.
RESULTS = "results.nc"
#: Folder of the steps of an unfinished run.
STEPS = "steps"
#: Numbers of a run.
SUMMARY = "summary.json"
#: Page about a run.
REPORT = "report.html"
_NAME = b"eigencontact"
#: Marks of our text files; files of others, which may mention us, do not have them. Tables: the end of the first line.
_MARKS: dict[str, tuple[bytes, ...]] = {
    ".json": (b'"scene_hash"', b'"generator": "eigencontact '),
    ".md": (b"<!-- generator: eigencontact ",),
    ".html": (b'<meta name="generator" content="eigencontact ',),
    ".csv": (b",failed,warnings\n", b",model_seconds,reference_seconds,reason\n"),
}
_BLOCK = 1 << 20


def is_ours(path: Path) -> bool:
    """Whether this package wrote a file, damaged since or not."""
    marks = _MARKS.get(path.suffix, (_NAME,))
    return path.is_file() and (any(_holds(path, mark) for mark in marks) or path.name in listed_files(path.parent))


def listed_files(folder: Path) -> list[str]:
    """Names of the files in the list of a folder's summary; None without a summary of this program."""
    summary = read_json(folder / SUMMARY)
    try:
        return [str(name) for name in summary["files"]] if "scene_hash" in summary else []
    except (KeyError, TypeError):
        return []


def refuse_foreign(
    folder: Path,
    regions: list[str],
    *,
    summary: bool,
    pictures: bool | str,
    vtk: bool,
    animation: bool = False,
) -> None:
    """Refuse a folder, missing or not, with foreign files under names of a run, of its regions or of its pictures.

    The flags say what will be written; `pictures` may be their ending where it is not ``png``. The `ResultsError` names
    the first such file.
    """
    try:
        present = sorted(folder.iterdir())
    except (OSError, ValueError):  # missing, or no folder that can be written: that is said where it is made
        return
    names = "|".join(re.escape(name) for name in (SURFACE, *regions))
    pictures_of_regions = [region + more for region in regions for more in ("", *OF_REGIONS)]
    stems = "|".join(re.escape(name) for name in (*PICTURES, *pictures_of_regions))
    names += r"|cells_[12]"
    ending = pictures if isinstance(pictures, str) else "png"
    used = [rf"({stems})\.{ending}"] * bool(pictures) + [rf"({names})(_\d{{4,}}\.vt[irp]|\.pvd)"] * vtk
    used += [re.escape(SUMMARY)] * summary + [rf"{ANIMATION}\.(gif|mp4)"] * animation
    for path in present:
        if any(re.fullmatch(pattern, path.name, re.IGNORECASE) for pattern in used):
            refuse_foreign_file(path, "rename the region that asks for it, ")


def refuse_foreign_file(path: Path, remedy: str = "") -> None:
    """Refuse to replace one file that this package did not write.

    Raises
    ------
    ResultsError
        Names the file.
    """
    if path.exists() and not is_ours(path):
        raise ResultsError(
            f"{path} must be a file that eigencontact wrote, or not be there (got a file of another origin, which "
            f"would be replaced); move it away, {remedy}or choose another folder with -o"
        )


def _holds(path: Path, mark: bytes) -> bool:
    """Whether the bytes of a file contain a mark of this program, near their start."""
    tail = b""
    with path.open("rb") as file:
        while block := file.read(_BLOCK):
            if mark in tail + block:
                return True
            tail = block[-len(mark) :]
    return False


def refuse_results(folder: Path, *, overwrite: bool) -> None:
    """Refuse a folder with results before they are computed again, when their cells are not yet chosen."""
    results = next((name for name in (RESULTS, STEPS) if (folder / name).exists()), None)
    if results is not None and not overwrite:
        raise ResultsError(
            f"{folder} must be without results for a run to an accuracy (got {results}); --overwrite replaces them, "
            "another -o keeps them"
        )
