"""Folder of a sweep, which belongs to one scene by its hash; the program never replaces other files in it."""

from __future__ import annotations

import hashlib
import json
from functools import lru_cache
from typing import TYPE_CHECKING, Any

from eigencontact.errors import ResultsError
from eigencontact.hooks.files import texts_of
from eigencontact.results.atomic import DAMAGE, open_hdf5, reason, replacing, writable_folder
from eigencontact.results.ownership import refuse_foreign_file
from eigencontact.scene.loader import put_values

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence
    from pathlib import Path

    from eigencontact.scene.schema import Scene
    from eigencontact.sweeps.axes import Axis
    from eigencontact.sweeps.variants import Variant

__all__ = [
    "AGAIN",
    "DATASET",
    "DESCRIPTION",
    "PROFILES",
    "TABLE",
    "checksum",
    "open_folder",
    "scene_digest",
    "sweep_digest",
]

#: All numbers of a sweep.
DATASET = "sweep.nc"
#: All numbers of a sweep as text.
TABLE = "sweep.csv"
#: Keys and values of a sweep.
DESCRIPTION = "sweep.json"
#: End of the name of the figure of a field.
PROFILES = "-profiles"
#: What a message says when the disk is full.
AGAIN = "running the sweep again reuses finished variants"


def open_folder(
    folder: Path, digest: str, axes: Sequence[Axis], variants: Sequence[Variant], pictures: Iterable[str], *,
    overwrite: bool,
) -> None:  # fmt: skip
    """Make the folder of a sweep with its parents and write its description, before the first run.

    `digest` is the hash of what all variants share (`sweep_digest`), `pictures` the names of figures that may be drawn.

    Raises
    ------
    ResultsError
        A folder that cannot be written, that holds files of others under the names of ours, or another sweep, unless
        that is overwritten.
    """
    for name in (DATASET, TABLE, DESCRIPTION, *(f"{number}.png" for number in pictures)):
        refuse_foreign_file(folder / name)
    if not overwrite:
        _refuse_another(folder, digest)
    writable_folder(folder)
    content = {
        "scene_hash": digest,
        "vary": {axis.key: list(axis.values) for axis in axes},
        "variants": [{"folder": variant.label, "values": variant.values} for variant in variants],
    }
    with replacing(folder / DESCRIPTION, "the description of the sweep", consequence=AGAIN) as sink:
        sink.write((json.dumps(content, indent=2, default=str) + "\n").encode())


def _refuse_another(folder: Path, digest: str) -> None:
    choice = "--overwrite (overwrite=True) replaces it, another folder with -o keeps it"
    stored_hash = digest
    try:
        if (folder / DESCRIPTION).exists():
            stored_hash = str(json.loads((folder / DESCRIPTION).read_text(encoding="utf-8"))["scene_hash"])
        elif (folder / DATASET).exists():
            with open_hdf5(folder / DATASET, "r") as file:
                stored_hash = str(file.attrs["scene_hash"])
    except DAMAGE as problem:
        raise ResultsError(f"{folder} must hold a complete sweep (got: {reason(problem)}); {choice}") from problem
    if stored_hash != digest:
        raise ResultsError(
            f"{folder} must be empty or hold this sweep, scene hash {digest[:16]} (got the sweep of another scene or "
            f"of other keys, scene hash {stored_hash[:16]}); {choice}"
        )


def scene_digest(scene: Scene) -> str:
    """Hash of the tables of a scene, and of its data and plugin files."""
    return _digest(scene, scene.resolved())


def sweep_digest(scene: Scene, axes: Sequence[Axis], *, grid: str) -> str:
    """Hash of the common input of all variants: the scene without its varied keys, these keys, the kind of grid.

    The values are left out, so that a sweep goes on with further ones.
    """
    shared = put_values(scene.resolved(), {axis.key: "varied" for axis in axes})
    return _digest(scene, [shared, [axis.name for axis in axes], grid])


def _digest(scene: Scene, content: Any) -> str:
    from eigencontact.scene.files import anchored

    digest = hashlib.sha256(json.dumps(content, sort_keys=True).encode())
    for text in texts_of(scene.plugin_files).values():
        digest.update(text.encode())
    for path in anchored(scene, scene.known_plugins())[1]:
        if path.is_file():
            state = path.stat()
            digest.update(_unchanged(path, state.st_mtime_ns, state.st_size).encode())
    return digest.hexdigest()


def checksum(path: Path) -> str:
    """SHA-256 of a file."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


@lru_cache(maxsize=256)
def _unchanged(path: Path, changed: int, size: int) -> str:  # noqa: ARG001 - they tell a changed file apart
    """Checksum of a data file, cached for all variants of a process."""
    return checksum(path)
