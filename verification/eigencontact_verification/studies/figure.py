"""Figure of a study from the description of its panels."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact.errors import SceneError
from eigencontact.viz.style import COLOURS, new_figure
from eigencontact_verification.reporting.typeset import subscripts
from eigencontact_verification.studies.errors import error_of
from eigencontact_verification.studies.formula import Context, evaluate
from eigencontact_verification.studies.run import source_in_words
from eigencontact_verification.studies.study import Finished, Study, formatted, label_of, levels_of, plain

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["draw_study", "panels_of"]

_DEFAULT_STYLES = ("-", "--", ":", "-.")
_NAMED = {"black": "black", "grey": "0.5"}


def draw_study(study: Study, variants: Sequence[Finished]) -> Figure:
    """Figure of all variants, with its source below."""
    panels = [item for panel in study.figure["panel"] for item in panels_of(study, panel, variants)]
    if not panels:
        raise SceneError(f"{study.name}: a figure must have values in at least one panel (got none)")
    first = len(panels_of(study, study.figure["panel"][0], variants))
    column_count = study.figure.get("columns", first if first > 1 else 4)
    columns = min(
        len(panels),
        len(levels_of((item.values for item in variants), column_count))
        if isinstance(column_count, str)
        else int(column_count),
    )
    rows = -(-len(panels) // columns)
    width, height = study.figure.get("size", (3.4 * columns + 1.4, 2.9 * rows))
    figure = new_figure(float(width), float(height))
    axes = list(figure.subplots(rows, columns, squeeze=False).ravel())
    maps: dict[int, list[tuple[Axes, Any]]] = {}
    for place, (panel, chosen, title) in zip(axes, panels, strict=False):
        place.set_title(title)
        if "map" in panel:
            maps.setdefault(id(panel["map"]), []).extend((place, item) for item in chosen)
        for n, curve in enumerate(panel["curve"]):
            _draw_curve(place, study, curve, chosen, variants, n)
        _dress(place, panel, study, chosen[0] if chosen else variants[0])
    for place in axes[len(panels) :]:
        place.set_axis_off()
    for panel in study.figure["panel"]:
        if "map" in panel and id(panel["map"]) in maps:
            _draw_maps(figure, panel["map"], maps[id(panel["map"])])
    _legend(figure, axes, str(study.figure.get("legend", "right")))
    source_text = "; ".join(source_in_words(item) for item in study.sources)
    if source_text:
        caption = "\n".join(textwrap.wrap(f"Computed anew after: {source_text}", max(40, int(17 * float(width)))))
        figure.supxlabel(caption, fontsize=6.5, x=0.01, ha="left", color="0.35")
    return figure


def panels_of(
    study: Study, panel: Mapping[str, Any], variants: Sequence[Finished]
) -> list[tuple[Mapping[str, Any], list[Finished], str]]:
    """Panels of a description: itself, or one for each variant or value of a parameter, with its variants and title."""
    chosen, title = _only(panel, variants), str(panel.get("title", ""))
    split = panel.get("each")
    if split is None:
        return [(panel, chosen, title)]
    if split == "variant":
        return [(panel, [member], _filled(title or "{label}", member)) for member in chosen]
    panels, label = [], label_of(study.parameters, split)
    for level in levels_of((variant.values for variant in chosen), split):
        group = [variant for variant in chosen if variant.values.get(split) == level]
        panels.append((panel, group, _filled(title, group[0]) if title else f"{label} = {plain(level)}"))
    return panels


def _only(table: Mapping[str, Any], variants: Sequence[Finished]) -> list[Finished]:
    if "only" not in table:
        return list(variants)
    return [variant for variant in variants if bool(evaluate(str(table["only"]), variant.context, "only"))]


def _filled(text: str, variant: Finished) -> str:
    """Text with parameters and numbers in braces; what stands between dollars has braces of its own."""
    pieces = text.split("$")
    pieces[::2] = [formatted(piece, {**variant.names, "label": variant.label}) for piece in pieces[::2]]
    return "$".join(pieces)


def _draw_curve(
    axes: Axes, study: Study, curve: Mapping[str, Any], panel: Sequence[Finished], variants: Sequence[Finished], n: int
) -> None:
    """Draw a curve of each variant, or one through the variants for each value of `by`."""
    if curve.get("once"):
        context = Context(variants[0].names)
        x, y = (np.ravel(evaluate(str(curve[axis]), context, f"curve.{axis}")) for axis in "xy")
        axes.plot(x, y, _style(curve, 0), color=_colour(curve, None, n), label=curve.get("label"), linewidth=0.9)
        return
    chosen = _only(curve, panel)
    by, dash = curve.get("by"), curve.get("dash-by")
    colours, dashes = (levels_of((variant.values for variant in variants), name) if name else [] for name in (by, dash))
    points: dict[Any, list[tuple[float, float, Finished]]] = {}
    for number, variant in enumerate(chosen):
        x, y = (_of(variant, str(curve[axis]), study) for axis in "xy")
        dash_at = dashes.index(variant.values[dash]) if dash else 0
        colour_at = colours.index(variant.values[by]) if by else None
        if np.ndim(y) == 0 and np.ndim(x) == 0:
            points.setdefault((colour_at, dash_at), []).append((x, float(y), variant))
            continue
        at = colour_at if by else (number if len(chosen) > 1 else None)
        label = _filled(str(curve.get("label", "{label}")), variant)
        x, y = np.broadcast_arrays(np.asarray(x), np.asarray(y))
        axes.plot(x, y, _style(curve, dash_at), color=_colour(curve, at, n), label=label)
    for (colour_at, dash_at), group in points.items():
        legend_label = f"{label_of(study.parameters, by)} = {plain(group[0][2].values[by])}" if by else ""
        label = _filled(str(curve["label"]), group[0][2]) if "label" in curve else legend_label
        across, up = [variant[0] for variant in group], [variant[1] for variant in group]
        colour = _colour(curve, colour_at, n)
        axes.plot(across, up, _style(curve, dash_at, "o-"), color=colour, label=label or None)
        bars = [error_of(str(curve["y"]), variant.context, variant.errors) for *_, variant in group]
        if any(bar for bar in bars if bar is not None):
            sizes = [float(bar) if bar is not None else np.nan for bar in bars]
            axes.errorbar(across, up, yerr=sizes, fmt="none", ecolor=colour, capsize=2.5, linewidth=0.9)


def _of(variant: Finished, formula: str, study: Study) -> Any:
    """Number or values of a variant; a parameter may be named as it is, whatever its name."""
    if formula in variant.values:
        return variant.values[formula]
    return np.asarray(evaluate(formula, variant.context, f"{study.name}: curve"))


def _style(curve: Mapping[str, Any], at: int, default: str = "") -> str:
    styles = curve.get("style", default or list(_DEFAULT_STYLES))
    return str(styles[at % len(styles)]) if isinstance(styles, list) else str(styles)


def _colour(curve: Mapping[str, Any], at: int | None, n: int) -> str:
    colour = curve.get("colour")
    if isinstance(colour, str):
        return _NAMED.get(colour, colour)
    return COLOURS[(colour if colour is not None else at if at is not None else n) % len(COLOURS)]


def _dress(axes: Axes, panel: Mapping[str, Any], study: Study, variant: Finished) -> None:
    first = panel["curve"][0] if panel["curve"] else panel.get("map", {})
    for axis in "xy":
        plain = str(first.get(axis, ""))
        label = panel.get(f"{axis}-label", label_of(study.parameters, plain) if plain in variant.values else plain)
        getattr(axes, f"set_{axis}label")(subscripts(str(label)))
        if f"{axis}-limits" in panel:
            getattr(axes, f"set_{axis}lim")(*panel[f"{axis}-limits"])
    if "x-scale" in panel:
        axes.set_xscale(str(panel["x-scale"]))
    for height in panel.get("levels", []):
        axes.axhline(float(height), color="0.6", linewidth=0.7, zorder=0)


def _draw_maps(figure: Figure, table: Mapping[str, Any], places: Sequence[tuple[Axes, Finished]]) -> None:
    """Fields of one description in one scale of colours; the uppermost points are drawn up to the surface."""
    fields = {id(variant): _field(table, variant) for _, variant in places}
    drawn = [values for _, _, values in (field for field in fields.values() if field is not None)]
    high = max((float(np.nanmax(np.abs(values))) for values in drawn), default=1.0) or 1.0
    low, colours = (-high, "RdBu_r") if table.get("signed") else (0.0, "viridis")
    image = None
    for axes, variant in places:
        field = fields[id(variant)]
        axes.set_aspect("equal")
        if field is None:
            axes.set_axis_off()
            continue
        x, y, values = field
        if y[0] > 0:
            y, values = np.concatenate([[0.0], y]), np.concatenate([values[:1], values])
        image = axes.pcolormesh(x, y, values, vmin=low, vmax=high, cmap=colours, shading="gouraud", rasterized=True)
        if "line" in table:
            axes.axhline(float(table["line"]), color="white", linewidth=0.8)
    if image is not None:
        label = subscripts(str(table.get("label", table["z"])))
        figure.colorbar(image, ax=[axes for axes, _ in places], shrink=0.9, label=label)


def _field(table: Mapping[str, Any], variant: Finished) -> tuple[Any, Any, Any] | None:
    if "only" in table and not bool(evaluate(str(table["only"]), variant.context, "map.only")):
        return None
    x, y, z = (np.asarray(evaluate(str(table[key]), variant.context, f"map.{key}")) for key in "xyz")
    return x, y, z


def _legend(figure: Figure, axes: Sequence[Axes], where: str) -> None:
    """One legend of all panels outside of them, each label once."""
    handles: dict[str, Any] = {}
    for item in axes:
        for handle, label in zip(*item.get_legend_handles_labels(), strict=True):
            handles.setdefault(label, handle)
    if not handles or where == "none":
        return
    place, columns = ("outside upper center", 4) if where == "above" else ("outside right upper", 1)
    figure.legend(list(handles.values()), list(handles), loc=place, ncols=columns)
