"""Tables of results: on the terminal, and between two markers of a Markdown file.

The table in a README is written here and never typed.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence
    from pathlib import Path

__all__ = ["Column", "Row", "check_section", "replace_section", "table"]

Row = dict[str, Any]


@dataclass(frozen=True, slots=True)
class Column:
    """One column: its title, the key of its value in a row, and how to write it.

    Attributes
    ----------
    brief : bool
        True where the column also belongs in the short table of a README.
    scale : float
        Factor on the value: 1e-6 for bytes to megabytes.
    """

    title: str
    key: str
    form: str = ""
    brief: bool = True
    scale: float = 1.0

    def write(self, row: Row) -> str:
        """Return the cell; a dash where a code does not report the value."""
        value = row.get(self.key)
        if value is None:
            return "–"
        return format(value if self.scale == 1.0 else self.scale * value, self.form)


def table(rows: Iterable[Row], columns: Sequence[Column]) -> str:
    """Write an aligned Markdown table, which is also fit to read as plain text.

    Examples
    --------
    >>> print(table([{"n": 256, "s": 0.5}, {"n": 2048}], [Column("N", "n"), Column("time [s]", "s", ".2f")]))
    |    N | time [s] |
    | ---: | -------: |
    |  256 |     0.50 |
    | 2048 |        – |
    """
    cells = [[column.title for column in columns]]
    cells += [[column.write(row) for column in columns] for row in rows]
    widths = [max(4, *(len(line[k]) for line in cells)) for k in range(len(columns))]
    cells.insert(1, [(w - 1) * "-" + ":" for w in widths])
    return "\n".join(
        "| " + " | ".join(cell.rjust(w) for cell, w in zip(line, widths, strict=True)) + " |" for line in cells
    )


def check_section(path: Path, section: str, *, family: str = "benchmark") -> None:
    """Raise what `replace_section` would raise, so that a long computation does not end in it."""
    _split(path, section, family)


def replace_section(path: Path, section: str, text: str, *, family: str = "benchmark") -> None:
    """Replace what stands between ``<!-- FAMILY:SECTION -->`` and ``<!-- /FAMILY:SECTION -->``.

    Parameters
    ----------
    path : Path
        A text file that has both markers once, each on a line of its own.
    section : str
        Name in the markers.
    text : str
        What is to stand between them.
    family : str
        What wrote it, the first word of the markers.

    Raises
    ------
    ValueError
        If a marker is missing, repeated or out of order; the file is then left alone.
    OSError
        If the file cannot be read or written.
    """
    before, old, after = _split(path, section, family)
    new = f"\n\n{text.strip()}\n\n"
    if new != old:
        path.write_text(before + new + after, encoding="utf-8")


def _split(path: Path, section: str, family: str) -> tuple[str, str, str]:
    """Text up to the end of the first marker, between both, and from the second on."""
    begin, end = f"<!-- {family}:{section} -->", f"<!-- /{family}:{section} -->"
    old = path.read_text(encoding="utf-8")
    pattern = re.compile(rf"(?<=^{re.escape(begin)}$).*?(?=^{re.escape(end)}$)", re.MULTILINE | re.DOTALL)
    markers = list(pattern.finditer(old))
    if len(markers) != 1 or old.count(begin) != 1 or old.count(end) != 1:
        raise ValueError(
            f"{path.name} must have the lines {begin!r} and {end!r} once each, in this order"
            f" (got {old.count(begin)} and {old.count(end)}); add both where the table belongs"
        )
    return old[: markers[0].start()], markers[0].group(), old[markers[0].end() :]
