"""Lines along the surface: profiles of fields, and the ends of the contact on profiles and above sections."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact.core.grid import Box
from eigencontact.viz.errors import draw_band
from eigencontact.viz.looks import legend_below
from eigencontact.viz.style import COLOURS, heading, new_figure, paper_style, place, scale_for
from eigencontact.viz.window import cell_edges, draw_contact_outline, is_ragged

if TYPE_CHECKING:
    from collections.abc import Iterable

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from eigencontact.results.stored import Results
    from eigencontact.viz.cut import StepValues, View
    from eigencontact.viz.frame import Frame
    from eigencontact.viz.style import Scale

__all__ = [
    "SURFACE_LINES",
    "SurfaceLine",
    "contact_middle",
    "contact_runs",
    "draw_contact_above",
    "draw_contact_ends",
    "draw_contact_from_above",
    "drawn_once",
    "legend_of_panels",
    "line_figure",
    "lines_through",
    "middle",
    "runs_of",
    "surface_line",
    "surface_line_at",
]

#: Names of the lines, and their axes.
SURFACE_LINES = {"along-x": "x", "along-y": "y"}
#: Lines of more cells have no markers.
MARKERS = 80
#: A line this many cells from the origin passes through it, as near as the cells are.
NEAR = 0.51
#: Profiles that differ by at most this part of the largest value are drawn once.
ALIKE = 0.01
#: With more runs than this the ends of the contact are a comb that hides the curve.
MOST_ENDS = 4


@dataclass(frozen=True)
class SurfaceLine:
    """A line of cells of the surface.

    Attributes
    ----------
    along, normal : {"x", "y"}
        Its direction, and the other one.
    across : float
        Its place along the normal [m].
    title : str
        Direction and place in words.
    where : tuple
        Its cells (rows, columns).
    at, edges : (n,), (n + 1,)
        Their middles and edges [m].
    """

    along: str
    normal: str
    across: float
    title: str
    where: tuple[Any, Any]
    at: NDArray[np.float64]
    edges: NDArray[np.float64]

    def finish(self, axes: Axes, length: Scale, pressure: NDArray[Any]) -> None:
        """Name the axis along the line, and draw the ends of the contact under a pressure (ny, nx)."""
        axes.set_xlabel(f"{self.along} [{length.unit}]")
        axes.set_title(self.title)
        draw_contact_ends(axes, runs_of(pressure[self.where] != 0, self.edges), length)


def surface_line_at(
    dataset: Results, along: str, cell: tuple[int, int], view: Box | None = None, *, central: bool = False,
    near: float = NEAR,
) -> SurfaceLine:  # fmt: skip
    """Line along x or y through a cell (row, column), within a view, by default the whole window.

    The title says whether the line passes through the middle of the contact (`central`), and where it lies, unless it
    lies no more than `near` cells from the origin.
    """
    normal, axis = ("y", 0) if along == "x" else ("x", 1)
    places, across = (np.asarray(dataset[name].values, dtype=float) for name in (along, normal))
    at = float(across[cell[axis]])
    title = f"along {along}"
    if abs(at) > near * float(np.atleast_1d(dataset.attrs["cell_size"])["xy".index(normal)]):
        title += f"{', middle' if central else ''} at {place(normal, at)}"
    span = slice(0, places.size) if view is None else view.slices[1 - axis]
    where = (cell[0], span) if along == "x" else (span, cell[1])
    edges = cell_edges(places, dataset, axis)[span.start : span.stop + 1]
    return SurfaceLine(along, normal, at, title, where, places[span], edges)


def lines_through(dataset: Results, cell: tuple[int, int], view: Box | None = None, **title: Any) -> list[SurfaceLine]:
    """Lines along x and y through a cell as of `surface_line_at`; only one where the other direction has one cell."""
    lines = [surface_line_at(dataset, along, cell, view, **title) for along in "xy"]
    return [line for line in lines if dataset.sizes[line.along] > 1] or lines[:1]


def drawn_once(dataset: Results, lines: list[SurfaceLine], fields: Iterable[NDArray[Any]]) -> list[SurfaceLine]:
    """Lines, or only the one along x if the profiles along y are equal on cells of the same edge."""
    cells = np.atleast_1d(dataset.attrs["cell_size"])
    if len(lines) != 2 or abs(cells[0] - cells[-1]) > ALIKE * cells[0]:
        return lines
    for field in fields:
        along, across = (np.asarray(field[line.where], dtype=float) for line in lines)
        if along.size != across.size or np.abs(along - across).max() > ALIKE * np.abs(field).max():
            return lines
    return [replace(lines[0], title=f"{lines[0].title}, the same along y")]


def line_figure(count: int, height: float, on: Frame | None = None) -> Figure:
    """Empty figure for panels of `count` lines side by side, `height` high [inch]."""
    return new_figure(3.3 * count + (0.3 if count > 1 else 1.2), height, on)


def legend_of_panels(figure: Any, panels: Iterable[Axes], order: Any, most: int | None = None) -> None:
    """Legend below all panels with each entry once, ordered by a key, in a limited number of columns."""
    entries = {name: item for axes in panels for item, name in zip(*axes.get_legend_handles_labels(), strict=True)}
    labels = sorted(entries, key=order)
    legend_below(figure, [entries[label] for label in labels], labels, most or len(labels))


def middle(pressure: NDArray[Any], symmetric: float = 1e-6) -> tuple[int, int]:
    """Row and column of profiles: through the middle of the window if the pressure is symmetric about it.

    Symmetric is what differs from its mirror image by at most a part `symmetric` of its largest value; any other
    pressure has its profiles through that value.
    """
    box = Box.around(pressure != 0) or Box(0, pressure.shape[0], 0, pressure.shape[1])
    edges = [min(box.y0, pressure.shape[0] - box.y1), min(box.x0, pressure.shape[1] - box.x1)]
    inner = pressure[tuple(slice(edge, side - edge) for edge, side in zip(edges, pressure.shape, strict=True))]
    tolerance = symmetric * float(np.abs(inner).max())  # all is zero outside of this part, whose middle is the same
    if all(np.abs(inner - np.flip(inner, axis)).max() <= tolerance for axis in (0, 1)):
        return pressure.shape[0] // 2, pressure.shape[1] // 2
    return _largest(pressure)


def contact_middle(pressure: NDArray[Any]) -> tuple[int, int, bool]:
    """Row and column of profiles of a contact, and whether they pass through its centre.

    They do where it is one patch; through the largest pressure where it is in patches, or open in its middle.
    """
    touched = pressure != 0
    box = Box.around(touched)
    if box is None:
        return pressure.shape[0] // 2, pressure.shape[1] // 2, True
    row, column = (box.y0 + box.y1) // 2, (box.x0 + box.x1) // 2
    central = bool(touched[row, column]) and not is_ragged(touched)
    return (row, column, True) if central else (*_largest(pressure), False)


def _largest(field: NDArray[Any]) -> tuple[int, int]:
    """Row and column of the largest value."""
    row, column = np.unravel_index(int(np.argmax(field)), field.shape)
    return int(row), int(column)


def surface_line(dataset: Results, along: str, numbers: StepValues, step: int, view: View) -> Figure:
    """Draw a field of the surface (`numbers`) over one row or one column of its cells.

    The line passes through the middle of the contact, or through the largest pressure where the contact is in patches.
    Without a contact it passes through the middle of what the field has, or through its largest value. Of the view
    ``horizontal`` is the part of the line that is seen.
    """
    pressure = np.zeros_like(numbers.values)
    if "pressure" in dataset:
        pressure = np.asarray(dataset["pressure"][step].values, dtype=float)
    row, column, central = contact_middle(pressure if pressure.any() else np.abs(numbers.values))
    line = surface_line_at(dataset, along, (row, column), central=central, near=0.0)
    values = numbers.values[line.where]
    unit, length = scale_for(values, numbers.unit), scale_for(view.horizontal or line.at, "m")
    with paper_style():
        figure = new_figure(5.2, 3.0)
        axes = figure.add_subplot()
        marker = "o" if line.at.size <= MARKERS else ""
        axes.plot(length(line.at), unit(values), "-", marker=marker, markersize=2.4, color=COLOURS[0])
        if numbers.errors is not None:
            draw_band(axes, length(line.at), values, numbers.errors[line.where], unit, COLOURS[0])
            axes.legend()
        axes.axhline(0.0, color="0.6", linewidth=0.6, zorder=0)
        line.finish(axes, length, pressure)
        axes.set_xlim(*length(view.horizontal or (line.at[0], line.at[-1])))
        axes.set_ylabel(unit.label(numbers.words))
        axes.set_title(f"{heading(dataset, step, numbers.words)}\n{line.title}")
    return figure


def runs_of(touched: NDArray[np.bool_], edges: NDArray[Any]) -> NDArray[np.float64]:
    """Ends (n, 2) of the runs of touched cells, from the edges of all cells."""
    padded = np.concatenate([[False], touched, [False]])
    begins, ends = (np.flatnonzero(padded[1:] & ~padded[:-1]), np.flatnonzero(~padded[1:] & padded[:-1]))
    return np.stack([edges[begins], edges[ends]], axis=1)


def contact_runs(dataset: Results, step: int, normal: str, at: float) -> NDArray[np.float64]:
    """Ends (n, 2) [m] of the contact on the line where a plane normal to x or y meets the surface.

    None where the plane passes beside the window. The contact is that of the row or column of cells that holds the
    place, so its ends lie on edges of cells.
    """
    if "pressure" not in dataset or normal not in ("x", "y"):
        return np.empty((0, 2))
    along = "y" if normal == "x" else "x"
    across, places = (np.asarray(dataset[axis].values, dtype=float) for axis in (normal, along))
    rows = cell_edges(across, dataset, "xy".index(normal))
    if not rows[0] <= at <= rows[-1]:
        return np.empty((0, 2))
    line = int(np.abs(across - at).argmin())
    where = (slice(None), line) if normal == "x" else (line, slice(None))
    touched = np.asarray(dataset["pressure"][step].values)[where] != 0
    return runs_of(touched, cell_edges(places, dataset, "xy".index(along)))


def draw_contact_above(axes: Axes, runs: NDArray[np.float64], length: Scale) -> None:
    """Bar above the upper edge of a section over every run of the contact."""
    for ends in runs:
        axes.plot(
            length(ends), [1.0, 1.0], transform=axes.get_xaxis_transform(), color="black", linewidth=3.2,
            solid_capstyle="butt", clip_on=False, zorder=7, scalex=False, scaley=False, label="_contact",
        )  # fmt: skip


def draw_contact_ends(axes: Axes, runs: NDArray[np.float64], length: Scale) -> None:
    """Faint line at both ends of every run of the contact, unless there are many."""
    if len(runs) > MOST_ENDS:
        return
    for at in np.unique(runs):
        axes.axvline(float(length(at)), color="0.55", linewidth=0.6, linestyle=(0, (2, 2)), zorder=0, label="_contact")


def draw_contact_from_above(axes: Axes, dataset: Results, step: int, length: Scale) -> None:
    """Outline of the contact over a section along the surface, faint, unless it is ragged."""
    touched = np.asarray(dataset["pressure"][step].values) != 0
    x, y = (cell_edges(np.asarray(dataset[axis].values, dtype=float), dataset, n) for n, axis in enumerate("xy"))
    draw_contact_outline(axes, touched, length(x), length(y), faint=True)
