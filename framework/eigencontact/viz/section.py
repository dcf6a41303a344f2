"""Pictures of sections: one number below the surface on a plane, or on a volume cut by one."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import numpy as np

from eigencontact.viz.contours import colour_ends, contours_by_side, grows, name_largest
from eigencontact.viz.cut import WHOLE, Cut, StepValues, View, VisiblePart
from eigencontact.viz.errors import error_line, errors_of
from eigencontact.viz.lines import contact_runs, draw_contact_above, draw_contact_from_above
from eigencontact.viz.outline import draw_interfaces, draw_outline
from eigencontact.viz.remembered import draw_zone, plastic_strains
from eigencontact.viz.sides import DEPTH_TOLERANCE, interface_depths
from eigencontact.viz.style import (
    colour_bar,
    draw_cross,
    heading,
    label_plane,
    paper_style,
    place,
    plane_figure,
    scale_for,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from eigencontact.results.stored import Results
    from eigencontact.viz.frame import Frame

__all__ = ["EQUIVALENT", "default_field", "drawable", "equivalent_of", "kind_of", "stress_section"]

#: Equivalent stresses of a region that a section can show, the first one present is shown, and their names.
EQUIVALENT = {"von_mises": "Von Mises stress", "tresca": "Tresca stress", "hydrostatic": "Mean normal stress"}
#: A plane this close to an interface, in parts of its depth, lies beside it.
BESIDE = 1e-3
#: A narrower figure [inch] has no room for its title.
NARROWEST = 4.2
#: What the title of a plane beside an interface says; both sides have pictures, with colours of their own.
INTERFACE = "the interface"
#: A section that begins within this part of its height below the surface has the contact above it.
AT_THE_TOP = 0.1


def drawable(dataset: Results) -> dict[str, str]:
    """Regions that can be drawn, by name: ``"section"`` or ``"profile"``.

    Planes and volumes (cut through the maximum) of at least 2 x 2 points give a section, lines a profile; scattered
    points give nothing.
    """
    regions = json.loads(dataset.attrs["regions"])
    kinds = {name: kind_of(dataset, name) for name in regions if equivalent_of(dataset, name) is not None}
    return {name: kind for name, kind in kinds.items() if kind}


def kind_of(dataset: Results, region: str) -> str:
    """Kind of picture of a region as in `drawable`; empty for one that cannot be drawn."""
    described = json.loads(dataset.attrs["regions"])[region]
    sizes = [dataset.sizes[f"{region}_{axis}"] for axis in described["dims"]]
    if described["shape"] in ("plane", "volume") and len(sizes) > 1 and min(sizes) > 1:
        return "section"
    return "profile" if described["shape"] == "line" and sizes[0] > 1 else ""


def stress_section(
    dataset: Results,
    region: str,
    step: int = -1,
    on: Frame | None = None,
    numbers: StepValues | None = None,
    view: View = WHOLE,
) -> Figure:
    """One scalar of one step on a section, z downwards if the section contains it, equal scales.

    Filled contours that cross no interface and no border of an inclusion (`eigencontact.viz.sides`); a cross at the
    largest value (in magnitude) of trusted points, unless it is that of a plateau; a bar above the contact; a line
    around what has yielded. A value that stands out at few points, as at an edge or beside a void, does not set the
    colours: it is written beside their end.

    Parameters
    ----------
    region : str
        A region of shape plane or volume. A volume is cut normal to y through its largest value.
    numbers : Shown, optional
        What is drawn; by default the first equivalent stress that is stored.
    view : View
        Part of the section, and colours, where they are chosen.
    """
    described = json.loads(dataset.attrs["regions"])[region]
    numbers = numbers or default_field(dataset, region, step)
    section = Cut(dataset, region, described, numbers.values, step)
    values, v, h = section.values, section.v, section.h
    vertical, horizontal = section.dims
    visible = VisiblePart.of(dataset, section, view, step, framed=on is None)
    inside = values[visible.points]
    trusted = np.where(section.sides.trusted, values, np.nan)[visible.points]
    trusted = trusted if np.isfinite(trusted).any() else inside
    length = scale_for([*visible.horizontal, *visible.vertical], "m")
    limits = trusted if on is None else on.film.limits(numbers.variable)
    colours = colour_ends(trusted) if on is None else tuple(on.film.limits(numbers.variable, colour_ends))
    unit = scale_for(limits, numbers.unit)
    with paper_style():
        figure, axes, wide = plane_figure(*visible.size, on=on, narrowest=NARROWEST)
        axes.set_aspect("equal")
        axes.set_xlim(length(visible.horizontal))
        axes.set_ylim(length(visible.vertical[::-1] if vertical == "z" else visible.vertical))
        filled = contours_by_side(
            axes, (h, v), unit(values), section.sides, length=length, limits=unit(limits), ends=unit(colours),
            visible=unit(inside) if on is None else unit(limits), cmap=view.cmap,
        )  # fmt: skip
        if section.outlined:
            draw_outline(axes, dataset, f"{region}_outline", length)
        draw_interfaces(axes, section.sides.interfaces, length)
        normal = section.normal
        if normal in ("x", "y") and vertical == "z" and visible.vertical[0] <= AT_THE_TOP * visible.size[1]:
            draw_contact_above(axes, visible.clipped(contact_runs(dataset, step, normal, section.cut[normal])), length)
        elif normal == "z" and "pressure" in dataset:
            draw_contact_from_above(axes, dataset, step, length)
        for strain in plastic_strains(dataset, step):
            if strain.body == described["body"] and normal:
                draw_zone(axes, dataset, strain, (normal, section.cut[normal]), length, step)
        label_plane(axes, f"{horizontal} [{length.unit}]", f"{vertical} [{length.unit}]")
        bodies = {region_["body"] for region_ in json.loads(dataset.attrs["regions"]).values()}
        title = heading(dataset, step, numbers.words + (f" in body {described['body']}" if len(bodies) > 1 else ""))
        cut = _cut_words(dataset, section, int(described["body"]), step)
        title = f"{title}, {cut.removeprefix('at ')}" if " at " in title and cut else f"{title} {cut}".strip()
        where = ""
        if filled is None:
            axes.text(0.5, 0.5, numbers.text_of_zeros, transform=axes.transAxes, ha="center", va="center", color="0.4")
        else:
            label = unit.label(numbers.words) + (" (nonlinear scale)" if grows(filled) else "")
            label += ", scale of this side" if INTERFACE in cut else ""
            bar = colour_bar(figure, axes, filled, label, wide=wide, shrink=0.7)
            row, column = section.largest(visible.points)
            largest = float(values[row, column])
            name_largest(bar, filled, float(unit(largest)), f"{unit(largest):.3g}")
            spot = [(horizontal, _near_zero(h, column)), (vertical, _near_zero(v, row) if vertical != "z" else v[row])]
            if vertical == "z" and spot[0][1] == 0.0:
                del spot[0]
            coordinates = ", ".join(place(axis, value) for axis, value in spot)
            if section.flat(visible.points):
                where = f"plateau at {unit.text(largest)}"
            else:
                where = f"{unit.text(largest)} at {coordinates} (cross)"
                draw_cross(axes, (length(h[column]), length(v[row])), zorder=8, clip_on=False)
        error = error_line(numbers) if on is None else ""  # frames keep their layout
        axes.set_title("\n".join(filter(None, [title, where, error])))
    return figure


def equivalent_of(dataset: Results, region: str) -> str | None:
    """First stored equivalent stress of a region."""
    return next((field for field in EQUIVALENT if f"{region}_{field}" in dataset), None)


def default_field(dataset: Results, region: str, step: int) -> StepValues:
    """Equivalent stress of a section by default."""
    field = equivalent_of(dataset, region) or next(iter(EQUIVALENT))
    name = f"{region}_{field}"
    values = np.asarray(dataset[name][step].values, dtype=float)
    return StepValues(EQUIVALENT[field], "Pa", values, name, errors_of(dataset, name, step))


def _near_zero(places: NDArray[np.float64], index: int) -> float:
    """Place of a point; zero where no point is nearer to zero than half of the spacing."""
    return float(places[index]) if abs(places[index]) > 0.51 * (places[1] - places[0]) else 0.0


def _cut_words(dataset: Results, cut: Cut, body: int, step: int) -> str:
    """Position of the plane as text, with the side of an interface next to it."""
    places = []
    for axis, at in cut.cut.items():
        near = [depth for depth in interface_depths(dataset, body, step) if abs(at - depth) <= BESIDE * depth]
        if axis == "z" and near:
            side = "above" if at < near[0] * (1 - DEPTH_TOLERANCE) else "below"
            places.append(f"{side} {INTERFACE} {place(axis, near[0])}")
        else:
            places.append(f"at {place(axis, at)}")
    return ", ".join(places)
