"""Table of numbers in a text file of an instrument, with its header.

Blanks, tabs, commas or semicolons separate numbers; a comma is a decimal separator if commas do not separate numbers.
Lines above the first row and all comments belong to the header. A cell is NaN if it is empty or has a word for a
missing value.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import NamedTuple

import numpy as np

from eigencontact.plugin import FloatArray
from eigencontact_plugins.geometries.text_header import REMARK, Refusal

__all__ = ["Table", "read_table"]


#: Words for points without a height.
_MISSING = frozenset(("", "nan", "na", "n/a", "bad", "null", "none", "-", "--", "---", "***", "void"))
_NUMBER = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+|inf|infinity)(?:[eE][+-]?\d+)?", re.IGNORECASE)


class Table(NamedTuple):
    """Numbers ``(rows, columns)``, NaN for cells without a number, and the lines of the header."""

    numbers: FloatArray
    header: list[str]


class _Marks(NamedTuple):
    """Separator of numbers, None for blanks, and whether a comma is a decimal separator."""

    delimiter: str | None
    decimal_comma: bool


def read_table(path: Path, refusal: Refusal) -> Table:
    """Read a text file.

    Parameters
    ----------
    path : Path
    refusal : callable of (rule, reason)
        Makes the error for an invalid file.
    """
    lines = _text(path).splitlines()
    header, rows, marks = [], [], None
    for number, line in enumerate(lines, 1):
        row = "" if REMARK.match(line) else line.partition("#")[0].rstrip()
        marks = marks or _marks(row)
        if marks is None or not row:
            header.append(line)
        else:
            rows.append((number, row))
    if marks is None:
        raise refusal("a text file with rows of numbers", "no line holds two numbers or more")
    delimiter, decimal_comma = marks
    if delimiter != "," and any("," in row for _, row in rows):  # the first rows may have only whole numbers
        decimal_comma = True
    try:
        texts = [row.replace(",", ".") if decimal_comma else row for _, row in rows]
        return Table(np.loadtxt(texts, delimiter=delimiter, ndmin=2, comments=None), header)
    except ValueError:  # missing values, a separator at the end of a row, or not a table: the cells are read one by one
        return Table(_by_cells(rows, _Marks(delimiter, decimal_comma), refusal), header)


def _text(path: Path) -> str:
    raw = path.read_bytes()
    if raw[:2] in (b"\xff\xfe", b"\xfe\xff"):
        return raw.decode("utf-16", errors="replace")
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError:
        return raw.decode("latin-1")  # in this encoding µ is a single byte


def _cells(row: str, marks: _Marks) -> list[str]:
    cells = [cell.strip().strip('"') for cell in row.split(marks.delimiter)]
    return [cell.replace(",", ".") for cell in cells] if marks.decimal_comma else cells


def _marks(row: str) -> _Marks | None:
    """Separator of the numbers of a row; None for a row without two numbers."""
    for delimiter in (";", "\t", ",", None):
        if delimiter is not None and delimiter not in row:
            continue
        marks = _Marks(delimiter, delimiter != "," and "," in row)
        cells = _cells(row, marks)
        numbers = [cell for cell in cells if cell.lower() not in _MISSING]
        if len(cells) > 1 and numbers and all(map(_NUMBER.fullmatch, numbers)):
            return marks
    return None


def _by_cells(rows: list[tuple[int, str]], marks: _Marks, refusal: Refusal) -> FloatArray:
    split = [[cell.lower() for cell in _cells(row, marks)] for _, row in rows]
    if not any(cells[-1] for cells in split):  # a separator at the end of every row
        split = [cells[:-1] for cells in split]
    columns, table = len(split[0]), []
    for (number, _), cells in zip(rows, split, strict=True):
        wrong = [cell for cell in cells if cell not in _MISSING and not _NUMBER.fullmatch(cell)]
        if wrong or len(cells) != columns:
            reason = f"line {number} holds {repr(wrong[0]) if wrong else len(cells)}"
            raise refusal(f"a text file with rows of {columns} numbers", reason)
        table.append([np.nan if cell in _MISSING else float(cell) for cell in cells])
    return np.array(table)
