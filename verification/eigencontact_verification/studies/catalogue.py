"""The bundled studies, by name; each is a TOML file beside this module."""

from __future__ import annotations

from functools import cache

from eigencontact_verification.reporting.bundled import bundled_names, find_file
from eigencontact_verification.studies.study import Study, read_study

__all__ = ["FOLDER", "find", "names", "studies"]

#: Where they lie in the package.
FOLDER = "studies"


@cache
def names() -> tuple[str, ...]:
    """Names of the bundled studies."""
    return bundled_names(FOLDER)


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
    return read_study(*find_file(name, "study", FOLDER))
