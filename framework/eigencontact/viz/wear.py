"""Pictures of surfaces that wear: map and profiles of the worn depth, worn coatings, history, loops of cycles."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from eigencontact.viz.errors import draw_band, errors_of, history_errors, with_error
from eigencontact.viz.friction import MODES, driven
from eigencontact.viz.friction_history import cycles_with_loops, strands_of
from eigencontact.viz.history import draw_strands
from eigencontact.viz.lines import SurfaceLine, drawn_once, line_figure, lines_through, middle
from eigencontact.viz.outline import coatings, inclusion_segments, paths_of
from eigencontact.viz.rolling import rolls
from eigencontact.viz.style import COLOURS, instant, is_line, new_figure, paper_style, scale_for, si_unit
from eigencontact.viz.window import contact_window, masked_map
from eigencontact.viz.worn import course, ends_of_cycles, initial_separation, interfaces

if TYPE_CHECKING:
    from collections.abc import Iterable

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from eigencontact.results.stored import Results
    from eigencontact.viz.frame import Frame
    from eigencontact.viz.outline import Coating
    from eigencontact.viz.worn import SolvedCycle

__all__ = ["loop_cycles", "wear_history", "worn_coating", "worn_loops", "worn_map", "worn_profiles"]

#: Depths below this part of the largest are no wear.
SHARE = 1e-3
#: Loops that are drawn.
LOOPS = 8
#: Tints of the two bodies, and of what they have lost.
TINTS, LOST = {1: "#CFE1EC", 2: "#E4E4E4"}, "#F3B7A0"
BODY_STYLES = {1: "-", 2: "--"}
#: Worn depths that differ from their mirror image by no more than this part of the largest have profiles in the middle.
SYMMETRIC = 0.05
#: With more points than this, only some carry a marker.
MARKERS = 40
#: Depth [m] up to which a picture of surfaces that have not worn yet looks.
NOTHING = 1e-9
#: Surfaces are shown up to this part of the largest approach above the first touch.
HEIGHT = 1.2
#: Points between two of an outline.
POINTS = 40
#: Room above and below the surfaces, as a part of what is shown.
ROOM = 0.12


def worn_map(dataset: Results, step: int = -1) -> Figure:
    """Depth that both bodies together have lost, with the outline of the contact of that step."""
    depth = np.asarray(dataset["worn_depth"][step].values, dtype=float)
    shown = np.where(depth > SHARE * depth.max(initial=0.0), depth, 0.0)
    contact = np.asarray(dataset["pressure"][step].values) != 0
    return masked_map(
        contact_window(dataset, contact | (shown > 0)),
        shown,
        unit="m",
        label="Worn depth",
        title=with_error(_heading(dataset, step), dataset, "worn_depth", step),
        outline=contact,
        empty="no wear",
    )


def _heading(dataset: Results, step: int) -> str:
    volume, deepest = (float(dataset[name][step]) for name in ("worn_volume", "max_worn_depth"))
    if deepest == 0.0:
        return f"Wear{instant(dataset, step)}\nnothing lost so far"
    cubes, length = (
        scale_for(dataset[name].values, si_unit(dataset, name)) for name in ("worn_volume", "max_worn_depth")
    )
    return f"Wear{instant(dataset, step)}\n{cubes.text(volume)} lost, at most {length.text(deepest)} deep"


def worn_profiles(dataset: Results, step: int = -1, on: Frame | None = None) -> Figure:
    """Surfaces of both bodies before and after wear, without load; below them the worn depth.

    The lines pass through the middle where the worn depth is symmetric about it, else through its largest value. Body 1
    is drawn flat: body 2 has all of the separation that they had at first.

    z points into body 1, downwards, and has a scale of its own.

    Parameters
    ----------
    on : Frame, optional
        Frame of an animation to draw in: one line alone.
    """
    section = _Section(dataset, step, on)
    lines = section.lines if on is None else section.lines[:1]
    most = max(section.most.values()) or NOTHING
    depth = scale_for(most, "m")
    with paper_style():
        figure = line_figure(len(lines), 4.4, on)
        panels = figure.subplots(2, len(lines), sharex="col", sharey="row", squeeze=False, height_ratios=(1.5, 1))
        ends = section.ends()
        for line, (above, below) in zip(lines, panels.T, strict=True):
            section.draw(above, line, ends)
            at = section.length(line.at)
            for body, values in section.worn(line).items():
                below.plot(at, depth(values), BODY_STYLES[body], color=COLOURS[body - 1], label=f"lost by body {body}")
                errors = errors_of(dataset, f"worn_depth_{body}", step) if on is None else None
                if errors is not None:
                    draw_band(below, at, values, errors[line.where], depth, COLOURS[body - 1])
            below.set_ylim(float(depth(most)) * (1 + ROOM), -ROOM * float(depth(most)))
            below.set_xlabel(f"{line.along} [{section.length.unit}]")
        panels[1, 0].set_ylabel(f"Worn depth [{depth.unit}]")
        _legend(figure, panels[:, 0], 4 if on is None else 3)
        figure.suptitle(_heading(dataset, step))
    return figure


def worn_coating(dataset: Results, step: int = -1) -> Figure:
    """Worn surfaces over the unchanged interfaces of layers and coatings, along x and along y.

    z points into body 1, downwards, and has a scale of its own.
    """
    section = _Section(dataset, step, None, coatings(dataset))
    with paper_style():
        lines = section.lines
        figure = line_figure(len(lines), 3.4)
        panels = figure.subplots(1, len(lines), sharey=True, squeeze=False)
        ends = section.ends(layers=True)
        for line, axes in zip(lines, panels[0], strict=True):
            section.draw(axes, line, ends)
            axes.set_xlabel(f"{line.along} [{section.length.unit}]")
        _legend(figure, panels[0, :1])
        figure.suptitle(_heading(dataset, step))
    return figure


def _legend(figure: Figure, panels: Iterable[Axes], columns: int = 4) -> None:
    """Legend of all panels without duplicates, below them."""
    entries = {name: item for axes in panels for item, name in zip(*axes.get_legend_handles_labels(), strict=True)}
    figure.legend(entries.values(), entries.keys(), loc="outside lower center", ncols=min(columns, len(entries)))


class _Section:
    """Both surfaces of one step, on lines along x and y through the wear."""

    def __init__(self, dataset: Results, step: int, on: Frame | None, coats: tuple[Coating, ...] = ()) -> None:
        last = np.asarray(dataset["worn_depth"][-1].values, dtype=float)
        touched = dataset["pressure"][-1].values != 0 if on is None else on.film.touched("pressure")
        window = contact_window(dataset, touched | (last > SHARE * last.max(initial=0.0)))
        self.length = window.length
        self.lines = lines_through(dataset, middle(last, SYMMETRIC), window.view, near=-1.0)
        self._first = initial_separation(dataset, step)
        touch = 0.0 if rolls(dataset) else max(0.0, float(self._first.min()))
        self._height = touch + HEIGHT * max(float(np.abs(dataset["approach"].values).max()), NOTHING)
        names = {body: f"worn_depth_{body}" for body in (1, 2) if f"worn_depth_{body}" in dataset}
        self._worn = {body: np.asarray(dataset[name][step].values, dtype=float) for body, name in names.items()}
        #: Largest depth that each body loses, in the step or in all frames [m].
        self.most = {
            body: float(self._worn[body].max() if on is None else on.film.limits(name)[1])
            for body, name in names.items()
        }
        if not coats:
            self.lines = drawn_once(dataset, self.lines, [*self._worn.values(), self._first])
        self._interfaces = {body: interfaces(dataset, body) for body in (1, 2)}
        self._dataset, self._coats = dataset, coats

    def worn(self, line: SurfaceLine) -> dict[int, NDArray[np.float64]]:
        """Depth that each body that wears has lost on a line [m]."""
        return {body: values[line.where] for body, values in self._worn.items()}

    def ends(self, *, layers: bool = False) -> tuple[float, float]:
        """Smallest and largest displayed z [m], the same in all frames of an animation."""
        high = self._height + self.most.get(2, 0.0)
        deep = self.most.get(1, 0.0)
        if layers:
            under = {body: list(depths) for body, depths in self._interfaces.items()}
            for coat in self._coats:
                under[coat.body].append(coat.bottom)
            high, deep = max(high, *under[2], 0.0), max(deep, *under[1], 0.0)
        room = ROOM * (high + deep)
        return -high, max(deep + room, 2 * room)

    def _under(self, body: int, line: SurfaceLine) -> list[tuple[NDArray[np.float64], NDArray[np.float64]]]:
        """Places on a line and depths [m] of the interfaces in a body."""
        curves = [(line.at, np.full(line.at.size, depth)) for depth in self._interfaces[body]]
        for coat in self._coats:
            if coat.body != body:
                continue
            segments = inclusion_segments(self._dataset, body, line.normal, line.across, coat.number)
            inner = segments[(segments[:, :, 1] > 0.0).any(axis=1)]  # without the face at the surface
            curves += [_between(path) for path in paths_of(inner)]
        return curves

    def draw(self, axes: Axes, line: SurfaceLine, ends: tuple[float, float]) -> None:
        """Draw both bodies, their worn material, and the interfaces of their layers."""
        z, at = scale_for(ends, "m"), self.length(line.at)
        worn_depth = self.worn(line)
        zero = np.zeros(line.at.size)
        before = {1: zero, 2: -self._first[line.where]}
        worn_surface = {1: zero + worn_depth.get(1, 0.0), 2: before[2] - worn_depth.get(2, 0.0)}
        for body, end in ((1, ends[1]), (2, ends[0])):
            axes.fill_between(at, z(worn_surface[body]), z(end), color=TINTS[body], linewidth=0, label=f"body {body}")
        for body in worn_depth:
            axes.fill_between(
                at, z(before[body]), z(worn_surface[body]), color=LOST, linewidth=0, zorder=2, label="worn off"
            )
        for body in (1, 2):
            axes.plot(at, z(before[body]), "--", color="0.35", linewidth=0.9, zorder=3, label="initial surface")
            axes.plot(
                at, z(worn_surface[body]), "-", color=COLOURS[body - 1], zorder=4, label=f"surface of body {body}"
            )
            sign = 1.0 if body == 1 else -1.0
            for places, depths in self._under(body, line):
                level = np.interp(places, line.at, before[body]) + sign * depths
                remaining = (
                    sign * (level - np.interp(places, line.at, worn_surface[body])) >= 0.0
                )  # of what is not worn off
                if remaining.any() and ends[0] < level.max() and level.min() < ends[1]:
                    shown = (self.length(places), np.where(remaining, z(level), np.nan))
                    axes.plot(*shown, "-.", color="black", linewidth=0.9, zorder=3, label="interface of layers")
        axes.set_xlim(float(at[0]), float(at[-1]))
        axes.set_ylim(float(z(ends[1])), float(z(ends[0])))
        axes.set_title(line.title)
        if line is self.lines[0]:
            axes.set_ylabel(f"z [{z.unit}]")


def _between(path: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Coordinates of a path with additional points between its own."""
    finer, corners = np.arange(POINTS * (len(path) - 1) + 1) / POINTS, np.arange(len(path))
    return np.interp(finer, corners, path[:, 0]), np.interp(finer, corners, path[:, 1])


def wear_history(dataset: Results) -> Figure:
    """Worn volume, largest depth, largest pressure and contact area over the cycles, or the path of sliding.

    Parameters
    ----------
    dataset : Results
        Results of a run that wears. One point is drawn for each number of cycles or path: of solved cycles their ends;
        loading at the beginning and unloading at the end wear nothing and have no points of their own.
    """
    values, words, unit = course(dataset)
    steps = _worn_steps(dataset, values)
    along = scale_for(values, unit)
    at = along(values[steps])
    line = is_line(dataset)
    shown = (
        ("worn_volume", "Worn area" if line else "Worn volume"),
        ("max_worn_depth", "Largest worn depth"),
        ("max_pressure", "Largest pressure"),
        ("contact_area", "Contact width" if line else "Contact area"),
    )
    with paper_style():
        figure = new_figure(6.6, 4.6)
        panels = figure.subplots(2, 2, sharex=True)
        for n, (axes, (name, quantity)) in enumerate(zip(panels.ravel(), shown, strict=True)):
            numbers = np.asarray(dataset[name].values, dtype=float)[steps]
            scale = scale_for(numbers, si_unit(dataset, name))
            stride = max(1, -(-steps.size // MARKERS))
            axes.plot(at, scale(numbers), "o-", color=COLOURS[n], markevery=stride)
            errors = history_errors(dataset, name)
            if errors is not None:
                draw_band(axes, at, numbers, errors[steps], scale, COLOURS[n])
                axes.legend()
            axes.set_ylabel(f"{quantity} [{scale.unit}]")
            axes.set_ylim(bottom=0.0)
            axes.margins(x=0.02)
        for axes in panels[1]:
            axes.set_xlabel(f"{words} [{along.unit}]" if along.unit else words)
            axes.xaxis.get_major_locator().set_params(integer=not along.unit)
        if "wear_error" in dataset and float(dataset["wear_error"][-1]) > 0:
            error = 100 * float(dataset["wear_error"][-1])
            figure.suptitle(f"Wear (estimated error of the volume {error:.2g} %)")
    return figure


def _worn_steps(dataset: Results, course_values: NDArray[np.float64]) -> NDArray[np.intp]:
    """Positions along ``step``: the last step with a contact at each place of the course, of cycles their ends."""
    steps = ends_of_cycles(dataset)
    pressed = np.asarray(dataset["max_pressure"].values)[steps] > 0
    chosen = []
    for value in np.unique(course_values[steps]):
        alike = course_values[steps] == value
        chosen.append(steps[alike & pressed][-1] if np.any(alike & pressed) else steps[alike][-1])
    return np.array(chosen, dtype=np.intp)


def loop_cycles(dataset: Results) -> list[SolvedCycle]:
    """Solved cycles whose loops are drawn: the first, the last, some between at even ratios of numbers."""
    cycles = cycles_with_loops(dataset)
    if len(cycles) < 2:
        return []
    numbers = np.log([cycle.cycle_count for cycle in cycles])
    even = np.linspace(numbers[0], numbers[-1], LOOPS)
    return [cycles[n] for n in np.unique(np.abs(numbers[:, None] - even).argmin(axis=0))]


def worn_loops(dataset: Results) -> Figure:
    """Loops of selected cycles drawn over each other, coloured by the number of cycles."""
    mode = driven(dataset)[0]
    load, displacement, words = MODES[mode]
    forces, displacements = (np.asarray(dataset[name].values, dtype=float) for name in (load, displacement))
    force, length = scale_for(forces, si_unit(dataset, load)), scale_for(displacements, si_unit(dataset, displacement))
    with paper_style():
        figure = new_figure(5.4, 3.6)
        axes = figure.add_subplot()
        axes.axhline(0.0, color="0.75", linewidth=0.6, zorder=0)
        axes.axvline(0.0, color="0.75", linewidth=0.6, zorder=0)
        strands = strands_of(loop_cycles(dataset))
        draw_strands(figure, axes, length(displacements), force(forces), strands, "Cycle", markers=False)
        axes.set(xlabel=f"{words[1]} [{length.unit}]", ylabel=f"{words[0]} [{force.unit}]")
        axes.set_title("Loops of solved cycles")
    return figure
