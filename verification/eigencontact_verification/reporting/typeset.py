"""Labels of figures and tables: symbols with an index become formulas."""

from __future__ import annotations

import re

__all__ = ["subscripts"]

#: A symbol of one letter with an index, which stands alone: ``E_i``, ``u_ref``; no name of a result, ``max_pressure``.
_INDEXED = re.compile(r"(?<![\w\\])([A-Za-zα-ωΑ-Ω])_([A-Za-z0-9]+)(?!\w)")


def subscripts(text: str) -> str:
    r"""Text with symbols that have an index as mathtext; text that has a formula already stays as it is.

    Examples
    --------
    >>> subscripts("E_i / E_m"), subscripts("u_ref"), subscripts("max_pressure"), subscripts("$E_i$, E_m")
    ('$E_{i}$ / $E_{m}$', '$u_{\\mathrm{ref}}$', 'max_pressure', '$E_i$, E_m')
    """
    if "$" in text:
        return text
    return _INDEXED.sub(lambda match: f"${match[1]}_{{{_index(match[2])}}}$", text)


def _index(text: str) -> str:
    return text if len(text) == 1 or text.isdigit() else rf"\mathrm{{{text}}}"
