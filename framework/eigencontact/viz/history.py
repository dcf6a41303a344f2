"""Pictures of a history: choice of informative pictures, curves of load and motion, cycles drawn over each other."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from eigencontact.core.bulk import BULK_NAMES
from eigencontact.viz.errors import draw_band, history_errors
from eigencontact.viz.frame import draw_way
from eigencontact.viz.style import COLOURS, is_line, new_figure, paper_style, scale_for, si_unit
from eigencontact.viz.worn import course, ends_of_cycles, initial_separation, wears

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from matplotlib.axes import Axes
    from matplotlib.colors import Normalize
    from matplotlib.figure import Figure
    from numpy.typing import ArrayLike, NDArray

    from eigencontact.results.stored import Results
    from eigencontact.viz.frame import Frame

__all__ = [
    "NOISE",
    "Panel",
    "Quantity",
    "Strand",
    "area_varies",
    "axis_from_zero",
    "draw_strands",
    "first_touch",
    "history_panels",
    "history_words",
    "load_history",
    "vanishes",
    "varies",
    "zones_change",
]

#: With more steps than this, only some carry a marker.
MARKERS = 40
#: Values that differ by no more than this part of the largest are constant.
CONSTANT = 1e-6
#: Values that fall to this part of the largest have an axis from zero.
LOW = 0.5
#: Largest pressures and areas that differ by no more than this part of the largest are noise of the cells.
NOISE = 0.03
#: Loads that move the surfaces.
_LOADS = ("normal_load", "tangential_load_x", "tangential_load_y", "torsion_moment")
#: Colours of the numbers.
COLOUR_MAP = "viridis"
#: End of the colour map in use: white paper swallows the yellow beyond it.
BRIGHTEST = 0.88
#: Ticks of a colour bar lie at least this part of its length apart.
TICK_ROOM = 0.08
#: Numbers of which half lie below this part of the largest have a logarithmic colour bar.
EARLY = 0.25
#: Strands of more points than this have no markers.
STRAND_MARKERS = 60


@dataclass(frozen=True)
class Quantity:
    """Number in each step, with description, unit, and errors if they were estimated."""

    values: NDArray[np.float64]
    words: str
    unit: str
    errors: NDArray[np.float64] | None = None

    @classmethod
    def stored(cls, dataset: Results, name: str, words: str) -> Quantity:
        """Quantity of a variable of the results."""
        values, unit = np.asarray(dataset[name].values, dtype=float), si_unit(dataset, name)
        return cls(values, words, unit, history_errors(dataset, name))

    def at(self, steps: NDArray[np.intp]) -> Quantity:
        """The same in some steps."""
        return replace(self, values=self.values[steps], errors=None if self.errors is None else self.errors[steps])

    def from_start(self, start: float | None) -> Quantity:
        """Quantity with a value before the first step, which has no error."""
        if start is None:
            return self
        errors = None if self.errors is None else np.append(0.0, self.errors)
        return replace(self, values=np.append(start, self.values), errors=errors)


@dataclass(frozen=True)
class Panel:
    """A curve of one quantity over another.

    Where `started`, the first point is the state before the first step. `steps` (n,) are positions along ``step`` of
    the points after it.
    """

    x: Quantity
    y: Quantity
    started: bool
    steps: NDArray[np.intp]

    @property
    def title(self) -> str:
        """Both quantities in words."""
        return f"{self.y.words} over {self.x.words.lower()}"

    def draw(self, axes: Axes, step: int | None) -> None:
        """Draw the curve, in an animation up to a position along ``step``."""
        scales = scale_for(self.x.values, self.x.unit), scale_for(self.y.values, self.y.unit)
        x, y = scales[0](self.x.values), scales[1](self.y.values)
        if step is not None:
            draw_way(axes, x, y, int(np.searchsorted(self.steps, step, side="right")) - 1 + self.started)
        else:
            axes.plot(x, y, "o-", color=COLOURS[0], markevery=max(1, -(-x.size // MARKERS)))
            axes.plot(x[:1], y[:1], "o", color=COLOURS[0], markerfacecolor="white", markersize=5)
            if self.y.errors is not None:
                draw_band(axes, x, self.y.values, self.y.errors, scales[1], COLOURS[0])
            if self.x.errors is not None:
                draw_band(axes, y, self.x.values, self.x.errors, scales[0], COLOURS[0], across=True)
                axes.legend(*[entries[:1] for entries in axes.get_legend_handles_labels()])
        for numbers, set_limits in ((x, axes.set_xlim), (y, axes.set_ylim)):
            if numbers.min() >= 0.0:
                set_limits(0.0, 1.05 * numbers.max())
        axes.set(xlabel=scales[0].label(self.x.words), ylabel=scales[1].label(self.y.words), title=self.title)


def history_panels(dataset: Results) -> list[Panel]:
    """Curves of a load history; empty if loads and displacements are constant.

    Normal load over approach, and contact area over load; where the load is constant and a moment or a tilt changes,
    moment over tilt, and contact area over moment. A load under a constant approach is drawn over the cycles, the path
    of sliding or the steps. The contact area is left out where its change may be that of a few cells.
    """
    if dataset.sizes["step"] < 2 or not {"normal_load", "approach", "contact_area"} <= set(dataset.data_vars):
        return []
    worn = wears(dataset)
    steps = ends_of_cycles(dataset) if worn else np.arange(dataset.sizes["step"])
    force, displacement = _driver(dataset)
    if not varies(force.values):
        return []
    x, y, start = displacement.at(steps), force.at(steps), None
    if not varies(displacement.values):
        values, words, unit = course(dataset)
        x = Quantity(values[steps], words, unit)
    elif displacement.words == "Approach":
        start = first_touch(dataset)
    panels = [Panel(x.from_start(start), y.from_start(None if start is None else 0.0), start is not None, steps)]
    if area_varies(dataset) and not worn:  # the history of wear shows the area
        words = "Contact width" if is_line(dataset) else "Contact area"
        panels.append(Panel(force, Quantity.stored(dataset, "contact_area", words), False, steps))
    return panels


def load_history(dataset: Results, step: int = -1, on: Frame | None = None) -> Figure:
    """Draw the curves of `history_panels`, through all steps.

    One or two panels; an open circle marks the first point, which tells loading and unloading apart.
    """
    panels = history_panels(dataset)
    with paper_style():
        figure = new_figure(6.6 if len(panels) > 1 else 3.9, 2.8, on)
        for axes, panel in zip(figure.subplots(1, len(panels), squeeze=False)[0], panels, strict=True):
            panel.draw(axes, None if on is None else step % dataset.sizes["step"])
    return figure


def history_words(panels: list[Panel]) -> str:
    """Caption of the picture."""
    return " and ".join(panel.title.lower() for panel in panels).capitalize() + "."


def first_touch(dataset: Results) -> float | None:
    """Approach [m] at first touch; None if the results lack it.

    Eigenstrain and a tilt move the surfaces before anything is loaded.
    """
    strained = bool(dataset.attrs["prestrained"])
    tilted = any(float(dataset[name][0]) != 0.0 for name in ("tilt_x", "tilt_y") if name in dataset)
    unloaded = float(dataset["normal_load"][0]) == 0.0
    if strained or tilted or unloaded or not {"gap", "displacement_z"} <= set(dataset.data_vars):
        return None
    return float(initial_separation(dataset, 0).min())


def _driver(dataset: Results) -> tuple[Quantity, Quantity]:
    """Force and displacement that change most through the history."""
    pairs = [("normal_load", "approach", "Normal load", "Approach")]
    if not varies(dataset["normal_load"].values):
        for axis in "yx":
            names = f"moment_{axis}", f"tilt_{axis}"
            if names[0] in dataset and np.ptp(dataset[names[1]].values) > 0 and varies(dataset[names[0]].values):
                pairs.insert(0, (*names, f"Moment about {axis}", f"Tilt about {axis}"))
                break
    force, displacement, load, motion = pairs[0]
    return Quantity.stored(dataset, force, load), Quantity.stored(dataset, displacement, motion)


def varies(values: ArrayLike, share: float = CONSTANT) -> bool:
    """Whether finite values differ by more than a fraction of the largest magnitude.

    Examples
    --------
    >>> varies([2.0, 2.0 + 1e-9]), varies([2.0, 2.1])
    (False, True)
    """
    numbers = np.asarray(values, dtype=float)
    numbers = numbers[np.isfinite(numbers)]
    return bool(numbers.size) and float(np.ptp(numbers)) > share * float(np.abs(numbers).max())


def vanishes(dataset: Results, names: Iterable[str], step: int) -> bool:
    """Whether all of some fields are zero, or missing, at a position along ``step``."""
    return not any(np.any(np.nan_to_num(dataset[name][step].values)) for name in names if name in dataset)


def area_varies(dataset: Results) -> bool:
    """Whether the contact area changes by more than a rim of half a cell all round the largest contact.

    The area is that of whole cells: a smaller change may be the steps of a few cells. The rim of a line contact is one
    cell, half of one at each end.
    """
    area = np.asarray(dataset["contact_area"].values, dtype=float)
    cell = float(np.prod(np.atleast_1d(dataset.attrs["cell_size"])))
    count = float(area.max(initial=0.0)) / cell
    rim = 1.0 if is_line(dataset) else float(np.sqrt(np.pi * count))
    return float(np.ptp(area)) > rim * cell


def axis_from_zero(values: ArrayLike) -> bool:
    """Whether the axis of values of one sign begins at zero: for values that fall far or vary only by noise.

    Examples
    --------
    >>> axis_from_zero([0.4, 1.0]), axis_from_zero([0.9, 1.0]), axis_from_zero([0.99, 1.0])
    (True, False, True)
    """
    numbers = np.asarray(values, dtype=float)
    low, high = float(np.nanmin(numbers)), float(np.nanmax(numbers))
    return low >= 0.0 and (low <= LOW * high or high - low <= NOISE * high)


def zones_change(dataset: Results, zones: NDArray[np.intp]) -> bool:
    """Whether both stick and slip occur in steps that move the surfaces.

    Parameters
    ----------
    zones : (steps, ...) int
        2 where the surfaces stick, 1 where they slip; in a step without motion all sticks, which tells nothing.
    """
    loads = (*_LOADS, *(name for names in BULK_NAMES.values() for name in names))
    histories = [np.asarray(dataset[name].values, dtype=float) for name in loads if name in dataset]
    moved = np.zeros(len(zones), dtype=bool)
    for values in histories:
        change = np.abs(np.diff(values, prepend=values[:1]))
        moved |= change > CONSTANT * np.abs(values).max(initial=0.0)
    zones_in_motion = zones[moved]
    return bool((zones_in_motion == 2).any() and (zones_in_motion == 1).any())


@dataclass(frozen=True)
class Strand:
    """Consecutive steps of a history, by positions along ``step`` of its ends: one stroke or cycle, and its number."""

    first: int
    last: int
    number: float


def draw_strands(
    figure: Figure,
    axes: Axes,
    x: NDArray[np.float64],
    y: NDArray[np.float64],
    strands: Sequence[Strand],
    bar_label: str,
    *,
    markers: bool = True,
) -> None:
    """Draw each strand in its colour and a colour bar of the numbers; a single strand in blue, without a bar.

    `x` and `y` (steps,) are in the units of the axes, the strands in the order of their numbers. With `markers` short
    strands have a marker at each step.
    """
    from matplotlib import colormaps
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import ListedColormap, LogNorm, Normalize

    numbers = [strand.number for strand in strands]
    several = len(strands) > 1
    low, high = numbers[0], numbers[-1]
    norm = LogNorm(low, high) if several and low > 0 and np.median(numbers) < EARLY * high else Normalize(low, high)
    colours = ListedColormap(colormaps[COLOUR_MAP](np.linspace(0.0, BRIGHTEST, 256)))
    for strand in strands:
        colour = colours(float(norm(np.array(strand.number)))) if several else COLOURS[0]
        steps = slice(strand.first, strand.last + 1)
        marker = "o" if markers and strand.last - strand.first < STRAND_MARKERS else ""
        axes.plot(x[steps], y[steps], linestyle="-", marker=marker, markersize=2.2, color=colour, linewidth=1.0)
    if several:
        ticks = _ticks(numbers, norm)
        bar = figure.colorbar(ScalarMappable(norm, colours), ax=axes, ticks=ticks, pad=0.03, aspect=22)
        bar.ax.set_yticks(ticks, [f"{number:.7g}" for number in ticks])
        bar.ax.set_yticks([], minor=True)
        bar.set_label(bar_label)


def _ticks(numbers: Sequence[float], norm: Normalize) -> list[float]:
    """Numbers that fit on the colour bar, with the last one."""
    ticks = [numbers[-1]]
    for number in reversed(numbers[:-1]):
        if float(norm(ticks[-1])) - float(norm(number)) >= TICK_ROOM:
            ticks.append(number)
    return ticks[::-1]
