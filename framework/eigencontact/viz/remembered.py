"""History fields of bodies for pictures: fields in the cells of a box, cut by planes, and a section cell by cell."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact.viz.contours import contour_lines
from eigencontact.viz.lines import contact_runs, draw_contact_above
from eigencontact.viz.outline import draw_segments, inclusion_segments
from eigencontact.viz.sides import Plane, sides_of
from eigencontact.viz.style import (
    colour_bar,
    colour_range,
    draw_cross,
    heading,
    label_plane,
    paper_style,
    place,
    plane_figure,
    scale_for,
)

if TYPE_CHECKING:
    from collections.abc import Iterator

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from eigencontact.results.stored import Results
    from eigencontact.viz.cut import StepValues, View
    from eigencontact.viz.style import Scale

__all__ = [
    "DAMAGE",
    "STRAIN",
    "CellField",
    "cells_map",
    "draw_zone",
    "plastic_strains",
    "remembered_fields",
    "yields",
    "zone_field",
]

#: Name, before the number of the body, of what a material that yields remembers.
STRAIN = "equivalent_plastic_strain"
#: The same of a material that degrades.
DAMAGE = "damage"
#: The plastic zone holds more than this part of the largest plastic strain: pictures show no less.
SHARE = 0.05
#: Cells with more than this part of the largest value are framed.
MATTERS = 1e-3
#: Room around the framed cells, in cells.
ROOM = 3


@dataclass(frozen=True)
class CellField:
    """A number in each cell of a box in a body.

    Attributes
    ----------
    body : int
        1 or 2.
    values : (nz, ny, nx)
        In the cells.
    axes : dict
        Middles of the cells [m] by axis.
    """

    body: int
    values: NDArray[Any]
    axes: dict[str, NDArray[Any]]

    def edge(self, axis: str) -> float:
        """Edge of the cells along an axis [m]; one layer begins at the surface."""
        places = self.axes[axis]
        return float(places[1] - places[0]) if places.size > 1 else 2.0 * abs(float(places[0]))

    def cut(self, normal: str, at: float) -> tuple[NDArray[Any], NDArray[Any], NDArray[Any]] | None:
        """Values, and coordinates along the vertical and horizontal axes, in the plane of cells at a coordinate [m].

        Cells at the surface are continued up to z = 0, beyond all other rims of the box there is one more cell of
        zeros. None where the plane passes beside the box.
        """
        index = int(np.abs(self.axes[normal] - at).argmin())
        if abs(float(self.axes[normal][index]) - at) > 0.5001 * self.edge(normal):
            return None
        vertical, horizontal = (axis for axis in "zyx" if axis != normal)
        values = np.take(self.values, index, axis="zyx".index(normal))
        surface = vertical == "z" and self.axes["z"][0] < 0.75 * self.edge("z")
        values = np.pad(values, 1)
        if surface:
            values[0] = values[1]
        v, h = (np.pad(self.axes[axis], 1) for axis in (vertical, horizontal))
        for places, axis in ((v, vertical), (h, horizontal)):
            places[0], places[-1] = places[1] - self.edge(axis), places[-2] + self.edge(axis)
        return values, v, h

    @property
    def largest(self) -> tuple[float, dict[str, float]]:
        """Largest value and its position; of several equal values the one nearest to the z axis."""
        top = float(self.values.max())
        k, j, i = np.nonzero(self.values >= (1.0 - 1e-9) * top)
        away = self.axes["x"][i] ** 2 + self.axes["y"][j] ** 2
        n = int(away.argmin())
        where = {"z": k[n], "y": j[n], "x": i[n]}
        return top, {axis: float(self.axes[axis][index]) for axis, index in where.items()}


def yields(dataset: Results) -> bool:
    """Whether the results contain plastic strain or damage."""
    return any(f"{name}_{body}" in dataset for body in (1, 2) for name in (STRAIN, DAMAGE))


def plastic_strains(dataset: Results, step: int) -> Iterator[CellField]:
    """Equivalent plastic strain of each body; see `remembered_fields`."""
    return remembered_fields(dataset, step, STRAIN)


def remembered_fields(dataset: Results, step: int, quantity: str) -> Iterator[CellField]:
    """History field of each body at a position along ``step``, if it is stored and not zero."""
    for body in (1, 2):
        name = f"{quantity}_{body}"
        if name not in dataset or dataset[name].ndim != 4:
            continue
        positions = np.flatnonzero(dataset["history_step"].values == int(dataset["step"][step]))
        if not positions.size:
            continue
        values = np.asarray(dataset[name][int(positions[0])].values, dtype=float)
        if float(values.max(initial=0.0)) > 0.0:
            axes = {axis: np.asarray(dataset[f"cells_{body}_{axis}"].values, dtype=float) for axis in "zyx"}
            yield CellField(body, values, axes)


def zone_field(dataset: Results, field: CellField, normal: str, at: float, step: int) -> tuple[Any, Any, Any] | None:
    """Coordinates (horizontal, vertical), values and sides of a plane of cells; None outside the box."""
    section = field.cut(normal, at)
    if section is None:
        return None
    values, v, h = section
    dims = [axis for axis in "zyx" if axis != normal]
    plane = Plane(field.body, (dims[0], dims[1]), v, h)
    return (h, v), values, sides_of(dataset, plane, inclusion_segments(dataset, field.body, normal, at), step)


def draw_zone(
    axes: Axes, dataset: Results, field: CellField, plane: tuple[str, float], length: Scale, step: int
) -> bool:
    """Draw the border of the plastic zone in a plane of cells; returns whether the plane meets the zone.

    It is the contour of the part `SHARE` of the largest value of the field, and of the values of each side of borders.
    """
    section = zone_field(dataset, field, *plane, step)
    level = SHARE * float(field.values.max())
    if section is None or not (section[1] > level).any():
        return False
    at, values, sides = section
    for width, colour in ((2.2, "1.0"), (1.1, "0.1")):
        line_sides = contour_lines(axes, at, values, sides, length=length, level=level)
        for lines in line_sides:
            lines.set(linewidth=width, edgecolor=colour, zorder=3)
    return True


def cells_map(dataset: Results, body: int, numbers: StepValues, step: int, view: View) -> Figure:
    """Numbers (nz, ny, nx) in the cells of a body, on the section normal to y through the largest, marked by a cross.

    `view` is the part of the section, and colours, where they are chosen.
    """
    middles = {axis: np.asarray(dataset[f"cells_{body}_{axis}"].values, dtype=float) for axis in "zyx"}
    field = CellField(body, np.abs(numbers.values), middles)
    at = field.largest[1] if numbers.values.any() else {axis: float(places.mean()) for axis, places in middles.items()}
    values = numbers.values[:, int(np.abs(middles["y"] - at["y"]).argmin())]
    halves = {axis: 0.5 * field.edge(axis) for axis in "zx"}
    edges = [np.append(middles[axis] - half, middles[axis][-1] + half) for axis, half in halves.items()]
    horizontal, vertical = view.horizontal, view.vertical
    if horizontal is None and vertical is None and values.any():
        rows, columns = np.nonzero(np.abs(values) > MATTERS * np.abs(values).max())
        left, right = (ROOM * side + index for side, index in ((-1, columns.min()), (1, columns.max() + 1)))
        horizontal = (edges[1][max(0, left)], edges[1][min(values.shape[1], right)])
        vertical = (edges[0][0], edges[0][min(values.shape[0], rows.max() + 1 + ROOM)])
    horizontal, vertical = horizontal or (edges[1][0], edges[1][-1]), vertical or (edges[0][0], edges[0][-1])
    length, unit = scale_for([*horizontal, *vertical], "m"), scale_for(values, numbers.unit)
    colours, low, high = colour_range(values)
    with paper_style():
        figure, axes, wide = plane_figure(horizontal[1] - horizontal[0], vertical[1] - vertical[0])
        mesh = axes.pcolormesh(
            length(edges[1]), length(edges[0]), unit(values), cmap=view.cmap or colours,
            vmin=low * unit.factor, vmax=high * unit.factor or 1.0,
        )  # fmt: skip
        axes.set_aspect("equal")
        axes.set_xlim(length(horizontal))
        axes.set_ylim(length(vertical[::-1]))
        draw_segments(axes, inclusion_segments(dataset, body, "y", at["y"]), length)
        draw_contact_above(axes, contact_runs(dataset, step, "y", at["y"]), length)
        label_plane(axes, f"x [{length.unit}]", f"z [{length.unit}]")
        title = f"{heading(dataset, step, f'{numbers.words} in body {body}')}, {place('y', at['y'])}"
        if values.any():
            colour_bar(figure, axes, mesh, unit.label(numbers.words), wide=wide, shrink=0.7)
            draw_cross(axes, (length(at["x"]), length(at["z"])))
            row, column = (int(np.abs(middles[axis] - at[axis]).argmin()) for axis in "zx")
            where = ", ".join(place(axis, at[axis]) for axis in "xz")
            title += f"\n{unit.text(values[row, column])} at {where} (cross)"
        axes.set_title(title)
    return figure
