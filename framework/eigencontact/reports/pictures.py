"""Pictures of a run for the page: the stored pictures, or new pictures if there are none."""

from __future__ import annotations

from base64 import b64encode
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

from eigencontact.results.ownership import SUMMARY

if TYPE_CHECKING:
    from collections.abc import Mapping

    from eigencontact.reports.source import Source

__all__ = ["Picture", "animation_of", "pictures_of", "read_pictures"]

#: Animations above this size [bytes] stay beside the page.
_LARGEST = 8_000_000
_KINDS = {".png": "image/png", ".gif": "image/gif"}
#: Pixels of the page to a pixel of a picture, so that all have letters of one size; animations are coarser.
_SHRUNK = {".png": 0.54, ".gif": 1.0}


@dataclass(frozen=True)
class Picture:
    """Picture: file name, description, content as a data URL, and size."""

    name: str
    sentence: str
    url: str
    width: int
    height: int


def pictures_of(source: Source) -> tuple[list[Picture], bool]:
    """All pictures of a run, and whether they were drawn again.

    Those in the folder are taken if each is there and none is younger than the summary that describes them: a command
    ``plot`` may have drawn another step since.
    """
    captions = _captions(source, ".png")
    folder = source.file.parent
    if captions and all(_unchanged(folder / name, folder / SUMMARY) for name in captions):
        return read_pictures(folder, captions), False
    from eigencontact.viz.figures import draw_all

    with TemporaryDirectory(prefix="eigencontact-report-") as copy_folder:
        new_captions = draw_all(source.dataset, Path(copy_folder), solid="plastic-surfaces.png" in captions)
        return read_pictures(Path(copy_folder), new_captions), True


def animation_of(source: Source) -> Picture | None:
    """Animation of a run, if it has one that is small enough for a page."""
    folder, captions = source.file.parent, _captions(source, ".gif")
    small = {name: text for name, text in captions.items() if _size(folder / name) <= _LARGEST}
    return next(iter(read_pictures(folder, small)), None)


def _captions(source: Source, ending: str) -> dict[str, str]:
    listed = source.summary.get("files") or {}
    return {name: str(text) for name, text in listed.items() if Path(name).suffix == ending and Path(name).name == name}


def _unchanged(picture: Path, summary: Path) -> bool:
    return picture.is_file() and picture.stat().st_mtime <= summary.stat().st_mtime


def _size(path: Path) -> float:
    return path.stat().st_size if path.is_file() else float("inf")


def read_pictures(folder: Path, captions: Mapping[str, str]) -> list[Picture]:
    """Pictures of a folder by the names of their files, with a sentence for each."""
    return [_picture(folder / name, text) for name, text in captions.items()]


def _picture(path: Path, sentence: str) -> Picture:
    from PIL import Image

    with Image.open(path) as image:
        width, height = (round(_SHRUNK[path.suffix] * side) for side in image.size)
    url = f"data:{_KINDS[path.suffix]};base64,{b64encode(path.read_bytes()).decode()}"
    return Picture(path.name, sentence, url, width, height)
