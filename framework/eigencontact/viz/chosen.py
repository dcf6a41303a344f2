"""Single picture of a chosen field, place, step, range and colour map."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact.core.grid import Box
from eigencontact.core.names import PICTURES
from eigencontact.core.units import parse_quantity
from eigencontact.errors import SceneError, nearest, shown
from eigencontact.viz.choices import (
    SURFACE,
    Field,
    cell_fields,
    cell_numbers,
    choose,
    region_fields,
    region_numbers,
    surface_fields,
    surface_numbers,
)
from eigencontact.viz.cut import View
from eigencontact.viz.errors import error_line
from eigencontact.viz.friction import ZONE_COLOURS, ZONES
from eigencontact.viz.lines import SURFACE_LINES, surface_line
from eigencontact.viz.profile import line_profile
from eigencontact.viz.remembered import cells_map
from eigencontact.viz.section import equivalent_of, kind_of, stress_section
from eigencontact.viz.style import colour_range, heading, lift_colours
from eigencontact.viz.surface import exposed_map
from eigencontact.viz.window import Window, masked_map, view_of, zone_map

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from matplotlib.figure import Figure

    from eigencontact.results.stored import Results

    Range = tuple[float, float]

__all__ = ["Picture", "chosen_picture", "colour_map", "zoom_of"]


@dataclass(frozen=True)
class Picture:
    """Picture to draw: its file name without extension, its description, and its figure."""

    name: str
    sentence: str
    figure: Figure


def chosen_picture(
    dataset: Results,
    field: str | None,
    *,
    component: str | None = None,
    step: int = -1,
    region: str | None = None,
    zoom: str | Sequence[Any] | None = None,
    cmap: str | None = None,
) -> Picture:
    """Draw one field; arguments like `eigencontact.plot`, except that `step` is a position along ``step``.

    `SceneError` names what is unknown, with the nearest valid choice.
    """
    (horizontal, vertical), colours = zoom_of(zoom), colour_map(cmap)
    view = View(horizontal, vertical, colours)
    stem = str(field).strip().lower().replace("_", "-")
    pictures = _standard(dataset, step) if stem in PICTURES else {}
    if stem in pictures:
        for name, value in {"component": component, "region": region, "zoom": zoom, "cmap": cmap}.items():
            if value is not None:
                raise SceneError(
                    f"{name} must be left out of {field!r}, which is a standard picture (got {shown(value)})"
                )
        sentence, draw = pictures[stem]
        return Picture(f"plot-{stem}", sentence, draw())
    place, choice = _place_and_field(dataset, field, region, tuple(pictures))
    axis = choice.component(component)
    stems = [] if place == SURFACE else [place or "cells"]
    name = "-".join([*stems, choice.name, *([axis] if axis else [])]).replace("_", "-")
    if place == SURFACE:
        figure = _surface(dataset, choice, axis, step, view)
    elif place in SURFACE_LINES:
        figure = surface_line(dataset, SURFACE_LINES[place], surface_numbers(dataset, choice, axis, step), step, view)
    elif not place:
        body = int(choice.variable.rpartition("_")[2])
        figure = cells_map(dataset, body, cell_numbers(dataset, choice, axis, step), step, view)
    else:
        numbers = region_numbers(dataset, place, choice, axis, step)
        if kind_of(dataset, place) == "profile":
            figure = line_profile(dataset, place, numbers, step, view)
        else:
            figure = stress_section(dataset, place, step, None, numbers, view)
    after = f" after step {int(dataset['step'][step])}" if dataset.sizes["step"] > 1 else ""
    sentence = f"{choice.name}{f' {axis}' if axis else ''} {f'on {place!r}' if place else 'in the cells'}{after}."
    return Picture(f"plot-{name}", sentence, figure)


def _standard(dataset: Results, step: int) -> dict[str, tuple[str, Callable[[], Figure]]]:
    """Sentence and function of the standard pictures that bear no name of a field, by their names."""
    from eigencontact.viz.figures import standard_pictures

    last = step % dataset.sizes["step"] == dataset.sizes["step"] - 1
    fields = {field.replace("_", "-") for field in surface_fields(dataset)}
    pictures = {
        file.removesuffix(".png"): (sentence, draw)
        for file, sentence, draw in standard_pictures(dataset, None if last else step)
    }
    return {name: pictures[name] for name in PICTURES if name in pictures and name not in fields}


def _place_and_field(
    dataset: Results, field: str | None, region: str | None, pictures: tuple[str, ...]
) -> tuple[str, Field]:
    """Place of a field, empty for the cells of bodies, and the field."""
    regions = [name for name in json.loads(dataset.attrs["regions"]) if kind_of(dataset, name)]
    surface, cells = surface_fields(dataset), cell_fields(dataset)
    places = [*regions, SURFACE, *SURFACE_LINES]
    if region is not None and region not in places:
        raise SceneError(
            f"region must be a stored one that can be drawn: {', '.join(map(repr, places))} (got {shown(region)})"
            f"{nearest(str(region), places)}; another one is described by a table, "
            '\'name = "cut", shape = "plane", depth-max = "1 mm"\''
        )
    if region is None and field is None and "pressure" not in surface:
        region = next(iter(regions), None)
    if region not in (None, SURFACE, *SURFACE_LINES):
        fields_there = region_fields(dataset, str(region))
        name = field or equivalent_of(dataset, str(region)) or next(iter(fields_there))
        return str(region), choose(name, fields_there, f" of region {region!r}")
    name = field or "pressure"
    if region in (SURFACE, *SURFACE_LINES):
        return str(region), choose(name, surface, " of the surface")
    everywhere = {at: region_fields(dataset, at) for at in regions}
    fields = {**{k: v for fields_there in everywhere.values() for k, v in fields_there.items()}, **cells, **surface}
    choice = choose(name, fields, "", pictures)
    if choice.name in surface:
        return SURFACE, surface[choice.name]
    if choice.name in cells:
        return "", cells[choice.name]
    at = next(at for at, fields_there in everywhere.items() if choice.name in fields_there)
    return at, everywhere[at][choice.name]


def _surface(dataset: Results, field: Field, component: str, step: int, view: View) -> Figure:
    """Map of a field of the surface."""
    if field.name == "exposed_material":
        return exposed_map(dataset, step)
    numbers = surface_numbers(dataset, field, component, step)
    values = numbers.values
    contact = np.zeros(values.shape, dtype=bool)
    if "pressure" in dataset:
        contact = np.asarray(dataset["pressure"][step].values) != 0
    rim = np.concatenate([values[0], values[-1], values[:, 0], values[:, -1]])
    local = not rim.any() and field.name != "gap"  # nothing but in the contact, or where it has been
    box = view_of(contact | (values != 0)) if local else Box(0, values.shape[0], 0, values.shape[1])
    window = Window(dataset, _zoomed(dataset, box, view))
    if field.name == "contact_zone":
        return zone_map(window, values, heading(dataset, step, "Stick and slip"), ZONES, ZONE_COLOURS)
    colours = None
    if field.name == "uplift" or numbers.variable == "residual_displacement_z":
        _, low, high = colour_range(values[window.view.slices])
        colours = lift_colours(low, high, 1 if field.name == "uplift" else -1)
    return masked_map(
        window,
        values,
        unit=numbers.unit,
        label=numbers.words,
        title="\n".join(filter(None, [heading(dataset, step, numbers.words), error_line(numbers, 2)])),
        outline=contact,
        empty="no contact" if field.name == "pressure" else "zero everywhere",
        cmap=view.cmap,
        masked=local,
        colours=colours,
    )


def _zoomed(dataset: Results, box: Box, view: View) -> Box:
    """Cells with their middles inside the zoom."""
    ends = []
    for axis, zoom, low, high in (("y", view.vertical, box.y0, box.y1), ("x", view.horizontal, box.x0, box.x1)):
        at = np.asarray(dataset[axis].values, dtype=float)
        if zoom is None:
            ends += [low, high]
            continue
        inside = np.flatnonzero((at >= zoom[0]) & (at <= zoom[1]))
        if not inside.size:
            raise SceneError(
                f"zoom must hold cells of the window, {axis} from {at[0]:g} m to {at[-1]:g} m (got {zoom[0]:g} m to "
                f"{zoom[1]:g} m)"
            )
        ends += [int(inside[0]), int(inside[-1]) + 1]
    return Box(*ends)


def zoom_of(zoom: str | Sequence[Any] | None) -> tuple[Range | None, Range | None]:
    """Limits [m] of a picture along the horizontal and the vertical.

    The vertical may be left out. `SceneError` for anything but a text or pairs of numbers as below.

    Examples
    --------
    >>> zoom_of("-6 um:6 um, 0:8 um")
    ((-6e-06, 6e-06), (0.0, 8e-06))
    >>> zoom_of([(0, 1e-6)])
    ((0.0, 1e-06), None)
    """
    rule = 'zoom must be one or two ranges of lengths, horizontal and vertical, "-6 um:6 um, 0:8 um"'
    if zoom is None:
        return None, None
    try:
        pairs = [ends.split(":") for ends in zoom.split(",")] if isinstance(zoom, str) else list(map(list, zoom))
        ranges = [[float(parse_quantity(_metres(end), "m", "a length")) for end in pair] for pair in pairs]
    except (TypeError, ValueError) as problem:
        raise SceneError(f"{rule} (got {shown(zoom)}: {problem})") from None
    good = 1 <= len(ranges) <= 2 and all(len(ends) == 2 and -np.inf < ends[0] < ends[1] < np.inf for ends in ranges)
    if not good:
        raise SceneError(f"{rule}, each from the smaller to the larger end (got {shown(zoom)})")
    first, second = ranges[0], ranges[-1]
    return (first[0], first[1]), (second[0], second[1]) if len(ranges) == 2 else None


def _metres(end: Any) -> Any:
    """Length in metres of a text that is a number without unit; zero needs no unit."""
    try:
        return float(end)
    except ValueError:
        return end


def colour_map(name: str | None) -> str | None:
    """Name of a colour map of matplotlib.

    Raises
    ------
    SceneError
        An unknown one, with the nearest.
    """
    if name is None:
        return None
    from matplotlib import colormaps

    if name not in colormaps:
        raise SceneError(
            f"cmap must be a colour map of matplotlib, such as 'viridis', 'cividis', 'magma' or 'RdBu_r' (got "
            f"{shown(name)}){nearest(str(name), list(colormaps))}"
        )
    return name
