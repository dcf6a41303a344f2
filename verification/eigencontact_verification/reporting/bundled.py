"""Questions as TOML files, of a user or bundled beside a module: found by name, read, shown."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from importlib.resources import files
from pathlib import Path
from typing import Any

from eigencontact.errors import SceneError, nearest

__all__ = ["bundled_names", "find_file", "read_toml", "text_of"]


def bundled_names(folder: str) -> tuple[str, ...]:
    """Names of the files of a folder of this package."""
    items = (files("eigencontact_verification") / folder).iterdir()
    return tuple(sorted(item.name.removesuffix(".toml") for item in items if item.name.endswith(".toml")))


def find_file(name: str, subject: str, folder: str) -> tuple[Path, str | None]:
    """Path of a file, and where it is a bundled one its text.

    Parameters
    ----------
    name : str
        A file, or the name of a bundled one.
    subject : str
        For the message.
    folder : str
        Of this package, where they lie.

    Raises
    ------
    SceneError
        Neither, with the nearest name.
    """
    path, bundled = Path(name), bundled_names(folder)
    if path.suffix == ".toml" or path.is_file():
        return path, None
    if name not in bundled:
        raise SceneError(
            f"{subject} must be a TOML file or one of {', '.join(bundled)} (got {name!r}){nearest(name, bundled)}"
        )
    text = (files("eigencontact_verification") / folder / f"{name}.toml").read_text(encoding="utf-8")
    return Path(f"{name}.toml"), text


def text_of(name: str, subject: str, folder: str) -> str:
    """Text of a file, or of a bundled one."""
    path, text = find_file(name, subject, folder)
    return path.read_text(encoding="utf-8") if text is None else text


def read_toml(path: Path, text: str | None, subject: str) -> Mapping[str, Any]:
    """Content of a file.

    Raises
    ------
    SceneError
        It cannot be read, or is no TOML.
    """
    try:
        return tomllib.loads(path.read_text(encoding="utf-8") if text is None else text)
    except (OSError, ValueError, RecursionError) as problem:
        raise SceneError(f"{subject} must be a readable TOML file (got {str(path)!r}): {problem}") from None
