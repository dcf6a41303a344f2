"""Pictures of fields along a line below the surface, and of means over each depth of a volume."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact.core.tensors import COMPONENTS
from eigencontact.viz.errors import BAND, draw_band, errors_of
from eigencontact.viz.section import EQUIVALENT
from eigencontact.viz.sides import line_sides
from eigencontact.viz.style import COLOURS, heading, new_figure, paper_style, scale_for

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from eigencontact.results.stored import Results
    from eigencontact.viz.cut import StepValues, View
    from eigencontact.viz.style import Scale

__all__ = ["Line", "line_profile", "mean_profile", "stress_profile"]

#: A coordinate that varies by less than this part of the largest is constant: the points of a line are rounded.
CONSTANT_TOLERANCE = 1e-9
#: Components of stress below this part of the largest are not drawn.
NEGLIGIBLE = 0.01
#: Lines of at most this many points have markers: between them the curve is not computed.
MAX_MARKED_POINTS = 60


class Line:
    """Points of a region of shape line, and the breaks of its curves at interfaces and borders of inclusions.

    Attributes
    ----------
    deep : bool
        Whether no coordinate varies more along it than depth.
    at : (n,)
        Depth where the line is deep; else x or y where nothing else varies, or the distance along it [m].
    name : str
        What ``at`` is, in words.
    whole : (n,) bool
        Points on no border and in no cell that a border cuts.
    jumps : (m,)
        Where the material changes, on the same scale [m].
    """

    def __init__(self, dataset: Results, region: str, step: int) -> None:
        places = [np.asarray(dataset[f"{region}_{axis}"].values, dtype=float) for axis in "xyz"]
        points = np.stack([at * np.ones(dataset.sizes[f"{region}_point"]) for at in places])
        extents = np.ptp(points, axis=1)
        varying = np.flatnonzero(extents > CONSTANT_TOLERANCE * np.abs(points).max())
        self.deep = bool(2 in varying and extents[2] >= (1.0 - CONSTANT_TOLERANCE) * extents.max())
        if self.deep or varying.size == 1:
            number = 2 if self.deep else int(varying[0])
            self.name, self.at = "xyz"[number], points[number]
        else:
            moved = np.linalg.norm(np.diff(points), axis=0)
            self.name, self.at = f"distance along {region}", np.concatenate([[0.0], np.cumsum(moved)])
        body = int(json.loads(dataset.attrs["regions"])[region]["body"])
        sides = line_sides(dataset, region, body, points[2], step)
        self.whole = sides.whole
        self._breaks = np.flatnonzero(sides.number[1:] != sides.number[:-1]) + 1
        first, last = self.at[self._breaks - 1], self.at[self._breaks]
        self.jumps = first + sides.shares * (last - first)

    def draw(self, axes: Axes, values: Any, length: Scale, *style: Any, **more: Any) -> None:
        """Draw a curve of values, one piece for each side of a jump, without points on borders and in cut cells."""
        values = np.where(self.whole, values, np.nan) if self.whole.any() else values
        places, numbers = (
            np.insert(np.asarray(curve, dtype=float), self._breaks, np.nan) for curve in (self.at, values)
        )
        pair = (numbers, length(places)) if self.deep else (length(places), numbers)
        if self.at.size <= MAX_MARKED_POINTS:
            more = {"marker": ".", **more}
        axes.plot(*pair, *style, **more)

    def band(self, axes: Axes, values: Any, errors: Any, length: Scale, scale: Scale, colour: str) -> None:
        """Draw the error band of such a curve."""
        if self.whole.any():
            values = np.where(self.whole, values, np.nan)
        places, numbers, widths = (
            np.insert(np.asarray(curve, dtype=float), self._breaks, np.nan) for curve in (self.at, values, errors)
        )
        draw_band(axes, length(places), numbers, widths, scale, colour, across=self.deep)

    def figure(self) -> tuple[Figure, Axes]:
        """Figure for curves along the line."""
        figure = new_figure(4.6, 3.4) if self.deep else new_figure(5.2, 3.0)
        return figure, figure.add_subplot()

    def finish(self, axes: Axes, length: Scale, label: str) -> None:
        """Name the axis along the line, z downwards, and that of the values; draw the jumps."""
        (axes.set_xlabel if self.deep else axes.set_ylabel)(label)
        if self.deep:
            axes.set_ylabel(f"{self.name} [{length.unit}]")
            axes.set_ylim(float(length(self.at.max())), float(length(self.at.min())))
        else:
            axes.set_xlabel(f"{self.name} [{length.unit}]")
            axes.margins(x=0)
        for jump in self.jumps:
            across = axes.axhline if self.deep else axes.axvline
            across(float(length(jump)), color="0.4", linewidth=0.6, linestyle=(0, (4, 2)), zorder=0, label="_interface")


def stress_profile(dataset: Results, region: str, step: int = -1) -> Figure:
    """Stresses of one step along a region of shape line: depth downwards, or the coordinate that varies most across.

    Equivalent stresses that were stored, and the components of more than 1 % of the largest.
    """
    line = Line(dataset, region, step)
    curves = {
        EQUIVALENT[field]: np.asarray(dataset[f"{region}_{field}"][step].values, dtype=float)
        for field in EQUIVALENT
        if f"{region}_{field}" in dataset
    }
    if f"{region}_stress" in dataset:
        components = np.asarray(dataset[f"{region}_stress"][step].values, dtype=float)
        largest = float(np.nanmax(np.abs(components)))
        for name, values in zip(COMPONENTS, components, strict=True):
            if float(np.nanmax(np.abs(values))) > NEGLIGIBLE * largest:
                curves[rf"$\sigma_{{{name}}}$"] = values
    errors = _errors(dataset, region, step)
    stress = scale_for(np.stack(list(curves.values())), "Pa")
    length = scale_for(line.at, "m")
    styles = ("-", "--", "-.", ":")
    with paper_style():
        figure, axes = line.figure()
        for n, (name, values) in enumerate(curves.items()):
            style = styles[(n // len(COLOURS)) % len(styles)] if name in EQUIVALENT.values() else styles[1 + n % 3]
            # On an axis of symmetry von Mises and Tresca coincide: the wider line shows beneath the narrower.
            width = 2.6 if n == 0 and len(curves) > 1 else 1.2
            line.draw(axes, stress(values), length, style, color=COLOURS[n % len(COLOURS)], label=name, linewidth=width)
            if name in errors:
                line.band(axes, values, errors[name], length, stress, COLOURS[n % len(COLOURS)])
        (axes.axvline if line.deep else axes.axhline)(0, color="0.6", linewidth=0.6, zorder=0)
        line.finish(axes, length, f"Stress [{stress.unit}]")
        subject = f"{'Residual stresses' if _unloaded(dataset, step) else 'Stresses'} along {region}"
        title = heading(dataset, step, subject)
        axes.set_title(title.replace(f"{region} at", f"{region}\nat"))  # the legend lies beside
        entries = dict(zip(*axes.get_legend_handles_labels()[::-1], strict=True))  # of several bands one
        entries |= {BAND: entries.pop(BAND)} if BAND in entries else {}
        figure.legend(entries.values(), entries.keys(), loc="outside right upper")
    return figure


def _errors(dataset: Results, region: str, step: int) -> dict[str, Any]:
    """Errors of the stresses of a region, by their names in a legend."""
    named = {EQUIVALENT[field]: errors_of(dataset, f"{region}_{field}", step) for field in EQUIVALENT}
    components = errors_of(dataset, f"{region}_stress", step)
    if components is not None:
        named |= {rf"$\sigma_{{{name}}}$": errors for name, errors in zip(COMPONENTS, components, strict=True)}
    return {name: errors for name, errors in named.items() if errors is not None}


def mean_profile(dataset: Results, region: str, step: int = -1) -> Figure:
    """Means over each depth of a region of shape volume of stresses along the surface, and the range of nine tenths."""
    stress = np.asarray(dataset[f"{region}_stress"][step].values, dtype=float)
    z = np.asarray(dataset[f"{region}_z"].values, dtype=float)
    flat = {name: stress[COMPONENTS.index(name)].reshape(z.size, -1) for name in ("xx", "yy")}
    bounds = np.stack([np.quantile(values, (0.05, 0.95), axis=1) for values in flat.values()])
    scale, length = scale_for(bounds, "Pa"), scale_for(z, "m")
    with paper_style():
        figure = new_figure(4.6, 3.4)
        axes = figure.add_subplot()
        for n, (name, values) in enumerate(flat.items()):
            axes.fill_betweenx(length(z), *scale(bounds[n]), color=COLOURS[n], alpha=0.15, linewidth=0)
            label = rf"mean $\sigma_{{{name}}}$"
            axes.plot(scale(values.mean(axis=1)), length(z), ("o-", "s--")[n], color=COLOURS[n], label=label)
        axes.axvline(0, color="0.6", linewidth=0.6, zorder=0)
        axes.set(xlabel=f"Stress [{scale.unit}]", ylabel=f"z [{length.unit}]")
        axes.set_ylim(float(length(z.max())), 0.0)
        subject = f"{'Residual stress' if _unloaded(dataset, step) else 'Stress'} over depth, {region}"
        axes.set_title(heading(dataset, step, subject) + "\nbands hold nine tenths of the points")
        axes.legend(loc="best")
    return figure


def line_profile(dataset: Results, region: str, numbers: StepValues, step: int, view: View) -> Figure:
    """Numbers at the points of a region of shape line: depth downwards, or the coordinate that varies most across.

    ``vertical`` of the view is the part of the line that is seen where it is deep, else ``horizontal``.
    """
    line = Line(dataset, region, step)
    unit, length = scale_for(numbers.values, numbers.unit), scale_for(line.at, "m")
    with paper_style():
        figure, axes = line.figure()
        line.draw(axes, unit(numbers.values), length, "-", color=COLOURS[0])
        if numbers.errors is not None:
            line.band(axes, numbers.values, numbers.errors, length, unit, COLOURS[0])
            axes.legend()
        line.finish(axes, length, unit.label(numbers.words))
        if line.deep and view.vertical:
            axes.set_ylim(*length(view.vertical[::-1]))
        elif not line.deep and view.horizontal:
            axes.set_xlim(*length(view.horizontal))
        axes.set_title(heading(dataset, step, f"{numbers.words} along {region}"))
    return figure


def _unloaded(dataset: Results, step: int) -> bool:
    """Whether a contact bears no load after a step."""
    return "normal_load" in dataset and float(dataset["normal_load"][step]) == 0.0
