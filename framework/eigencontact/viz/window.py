"""Common parts of pictures of the surface: visible cells, their edges, the outline of the contact, a map."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact.core.grid import Box
from eigencontact.viz.fitting import legend_below
from eigencontact.viz.smooth import extended, smooth_border
from eigencontact.viz.style import (
    box_size,
    colour_range,
    label_plane,
    lift_colours,
    new_figure,
    paper_style,
    place,
    scale_for,
)

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from matplotlib.axes import Axes
    from matplotlib.colors import Colormap
    from matplotlib.figure import Figure
    from matplotlib.path import Path
    from numpy.typing import NDArray

    from eigencontact.results.stored import Results
    from eigencontact.viz.frame import Frame
    from eigencontact.viz.style import Scale

__all__ = [
    "Window",
    "alike",
    "cell_edges",
    "contact_middle",
    "contact_window",
    "draw_classes",
    "draw_contact_outline",
    "is_ragged",
    "line_words",
    "masked_map",
    "middle",
    "view_of",
    "zone_map",
]

#: Cells along a side that a map shows at most: somewhat more than its dots.
DOTS = 1000
#: Colours of maps of ragged contacts, light for low values.
PALE_FIRST = "YlGnBu"
#: Part of these colours in use: small spots of low values must not stand out from the light ground, nor vanish in it.
USED = (0.15, 1.0)
#: A line this many cells from the origin passes through it, as near as the cells are.
NEAR = 0.51
#: Profiles that differ by at most this part of the largest value are drawn once.
ALIKE = 0.01
#: Room around the contact in a picture, as a part of the larger side of the contact.
MARGIN = 0.25


class Window:
    """Part of the surface that a picture shows: its cells, the edges of them and the unit of length.

    Parameters
    ----------
    dataset : Results
        Results of a run.
    view : Box
        Cells shown.

    Attributes
    ----------
    view : Box
        Cells shown.
    edges_x, edges_y : arrays
        Edges of the cells shown [m].
    length : Scale
        Unit for both axes.
    extent : tuple of float
        Left, right, bottom, top in that unit.
    """

    def __init__(self, dataset: Results, view: Box) -> None:
        self.view = view
        x, y = (np.asarray(dataset[axis].values, dtype=float) for axis in "xy")
        self.edges_x = cell_edges(x, dataset, 0)[view.x0 : view.x1 + 1]
        self.edges_y = cell_edges(y, dataset, 1)[view.y0 : view.y1 + 1]
        ends = (self.edges_x[0], self.edges_x[-1], self.edges_y[0], self.edges_y[-1])
        self.length: Scale = scale_for(ends, "m")
        left, right, bottom, top = (float(end) for end in self.length(ends))
        self.extent = (left, right, bottom, top)

    def axes_of_map(self, on: Frame | None = None, *, bar: bool = True) -> tuple[Figure, Axes, bool]:
        """Figure for a map of equal scales; whether it is wide, so that the bar of its colours goes below.

        Without a bar there is room for a legend below.
        """
        width, height = box_size(self.extent[1] - self.extent[0], self.extent[3] - self.extent[2])
        wide = width > 2.2 * height
        below = wide or not bar
        figure = new_figure(width + (0.8 if below else 1.6), height + (1.5 if wide else 1.0 if below else 0.7), on)
        axes = figure.add_subplot()
        axes.set_facecolor("0.93")
        return figure, axes, wide

    @property
    def shape(self) -> tuple[int, int]:
        """Numbers of cells along y and x."""
        return self.edges_y.size - 1, self.edges_x.size - 1

    def label(self, axes: Axes) -> None:
        """Name both axes."""
        label_plane(axes, f"x [{self.length.unit}]", f"y [{self.length.unit}]")

    def outline(self, axes: Axes, contact: NDArray[np.bool_]) -> None:
        """Line around the contact, given for the cells shown, unless it is ragged."""
        draw_contact_outline(axes, contact, *self.edges)

    @property
    def edges(self) -> tuple[NDArray[Any], NDArray[Any]]:
        """Edges of the cells along x and y, in the unit of the axes."""
        return self.length(self.edges_x), self.length(self.edges_y)


def masked_map(
    window: Window,
    field: NDArray[Any],
    *,
    unit: str,
    label: str,
    title: str,
    outline: NDArray[np.bool_],
    empty: str,
    limits: NDArray[Any] | None = None,
    on: Frame | None = None,
    cmap: str | None = None,
    masked: bool = True,
    lifted: int = 0,
) -> Figure:
    """Map of a field over a window, interpolated between the middles of cells.

    A region of zeros has a smooth border, except around ragged regions and regions of few cells, which are drawn cell
    by cell (`eigencontact.viz.smooth`).

    Parameters
    ----------
    field : (ny, nx) array
        In SI units, on all cells; zeros are grey.
    unit, label, title : str
        Its unit, and words for the colour bar and above the picture.
    outline : (ny, nx) bool
        Cells to draw a line around, on all cells.
    empty : str
        What is said in the picture where the field is zero everywhere.
    limits : (2,) array, optional
        Smallest and largest value that the colours are for; by default of the cells shown.
    cmap : str, optional
        Colour map; by default one that suits the signs.
    masked : bool
        Whether zeros are grey.
    lifted : int
        1 where positive values lift the surface out of the body, -1 where negative ones do: `lift_colours`.
    """
    visible = field[window.view.slices]
    with paper_style():
        figure, axes, wide = window.axes_of_map(on)
        limits = visible if limits is None else limits
        scale = scale_for(limits, unit)
        colours: str | Colormap
        colours, low, high = colour_range(limits)
        if lifted:
            colours, low, high = lift_colours(low, high, lifted)
        samples = _sampled(visible)
        nonzero = (samples != 0) | (not masked)
        border = None if nonzero.all() else _smooth_border(window, nonzero)
        smooth = border is not None or bool(nonzero.all())
        if masked and low == 0.0 and is_ragged(outline if on is None else on.film.touched("pressure")):
            colours = _pale_first()
        image = axes.imshow(
            scale(extended(samples, nonzero)) if border else np.ma.masked_where(~nonzero, scale(samples)),
            origin="lower",
            extent=window.extent,
            cmap=cmap or colours,
            interpolation="bilinear" if smooth else None,
            vmin=low * scale.factor,
            vmax=high * scale.factor,
        )
        if border:
            image.set_clip_path(border, axes.transData)
        window.label(axes)
        axes.set_title(title)
        window.outline(axes, outline[window.view.slices])
        if np.any(limits):
            bar = figure.colorbar(
                image,
                ax=axes,
                location="bottom" if wide else "right",
                shrink=0.6 if wide else 1.0,
                aspect=30 if wide else 22,
                pad=0.03,
            )
            bar.set_label(f"{label} [{scale.unit}]" if scale.unit else label)
        if not np.any(visible):
            axes.text(0.5, 0.5, empty, transform=axes.transAxes, ha="center", va="center", color="0.4")
    return figure


def zone_map(
    window: Window, field: NDArray[Any], title: str, names: tuple[str, ...], colours: tuple[str, ...]
) -> Figure:
    """Map of a field of whole numbers, each with a name and a colour of its own."""
    from matplotlib.patches import Patch

    visible = np.rint(field[window.view.slices]).astype(int)
    with paper_style():
        figure, axes, _ = window.axes_of_map(bar=False)
        draw_classes(axes, window, visible, colours)
        window.label(axes)
        window.outline(axes, visible > 0)
        axes.set_title(title)
        patches = [
            Patch(facecolor=colour, edgecolor="0.4", linewidth=0.5, label=name)
            for name, colour in zip(names, colours, strict=True)
        ]
        legend_below(figure, patches, names, len(names))
    return figure


def draw_classes(axes: Axes, window: Window, numbers: NDArray[np.int_], colours: tuple[str, ...]) -> None:
    """Colour each cell shown by its number; regions of numbers that lie inside each other have smooth borders."""
    from matplotlib.colors import BoundaryNorm, ListedColormap
    from matplotlib.patches import PathPatch

    norm = BoundaryNorm(np.arange(len(colours) + 1) - 0.5, len(colours))
    regions = [numbers >= number for number in range(1, int(numbers.max()) + 1)]
    borders = [border for region in regions if (border := _smooth_border(window, region)) is not None]
    smooth = len(borders) == len(regions)
    ground = np.zeros_like(numbers) if smooth else numbers
    axes.imshow(ground, origin="lower", extent=window.extent, cmap=ListedColormap(colours), norm=norm)
    for border, colour in zip(borders if smooth else (), colours[1:], strict=False):
        axes.add_patch(PathPatch(border, facecolor=colour, linewidth=0))


def _pale_first() -> Colormap:
    """Colours of maps of ragged contacts."""
    from matplotlib import colormaps
    from matplotlib.colors import ListedColormap

    return ListedColormap(colormaps[PALE_FIRST](np.linspace(*USED, 256)), name=PALE_FIRST)


def _smooth_border(window: Window, region: NDArray[np.bool_]) -> Path | None:
    """Smooth border of a region of the cells shown, in the unit of the axes."""
    return None if region.shape != window.shape else smooth_border(region, *window.edges)


def _sampled(field: NDArray[Any]) -> NDArray[Any]:
    """Evenly spread cells of a field, no more than the dots of a picture."""
    if max(field.shape) <= DOTS:
        return field
    counts = [min(side, DOTS) for side in field.shape]
    places = [((np.arange(n) + 0.5) * (side / n)).astype(int) for n, side in zip(counts, field.shape, strict=True)]
    return np.asarray(field[np.ix_(*places)])


def cell_edges(centres: NDArray[Any], dataset: Results, axis: int) -> NDArray[Any]:
    """Edges of the cells along one axis (0: x, 1: y) [m]."""
    cell = float(np.atleast_1d(dataset.attrs["cell_size"])[axis])
    return np.append(centres - 0.5 * cell, centres[-1] + 0.5 * cell)


def view_of(mask: NDArray[np.bool_]) -> Box:
    """Cells to show: those of the mask and room around them, all cells where the mask is empty."""
    box = Box.around(mask)
    rows, columns = mask.shape
    if box is None:
        return Box(0, rows, 0, columns)
    margins = [max(2, round(MARGIN * side)) for side in box.shape]
    return box.grown(margins[0], margins[1], (rows, columns))


def contact_window(dataset: Results, mask: NDArray[np.bool_]) -> Window:
    """Window around the cells of a mask."""
    return Window(dataset, view_of(mask))


def middle(pressure: NDArray[Any], symmetric: float = 1e-6) -> tuple[int, int]:
    """Row and column of profiles: through the middle of the window where the pressure is symmetric about it.

    Symmetric is what differs from its mirror image by at most a part `symmetric` of its largest value; any other
    pressure has its profiles through that value.
    """
    box = Box.around(pressure != 0) or Box(0, pressure.shape[0], 0, pressure.shape[1])
    edges = [min(box.y0, pressure.shape[0] - box.y1), min(box.x0, pressure.shape[1] - box.x1)]
    inner = pressure[tuple(slice(edge, side - edge) for edge, side in zip(edges, pressure.shape, strict=True))]
    tolerance = symmetric * float(np.abs(inner).max())  # all is zero outside of this part, whose middle is the same
    if all(np.abs(inner - np.flip(inner, axis)).max() <= tolerance for axis in (0, 1)):
        return pressure.shape[0] // 2, pressure.shape[1] // 2
    row, column = np.unravel_index(int(np.argmax(pressure)), pressure.shape)
    return int(row), int(column)


def contact_middle(pressure: NDArray[Any]) -> tuple[int, int, bool]:
    """Row and column of profiles of a contact, and whether they pass through its middle.

    They do where it is one patch; through the largest pressure where it is in patches, or open in its middle.
    """
    touched = pressure != 0
    box = Box.around(touched)
    if box is None:
        return pressure.shape[0] // 2, pressure.shape[1] // 2, True
    row, column = (box.y0 + box.y1) // 2, (box.x0 + box.x1) // 2
    if not is_ragged(touched) and touched[row, column]:
        return row, column, True
    row, column = (int(index) for index in np.unravel_index(int(np.argmax(pressure)), pressure.shape))
    return row, column, False


def line_words(along: str, across: str, at: float, *, central: bool, cell: float = 0.0) -> str:
    """Title of a profile: its direction, and its place unless a cell `cell` wide there holds the origin."""
    if abs(at) <= NEAR * cell:
        return f"along {along}"
    where = place(across, at)
    return f"along {along}, middle at {where}" if central else f"along {along} at {where}"


def alike(dataset: Results, fields: Iterable[NDArray[Any]], lines: Sequence[tuple[Any, Any]]) -> bool:
    """Whether profiles of fields along x and along y show the same, on cells of the same edge."""
    edges = np.atleast_1d(dataset.attrs["cell_size"])
    if len(lines) != 2 or abs(edges[0] - edges[-1]) > ALIKE * edges[0]:
        return False
    for field in fields:
        along, across = (np.asarray(field[where], dtype=float) for where in lines)
        if along.size != across.size or np.abs(along - across).max() > ALIKE * np.abs(field).max():
            return False
    return True


def is_ragged(contact: NDArray[np.bool_]) -> bool:
    """Whether the border of the contact is much longer than that of the box around it, or there is no contact.

    The border of one convex patch is as long as that of its box.
    """
    box = Box.around(contact)
    edges = int(np.count_nonzero(contact[1:] != contact[:-1])) + int(
        np.count_nonzero(contact[:, 1:] != contact[:, :-1])
    )
    return box is None or edges > 3 * sum(box.shape)


def draw_contact_outline(
    axes: Axes, contact: NDArray[np.bool_], x: NDArray[Any], y: NDArray[Any], *, faint: bool = False
) -> None:
    """Line around the contact (`x`, `y`: edges of the cells), unless it is ragged; along the edges of few cells."""
    from matplotlib.collections import LineCollection
    from matplotlib.patches import PathPatch

    if is_ragged(contact):
        return
    style: dict[str, Any] = {"alpha": 0.8 if faint else None, "zorder": 3}
    colour, width = ("1.0", 0.7) if faint else ("0.15", 0.8)
    border = smooth_border(contact, x, y)
    if border is not None:
        axes.add_patch(PathPatch(border, fill=False, edgecolor=colour, linewidth=width, **style))
        return
    rows, columns = np.nonzero(contact[1:] != contact[:-1])
    level = np.stack([np.stack([x[columns + n], y[rows + 1]], axis=-1) for n in (0, 1)], axis=1)
    rows, columns = np.nonzero(contact[:, 1:] != contact[:, :-1])
    upright = np.stack([np.stack([x[columns + 1], y[rows + n]], axis=-1) for n in (0, 1)], axis=1)
    axes.add_collection(
        LineCollection(
            [*level, *upright],
            colors=colour,
            linewidths=width,
            capstyle="projecting",
            **style,
        ),
        autolim=False,
    )
