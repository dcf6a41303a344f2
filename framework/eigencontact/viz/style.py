"""Common parts of all figures: engineering units, colour ranges, sizes, titles, storage."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, BinaryIO, cast

import numpy as np

from eigencontact import __version__
from eigencontact.results.atomic import replacing
from eigencontact.viz.looks import COLOURS, are_shown, figure_look, finish, used_look

if TYPE_CHECKING:
    from pathlib import Path

    from matplotlib.axes import Axes
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.colors import Colormap
    from matplotlib.figure import Figure
    from numpy.typing import ArrayLike

    from eigencontact.results.stored import Results
    from eigencontact.viz.frame import Frame

__all__ = [
    "COLOURS",
    "FORMATS",
    "Scale",
    "box_size",
    "colour_bar",
    "colour_range",
    "draw_cross",
    "heading",
    "instant",
    "is_line",
    "label_plane",
    "lift_colours",
    "moment",
    "new_figure",
    "paper_style",
    "place",
    "plane_figure",
    "save",
    "scale_for",
    "si_unit",
]

#: Negative values below this part of the largest are what a solver leaves of zero.
SIGNED = 1e-5
#: Displacements below this part of the largest leave the other half of a diverging map unused.
ONE_WAY = 0.05
#: Formats of pictures.
FORMATS = ("png", "pdf", "svg")

_PREFIXES = {-12: "p", -9: "n", -6: "µ", -3: "m", 0: "", 3: "k", 6: "M", 9: "G", 12: "T"}


@dataclass(frozen=True, slots=True)
class Scale:
    """Engineering unit for an axis: ``values * factor`` are numbers of `unit`."""

    factor: float
    unit: str

    def __call__(self, values: ArrayLike) -> Any:
        """Numbers in this unit."""
        return np.asarray(values) * self.factor

    def label(self, words: str) -> str:
        """Text of an axis or a colour bar with the unit in brackets, if there is one."""
        return f"{words} [{self.unit}]" if self.unit else words

    def text(self, value: float, digits: int = 3) -> str:
        """Number and unit in words: ``"8.47 GPa"``."""
        number = f"{float(value) * self.factor:.{digits}g}"
        return f"{number} {self.unit}".strip() if "e" not in number else f"{float(value) * self.factor:.0f} {self.unit}"


def scale_for(values: ArrayLike, unit: str) -> Scale:
    """Engineering unit in which the largest magnitude of `values` is between 1 and 1000.

    Parameters
    ----------
    values : array_like
        Values in the SI unit `unit`; those that are not finite are ignored.
    unit : str
        ``"m"``, ``"m2"``, ``"Pa"``, ``"N"``, ... Units that take no prefix (``"1"``) are returned as they are.

    Examples
    --------
    >>> scale_for([0.0, 8.47e9], "Pa").unit, scale_for([105e-6], "m").text(105e-6)
    ('GPa', '105 µm')
    """
    finite = np.abs(np.asarray(values, dtype=float))
    finite = finite[np.isfinite(finite)]
    largest = float(finite.max()) if finite.size else 0.0
    if unit in ("1", "", "unknown"):
        return Scale(1.0, "")
    if largest == 0.0:
        return Scale(1.0, unit.replace("m2", "m²").replace("m3", "m³"))
    power = {"m2": 2, "m3": 3}.get(unit, 1)
    # A value a hair below a power of ten, 999.9996, is a round number that lost a digit.
    exponent = 3 * power * math.floor(math.log10(largest * (1 + 1e-9)) / (3 * power))
    exponent = max(min(exponent, 12 if power == 1 else 0), -12 * power)
    if unit in ("m", "m2"):  # no kilometres of contact
        exponent = min(exponent, 0)
    return Scale(10.0**-exponent, _PREFIXES[exponent // power] + unit.replace("m2", "m²").replace("m3", "m³"))


def is_line(dataset: Results) -> bool:
    """Whether the results belong to a line contact, whose surface is one row of strips."""
    return bool(dataset.attrs.get("line", 0))


def si_unit(dataset: Results, name: str) -> str:
    """SI unit of a stored variable: that of a line contact is per length."""
    return str(dataset[name].attrs.get("units", "unknown"))


def colour_range(values: ArrayLike) -> tuple[str, float, float]:
    """Colour map and its limits: viridis from 0 for values of one sign, a symmetric diverging map for signed ones."""
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    if low < -SIGNED * max(abs(high), abs(low)) and high > 0:
        end = max(-low, high)
        return "RdBu_r", -end, end
    if high <= 0 and low < 0:
        return "viridis_r", low, 0.0
    return "viridis", 0.0, high


def lift_colours(low: float, high: float, out: int = 1) -> tuple[Colormap, float, float]:
    """Colour map and limits for an uplift of the surface: red upwards, blue downwards.

    `low` and `high` are the smallest and largest value. `out` is 1 where positive values lift the surface out of the
    body, -1 where negative ones do. Where (nearly) all of it goes one way the map is that half, from white on. Zeros
    alone have limits around them.
    """
    from matplotlib import colormaps
    from matplotlib.colors import ListedColormap

    colours = colormaps["RdBu_r" if out > 0 else "RdBu"]
    end = max(abs(low), abs(high))
    if end == 0.0:
        return colours, -1.0, 1.0
    if low >= -ONE_WAY * end:
        return ListedColormap(colours(np.linspace(0.5, 1.0, 256))), min(low, 0.0), high
    if high <= ONE_WAY * end:
        return ListedColormap(colours(np.linspace(0.0, 0.5, 256))), low, max(high, 0.0)
    return colours, -end, end


def box_size(width: float, height: float, largest: tuple[float, float] = (4.2, 3.6)) -> tuple[float, float]:
    """Size [inch] of an axes box with the proportions of ``width x height``, as large as `largest` allows."""
    ratio = min(largest[0] / width, largest[1] / height)
    return width * ratio, height * ratio


def new_figure(width: float, height: float, on: Frame | None = None) -> Figure:
    """Empty figure [inch] with its own canvas, or a part of a frame.

    Pyplot does not know it, except in a block of `eigencontact.viz.looks.shown_figures`.
    """
    if on is not None and on.subfigure is not None:
        return cast("Figure", on.subfigure)
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    look = used_look()
    layout: Any = "compressed" if look.compact else "constrained"
    if are_shown():
        from matplotlib import pyplot as plt

        return cast("Figure", plt.figure(figsize=look.size(width, height), layout=layout))
    figure = Figure(figsize=look.size(width, height), layout=layout)
    FigureCanvasAgg(figure)
    return figure


def plane_figure(
    width: float,
    height: float,
    largest: tuple[float, float] = (4.4, 3.4),
    on: Frame | None = None,
    *,
    bar: bool = True,
    narrowest: float = 0.0,
) -> tuple[Figure, Axes, bool]:
    """Figure for a plane of equal scales, at least `narrowest` wide [inch]; and whether its colour bar lies below.

    Without a bar there is room for a legend below. See `box_size` for the other lengths.
    """
    width, height = box_size(width, height, largest)
    wide = width > 2.2 * height
    below = wide or not bar
    room = 1.5 if wide else 1.0 if below else 0.7
    figure = new_figure(max(width + (0.8 if below else 1.6), narrowest), height + room, on)
    return figure, figure.add_subplot(), wide


def colour_bar(figure: Figure, axes: Axes, mapped: Any, label: str, *, wide: bool, shrink: float, **more: Any) -> Any:
    """Colour bar of a plane: on the right, or below a wide one with the fraction `shrink` of its width."""
    side: dict[str, Any] = {"location": "bottom" if wide else "right", "aspect": 30 if wide else 22}
    bar = figure.colorbar(mapped, ax=axes, shrink=shrink if wide else 1.0, pad=0.03, **side, **more)
    bar.set_label(label)
    return bar


def draw_cross(
    axes: Axes, at: tuple[Any, Any], black: tuple[float, float] = (9, 2.6), white: tuple[float, float] = (8, 1.2),
    **style: Any,
) -> None:  # fmt: skip
    """Cross at a point, white on black for contrast on all colours; size and width of both [points]."""
    for colour, (size, width) in (("black", black), ("white", white)):
        axes.plot(*at, "+", color=colour, markersize=size, markeredgewidth=width, **style)


def label_plane(axes: Axes, x: str, y: str) -> None:
    """Label the axes of a map of equal scales; the short side has the ticks of the long one if at least two fit."""
    from matplotlib.ticker import MaxNLocator, MultipleLocator

    axes.set_xlabel(x)
    axes.set_ylabel(y)
    sides = [(axes.xaxis, axes.get_xlim()), (axes.yaxis, axes.get_ylim())]
    longest = max((limits for _, limits in sides), key=lambda limits: abs(limits[1] - limits[0]))
    ticks = MaxNLocator(nbins=8, steps=[1, 2, 4, 5, 10]).tick_values(min(longest), max(longest))
    step = float(ticks[1] - ticks[0])
    for axis, (low, high) in sides:
        axis.set_major_locator(MultipleLocator(step) if abs(high - low) >= 2 * step else MaxNLocator(nbins=2))


def place(axis: str, value: float) -> str:
    """Coordinate in words: ``"y = 125 nm"``, ``"y = 0"``."""
    return f"{axis} = {scale_for([value], 'm').text(value)}" if value else f"{axis} = 0"


def heading(dataset: Results, step: int, subject: str) -> str:
    """Title of a picture: its subject, the load, and the step unless it is the last."""
    title = subject
    if "normal_load" in dataset:
        load = float(dataset["normal_load"][step])
        title += f" at {scale_for([load], si_unit(dataset, 'normal_load')).text(load)}"
    return title + instant(dataset, step)


def instant(dataset: Results, step: int) -> str:
    """End of the title of a picture: the number of wear cycles, or the step unless it is the last."""
    if cycles := _cycles(dataset, step):
        return f", {cycles}"
    last = dataset.sizes["step"] - 1
    return "" if step % (last + 1) == last else f", step {int(dataset['step'][step])}"


def moment(dataset: Results, step: int) -> str:
    """Step of a picture for its caption, with the number of cycles of surfaces that wear; empty for a single step."""
    if dataset.sizes["step"] == 1:
        return ""
    number = int(dataset["step"][step])
    if cycles := _cycles(dataset, step):
        return f" (step {number}, {cycles} done)"
    return f" (step {number} of {int(dataset['step'][-1])})"


def _cycles(dataset: Results, step: int) -> str:
    """Number of cycles of a step, as text; empty without wear in cycles."""
    if "cycles" not in dataset or not float(np.nanmax(dataset["cycles"].values)) > 0:
        return ""
    count = float(dataset["cycles"][step])
    return f"{count:.7g} {'cycle' if count == 1 else 'cycles'}"


#: The look in use; figures are drawn and stored in this block.
paper_style = figure_look


def save(figure: Figure, path: Path, dpi: int | None = None, caption: str = "") -> None:
    """Write a picture that names this package, in the format of the ending ``.png``, ``.pdf`` or ``.svg``.

    The file appears complete or not at all, and carries the caption as its description. The dots per inch are by
    default those of the look in use. `ResultsError` when it cannot be stored.
    """
    kind = path.suffix.removeprefix(".")
    look = used_look()
    dots = dpi or look.dpi
    with paper_style(), replacing(path, f"picture {path.name}", lasting=False) as sink:  # `plot` draws it again
        # What bbox_inches="tight" does, without drawing everything once more to find the box.
        figure.set_dpi(dots if kind == "png" else 72)
        canvas = cast("FigureCanvasAgg", figure.canvas)
        finish(figure)
        figure.set_layout_engine(None)
        box = figure.get_tightbbox(canvas.get_renderer()).padded(0.06)
        if look.column:  # as wide as the column, to the point
            box.x0, box.x1 = 0.0, figure.get_figwidth()
        elif box.width < (page := look.page):  # pages show pictures of one width: letters are of one size
            box.x0, box.x1 = (0.5 * (box.x0 + box.x1 + side * page) for side in (-1, 1))
        metadata = {**_METADATA[kind], _CAPTION[kind]: caption} if caption else _METADATA[kind]
        figure.savefig(cast("BinaryIO", sink), format=kind, dpi=dots, bbox_inches=box, metadata=metadata)


#: Where a file has room for a caption.
_CAPTION = {"png": "Description", "pdf": "Subject", "svg": "Description"}
_MAKER = f"eigencontact {__version__}"
#: What a file says of itself; a date would make another file of the same picture.
_METADATA: dict[str, dict[str, Any]] = {
    "png": {"Software": _MAKER},
    "pdf": {"Creator": _MAKER, "CreationDate": None},
    "svg": {"Creator": _MAKER, "Date": None},
}
