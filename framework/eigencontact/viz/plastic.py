"""Pictures of bodies that yield: plastic strain on a section, in space and through the history, load against depth."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact.viz.contours import draw_sides
from eigencontact.viz.errors import draw_band, history_errors, with_error
from eigencontact.viz.frame import draw_way
from eigencontact.viz.history import first_touch
from eigencontact.viz.outline import draw_segments, inclusion_segments
from eigencontact.viz.remembered import DAMAGE, SHARE, STRAIN, CellField, draw_zone, zone_field
from eigencontact.viz.style import (
    COLOURS,
    Scale,
    colour_bar,
    draw_cross,
    heading,
    is_line,
    label_plane,
    new_figure,
    paper_style,
    place,
    plane_figure,
    scale_for,
    si_unit,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from eigencontact.results.stored import Results
    from eigencontact.viz.frame import Frame

__all__ = [
    "load_depth",
    "loaded_step",
    "plastic_history",
    "plastic_section",
    "plastic_surfaces",
    "surface_of",
    "unloads",
]

#: A load that falls by more than this part of the largest is unloading.
FALL = 1e-3
#: Room around the plastic zone, as a part of its larger side.
ROOM = 0.25
#: Plastic strain is shown in percent.
PERCENT = 100.0
#: Colour of what has not yielded.
ELASTIC = "0.93"
PLASTIC = "Equivalent plastic strain [%]"
#: Name and line of a load that rises, falls or is held.
_WAYS: dict[int, tuple[str, dict[str, Any]]] = {
    1: ("loading", {"color": COLOURS[0], "linestyle": "-", "marker": "o"}),
    -1: ("unloading", {"color": COLOURS[1], "linestyle": "--", "marker": "s"}),
    0: ("load held", {"color": COLOURS[2], "linestyle": "-.", "marker": "^"}),
}
#: Part by which loads of steps may differ and count as one.
SAME_LOAD = 1e-5
#: Shares of the largest strain whose surfaces are drawn, and how well one sees through them.
SHARES = ((0.02, 0.16), (0.25, 0.35), (0.75, 0.9))


def loaded_step(dataset: Results) -> int:
    """Position of the last step; where nothing presses in the last, of the largest load, normal before tangential."""
    if "pressure" not in dataset or np.any(dataset["pressure"][-1].values != 0):
        return -1
    normal = np.asarray(dataset["normal_load"].values, dtype=float)
    names = [name for name in ("tangential_load_x", "tangential_load_y") if name in dataset]
    pull = np.linalg.norm([np.zeros_like(normal), *(dataset[name].values for name in names)], axis=0)
    pull[normal < (1 - SAME_LOAD) * normal.max()] = -1.0
    return int(np.flatnonzero(pull >= (1 - SAME_LOAD) * pull.max())[0])


def unloads(dataset: Results) -> bool:
    """Whether the load falls from its largest value."""
    if not {"normal_load", "approach"} <= set(dataset.data_vars):
        return False
    loads = np.asarray(dataset["normal_load"].values, dtype=float)
    return bool(np.any(np.diff(loads) < -FALL * loads.max(initial=0.0)))


def load_depth(dataset: Results, step: int = -1, on: Frame | None = None) -> Figure:
    """Normal load over approach from the first touch, with distinct loading, unloading and constant load.

    The title gives the largest approach, and that of the last step where it has no load. Faint dots join the two ends
    of an unloading in one increment, between which nothing was computed.
    """
    loads, depths = (np.asarray(dataset[name].values, dtype=float) for name in ("normal_load", "approach"))
    last = len(loads) - 1 if on is None else step % len(loads)
    largest, residual, unloaded = (
        float(depths[: last + 1].max()),
        float(depths[last]),
        loads[last] <= FALL * loads.max(),
    )
    touch, errors = first_touch(dataset), history_errors(dataset, "approach") if on is None else None
    if touch is not None:
        loads, depths, last = np.append(0.0, loads), np.append(touch, depths), last + 1
        errors = None if errors is None else np.append(0.0, errors)
    force, length = scale_for(loads, si_unit(dataset, "normal_load")), scale_for(depths, "m")
    with paper_style():
        figure = new_figure(4.4, 3.2, on)
        axes = figure.add_subplot()
        if on is not None:
            draw_way(axes, length(depths), force(loads), last, line=False)
        labelled: set[str] = set()
        for first, end, direction in _runs(loads[: last + 1]):
            name, style = _WAYS[direction]
            if end - first == 1 and direction < 0:
                style = {**style, "linestyle": ":", "linewidth": 0.8}
            branch = slice(first, end + 1)
            label = None if name in labelled else name
            axes.plot(length(depths[branch]), force(loads[branch]), label=label, **style)
            if errors is not None:
                band = (depths[branch], errors[branch], length, style["color"])
                draw_band(axes, force(loads[branch]), *band, across=True)
            labelled.add(name)
        depths_in_title = f"largest {length.text(largest)}"
        if last > 0 and unloaded:
            depths_in_title += f", {scale_for([residual], 'm').text(residual)} after unloading"
        axes.set(xlabel=f"Approach [{length.unit}]", ylabel=f"Normal load [{force.unit}]")
        axes.set_title(f"Load and depth\n{depths_in_title}")
        axes.set_xlim(left=min(0.0, 1.05 * float(length(depths.min()))))
        axes.set_ylim(bottom=0.0)
        if labelled:
            entries = dict(zip(*axes.get_legend_handles_labels()[::-1], strict=True))
            axes.legend(entries.values(), entries.keys(), loc="upper left")
    return figure


def _runs(loads: NDArray[np.float64]) -> list[tuple[int, int, int]]:
    """First and last point of each part of a history with rising (1), falling (-1) or constant (0) load."""
    if loads.size < 2:
        return []
    change = np.diff(loads)
    directions = np.where(np.abs(change) > FALL * np.abs(loads).max(), np.sign(change), 0.0).astype(int)
    ends = [0, *(np.flatnonzero(directions[1:] != directions[:-1]) + 1).tolist(), directions.size]
    return [(first, end, int(directions[first])) for first, end in pairwise(ends)]


def plastic_section(
    dataset: Results, field: CellField, step: int = -1, labels: tuple[str, str] = ("Plastic strain", PLASTIC)
) -> Figure:
    """Plastic strain or damage of one body on the section normal to y through its largest value, and its zone.

    Filled contours between the middles of cells, equal scales, z downwards. The labels are the name of the number in
    the title, and beside its colours; it is given in per cent.
    """
    from matplotlib import colormaps
    from matplotlib.colors import BoundaryNorm, ListedColormap
    from matplotlib.ticker import MaxNLocator

    top, at = field.largest
    section = zone_field(dataset, field, "y", at["y"], step)
    assert section is not None
    (x, z), values, sides = section
    inside = values > SHARE * top
    rows, columns = (np.flatnonzero(inside.any(axis=axis)) for axis in (1, 0))
    room = ROOM * max(float(x[columns[-1]] - x[columns[0]]), float(z[rows[-1]]), field.edge("x"))
    left, right, deep = float(x[columns[0]]) - room, float(x[columns[-1]]) + room, float(z[rows[-1]]) + room
    length = scale_for([left, right, deep], "m")
    with paper_style():
        figure, axes, wide = plane_figure(right - left, deep)
        axes.set_aspect("equal")
        levels = np.asarray(MaxNLocator(nbins=14).tick_values(0.0, PERCENT * top))
        levels = np.concatenate([[0.0, PERCENT * SHARE * top], levels[levels > PERCENT * SHARE * top]])
        if labels[1] != PLASTIC:  # parts of a whole
            levels = np.unique(np.minimum(levels, PERCENT))
        cmap = ListedColormap([ELASTIC, *colormaps["viridis"](np.linspace(0.0, 1.0, len(levels) - 2))])
        norm = BoundaryNorm(levels, cmap.N)
        axes.set_ylim(float(length(deep)), 0.0)
        segments = inclusion_segments(dataset, field.body, "y", at["y"])
        filled = draw_sides(axes, (x, z), PERCENT * values, sides, length=length, levels=levels, cmap=cmap, norm=norm)
        axes.set_facecolor(ELASTIC)
        draw_segments(axes, segments, length)
        draw_zone(axes, dataset, field, ("y", at["y"]), length, step)
        draw_cross(axes, (length(at["x"]), length(at["z"])), (9, 9 / 3.5 - 0.6), (7, 1.4), zorder=5)
        axes.set_xlim(length([left, right]))
        axes.set_ylim(float(length(deep)), 0.0)
        label_plane(axes, f"x [{length.unit}]", f"z [{length.unit}]")
        colour_bar(figure, axes, filled, labels[1], wide=wide, shrink=0.8, ticks=[0.0, *levels[2::2]])
        title = heading(dataset, step, f"{labels[0]} in body {field.body}")
        where = ", ".join(place(axis, at[axis]) for axis in "xyz")
        title = f"{title}\n{PERCENT * top:.3g} % at {where} (cross)"
        variable = f"{STRAIN if labels[1] == PLASTIC else DAMAGE}_{field.body}"
        axes.set_title(with_error(title, dataset, variable, step))
    return figure


def plastic_history(dataset: Results, prefix: str) -> Figure:
    """Largest plastic strain, plastic volume, and increment of the strain, over the number of the step.

    Parameters
    ----------
    prefix : str
        Of the numbers of that observer.
    """
    step = np.asarray(dataset["step"].values)
    strain = np.asarray(dataset[f"{prefix}_max_strain"].values, dtype=float)
    volume = np.asarray(dataset[f"{prefix}_volume"].values, dtype=float)
    name, unit = ("area", "m2") if is_line(dataset) else ("volume", "m3")
    size = scale_for([float(volume.max(initial=0.0))], unit)
    with paper_style():
        figure = new_figure(6.6, 2.8)
        label = f"{name.capitalize()} [{size.unit}]"
        curves = (
            ("max_strain", strain, PERCENT, "o-", "Equivalent plastic strain [%]", "Largest plastic strain"),
            ("volume", volume, size.factor, "s-", label, f"Plastic {name}"),
        )
        panels = zip(figure.subplots(1, 2), curves, strict=True)
        for n, (axes, (name, values, factor, style, label, title)) in enumerate(panels):
            axes.plot(step, factor * values, style, color=COLOURS[n], markevery=max(1, step.size // 30))
            errors = history_errors(dataset, f"{prefix}_{name}")
            if errors is not None:
                draw_band(axes, step, values, errors, Scale(factor, ""), COLOURS[n])
                axes.legend()
            axes.set(xlabel="Step", ylabel=label, title=title)
            axes.set_ylim(bottom=0.0)
            axes.margins(x=0.02)
            axes.xaxis.get_major_locator().set_params(integer=True)
    return figure


def plastic_surfaces(dataset: Results, field: CellField, step: int = -1) -> Figure:
    """Surfaces of equal equivalent plastic strain of one body, cut open at the plane through the largest strain.

    The half behind that plane, normal to y, z downwards, equal scales.
    """
    from matplotlib import colormaps
    from matplotlib.colors import LightSource
    from matplotlib.patches import Patch
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    top, at = field.largest
    length = scale_for([float(np.abs(places).max()) for places in field.axes.values()], "m")
    with paper_style():
        figure = new_figure(5.0, 3.8)
        axes: Any = figure.add_subplot(projection="3d")
        corners, legend = [], []
        for share, opacity in SHARES:
            triangles = surface_of(field, share * top, at["y"])
            if not triangles.size:
                continue
            colour = colormaps["viridis"](0.1 + 0.85 * share)
            light = LightSource(azdeg=225, altdeg=50)
            faces = Poly3DCollection(
                length(triangles),
                facecolors=colour,
                edgecolors=colour,
                linewidths=0,
                alpha=opacity,
                shade=True,
                lightsource=light,
            )
            axes.add_collection3d(faces)
            corners.append(triangles.reshape(-1, 3))
            legend.append(Patch(facecolor=colour, label=f"{PERCENT * share * top:.2g} %"))
        ends = np.concatenate(corners)
        low, high = length(ends.min(axis=0)), length(ends.max(axis=0))
        low[2] = 0.0
        axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(high[2], low[2]))
        axes.set_box_aspect(high - low, zoom=0.85)
        axes.view_init(elev=24, azim=-68)
        for axis in "xyz":
            getattr(axes, f"set_{axis}label")(f"{axis} [{length.unit}]")
            getattr(axes, f"{axis}axis").get_major_locator().set_params(nbins=4 if axis == "y" else 5)
        axes.set_title(heading(dataset, step, f"Equal plastic strain in body {field.body}"))
        figure.legend(handles=legend, loc="outside right upper", title="equivalent\nplastic strain", title_fontsize=8)
    return figure


def surface_of(field: CellField, value: float, y: float) -> NDArray[Any]:
    """Triangles ``(n, 3, 3)`` [m] of the surface of a value, behind a plane normal to y."""
    import pyvista as pv

    values = np.pad(field.values, 1)
    if field.axes["z"][0] < 0.75 * field.edge("z"):  # up to the surface
        values[0] = values[1]
    axes = {axis: np.pad(places, 1) for axis, places in field.axes.items()}
    for axis, places in axes.items():
        places[0], places[-1] = places[1] - field.edge(axis), places[-2] + field.edge(axis)
    axes["z"][0] = max(axes["z"][0], 0.0)
    edge = max(field.edge(axis) for axis in "xyz")  # lengths of micrometres are too small for the filters
    grid: Any = pv.RectilinearGrid(*(axes[axis] / edge for axis in "xyz"))
    grid.point_data["strain"] = values.ravel()
    mesh = grid.contour([value], scalars="strain")
    if mesh.n_points:
        mesh = mesh.clip("-y", origin=(0.0, y / edge, 0.0)).triangulate()
    if not mesh.n_points:
        return np.empty((0, 3, 3))
    faces = np.asarray(mesh.faces).reshape(-1, 4)[:, 1:]
    return np.asarray(np.asarray(mesh.points, dtype=float)[faces] * edge)
