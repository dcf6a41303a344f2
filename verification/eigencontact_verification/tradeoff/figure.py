"""Picture of a study: error against time and against memory, the fronts marked."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from eigencontact.viz.style import COLOURS, new_figure, paper_style, save
from eigencontact_verification.tradeoff.variant import KEYS

if TYPE_CHECKING:
    from eigencontact_verification.tradeoff.study import Row, Study

__all__ = ["draw"]

#: By key: symbols and colours both differ, so that neither is needed to tell them apart.
_KEYS = ("scene", *KEYS)
_SYMBOLS = ("*", "o", "s", "^", "D", "v", "P", "X")
_LOOK = dict(zip(_KEYS, zip(("black", *COLOURS, "0.45"), _SYMBOLS, strict=True), strict=True))
#: Errors below this are drawn at it: nothing but rounding is left.
_LEAST = 1e-15


def draw(study: Study, file: Path) -> None:
    """Write a PNG; numbers beside the points are those of the table."""
    rows = [(k, row) for k, row in enumerate(study.rows) if row.error is not None]
    with paper_style():
        figure = new_figure(9.4, 3.9)
        left, right = figure.subplots(1, 2, sharey=True)
        _panel(left, rows, "time")
        _panel(right, rows, "memory")
        left.set_xlabel("computing time [s]")
        right.set_xlabel("peak memory of the process [MB]")
        left.set_ylabel(f"{study.headline}: relative error")
        handles, labels = left.get_legend_handles_labels()
        compared = "\n".join(["compared with", *(f"  {words}" for words in study.rows[0].variant.words.split(", "))])
        legend = figure.legend(handles, labels, loc="outside right upper", title=compared, alignment="left")
        legend.get_title().set_fontsize(8)
        left.set_title(f"{study.name}: error and time", loc="left")
        right.set_title("error and memory", loc="left")
        save(figure, file)


def _panel(axes: Any, rows: list[tuple[int, Row]], price: str) -> None:
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    def place(row: Row) -> tuple[float, float]:
        value = row.seconds if price == "time" else 1e-6 * (row.memory or 0.0)
        return float(value or 0.0), max(float(row.error or 0.0), _LEAST)

    front = sorted(place(row) for _, row in rows if price in row.fronts)
    if front:
        along, errors = zip(*front, strict=True)
        rings = {"marker": "o", "markersize": 11, "markerfacecolor": "none", "markeredgecolor": "0.4"}
        axes.plot(along, errors, drawstyle="steps-post", color="0.6", linewidth=2.0, zorder=2, label="front", **rings)
    for k, row in rows:
        colour, symbol = _LOOK[row.variant.key]
        x, y = place(row)
        label = f"{k}  {row.variant.words}" + (" (scene)" if row.variant.key == "scene" else "")
        size = 9.0 if symbol == "*" else 5.5
        axes.plot(x, y, symbol, color=colour, markersize=size, linestyle="none", zorder=3, label=label)
        side = ((-5, 4), (5, 4), (-5, -10), (5, -10))[k % 4]
        align = "left" if side[0] > 0 else "right"
        axes.annotate(str(k), (x, y), xytext=side, textcoords="offset points", fontsize=8, ha=align)
    axes.set_yscale("log")
    prices = [place(row)[0] for _, row in rows]
    if max(prices) > 5.0 * min(prices):
        axes.set_xscale("log")
        if max(prices) < 200.0 * min(prices):  # few decades: numbers between the powers of ten too
            axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axes.xaxis.set_minor_formatter(NullFormatter())
    axes.margins(0.12)
    axes.set_axisbelow(True)
    # what hardly differs must not fill the picture
    low, high = axes.get_xlim()
    if high - low < 0.5 * max(prices):
        middle = 0.5 * (low + high)
        axes.set_xlim(0.75 * middle, 1.25 * middle)
    low, high = axes.get_ylim()
    if high < 10.0 * low:
        middle = (low * high) ** 0.5
        axes.set_ylim(middle / 10.0**0.5, middle * 10.0**0.5)
    axes.grid(visible=True, which="major", color="0.9", linewidth=0.6)
