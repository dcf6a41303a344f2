"""The bundled studies, by name; each is a TOML file beside this module."""

from __future__ import annotations

from functools import cache
from importlib.resources import files
from pathlib import Path

from eigencontact.errors import SceneError, nearest
from eigencontact_verification.studies.study import Study, read_study

__all__ = ["find", "names", "studies"]


@cache
def names() -> tuple[str, ...]:
    """Names of the bundled studies."""
    folder = files("eigencontact_verification") / "studies"
    return tuple(sorted(item.name.removesuffix(".toml") for item in folder.iterdir() if item.name.endswith(".toml")))


def studies() -> tuple[Study, ...]:
    """All bundled studies."""
    return tuple(find(name) for name in names())


@cache
def find(name: str) -> Study:
    """Study of a file, or of the name of a bundled one.

    Raises
    ------
    SceneError
        No such study, with the nearest name; or a file that is none.
    """
    path = Path(name)
    if path.suffix == ".toml" or path.is_file():
        return read_study(path)
    if name not in names():
        raise SceneError(
            f"study must be a TOML file or one of {', '.join(names())} (got {name!r}){nearest(name, names())}"
        )
    text = (files("eigencontact_verification") / "studies" / f"{name}.toml").read_text(encoding="utf-8")
    return read_study(Path(f"{name}.toml"), text)
