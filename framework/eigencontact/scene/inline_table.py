"""Inline tables of options and arguments, with or without their braces."""

from __future__ import annotations

import re
import tomllib
from typing import Any

from eigencontact.errors import SceneError, shown

__all__ = ["inline_table"]


def inline_table(text: str, rule: str) -> dict[str, Any]:
    """Table of the text of a TOML inline table.

    Parameters
    ----------
    rule : str
        Beginning of the message: which option must be what.

    Raises
    ------
    SceneError
        Text that is no table.

    Examples
    --------
    >>> inline_table('shape = "plane", depth-max = "2 mm"', "region must be a table")
    {'shape': 'plane', 'depth-max': '2 mm'}
    >>> inline_table("{ slope = 5 }", "--life must be a table")
    {'slope': 5}
    """
    inside = text.strip()
    inside = inside[1:-1] if len(inside) > 1 and inside[0] + inside[-1] == "{}" else inside
    try:
        (table,) = tomllib.loads(f"table = {{{inside}}}").values()
    except (tomllib.TOMLDecodeError, RecursionError, ValueError) as problem:
        reason = re.sub(r" \(at .*\)$", "", str(problem))  # the place counts what is added here
        raise SceneError(f"{rule} (got {shown(text)}: {reason})") from None
    return dict(table)
