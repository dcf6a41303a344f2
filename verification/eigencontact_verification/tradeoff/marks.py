"""Marks of a study's picture, and the places of their numbers."""

from __future__ import annotations

from collections.abc import Sequence
from math import copysign, cos, hypot, radians, sin
from typing import Any

from eigencontact.viz.style import COLOURS
from eigencontact_verification.tradeoff.variant import KEYS

__all__ = ["look", "number_marks"]

#: Symbols and colours both differ from one key to the next, so that neither is needed to tell them apart.
_SYMBOLS = ("o", "s", "^", "D", "v", "P", "X", "<", ">", "p", "h", "d", "H")
_SHADES = (*COLOURS, "0.45")
#: Marks nearer than this to each other share their numbers; distances of a number from its mark [points].
_TOGETHER, _DISTANCES = 7.0, (9.0, 13.0, 18.0, 24.0, 32.0)
#: Directions from a mark in which a number is tried.
_WAYS = [(cos(radians(angle)), sin(radians(angle))) for angle in (45, 135, 315, 225, 90, 270, 0, 180)]
#: Space around a number: half the width of a digit, and half its height [points].
_DIGIT, _HEIGHT = 2.4, 3.5


def look(key: str) -> tuple[str, str]:
    """Colour and symbol of a key."""
    if key in ("scene", "reference"):
        return "black", "*"
    number = KEYS.index(key)
    return _SHADES[number % len(_SHADES)], _SYMBOLS[number % len(_SYMBOLS)]


def number_marks(axes: Any, marks: Sequence[tuple[int, float, float]]) -> None:
    """Write numbers beside their marks: nearer to them than to any other mark, and apart from each other.

    Parameters
    ----------
    axes : Axes
        Its limits and its place in the figure must not change any more.
    marks : sequence of (int, float, float)
        Number and place, in data.
    """
    scale = 72.0 / axes.figure.dpi
    groups: list[tuple[list[int], list[tuple[float, float]], tuple[float, float]]] = []
    for number, x, y in marks:
        place = tuple(float(value) * scale for value in axes.transData.transform((x, y)))
        at = (place[0], place[1])
        near = next((group for group in groups if _apart(group[1][0], at) < _TOGETHER), None)
        if near is None:
            groups.append(([number], [at], (x, y)))
        else:
            near[0].append(number)
            near[1].append(at)
    boxes: list[tuple[float, float, float]] = []
    for numbers, mark, data in groups:
        text = ", ".join(map(str, numbers))
        half = _DIGIT * len(text)
        other_places = [at for _, places, _ in groups if places is not mark for at in places]

        def free(
            offset: tuple[float, float], mark: Any = mark, other_places: Any = other_places, half: float = half
        ) -> float:
            """Room between a number and all that is not its mark [points]; above zero nothing is confused."""
            x, y = mark[0][0] + offset[0], mark[0][1] + offset[1]
            room = min((_gap(x, y, half, at, 6.0) for at in other_places), default=_DISTANCES[-1])
            room = min(room, min((_apart((x, y), at) - _apart((x, y), mark[0]) for at in other_places), default=room))
            for u, v, width in boxes:
                room = min(room, max(abs(x - u) - half - width, abs(y - v) - 2.0 * _HEIGHT))
            return room

        # beside a mark a number begins, or ends, where a shorter one would
        offsets = [
            (distance * x + copysign(half - _DIGIT, x) * (abs(x) > 0.1), distance * y)
            for distance in _DISTANCES
            for x, y in _WAYS
        ]
        best = next((offset for offset in offsets if free(offset) > 0.0), max(offsets, key=free))
        boxes.append((mark[0][0] + best[0], mark[0][1] + best[1], half))
        axes.annotate(
            text, data, xytext=best, textcoords="offset points", fontsize=8, ha="center", va="center",
            annotation_clip=False,
        )  # fmt: skip


def _apart(first: tuple[float, float], second: tuple[float, float]) -> float:
    return hypot(first[0] - second[0], first[1] - second[1])


def _gap(x: float, y: float, half: float, mark: tuple[float, float], size: float) -> float:
    """Distance between the box of a number and a mark."""
    return max(abs(x - mark[0]) - half, abs(y - mark[1]) - _HEIGHT) - 0.5 * size
