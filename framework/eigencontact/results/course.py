"""The course of a run in a small table of text: loads, motions, stick, work of friction and wear, step by step."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.rigid_modes import TANGENTIAL_MODES
from eigencontact.results.cycles import friction_work

__all__ = ["course_table", "driven_motions"]

FloatArray = NDArray[np.float64]

#: Fewest rows of a table of many steps.
_MIN_ROWS = 6
#: Most rows of a table.
_MAX_ROWS = 12
#: A load below this part of the largest of its kind is a by-product.
_BY_PRODUCT = 1e-3
#: A load below this part of the normal load is a by-product.
_NOTHING = 1e-6
#: Width of the table [letters].
_WIDTH = 80
#: Spaces before the table.
_INDENT = 2
#: Text between columns.
_GAP = "  "
#: A value below this part of the largest of its column is round-off.
_ROUND_OFF = 1e-9
#: By motion: headings of displacement and force, and their units.
_MOTIONS = {
    "x": ("shift x", "m", "force x", "N"),
    "y": ("shift y", "m", "force y", "N"),
    "twist": ("twist", "rad", "torsion", "N m"),
}
_MODES = dict(zip(_MOTIONS, TANGENTIAL_MODES, strict=True))
_PREFIXES = {9: "G", 6: "M", 3: "k", 0: "", -3: "m", -6: "u", -9: "n", -12: "p", -15: "f"}


def driven_motions(history: Mapping[str, FloatArray]) -> list[str]:
    """Driven motions among ``x``, ``y`` and ``twist`` of a history with friction, without by-products of other loads.

    Parameters
    ----------
    history : mapping of str to (steps,) array
        Scalars of all steps by the names of results; those that are missing count as zero.

    Examples
    --------
    >>> pulled = {"normal_load": [1.0, 1.0], "tangential_load_x": [0.0, 0.2], "shift_x": [0.0, 1e-7]}
    >>> driven_motions({name: np.array(values) for name, values in pulled.items()})
    ['x']
    """

    def largest(name: str) -> float:
        return float(np.nanmax(np.abs(history[name]), initial=0.0)) if name in history else 0.0

    motions = []
    for motion, mode in _MODES.items():
        alike = [mode] if motion == "twist" else [_MODES["x"], _MODES["y"]]
        arm = largest("contact_radius") if motion == "twist" else 1.0
        leads = all(
            largest(getattr(mode, side)) > _BY_PRODUCT * max(largest(getattr(rival, side)) for rival in alike)
            for side in ("force", "displacement")
        )
        if leads and largest(mode.force) > _NOTHING * largest("normal_load") * arm:
            motions.append(motion)
    return motions


def course_table(history: Sequence[Mapping[str, Any]], units: Mapping[str, str] | None = None) -> str:
    """Table of a history, at most 80 columns wide: all steps of a few; of many the first, the last and turns.

    With friction the load, the motions that are driven and their forces, the part of the contact that sticks and the
    work of friction since the start, that of skipped cycles included; without it load, approach, contact radius and
    largest pressure. Wear adds cycles and the largest depth.

    Parameters
    ----------
    history : sequence of mapping
        Numbers of every step by name, in order, as in ``summary["history"]`` of a run.
    units : mapping of str to str, optional
        SI unit of each number that has another one than in three dimensions: those of a line contact.

    Returns
    -------
    str
        Lines; empty for runs without contact, and for those of one step.

    Examples
    --------
    >>> rows = [{"step": n, "normal_load": 0.1 * n, "approach": 1e-7 * n} for n in (1, 2)]
    >>> print(course_table(rows))
      step   load  approach
               mN        nm
         1  100.0     100.0
         2  200.0     200.0
    """
    if len(history) < 2 or "normal_load" not in history[-1]:
        return ""
    names = sorted({name for row in history for name in row})
    columns = {name: np.array([_number(row.get(name)) for row in history]) for name in names}
    motions = driven_motions(columns)
    rows, cut = _rows(columns, motions)
    steps = ["step", "", *(f"{columns['step'][row]:.0f}" for row in rows)]
    texts = [
        _texts(heading, unit, values, rows) for heading, unit, values in _table_columns(columns, motions, units or {})
    ]
    if cut:
        for column in (steps, *texts):
            column.insert(2 + len(rows) // 2, "..." if column is steps else "")
    return "\n\n".join(_side_by_side([steps, *group]) for group in _narrow(steps, texts))


def _narrow(steps: list[str], texts: list[list[str]]) -> Iterator[list[list[str]]]:
    """Columns in groups that fit into the width, each with the numbers of the steps."""
    group, width = list[list[str]](), 0
    for column in texts:
        column_width = len(_GAP) + max(map(len, column))
        if group and _INDENT + len(max(steps, key=len)) + width + column_width > _WIDTH:
            yield group
            group, width = [], 0
        group.append(column)
        width += column_width
    yield group


def _side_by_side(texts: list[list[str]]) -> str:
    widths = [max(map(len, column)) for column in texts]
    lines = (
        " " * _INDENT + _GAP.join(text.rjust(width) for text, width in zip(line, widths, strict=True))
        for line in zip(*texts, strict=True)
    )
    return "\n".join(line.rstrip() for line in lines)


def _number(value: Any) -> float:
    return float("nan") if value is None else float(value)


def _table_columns(
    columns: Mapping[str, FloatArray], motions: Sequence[str], units: Mapping[str, str]
) -> list[tuple[str, str, FloatArray]]:
    """Heading, unit and values of each column."""
    choice = [("load", "N", "normal_load")]
    if "slip_fraction" in columns:
        for motion in motions:
            displacement, way_unit, force, force_unit = _MOTIONS[motion]
            choice += [(displacement, way_unit, _MODES[motion].displacement), (force, force_unit, _MODES[motion].force)]
        if not motions:
            choice.append(("radius", "m", "contact_radius"))
    else:
        choice += [("approach", "m", "approach"), ("radius", "m", "contact_radius"), ("pressure", "Pa", "max_pressure")]
    columns_of_table = [
        (heading, units.get(name, unit), columns[name]) for heading, unit, name in choice if name in columns
    ]
    if "slip_fraction" in columns:
        touches = columns["normal_load"] > 0.0
        columns_of_table.append(("stick", "%", np.where(touches, 100.0 * (1.0 - columns["slip_fraction"]), np.nan)))
        work = friction_work(columns)
        assert work is not None
        columns_of_table.append(("work", units.get("dissipated_energy", "J"), work))
    if "max_worn_depth" in columns:
        columns_of_table.append(("worn", "m", columns["max_worn_depth"]))
    if "cycles" in columns and np.nanmax(columns["cycles"], initial=0.0) > 1.0:
        columns_of_table.insert(0, ("cycle", "", columns["cycles"]))
    return columns_of_table


def _rows(columns: Mapping[str, FloatArray], motions: Sequence[str]) -> tuple[list[int], bool]:
    """Indices of the displayed steps, and whether middle steps are omitted.

    All of a few; else the first, the last, ends of ramps and turns.
    """
    count = len(columns["step"])
    if count <= _MAX_ROWS:
        return list(range(count)), False
    positions = {0, count - 1}
    if "time" in columns:
        positions |= set(np.flatnonzero(np.abs(columns["time"] - np.round(columns["time"])) < _ROUND_OFF).tolist())
    for name in ("normal_load", *(_MODES[motion].displacement for motion in motions)):
        moves = np.diff(columns[name])
        moves[np.abs(moves) < _ROUND_OFF * np.nanmax(np.abs(columns[name]), initial=0.0)] = 0.0
        positions |= set((np.flatnonzero(moves[1:] * moves[:-1] < 0.0) + 1).tolist())
    if len(positions) < _MIN_ROWS:
        positions |= set(np.round(np.linspace(0, count - 1, _MIN_ROWS)).astype(int).tolist())
    rows = sorted(positions)
    cut = len(rows) > _MAX_ROWS
    return [*rows[: _MAX_ROWS // 2], *rows[-_MAX_ROWS // 2 :]] if cut else rows, cut


def _texts(heading: str, unit: str, values: FloatArray, rows: Sequence[int]) -> list[str]:
    """Heading, unit and the values of some rows, with as many decimals as the largest needs for four digits."""
    numbers = np.where(np.abs(values) < _ROUND_OFF * np.nanmax(np.abs(values), initial=0.0), 0.0, values)
    largest = float(np.nanmax(np.abs(numbers), initial=0.0))
    power = 0
    if unit not in ("%", "") and largest > 0.0:
        power = int(np.clip(3 * np.floor(np.log10(largest * (1.0 + _ROUND_OFF)) / 3), min(_PREFIXES), max(_PREFIXES)))
    largest /= 10.0**power
    digits = 1 if unit == "%" else 0 if not unit or largest == 0.0 else max(0, 3 - int(np.floor(np.log10(largest))))
    texts = (f"{round(value / 10.0**power, digits) + 0.0:.{digits}f}" for value in numbers[rows])
    return [heading, f"{_PREFIXES[power]}{unit}", *("-" if text == "nan" else text for text in texts)]
