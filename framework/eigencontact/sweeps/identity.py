"""Hashes by which a sweep knows its scene again, and a variant its results."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from eigencontact.hooks.files import texts_of
from eigencontact.scene.loader import put_values

if TYPE_CHECKING:
    from eigencontact.scene.schema import Scene
    from eigencontact.sweeps.axes import Axis

__all__ = ["checksum", "scene_digest", "sweep_digest"]


def scene_digest(scene: Scene) -> str:
    """Hash of the tables of a scene, and of the data and plugin files that it names."""
    return _digest(scene, scene.resolved())


def sweep_digest(scene: Scene, axes: Sequence[Axis], *, grid: str) -> str:
    """Hash of what all variants of a sweep share: the scene but for its varied keys, these keys, and the kind of grid.

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
    """Checksum of a data file, which all variants of a process share."""
    return checksum(path)
