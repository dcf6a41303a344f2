"""Picture of a campaign: a map with error and verdict in each cell, or a curve with the reference's own error."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact.viz.style import COLOURS, new_figure
from eigencontact_verification.campaign.finding import JudgedPoint, MapFinding
from eigencontact_verification.reporting.typeset import subscripts
from eigencontact_verification.reporting.verdict import MARKS, percent
from eigencontact_verification.studies.study import label_of, levels_of, number_of, plain

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from eigencontact_verification.campaign.campaign import Campaign

__all__ = ["axes_of_map", "draw_map", "label_in", "levels_in", "quantities_of"]

#: Light tints that differ in brightness as well: blue, yellow, vermilion, grey.
_BARS = COLOURS[1]
_TINTS = {"agrees": "#b5d8ee", "inconclusive": "#f7ecae", "disagrees": "#f0a17a", "failed": "#d0d0d0"}


def axes_of_map(campaign: Campaign, points: Sequence[JudgedPoint]) -> tuple[str, str | None, list[str]]:
    """Parameter across, parameter upwards or None, and those that make a panel for each of their values."""
    names = list(dict.fromkeys(parameter.name for model in campaign.models for parameter in model.study.parameters))
    varied = [name for name in names if len(levels_in(points, name)) > 1] or names[:1]
    x = str(campaign.drawn.get("x", varied[0]))
    remaining = [name for name in varied if name != x]
    y = campaign.drawn.get("y", remaining[0] if remaining else None)
    y = y if y in remaining else None  # one value, as in a first look, needs no axis
    return x, y, [name for name in remaining if name != y]


def quantities_of(campaign: Campaign, points: Sequence[JudgedPoint]) -> list[str]:
    """Names of quantities that were judged; those that the file wants drawn."""
    judged_names = list(dict.fromkeys(finding.quantity for point in points for finding in point.findings))
    names = campaign.drawn.get("quantities", judged_names)
    return [name for name in judged_names if name in names] or judged_names


def draw_map(campaign: Campaign, points: Sequence[JudgedPoint]) -> Figure:
    """One panel for each quantity, and for each value of further parameters."""
    x, y, panel_axes = axes_of_map(campaign, points)
    names = quantities_of(campaign, points)
    groups = list(product(*(levels_in(points, name) for name in panel_axes)))
    panels = [(name, group) for group in groups for name in names]
    across, up = levels_in(points, x), [None] if y is None else levels_in(points, y)
    columns = min(len(panels), 3 if y is None else max(1, 10 // max(3, len(across))))
    rows = -(-len(panels) // columns)
    width, height = (4.2, 3.3) if y is None else (1.5 + 0.84 * len(across), 1.3 + 0.6 * len(up))
    figure = new_figure(max(5.0, columns * width), rows * height + 0.6)
    places = list(figure.subplots(rows, columns, squeeze=False).ravel())
    for place, (name, group) in zip(places, panels, strict=False):
        at = dict(zip(panel_axes, group, strict=True))
        chosen = [point for point in points if all(point.point.values.get(key) == value for key, value in at.items())]
        panel = ", ".join([name, *(f"{label_in(campaign, key)} {plain(value)}" for key, value in at.items())])
        place.set_title(subscripts(panel))
        if y is None:
            _curve(place, chosen, name, x, across)
        else:
            _cells(place, chosen, name, (x, across), (y, up))
            place.set_ylabel(subscripts(str(campaign.drawn.get("y-label", label_in(campaign, y)))))
        place.set_xlabel(subscripts(str(campaign.drawn.get("x-label", label_in(campaign, x)))))
    for place in places[len(panels) :]:
        place.set_axis_off()
    _key(figure, points, cells=y is not None)
    figure.suptitle(subscripts(f"{campaign.title}\n{campaign.words}, judged by {campaign.reference}"), fontsize=9)
    return figure


def label_in(campaign: Campaign, name: str) -> str:
    """Label of a parameter."""
    return label_of((parameter for model in campaign.models for parameter in model.study.parameters), name)


def levels_in(points: Sequence[JudgedPoint], name: str) -> list[Any]:
    """Values of a parameter at points, in order."""
    return levels_of((judged.point.values for judged in points), name)


def _of(point: JudgedPoint, name: str) -> MapFinding | None:
    return next((finding for finding in point.findings if finding.quantity == name), None)


def _cells(
    axes: Axes, chosen: Sequence[JudgedPoint], name: str, x: tuple[str, Sequence[Any]], y: tuple[str, Sequence[Any]]
) -> None:
    """Cell for each point: tint and mark are the verdict, the number is the error; thick lines bound the claim."""
    from matplotlib.patches import Rectangle

    claimed = np.full((len(y[1]), len(x[1])), fill_value=False)
    for point in chosen:
        column, row = x[1].index(point.point.values[x[0]]), y[1].index(point.point.values[y[0]])
        finding = _of(point, name)
        if finding is None:
            continue
        claimed[row, column] = finding.claimed
        axes.add_patch(Rectangle((column - 0.5, row - 0.5), 1, 1, facecolor=_TINTS[finding.word], edgecolor="white"))
        words = f"{MARKS[finding.word]} {finding.word}"
        if finding.error is not None:
            words += f"\n{percent(finding.error)}\n±{percent(finding.uncertainty)}"
        axes.text(column, row, words, ha="center", va="center", fontsize=6.5)
    for row, column in product(*map(range, claimed.shape)):
        if column and claimed[row, column] != claimed[row, column - 1]:
            axes.plot([column - 0.5] * 2, [row - 0.5, row + 0.5], color="black", linewidth=1.8)
        if row and claimed[row, column] != claimed[row - 1, column]:
            axes.plot([column - 0.5, column + 0.5], [row - 0.5] * 2, color="black", linewidth=1.8)
    axes.set_xlim(-0.5, len(x[1]) - 0.5)
    axes.set_ylim(-0.5, len(y[1]) - 0.5)
    axes.set_xticks(range(len(x[1])), [plain(value) for value in x[1]])
    axes.set_yticks(range(len(y[1])), [plain(value) for value in y[1]])
    axes.tick_params(length=0)


def _curve(axes: Axes, chosen: Sequence[JudgedPoint], name: str, x: str, levels: Sequence[Any]) -> None:
    """Error against the parameter with the reference's own error as a band, tolerance and claim."""
    numbers = all(isinstance(number_of(level), int | float) for level in levels)
    points = []
    for level in sorted(chosen, key=lambda level: levels.index(level.point.values[x])):
        finding = _of(level, name)
        at = number_of(level.point.values[x]) if numbers else levels.index(level.point.values[x])
        if finding is not None and finding.error is not None and finding.uncertainty is not None:
            points.append((at, 100 * finding.error, 100 * finding.uncertainty, finding))
    if points:
        across, error, reference_error = (np.array([level[k] for level in points], dtype=float) for k in range(3))
        style = "o-" if numbers else "o"
        if len(points) > 1 and numbers:
            axes.fill_between(
                across,
                np.maximum(error - reference_error, 0),
                error + reference_error,
                color=COLOURS[0],
                alpha=0.25,
                linewidth=0,
            )
        else:
            axes.errorbar(across, error, yerr=reference_error, fmt="none", color=COLOURS[0], capsize=3)
        axes.plot(across, error, style, color=COLOURS[0])
        bars = np.array([100 * level.run_error if level.run_error is not None else np.nan for *_, level in points])
        if np.isfinite(bars).any():
            axes.errorbar(across, error, yerr=bars, fmt="none", ecolor=_BARS, capsize=4, linewidth=0.9)
        for at, height, _, finding in points:
            axes.annotate(f"{MARKS[finding.word]} {finding.word}", (at, height), xytext=(0, 5),
                          textcoords="offset points", ha="center", fontsize=6.5)  # fmt: skip
        axes.axhline(100 * points[0][3].tolerance, color="black", linestyle="--", linewidth=0.9)
        top = max(float((error + np.fmax(reference_error, bars)).max()), 100 * points[0][3].tolerance)
        axes.set_ylim(0.0, 1.18 * top)
        if numbers:
            axes.margins(x=0.14)  # room for the words of the outermost points
    for level in chosen:
        finding = _of(level, name)
        if finding is not None and finding.claimed and len(levels) > 1:
            at = number_of(level.point.values[x]) if numbers else levels.index(level.point.values[x])
            axes.plot([at], [0.0], marker="^", color="black", markersize=5, clip_on=False, zorder=5)
    if not numbers:
        axes.set_xticks(range(len(levels)), [plain(value) for value in levels], rotation=30, ha="right")
        axes.set_xlim(-0.6, len(levels) - 0.4)
    axes.set_ylabel("error [%]")


def _key(figure: Figure, points: Sequence[JudgedPoint], *, cells: bool) -> None:
    """Draw the legend of tints, marks and lines."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    bordered = len({finding.claimed for point in points for finding in point.findings}) > 1
    entries: list[tuple[Any, str]] = []
    if cells:
        used = {finding.word for point in points for finding in point.findings}
        entries = [(Patch(color=tint), f"{MARKS[word]} {word}") for word, tint in _TINTS.items() if word in used]
        entries += [(Line2D([], [], color="black", linewidth=1.8), "border of the claim")] if bordered else []
    else:
        band = Patch(color=COLOURS[0], alpha=0.25)
        entries = [(band, "own error of the reference"),
                   (Line2D([], [], color="black", linestyle="--", linewidth=0.9), "tolerance")]  # fmt: skip
        if any(finding.run_error is not None for point in points for finding in point.findings):
            entries.append((Line2D([], [], color=_BARS, marker="|", linestyle="-"), "error bar of the model"))
        if bordered:
            entries.append((Line2D([], [], color="black", marker="^", linestyle="none"), "agreement is claimed"))
    handles, words = zip(*entries, strict=True)
    figure.legend(handles, words, loc="outside lower center", ncols=len(entries), fontsize=8, frameon=False)
