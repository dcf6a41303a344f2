"""Small charts of numbers over the steps, as SVG in the colours of the page."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from markupsafe import Markup, escape

if TYPE_CHECKING:
    from collections.abc import Sequence

    from eigencontact.reports.columns import Column

__all__ = ["chart", "in_words"]

_WIDTH, _HEIGHT = 320, 170
_LEFT, _RIGHT, _TOP, _BOTTOM = 52, 312, 10, 142
#: Steps up to which each has a mark; points up to which a line is drawn as it is.
_MARKED, _POINTS = 40, 600


def chart(column: Column, steps: Sequence[int]) -> Markup:
    """One number over the steps (by their numbers), in the unit of its scale, as ``svg`` with a title."""
    errors = column.errors or (0.0,) * len(steps)
    points, band = [], []
    for step, value, error in zip(steps, column.values, errors, strict=True):
        if value is not None:
            points.append((float(step), value * column.scale.factor))
            band.append((float(step), error * column.scale.factor))
    ends = [y + sign * width for (_, y), (_, width) in zip(points, band, strict=True) for sign in (1.0, -1.0)]
    ticks = _ticks(min(0.0, *ends), max(0.0, *ends))
    low, high = ticks[0], ticks[-1]
    first, last = float(steps[0]), float(steps[-1])

    def place(x: float, y: float) -> tuple[float, float]:
        across = (x - first) / ((last - first) or 1.0)
        return _LEFT + across * (_RIGHT - _LEFT), _BOTTOM - (y - low) / (high - low) * (_BOTTOM - _TOP)

    parts = [_text(_RIGHT, _BOTTOM + 15, f"{steps[-1]}", "end"), _text(_LEFT, _BOTTOM + 15, f"{steps[0]}", "start")]
    parts.append(_text((_LEFT + _RIGHT) / 2, _BOTTOM + 24, "step", "middle"))
    for tick in ticks:
        y = place(first, tick)[1]
        parts.append(f'<path class="{"zero" if tick == 0 else "grid"}" d="M{_LEFT} {y:.1f}H{_RIGHT}"/>')
        parts.append(_text(_LEFT - 5, y + 3.5, f"{tick:.6g}", "end"))
    if column.errors:
        stride = -(-len(points) // _POINTS)
        visible = [(x, y, width) for (x, y), (_, width) in zip(points, band, strict=True)][::stride]
        upper, lower = ([(x, y + sign * width) for x, y, width in visible] for sign in (1.0, -1.0))
        around = [place(x, y) for x, y in (*upper, *reversed(lower))]
        parts.append(f'<path class="band" d="M{"L".join(f"{x:.1f} {y:.1f}" for x, y in around)}Z"/>')
    vertices = [place(x, y) for x, y in _thinned(points)]
    parts.append(f'<path class="line" d="M{"L".join(f"{x:.1f} {y:.1f}" for x, y in vertices)}"/>')
    if len(vertices) <= _MARKED:
        parts += [f'<circle class="mark" cx="{x:.1f}" cy="{y:.1f}" r="2.4"/>' for x, y in vertices]
    title = escape(f"{column.label} over the steps: {in_words(column, steps)}")
    inside = "".join(parts)
    return Markup(f'<svg viewBox="0 0 {_WIDTH} {_HEIGHT}" role="img"><title>{title}</title>{inside}</svg>')  # noqa: S704


def in_words(column: Column, steps: Sequence[int]) -> str:
    """Description of a chart: first and last value, and the largest if it is neither."""
    points = [(step, value) for step, value in zip(steps, column.values, strict=True) if value is not None]
    (first, begun), (last, ended) = points[0], points[-1]
    ends = column.with_unit(begun), column.with_unit(ended)
    words = f"{ends[0]} at step {first}, {ends[1]} at step {last}"
    largest = column.with_unit(column.largest)
    return words if largest in ends else f"{words}; largest {largest} at step {steps[column.at_largest]}"


def _ticks(low: float, high: float) -> list[float]:
    """Round numbers, three to five, from below `low` to above `high`."""
    span = (high - low) or 1.0
    rough = span / 3
    power = 10.0 ** math.floor(math.log10(rough))
    step = next(factor * power for factor in (1, 2, 2.5, 5, 10) if factor * power >= rough * (1 - 1e-9))
    count = range(math.floor(low / step + 1e-9), math.ceil(high / step - 1e-9) + 1)
    return [k * step for k in count]


def _thinned(points: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """Reduce a curve to about `_POINTS` points: the lowest and highest point of each interval, in order."""
    if len(points) <= _POINTS:
        return points
    size = math.ceil(2 * len(points) / _POINTS)
    extremes = [points[0]]
    for start in range(0, len(points), size):
        stretch = points[start : start + size]
        extremes += sorted({min(stretch, key=lambda point: point[1]), max(stretch, key=lambda point: point[1])})
    return [*extremes, points[-1]]


def _text(x: float, y: float, words: str, anchor: str) -> str:
    return f'<text x="{x:.0f}" y="{y:.1f}" text-anchor="{anchor}">{escape(words)}</text>'
