"""Common parts of pictures of the surface: visible cells, their edges, the outline of the contact, a map."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact.core.grid import Box
from eigencontact.viz.looks import legend_below
from eigencontact.viz.smooth import extended, smooth_border
from eigencontact.viz.style import colour_bar, colour_range, label_plane, paper_style, plane_figure, scale_for

if TYPE_CHECKING:
    from collections.abc import Iterable

    from matplotlib.axes import Axes
    from matplotlib.colors import Colormap
    from matplotlib.figure import Figure
    from matplotlib.patches import Patch
    from matplotlib.path import Path
    from numpy.typing import NDArray

    from eigencontact.results.stored import Results
    from eigencontact.viz.frame import Frame
    from eigencontact.viz.style import Scale

__all__ = [
    "Window",
    "cell_edges",
    "class_patches",
    "contact_window",
    "draw_classes",
    "draw_contact_outline",
    "is_ragged",
    "masked_map",
    "view_of",
    "zone_map",
]

#: Cells along a side that a map shows at most: somewhat more than its dots.
DOTS = 1000
#: Colours of maps of ragged contacts, light for low values.
PALE_FIRST = "YlGnBu"
#: Part of these colours in use: small spots of low values must not stand out from the light ground, nor vanish in it.
USED = (0.15, 1.0)
#: Room around the contact in a picture, as a part of the larger side of the contact.
MARGIN = 0.25


class Window:
    """Visible part of the surface: its cells, their edges and the unit of length.

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
        """Figure for a map on a grey ground; see `plane_figure`."""
        width, height = self.extent[1] - self.extent[0], self.extent[3] - self.extent[2]
        figure, axes, wide = plane_figure(width, height, (4.2, 3.6), on, bar=bar)
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
        """Line around the contact of the visible cells, unless it is ragged."""
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
    colours: tuple[str | Colormap, float, float] | None = None,
) -> Figure:
    """Map of a field (ny, nx) in SI units over a window, interpolated between the middles of cells.

    A region of zeros has a smooth border, except around ragged regions and regions of few cells, which are drawn cell
    by cell (`eigencontact.viz.smooth`).

    Parameters
    ----------
    unit, label, title : str
        Unit of the field, and words for the colour bar and above the picture.
    outline : (ny, nx) bool
        Cells to draw a line around.
    empty : str
        Text of the picture where the field is zero everywhere.
    limits : (2,) array, optional
        Smallest and largest value that the colours are for; by default of the cells shown.
    masked : bool
        Whether zeros are grey.
    colours : (colour map, float, float), optional
        Colour map and its limits; by default `colour_range` of the limits. `cmap` replaces the colour map alone.
    """
    from matplotlib import colormaps
    from matplotlib.colors import ListedColormap

    visible = field[window.view.slices]
    with paper_style():
        figure, axes, wide = window.axes_of_map(on)
        limits = visible if limits is None else limits
        scale = scale_for(limits, unit)
        colour_map, low, high = colours or colour_range(limits)
        samples = _sampled(visible)
        nonzero = (samples != 0) | (not masked)
        border = None if nonzero.all() else _smooth_border(window, nonzero)
        smooth = border is not None or bool(nonzero.all())
        if masked and low == 0.0 and is_ragged(outline if on is None else on.film.touched("pressure")):
            colour_map = ListedColormap(colormaps[PALE_FIRST](np.linspace(*USED, 256)), name=PALE_FIRST)
        image = axes.imshow(
            scale(extended(samples, nonzero)) if border else np.ma.masked_where(~nonzero, scale(samples)),
            origin="lower",
            extent=window.extent,
            cmap=cmap or colour_map,
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
            colour_bar(figure, axes, image, scale.label(label), wide=wide, shrink=0.6)
        if not np.any(visible):
            axes.text(0.5, 0.5, empty, transform=axes.transAxes, ha="center", va="center", color="0.4")
    return figure


def zone_map(
    window: Window, field: NDArray[Any], title: str, names: tuple[str, ...], colours: tuple[str, ...]
) -> Figure:
    """Map of a field of whole numbers, each with its name and colour."""
    visible = np.rint(field[window.view.slices]).astype(int)
    with paper_style():
        figure, axes, _ = window.axes_of_map(bar=False)
        draw_classes(axes, window, visible, colours)
        window.label(axes)
        window.outline(axes, visible > 0)
        axes.set_title(title)
        legend_below(figure, class_patches(zip(colours, names, strict=True)), names, len(names))
    return figure


def class_patches(classes: Iterable[tuple[str, str]]) -> list[Patch]:
    """Entries of a legend for classes of cells, by colour and name."""
    from matplotlib.patches import Patch

    return [Patch(facecolor=colour, edgecolor="0.4", linewidth=0.5, label=name) for colour, name in classes]


def draw_classes(axes: Axes, window: Window, numbers: NDArray[np.int_], colours: tuple[str, ...]) -> None:
    """Colour each visible cell by its number; nested regions have smooth borders."""
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


def _smooth_border(window: Window, region: NDArray[np.bool_]) -> Path | None:
    """Smooth border of a region of the visible cells, in the unit of the axes."""
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
    """Visible cells: those of the mask with a margin; all cells for an empty mask."""
    box = Box.around(mask)
    rows, columns = mask.shape
    if box is None:
        return Box(0, rows, 0, columns)
    margins = [max(2, round(MARGIN * side)) for side in box.shape]
    return box.grown(margins[0], margins[1], (rows, columns))


def contact_window(dataset: Results, mask: NDArray[np.bool_]) -> Window:
    """Window around the cells of a mask."""
    return Window(dataset, view_of(mask))


def is_ragged(contact: NDArray[np.bool_]) -> bool:
    """Whether the border of the contact is much longer than that of its box, or there is no contact.

    The border of one convex patch is as long as that of its box.
    """
    box = Box.around(contact)
    edges = sum(int(np.count_nonzero(np.diff(contact, axis=axis))) for axis in (0, 1))
    return box is None or edges > 3 * sum(box.shape)


def draw_contact_outline(
    axes: Axes, contact: NDArray[np.bool_], x: NDArray[Any], y: NDArray[Any], *, faint: bool = False
) -> None:
    """Line around the contact (`x`, `y`: edges of the cells), unless ragged; along the edges of few cells."""
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
    lines = LineCollection([*level, *upright], colors=colour, linewidths=width, capstyle="projecting", **style)
    axes.add_collection(lines, autolim=False)
