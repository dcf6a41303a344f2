"""Pictures of the history of a contact with friction: loops of load and displacement, time strip of stick and slip."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact.core.bulk import BULK_NAMES, IN_PLANE
from eigencontact.core.grid import Box
from eigencontact.results.cycles import friction_work, last_cycle
from eigencontact.viz.frame import draw_way
from eigencontact.viz.friction import MODES, ZONE_COLOURS, ZONES, driven, history_of
from eigencontact.viz.history import Strand, draw_strands, varies
from eigencontact.viz.lines import SurfaceLine, surface_line_at
from eigencontact.viz.style import COLOURS, new_figure, paper_style, place, scale_for, si_unit
from eigencontact.viz.window import class_patches, is_ragged, view_of
from eigencontact.viz.worn import solved_cycles

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from eigencontact.results.cycles import Cycle
    from eigencontact.results.stored import Results
    from eigencontact.viz.frame import Frame
    from eigencontact.viz.worn import SolvedCycle

__all__ = ["cycles_with_loops", "fretting_loops", "is_a_loop", "strands_of", "zone_strip", "zones_of_line"]

#: With more steps than this, only some carry a marker.
MARKERS = 60
#: Fewer increments than this are no loop.
LOOP_STEPS = 3
#: With more steps than this the last cycle alone is dark.
LONG_HISTORY = 250
#: Entries of a legend that fit in one row.
_ENTRIES = 5
#: Area of the polygon through the increments less the work of friction, relative, above which it is said: loops of 24
#: increments and more in partial slip stay below it.
_COARSE = 0.02


def is_a_loop(dataset: Results) -> bool:
    """Whether load and tangential displacement close a cycle, or cycles are drawn over each other."""
    history, motions = history_of(dataset), driven(dataset)
    closed = any(last_cycle(history, "twist" if motion == "twist" else "shift") for motion in motions)
    return closed or len(cycles_with_loops(dataset)) > 1


def fretting_loops(dataset: Results, step: int = -1, on: Frame | None = None) -> Figure:
    """Tangential load over shift, torsion moment over twist, through all steps; cycles in the colours of their numbers.

    One panel for each loop. The last closed cycle is tinted; the title has its work of friction, and says where the
    increments are too coarse for the area of the drawn loop to be that work. An open circle marks the first step that
    is dark: of long histories that is the last cycle, else all.
    """
    modes = driven(dataset)
    with paper_style():
        figure = new_figure(3.5 * len(modes) + (1.3 if len(modes) == 1 else 0.3), 3.4, on)
        for axes, mode in zip(figure.subplots(1, len(modes), squeeze=False)[0], modes, strict=True):
            load, displacement, labels = MODES[mode]
            forces, displacements = (np.asarray(dataset[name].values, dtype=float) for name in (load, displacement))
            cycle = last_cycle(history_of(dataset), "twist" if mode == "twist" else "shift")
            scales = scale_for(displacements, si_unit(dataset, displacement)), scale_for(forces, si_unit(dataset, load))
            if on is None:
                _loop(
                    figure,
                    axes,
                    scales[0](displacements),
                    scales[1](forces),
                    cycle,
                    strands_of(cycles_with_loops(dataset)),
                )
            else:
                draw_way(axes, scales[0](displacements), scales[1](forces), step)
            axes.set(xlabel=f"{labels[1]} [{scales[0].unit}]", ylabel=f"{labels[0]} [{scales[1].unit}]")
        title = _energy_words(dataset, modes) if on is None else _spent_words(dataset, step)
        figure.suptitle(title)
    return figure


def cycles_with_loops(dataset: Results) -> list[SolvedCycle]:
    """Solved cycles with enough increments for a loop."""
    if not driven(dataset):
        return []
    return [cycle for cycle in solved_cycles(dataset) if cycle.last - cycle.first + 1 >= LOOP_STEPS]


def strands_of(cycles: Sequence[SolvedCycle]) -> list[Strand]:
    """Curve of each cycle, from the end of the previous solved cycle."""
    return [Strand(max(cycle.first - 1, 0), cycle.last, cycle.cycle_count) for cycle in cycles]


def _loop(
    figure: Figure, axes: Axes, x: NDArray[Any], y: NDArray[Any], cycle: Cycle | None, strands: list[Strand]
) -> None:
    axes.axhline(0.0, color="0.75", linewidth=0.6, zorder=0)
    axes.axvline(0.0, color="0.75", linewidth=0.6, zorder=0)
    is_long = cycle is not None and x.size > LONG_HISTORY
    if cycle is not None:
        loop = slice(cycle.first, cycle.last + 1)
        axes.fill(x[loop], y[loop], color=COLOURS[0], alpha=0.15, linewidth=0, zorder=1)
    if cycle is not None and is_long:
        axes.plot(x, y, "-", color="0.75", linewidth=0.4, zorder=0)
        strands = [Strand(cycle.first, cycle.last, 1)]
    elif len(strands) > 1:
        before = slice(0, strands[0].first + 1)
        axes.plot(x[before], y[before], "-", color="0.5", linewidth=0.8)
    else:
        strands = [Strand(0, x.size - 1, 1)]
    draw_strands(figure, axes, x, y, strands, "Cycle")
    start = strands[0].first if is_long else 0
    axes.plot(x[start], y[start], "o", color=COLOURS[0], markerfacecolor="white", markersize=5, zorder=3)


def _energy_words(dataset: Results, modes: list[str]) -> str:
    """Work of friction of the last closed cycle, else of the whole history."""
    twisted = modes == ["twist"]
    cycle = last_cycle(history_of(dataset), "twist" if twisted else "shift")
    if cycle is None:
        return _spent_words(dataset, -1) + (", no closed cycle" if "dissipated_energy" in dataset else "")
    steps = np.asarray(dataset["step"].values)[[cycle.first, cycle.last]]
    sentence = f"Cycle of steps {steps[0]} to {steps[1]}"
    if np.isfinite(cycle.dissipated):
        unit = si_unit(dataset, "dissipated_energy")
        sentence += f": work of friction {scale_for([cycle.dissipated], unit).text(cycle.dissipated)}"
    more = []
    if len(modes) == 1:
        ratio = "4 M\\varphi" if twisted else "4 Q\\delta"
        more.append(f"energy ratio $E/({ratio})$ = {cycle.energy_ratio:.3g}")
    dissipated = cycle.dissipated
    if "plastic_work" in dataset:
        dissipated += float(np.ptp(dataset["plastic_work"].values[[cycle.first, cycle.last]]))
    if abs(cycle.work - dissipated) > _COARSE * abs(dissipated):
        more.append("increments too coarse for the area of the drawn loop")
    return "\n".join(filter(None, [sentence, ", ".join(more)]))


def _spent_words(dataset: Results, step: int) -> str:
    """Work of friction up to a step, in words."""
    work = friction_work(history_of(dataset))
    if work is None:
        return "Load and displacement"
    return f"Work of friction {scale_for([work[step]], si_unit(dataset, 'dissipated_energy')).text(work[step])}"


def zone_strip(dataset: Results) -> Figure:
    """Stick and slip on one line through the contact, step by step, under the course of the loads.

    Below the zones on the line along x through the middle of the contact, or through most of it where it is in patches
    (along y where only that direction is loaded or has cells); above it the loads and bulk stresses, each relative to
    its largest size.
    """
    from matplotlib.colors import BoundaryNorm, ListedColormap
    from matplotlib.ticker import MaxNLocator

    strip, line = zones_of_line(dataset)
    length = scale_for(line.edges, "m")
    steps = np.asarray(dataset["step"].values, dtype=float)
    with paper_style():
        figure = new_figure(6.2, 3.7)
        above, below = figure.subplots(2, 1, sharex=True, height_ratios=(1, 2.4))
        below.pcolormesh(
            np.append(steps - 0.5, steps[-1] + 0.5), length(line.edges), strip.T,
            cmap=ListedColormap(ZONE_COLOURS), norm=BoundaryNorm([-0.5, 0.5, 1.5, 2.5], 3), rasterized=True,
        )  # fmt: skip
        below.set(xlabel="Step", ylabel=f"{line.along} [{length.unit}]")
        below.xaxis.set_major_locator(MaxNLocator(integer=True))
        _courses(above, dataset, steps)
        above.set_title(f"Stick and slip along {line.along} at {place(line.normal, line.across)}")
        present = [value for value in (2, 1, 0) if np.any(strip == value)]
        patches = class_patches((ZONE_COLOURS[value], ZONES[value]) for value in present)
        handles, _ = above.get_legend_handles_labels()
        entries = [*handles, *patches]
        columns = len(entries) if len(entries) <= _ENTRIES else -(-len(entries) // 2)
        figure.legend(handles=entries, loc="outside lower center", ncols=columns)
    return figure


def zones_of_line(dataset: Results) -> tuple[NDArray[np.intp], SurfaceLine]:
    """Zones (steps, n) on the line of `zone_strip`, and the line."""
    zones = np.rint(np.asarray(dataset["contact_zone"].values, dtype=float)).astype(int)
    touched = (zones > 0).any(axis=0)
    along = "y" if driven(dataset) == ["y"] or dataset.sizes["x"] == 1 else "x"
    box = Box.around(touched) or Box(0, touched.shape[0], 0, touched.shape[1])
    cell = ((box.y0 + box.y1) // 2, (box.x0 + box.x1) // 2)
    if is_ragged(touched):  # patches: the line that meets most of them
        cell = (int(np.argmax(touched.sum(axis=1))), int(np.argmax(touched.sum(axis=0))))
    line = surface_line_at(dataset, along, cell, view_of(touched))
    return zones[(slice(None), *line.where)], line


def _courses(axes: Axes, dataset: Results, steps: NDArray[Any]) -> None:
    """Draw the loads and bulk stresses that change over the steps, relative to their largest size in the legend."""
    symbols = {"x": "$Q_x$", "y": "$Q_y$", "twist": "$M_z$"}
    curves = [("normal_load", "$P$", "0.35", ":")]
    curves += [(MODES[mode][0], symbols[mode], COLOURS[n], "-") for n, mode in enumerate(driven(dataset))]
    curves += [
        (name, f"$\\sigma_{{{component}{body if body > 1 else ''}}}$", COLOURS[body + 2], style)
        for body, names in BULK_NAMES.items()
        for name, component, style in zip(names, IN_PLANE, ("--", "-.", ":"), strict=True)
        if name in dataset
    ]
    for name, symbol, colour, style in curves:
        values = np.asarray(dataset[name].values, dtype=float)
        largest = float(np.abs(values).max())
        if largest == 0 or not varies(values):  # a constant course is a line at 1
            continue
        word = f"{symbol} (largest {scale_for([largest], si_unit(dataset, name)).text(largest)})"
        marker = "o" if len(steps) <= MARKERS else ""
        axes.plot(
            steps, values / largest, style, label=word, marker=marker, markersize=2.4, linewidth=1.0, color=colour
        )
    axes.axhline(0.0, color="0.75", linewidth=0.6, zorder=0)
    low, high = axes.get_ylim()
    axes.set_ylim(min(low, -0.1), max(high, 1.15))
    axes.set_ylabel("Load / max.")
