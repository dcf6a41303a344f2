"""The folder of a sweep: it belongs to one scene, and files of others in it are never replaced."""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from eigencontact.errors import ResultsError
from eigencontact.results.atomic import DAMAGE, open_hdf5, reason, replacing, writable_folder
from eigencontact.results.ownership import refuse_foreign_file

if TYPE_CHECKING:
    from eigencontact.sweeps.axes import Axis
    from eigencontact.sweeps.variants import Variant

__all__ = ["AGAIN", "DATASET", "DESCRIPTION", "PROFILES", "TABLE", "open_folder"]

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
    """Make the folder of a sweep and write its description, before any variant is run.

    Parameters
    ----------
    folder : Path
        Made with its parents where missing.
    digest : str
        Hash of what all variants share (`eigencontact.sweeps.identity.sweep_digest`).
    axes, variants : sequence
        What is varied.
    pictures : iterable of str
        Names of the figures that may be drawn.
    overwrite : bool
        Replace the results of another sweep.

    Raises
    ------
    ResultsError
        A folder that cannot be written, that holds files of others under the names of ours, or another sweep.
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
    with replacing(folder / DESCRIPTION, "the description of the sweep", kept=AGAIN) as sink:
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
