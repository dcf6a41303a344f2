"""Picture of the load history: load, approach, moment, tilt and contact area, as far as they change."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from eigencontact.viz.frame import draw_way
from eigencontact.viz.informative import area_varies, varies
from eigencontact.viz.style import COLOURS, new_figure, paper_style, scale_for
from eigencontact.viz.worn import course, ends_of_cycles, initial_separation, wears

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from eigencontact.results.stored import Results
    from eigencontact.viz.frame import Frame

__all__ = ["Panel", "Quantity", "first_touch", "history_panels", "history_words", "load_history"]

#: With more steps than this, only some carry a marker.
MARKERS = 40


@dataclass(frozen=True)
class Quantity:
    """A number in each step, what it is and its unit."""

    values: NDArray[np.float64]
    words: str
    unit: str

    def from_start(self, start: float | None) -> Quantity:
        """The same with a value before the first step."""
        return self if start is None else Quantity(np.append(start, self.values), self.words, self.unit)


@dataclass(frozen=True)
class Panel:
    """A curve of one quantity over another.

    Attributes
    ----------
    x, y : Quantity
        Of all points, that of the unloaded start among them where `started`.
    started : bool
        Whether the first point is the state before the first step.
    steps : (n,) int
        Positions along ``step`` of the points after the start.
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
        """Draw the curve, in an animation as far as a position along ``step``."""
        scales = scale_for(self.x.values, self.x.unit), scale_for(self.y.values, self.y.unit)
        x, y = scales[0](self.x.values), scales[1](self.y.values)
        if step is not None:
            draw_way(axes, x, y, int(np.searchsorted(self.steps, step, side="right")) - 1 + self.started)
        else:
            axes.plot(x, y, "o-", color=COLOURS[0], markevery=max(1, -(-x.size // MARKERS)))
            axes.plot(x[:1], y[:1], "o", color=COLOURS[0], markerfacecolor="white", markersize=5)
        for numbers, set_limits in ((x, axes.set_xlim), (y, axes.set_ylim)):
            if numbers.min() >= 0.0:
                set_limits(0.0, 1.05 * numbers.max())
        labels = [
            f"{quantity.words} [{scale.unit}]" if scale.unit else quantity.words
            for quantity, scale in zip((self.x, self.y), scales, strict=True)
        ]
        axes.set(xlabel=labels[0], ylabel=labels[1], title=self.title)


def history_panels(dataset: Results) -> list[Panel]:
    """Curves of a load history; none where loads and displacements are constant.

    Normal load over approach, and contact area over load; where the load is constant and a moment or a tilt changes,
    moment over tilt, and contact area over moment. A load under a constant approach is drawn over the cycles, the path
    of sliding or the steps. The contact area is left out where its change may be that of a few cells.
    """
    if dataset.sizes["step"] < 2 or not {"normal_load", "approach", "contact_area"} <= set(dataset.data_vars):
        return []
    worn = wears(dataset)
    steps = ends_of_cycles(dataset) if worn else np.arange(dataset.sizes["step"])
    force, way = _driver(dataset)
    if not varies(force.values):
        return []
    start = first_touch(dataset) if way.words == "Approach" else None
    panels = []
    if varies(way.values):
        curve = Quantity(way.values[steps], way.words, way.unit), Quantity(force.values[steps], force.words, force.unit)
        panels.append(
            Panel(
                curve[0].from_start(start),
                curve[1].from_start(None if start is None else 0.0),
                start is not None,
                steps,
            )
        )
    else:
        values, label, unit = course(dataset)
        curve = Quantity(values[steps], label, unit), Quantity(force.values[steps], force.words, force.unit)
        panels.append(Panel(*curve, False, steps))
    if area_varies(dataset) and not worn:  # the history of wear shows the area
        area = np.asarray(dataset["contact_area"].values, dtype=float)
        panels.append(Panel(force, Quantity(area, "Contact area", "m2"), False, steps))
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
    """Approach [m] at first touch; None where the results do not give it.

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
    pairs = [("normal_load", "approach", "Normal load", "Approach", "N", "m")]
    if not varies(dataset["normal_load"].values):
        for axis in "yx":
            names = f"moment_{axis}", f"tilt_{axis}"
            if names[0] in dataset and np.ptp(dataset[names[1]].values) > 0 and varies(dataset[names[0]].values):
                pairs.insert(0, (*names, f"Moment about {axis}", f"Tilt about {axis}", "N m", "rad"))
                break
    force, way, load, motion, force_unit, way_unit = pairs[0]
    loads, ways = (np.asarray(dataset[name].values, dtype=float) for name in (force, way))
    return Quantity(loads, load, force_unit), Quantity(ways, motion, way_unit)
