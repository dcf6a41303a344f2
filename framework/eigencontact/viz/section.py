"""Pictures of sub-surface regions: equivalent stress on a section, stresses along a line."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact.core.tensors import COMPONENTS
from eigencontact.viz.frame import extremes
from eigencontact.viz.outline import draw_outline
from eigencontact.viz.remembered import draw_zone, plastic_strains
from eigencontact.viz.style import (
    COLOURS,
    box_size,
    colour_range,
    heading,
    label_plane,
    new_figure,
    paper_style,
    place,
    scale_for,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from eigencontact.results.stored import Results
    from eigencontact.viz.frame import Frame

__all__ = ["drawable", "mean_profile", "stress_profile", "stress_section"]

#: Fields of a region that a section can show, the first one present is shown.
SCALAR_FIELDS = ("von_mises", "tresca", "hydrostatic")
_WORDS = {"von_mises": "Von Mises stress", "tresca": "Tresca stress", "hydrostatic": "Mean normal stress"}
#: Number of filled contours.
LEVELS = 14
#: Values beyond so many times the quantile do not set the range of the colours.
OUTLYING, COMMON = 1.3, 0.995
#: Colours begin at zero, unless all values are larger than this part of the largest.
NARROW = 0.3


def drawable(dataset: Results) -> dict[str, str]:
    """Regions that can be drawn, by name: ``"section"`` or ``"profile"``.

    Planes and volumes (cut through the maximum) of at least 2 x 2 points give a section, lines a profile; scattered
    points give nothing.
    """
    found = {}
    for name, region in json.loads(dataset.attrs["regions"]).items():
        field = _field(dataset, name)
        if field is None:
            continue
        sizes = [dataset.sizes[f"{name}_{axis}"] for axis in region["dims"]]
        if region["shape"] in ("plane", "volume") and len(sizes) > 1 and min(sizes) > 1:
            found[name] = "section"
        elif region["shape"] == "line" and sizes[0] > 1:
            found[name] = "profile"
    return found


def stress_section(dataset: Results, region: str, step: int = -1, on: Frame | None = None) -> Figure:
    """Equivalent stress of one step on a section, z downwards where the section contains it, equal scales.

    Parameters
    ----------
    dataset : Results
        Results of a run.
    region : str
        A region of shape plane or volume. A volume is cut normal to y through its largest value.
    step : int
        Position along ``step``.
    on : Frame, optional
        Frame of an animation to draw in.

    Returns
    -------
    matplotlib.figure.Figure
        Filled contours; a cross at the largest value (in magnitude); a line around what has yielded. A value that
        stands out at few points, as at an edge or beside a void, does not set the colours.
    """
    described = json.loads(dataset.attrs["regions"])[region]
    field = _field(dataset, region) or SCALAR_FIELDS[0]
    values = np.asarray(dataset[f"{region}_{field}"][step].values, dtype=float)
    dims = list(described["dims"])
    where = np.unravel_index(int(np.argmax(np.abs(np.nan_to_num(values)))), values.shape)
    cut = {axis: float(dataset[f"{region}_{axis}"]) for axis in "xyz" if _is_single(dataset, region, axis)}
    if len(dims) == 3:
        at = where[dims.index("y")]
        values = np.take(values, at, axis=dims.index("y"))
        cut["y"] = float(dataset[f"{region}_y"][at])
        where = tuple(np.delete(where, dims.index("y")))
        dims.remove("y")
    vertical, horizontal = dims
    v, h = (np.asarray(dataset[f"{region}_{axis}"].values, dtype=float) for axis in dims)
    length = scale_for([v.min(), v.max(), h.min(), h.max()], "m")
    name = f"{region}_{field}"
    limits = values if on is None else on.film.limits(name)
    colours = _ends(values) if on is None else tuple(on.film.limits(name, _ends))
    stress = scale_for(limits, "Pa")
    width, height = box_size(float(np.ptp(h)), float(np.ptp(v)), (4.4, 3.4))
    with paper_style():
        wide = width > 2.2 * height
        figure = new_figure(width + (0.8 if wide else 1.6), height + (1.5 if wide else 0.7), on)
        axes = figure.add_subplot()
        axes.set_aspect("equal")
        filled = _contours(axes, (length(h), length(v), stress(values)), stress(limits), stress(colours))
        if len(described["dims"]) == 2:
            draw_outline(axes, dataset, f"{region}_outline", length)
        axes.set_xlim(length(h[[0, -1]]))
        axes.set_ylim(length(v[[-1, 0]] if vertical == "z" else v[[0, -1]]))
        zoned = False
        for strain in plastic_strains(dataset, step):
            if strain.body == described["body"]:
                normal = next(axis for axis in "xyz" if axis in cut)
                zoned = draw_zone(axes, strain, normal, cut[normal], length)
        label_plane(axes, f"{horizontal} [{length.unit}]", f"{vertical} [{length.unit}]")
        bodies = {region_["body"] for region_ in json.loads(dataset.attrs["regions"]).values()}
        title = heading(dataset, step, _WORDS[field] + (f" in body {described['body']}" if len(bodies) > 1 else ""))
        below = ", ".join(f"at {place(axis, value)}" for axis, value in cut.items())
        if filled is None:
            axes.text(0.5, 0.5, "no stress", transform=axes.transAxes, ha="center", va="center", color="0.4")
        else:
            bar = figure.colorbar(
                filled,
                ax=axes,
                location="bottom" if wide else "right",
                shrink=0.7 if wide else 1.0,
                aspect=30 if wide else 22,
                pad=0.03,
            )
            bar.set_label(f"{_WORDS[field]} [{stress.unit}]")
            outlined = zoned or f"{region}_outline" in dataset
            spot = f"at {place(vertical, v[where[0]])}"
            if vertical != "z" or outlined:
                spot = f"at {place(horizontal, h[where[1]])}, {place(vertical, v[where[0]])}"
            words = f"{stress.text(values[where])}\n{spot}"
            _mark(axes, (float(length(h[where[1]])), float(length(v[where[0]]))), "" if outlined else words)
            if outlined:  # a label would hide what the outlines show
                below = ";  ".join(filter(None, [below, words.replace("\n", " ") + " (cross)"]))
        axes.set_title(f"{title}\n{below}" if below else title)
    return figure


def stress_profile(dataset: Results, region: str, step: int = -1) -> Figure:
    """Stresses of one step along a line: depth downwards, or distance along it where the depth is constant.

    Parameters
    ----------
    dataset : Results
        Results of a run.
    region : str
        A region of shape line.
    step : int
        Position along ``step``.

    Returns
    -------
    matplotlib.figure.Figure
        Equivalent stresses that were stored, and the normal and shear components that do not vanish.
    """
    points = {
        axis: np.asarray(dataset[f"{region}_{axis}"].values, dtype=float) * np.ones(dataset.sizes[f"{region}_point"])
        for axis in "xyz"
    }
    deep = bool(np.ptp(points["z"]) > 0)
    moved = np.sqrt(sum(np.diff(values) ** 2 for values in points.values()))
    at = points["z"] if deep else np.concatenate([[0.0], np.cumsum(moved)])
    curves = {
        _WORDS[field]: np.asarray(dataset[f"{region}_{field}"][step].values, dtype=float)
        for field in SCALAR_FIELDS
        if f"{region}_{field}" in dataset
    }
    if f"{region}_stress" in dataset:
        components = np.asarray(dataset[f"{region}_stress"][step].values, dtype=float)
        largest = float(np.nanmax(np.abs(components)))
        for name, values in zip(COMPONENTS, components, strict=True):
            if float(np.nanmax(np.abs(values))) > 1e-6 * largest:
                curves[rf"$\sigma_{{{name}}}$"] = values
    stress = scale_for(np.stack(list(curves.values())), "Pa")
    length = scale_for(at, "m")
    styles = ("-", "--", "-.", ":")
    with paper_style():
        figure = new_figure(4.6, 3.4) if deep else new_figure(5.2, 3.0)
        axes = figure.add_subplot()
        for n, (name, values) in enumerate(curves.items()):
            pair = (stress(values), length(at)) if deep else (length(at), stress(values))
            style = styles[(n // len(COLOURS)) % len(styles)] if name in _WORDS.values() else styles[1 + n % 3]
            # On an axis of symmetry von Mises and Tresca coincide: the wider line shows beneath the narrower.
            width = 2.6 if n == 0 and len(curves) > 1 else 1.2
            axes.plot(*pair, style, color=COLOURS[n % len(COLOURS)], label=name, linewidth=width)
        (axes.axvline if deep else axes.axhline)(0, color="0.6", linewidth=0.6, zorder=0)
        if deep:
            axes.set(xlabel=f"Stress [{stress.unit}]", ylabel=f"z [{length.unit}]")
            axes.set_ylim(float(length(at.max())), float(length(at.min())))
        else:
            axes.set(xlabel=f"distance along {region} [{length.unit}]", ylabel=f"Stress [{stress.unit}]")
            axes.margins(x=0)
        unloaded = "normal_load" in dataset and float(dataset["normal_load"][step]) == 0.0
        title = heading(dataset, step, f"{'Residual stresses' if unloaded else 'Stresses'} along {region}")
        axes.set_title(title.replace(f"{region} at", f"{region}\nat"))  # the legend lies beside
        figure.legend(loc="outside right upper")
    return figure


def mean_profile(dataset: Results, region: str, step: int = -1) -> Figure:
    """Means over each depth of a volume of the stresses along the surface, with the range of nine tenths of the points.

    Parameters
    ----------
    dataset : Results
        Results of a run.
    region : str
        A region of shape volume with its stress.
    step : int
        Position along ``step``.
    """
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
        unloaded = "normal_load" in dataset and float(dataset["normal_load"][step]) == 0.0
        what = f"{'Residual stress' if unloaded else 'Stress'} over depth, {region}"
        axes.set_title(heading(dataset, step, what) + "\nbands hold nine tenths of the points")
        axes.legend(loc="best")
    return figure


def _field(dataset: Results, region: str) -> str | None:
    return next((field for field in SCALAR_FIELDS if f"{region}_{field}" in dataset), None)


def _is_single(dataset: Results, region: str, axis: str) -> bool:
    return f"{region}_{axis}" in dataset.variables and dataset[f"{region}_{axis}"].ndim == 0


def _ends(values: NDArray[Any]) -> tuple[float, float]:
    """Smallest and largest value, without those that stand out."""
    size = np.abs(values[np.isfinite(values)])
    end = min(float(size.max()), OUTLYING * float(np.quantile(size, COMMON)) or np.inf) if size.size else 0.0
    return extremes(np.clip(values, -end, end))


def _contours(axes: Axes, field: tuple[NDArray[Any], ...], limits: NDArray[Any], ends: NDArray[Any]) -> Any:
    """Filled contours of a field (x, y, values) with round levels between ends; None where limits and ends are zero."""
    from matplotlib.ticker import MaxNLocator

    if not np.any(np.nan_to_num(limits)):
        return None
    x, y, values = field
    colours, low, high = colour_range(ends)
    signed = low < 0 < high
    least = float(np.nanmin(limits))
    if low == 0.0 and least > NARROW * high:  # a close-up, whose values differ little
        low = least
    levels = MaxNLocator(nbins=LEVELS, symmetric=signed).tick_values(low, high)
    beyond = {(False, False): "neither", (True, False): "min", (False, True): "max", (True, True): "both"}
    extend = beyond[bool(least < levels[0]), bool(np.nanmax(limits) > levels[-1])]
    filled = axes.contourf(x, y, np.ma.masked_invalid(values), levels=levels, cmap=colours, extend=extend)
    inner = [level for level in levels[::2] if np.nanmin(values) < level < np.nanmax(values)]
    if inner:
        axes.contour(
            x,
            y,
            np.ma.masked_invalid(values),
            levels=inner,
            colors="0.15" if signed else "1.0",
            linewidths=0.3,
            alpha=0.6,
        )
    return filled


def _mark(axes: Axes, at: tuple[float, float], words: str) -> None:
    """Cross and label at a point, the label on the side that has more room."""
    left, right = axes.get_xlim()
    bottom, top = axes.get_ylim()
    u, v = (at[0] - left) / (right - left), (at[1] - bottom) / (top - bottom)
    axes.plot(*at, "+", color="black", markersize=9, markeredgewidth=2.6, zorder=4, clip_on=False)
    axes.plot(*at, "+", color="white", markersize=8, markeredgewidth=1.2, zorder=5, clip_on=False)
    if not words:
        return
    axes.annotate(
        words,
        at,
        xytext=(9 if u < 0.6 else -9, -7 if v > 0.5 else 7),
        textcoords="offset points",
        ha="left" if u < 0.6 else "right",
        va="top" if v > 0.5 else "bottom",
        fontsize=8,
        bbox={"boxstyle": "round,pad=0.25", "facecolor": "white", "edgecolor": "none", "alpha": 0.85},
        zorder=6,
    )
