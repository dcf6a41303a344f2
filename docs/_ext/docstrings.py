"""Docstrings as they stand in the code, read by Sphinx: bars of absolute values are no substitutions."""

from __future__ import annotations

import re
from typing import Any

from sphinx.application import Sphinx

LITERAL = re.compile(r"(``.*?``|`[^`]*`)")


def _escape(_app: Sphinx, _what: str, _name: str, _obj: Any, _options: Any, lines: list[str]) -> None:
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


def setup(app: Sphinx) -> dict[str, bool]:
    app.connect("autodoc-process-docstring", _escape, priority=900)  # after numpydoc
    return {"parallel_read_safe": True, "parallel_write_safe": True}
