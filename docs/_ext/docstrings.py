"""Docstrings read by Sphinx: bars of absolute values are no substitutions, sections of modules no headings."""

from __future__ import annotations

import re
from types import GenericAlias
from typing import Any

from sphinx.application import Sphinx

LITERAL = re.compile(r"(``.*?``|`[^`]*`)")


def _escape(_app: Sphinx, what: str, _name: str, _obj: Any, _options: Any, lines: list[str]) -> None:
    if what == "module":  # numpydoc leaves the sections of modules as they are
        for number in range(len(lines) - 1, 0, -1):
            if lines[number] and not lines[number].strip("-"):
                lines[number - 1 : number + 1] = [f".. rubric:: {lines[number - 1]}", ""]
    code = False
    for number, line in enumerate(lines):
        if line.lstrip().startswith(">>>"):
            code = True
        elif not line.strip():
            code = False
        if not code:
            parts = LITERAL.split(line)
            lines[number] = "".join(
                part if at % 2 else re.sub(r"(?<!\\)\|", r"\|", part) for at, part in enumerate(parts)
            )


def _skip(_app: Sphinx, _what: str, name: str, obj: Any, _skipped: bool, _options: Any) -> bool | None:  # noqa: FBT001
    """Aliases of tuples, which Sphinx takes for classes, and what pydantic adds."""
    return True if isinstance(obj, GenericAlias) or name.startswith("model_") else None


def _signature(_app: Sphinx, _what: str, _name: str, obj: Any, *_: Any) -> tuple[str, str] | None:
    """Tables of a scene have no signature to read: their keys are in the reference."""
    return ("", "") if hasattr(obj, "model_fields") else None


def setup(app: Sphinx) -> dict[str, bool]:
    app.connect("autodoc-process-docstring", _escape, priority=900)  # after numpydoc
    app.connect("autodoc-skip-member", _skip)
    app.connect("autodoc-process-signature", _signature)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
