"""Meanings of the fields of a class from its numpydoc docstring."""

from __future__ import annotations

import inspect
import re

__all__ = ["meanings", "summary"]

_HEADINGS = ("Parameters", "Attributes")


def summary(cls: type) -> str:
    """First paragraph of the docstring, in one line."""
    return " ".join(inspect.cleandoc(cls.__dict__.get("__doc__") or "").split("\n\n")[0].split())


def meanings(cls: type) -> dict[str, str]:
    """Meaning of each field by its name in Python; fields that a base class documents are inherited.

    Examples
    --------
    >>> from eigencontact.scene.wear import Shares
    >>> meanings(Shares)["body1"]
    'Share of body 1 in the worn depth.'
    """
    meaning_of: dict[str, str] = {}
    for base in reversed(cls.__mro__):
        meaning_of |= _of_text(inspect.cleandoc(base.__dict__.get("__doc__") or ""))
    return meaning_of


def _of_text(text: str) -> dict[str, str]:
    meaning_of: dict[str, str] = {}
    names: list[str] = []
    heading, lines = "", text.split("\n")
    for line, after in zip(lines, [*lines[1:], ""], strict=True):
        if re.fullmatch("-{3,}", after):
            heading, names = line.strip(), []
        elif heading in _HEADINGS and line.strip() and not re.fullmatch("-{3,}", line):
            if line[0] != " ":
                names = [name.strip() for name in line.split(" : ")[0].split(",")]
                meaning_of |= dict.fromkeys(names, "")
            else:
                meaning_of |= {name: f"{meaning_of[name]} {line.strip()}".strip() for name in names}
    return meaning_of
