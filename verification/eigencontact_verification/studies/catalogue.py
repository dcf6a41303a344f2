"""Bundled TOML files of one kind by name, and files of the same kind from a user."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Generic, TypeVar

from eigencontact_verification.reporting.bundled import bundled_names, find_file, text_of
from eigencontact_verification.studies.study import Study, read_study

__all__ = ["STUDIES", "Catalogue"]

T = TypeVar("T")


@dataclass(frozen=True)
class Catalogue(Generic[T]):
    """Files of one kind."""

    kind: str  #: word for one, in messages
    folder: str  #: folder of this package with the bundled ones
    read: Callable[[Path, str | None], T]  #: reads a file, or the text of a bundled one

    def names(self) -> tuple[str, ...]:
        """Names of the bundled files."""
        return bundled_names(self.folder)

    def find(self, name: str) -> T:
        """Read a file, or the bundled one of this name.

        Raises
        ------
        SceneError
            No such file, with the nearest name; or a file of another kind.
        """
        return self.read(*find_file(name, self.kind, self.folder))

    def text(self, name: str) -> str:
        """Text of a file, or of the bundled one of this name."""
        return text_of(name, self.kind, self.folder)


STUDIES: Catalogue[Study] = Catalogue("study", "studies", read_study)
