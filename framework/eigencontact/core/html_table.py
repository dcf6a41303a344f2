"""A small table for notebooks: a heading, rows of a name and a value, everything escaped."""

from __future__ import annotations

from collections.abc import Iterable
from html import escape

__all__ = ["html_table"]

_CELL = "text-align:left;padding:0.1em 1em 0.1em 0"


def html_table(heading: str, rows: Iterable[tuple[str, str]], note: str = "") -> str:
    """HTML text of a heading, table rows and a note.

    Examples
    --------
    >>> print(html_table("A < B", [("load", "1 N")]))
    <div><strong>A &lt; B</strong><table>
    <tr><th style="text-align:left;padding:0.1em 1em 0.1em 0">load</th><td style="text-align:left">1 N</td></tr>
    </table></div>
    """
    lines = [
        f'<tr><th style="{_CELL}">{escape(name)}</th><td style="text-align:left">{escape(value)}</td></tr>'
        for name, value in rows
    ]
    below = f"<p>{escape(note)}</p>" if note else ""
    return "\n".join([f"<div><strong>{escape(heading)}</strong><table>", *lines, f"</table>{below}</div>"])
