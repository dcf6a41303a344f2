"""Picture of a study: error against time and against memory, the fronts marked."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from eigencontact.viz.style import new_figure, paper_style, save
from eigencontact_verification.tradeoff.marks import look, number_marks

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from eigencontact_verification.tradeoff.study import Row, Study

__all__ = ["draw", "picture"]

#: Errors below this are drawn at it: nothing but rounding is left.
_LEAST = 1e-15


def draw(study: Study, file: Path) -> None:
    """Write a PNG; numbers beside the points are those of the table."""
    with paper_style():
        save(picture(study), file)


def picture(study: Study) -> Figure:
    """Figure of a study, a panel for the time and one for the memory."""
    rows = [(k, row) for k, row in enumerate(study.rows) if row.error is not None]
    figure = new_figure(9.4, 3.9)
    left, right = figure.subplots(1, 2, sharey=True)
    for axes, price in ((left, "time"), (right, "memory")):
        _panel(axes, rows, price)
        _draw_bars(axes, study, price)
    left.set_xlabel("time [s]")
    right.set_xlabel("peak memory [MB]")
    left.set_ylabel(f"{study.headline}: relative error")
    handles, labels = left.get_legend_handles_labels()
    compared = "\n".join(["compared with", *(f"  {words}" for words in study.rows[0].variant.words.split(", "))])
    legend = figure.legend(handles, labels, loc="outside right upper", title=compared, alignment="left")
    legend.get_title().set_fontsize(8)
    left.set_title(study.name, loc="left")
    figure.draw_without_rendering()  # the layout is settled before numbers find their places
    for axes, price in ((left, "time"), (right, "memory")):
        number_marks(axes, [(k, *_place(row, price)) for k, row in rows])
    return figure


def _place(row: Row, price: str) -> tuple[float, float]:
    value = row.seconds if price == "time" else 1e-6 * (row.memory or 0.0)
    return float(value or 0.0), max(float(row.error or 0.0), _LEAST)


def _panel(axes: Any, rows: list[tuple[int, Row]], price: str) -> None:
    front = sorted(_place(row, price) for _, row in rows if price in row.fronts)
    if front:
        along, errors = zip(*front, strict=True)
        rings = {"marker": "o", "markersize": 11, "markerfacecolor": "none", "markeredgecolor": "0.4"}
        axes.plot(along, errors, drawstyle="steps-post", color="0.6", linewidth=2.0, zorder=2, label="front", **rings)
    for k, row in rows:
        colour, symbol = look(row.variant.key)
        label = f"{k}  {row.variant.words}" + (" (scene)" if row.variant.key == "scene" else "")
        size = 9.0 if symbol == "*" else 5.5
        axes.plot(*_place(row, price), symbol, color=colour, markersize=size, linestyle="none", zorder=3, label=label)
    axes.set_yscale("log")
    _scale_prices(axes, [_place(row, price)[0] for _, row in rows])
    axes.set_axisbelow(True)
    low, high = axes.get_ylim()
    if high < 10.0 * low:  # what hardly differs must not fill the picture
        middle = (low * high) ** 0.5
        axes.set_ylim(middle / 10.0**0.5, middle * 10.0**0.5)
    axes.grid(visible=True, which="major", color="0.9", linewidth=0.6)


def _draw_bars(axes: Any, study: Study, price: str) -> None:
    """Error of the scene by its error bar, and the errors that the reference cannot tell apart."""
    reference, *variants = study.rows
    for row in variants:
        if (bar := row.bars.get(study.headline)) is not None:
            place, error = _place(row, price)
            axes.plot([place, place], [error, max(bar, _LEAST)], color="black", linewidth=0.8, zorder=2)
            axes.plot(place, max(bar, _LEAST), "_", color="black", markersize=10, label="error bar of the scene")
    if (bar := reference.bars.get(study.headline)) is not None:
        limits = axes.get_ylim()
        axes.axhspan(min(limits[0], bar), bar, color="0.92", zorder=0, label="below the bar of the reference")
        axes.set_ylim(*limits)


def _scale_prices(axes: Any, prices: list[float]) -> None:
    """Axis of a price: logarithmic over more than a factor of five, and no narrower than a half of the prices."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    if max(prices) > 5.0 * min(prices):
        axes.set_xscale("log")
        if max(prices) < 200.0 * min(prices):  # few decades: numbers between the powers of ten too
            axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axes.xaxis.set_minor_formatter(NullFormatter())
    axes.margins(0.12)
    if max(prices) < 1.6 * min(prices):
        middle = 0.5 * (min(prices) + max(prices))
        axes.set_xlim(0.7 * middle, 1.3 * middle)
