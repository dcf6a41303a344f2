"""Picture of what the cells of a body remember: one section, every cell in its place."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from eigencontact.viz.cut import Shown, View
from eigencontact.viz.lines import contact_runs, draw_contact_above
from eigencontact.viz.outline import draw_segments, inclusion_segments
from eigencontact.viz.remembered import CellField
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
    from matplotlib.figure import Figure

    from eigencontact.results.stored import Results

__all__ = ["cells_map"]

#: Cells with more than this part of the largest value are framed.
MATTERS = 1e-3
#: Room around the framed cells, in cells.
ROOM = 3


def cells_map(dataset: Results, body: int, numbers: Shown, step: int, view: View) -> Figure:
    """A number in every cell of the section normal to y through the largest of them, which is marked by a cross.

    Parameters
    ----------
    body : int
        1 or 2.
    numbers : Shown
        Numbers (nz, ny, nx) in the cells of that body.
    view : View
        Part of the section, and colours, where they are chosen.
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
