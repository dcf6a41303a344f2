"""Pictures of one step of a contact with friction: shear over stick and slip, work of friction, profiles of shear."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact.core.grid import Box
from eigencontact.results.course import driven_motions
from eigencontact.results.cycles import friction_work, skips_cycles
from eigencontact.viz.errors import draw_band, errors_of, with_error
from eigencontact.viz.lines import contact_middle, drawn_once, legend_of_panels, line_figure, lines_through, runs_of
from eigencontact.viz.looks import legend_below
from eigencontact.viz.style import COLOURS, instant, paper_style, scale_for, si_unit
from eigencontact.viz.window import class_patches, contact_window, draw_classes, is_ragged, masked_map, view_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from eigencontact.results.stored import Results
    from eigencontact.viz.frame import Frame

__all__ = [
    "MODES",
    "ZONES",
    "ZONE_COLOURS",
    "dissipation_map",
    "dissipation_profile",
    "driven",
    "friction_heading",
    "history_of",
    "shear_map",
    "shear_profiles",
    "tint_stick",
]

#: Arrows across the longer side of the contact, about.
ARROWS = 13
#: Arrows across the longer side of a contact in patches, about.
FEWER = 14
#: Arrows of a contact in patches are this many times longer.
LONGER = 1.5
#: With more cells than this along a profile, only some carry a marker.
MARKERS = 64
#: Components below this part of the largest shear on the lines are not drawn.
_NEGLIGIBLE = 0.05
#: Values of the field ``contact_zone`` are positions in these.
ZONES = ("open", "slip", "stick")
#: Grey, and light tints of orange and blue that the colour-blind tell apart.
ZONE_COLOURS = ("#EDEDED", "#F5C26B", "#8DBFE0")
#: By direction: load, displacement, words for both.
MODES = {
    "x": ("tangential_load_x", "shift_x", ("Tangential load $Q_x$", "Shift $\\delta_x$")),
    "y": ("tangential_load_y", "shift_y", ("Tangential load $Q_y$", "Shift $\\delta_y$")),
    "twist": ("torsion_moment", "twist", ("Torsion moment $M_z$", "Twist $\\varphi_z$")),
}


def shear_map(dataset: Results, step: int = -1, on: Frame | None = None) -> Figure:
    """Shear traction on body 1 as arrows over stick and slip; in a film arrows are of one scale in all frames.

    Cut to the contact. Every few cells carry an arrow, centred on the cell; its length is the shear of that cell. Where
    the contact is in patches, the arrows are on the cells of largest shear, with some distance between them.
    """
    zone = np.rint(_field(dataset, "contact_zone", step)).astype(int)
    touched = zone > 0 if on is None else on.film.touched("contact_zone")
    window = contact_window(dataset, touched)
    zones = zone[window.view.slices]
    with paper_style():
        figure, axes, _ = window.axes_of_map(on, bar=False)
        draw_classes(axes, window, zones, ZONE_COLOURS)
        window.label(axes)
        window.outline(axes, zones > 0)
        if np.any(zones) or on is not None:  # frames keep their layout where the contact is lost
            key = _arrows(axes, dataset, step, zone, window, on)
            counts = [np.count_nonzero(zones == value) / (np.count_nonzero(zones) or 1) for value in (2, 1)]
            patches = class_patches(
                (ZONE_COLOURS[value], f"{ZONES[value]}{f', {100 * share:.3g} %' if share < 1 else ' everywhere'}")
                for value, share in zip((2, 1), counts, strict=True)
                if share > 0 or on is not None
            )
            entries = [*patches, *key]
            legend_below(figure, entries, [str(entry.get_label()) for entry in entries], len(entries))
        if not np.any(zones):
            axes.text(0.5, 0.5, "no contact", transform=axes.transAxes, ha="center", va="center", color="0.4")
        axes.set_title(friction_heading(dataset, step, "Shear traction"))
    return figure


def _arrows(axes: Axes, dataset: Results, step: int, zone: NDArray[Any], window: Any, on: Frame | None) -> list[Any]:
    """Draw arrows on some cells; returns an entry of the legend with the value of the longest arrow."""
    from matplotlib.lines import Line2D

    loaded = zone > 0
    box = Box.around(loaded if on is None else on.film.touched("contact_zone"))
    assert box is not None
    q = [_field(dataset, f"shear_{axis}", step) for axis in "xy"]
    size = np.hypot(*q)
    x, y = (window.length(np.asarray(dataset[axis].values, dtype=float)) for axis in "xy")
    ragged = is_ragged(loaded)
    cells = max(1, round(max(box.shape) / (FEWER if ragged else ARROWS)))
    if ragged:
        row, column = _strongest(size * loaded, cells)
    else:
        rows, columns = (_thinned(low, side, cells) for low, side in zip((box.y0, box.x0), box.shape, strict=True))
        row, column = (index.ravel() for index in np.meshgrid(rows, columns, indexing="ij"))
    longest = float(size[row, column].max(initial=0.0))
    full = longest
    if on is not None:
        full = max(float(np.abs(on.film.limits(f"shear_{axis}")).max()) for axis in "xy" if f"shear_{axis}" in dataset)
    visible = size[row, column] > 1e-2 * full
    row, column = row[visible], column[visible]
    if longest == 0:
        return []
    edges = [float(at[1] - at[0]) for at in (x, y) if at.size > 1]
    reach = 0.95 * cells * min(edges) if edges else 0.5 * float(np.ptp(window.extent[:2]))
    pointed: dict[str, Any] = {
        "headwidth": 3.2, "headlength": 3.4, "headaxislength": 3.1, "minshaft": 1.4, "minlength": 0.4,
    }  # fmt: skip
    if ragged:  # arrows stand alone on spots of any size: longer, and light around, so that they show beside the spots
        reach *= LONGER
        pointed |= {"edgecolor": "white", "linewidth": 0.5}
    axes.quiver(
        x[column], y[row], *(component[row, column] / full * reach for component in q),
        angles="xy", scale_units="xy", scale=1.0, pivot="middle", facecolor="0.1", width=0.0052 if ragged else 0.0042,
        zorder=4, **pointed,
    )  # fmt: skip
    word = f"longest arrow: {scale_for([longest], 'Pa').text(longest)}"
    return [Line2D([], [], color="0.1", marker=r"$\rightarrow$", linestyle="", markersize=11, label=word)]


def _thinned(low: int, side: int, spacing: int) -> NDArray[np.int_]:
    """Evenly spaced cells along one side of the contact, with equal room at both ends where possible."""
    return np.arange(low + ((side - 1) % spacing) // 2, low + side, spacing)


def _strongest(size: NDArray[Any], distance: int) -> tuple[NDArray[Any], NDArray[Any]]:
    """Cells with the largest values, at a minimum distance in cells."""
    row, column = np.nonzero(size)
    order = np.argsort(-size[row, column], kind="stable")
    free = np.ones(size.shape, dtype=bool)
    cells = []
    for m, n in zip(row[order].tolist(), column[order].tolist(), strict=True):
        if free[m, n]:
            cells.append((m, n))
            free[max(0, m - distance + 1) : m + distance, max(0, n - distance + 1) : n + distance] = False
    rows, columns = np.array(cells, dtype=int).reshape(-1, 2).T
    return rows, columns


def dissipation_map(dataset: Results, step: int = -1) -> Figure:
    """Work of friction for each area up to a step, with the outline of the contact of that step.

    Where cycles are skipped the map is that of the solved increments, as its title says, beside the work in all.
    """
    density = _density(dataset, step)
    contact = _field(dataset, "contact_zone", step) > 0.5
    return masked_map(
        contact_window(dataset, contact | (density > 0)),
        density,
        unit="J/m2",
        label="Dissipated energy",
        title=_dissipation_title(dataset, step),
        outline=contact,
        empty="no slip",
    )


def dissipation_profile(dataset: Results, step: int = -1) -> Figure:
    """Work of friction for each area up to a step along x, for line contacts; the stick zone is tinted."""
    density, zone = _density(dataset, step), _field(dataset, "contact_zone", step)
    view = view_of((zone > 0.5) | (density > 0))
    (line,) = lines_through(dataset, (0, 0), view)
    work = scale_for(density, "J/m2")
    with paper_style():
        figure = line_figure(1, 2.9)
        axes, length = figure.add_subplot(), scale_for(line.edges, "m")
        tint_stick(axes, zone[line.where], length(line.edges))
        stride = max(1, -(-line.at.size // MARKERS))
        axes.plot(length(line.at), work(density[line.where]), "o-", color=COLOURS[0], markevery=stride)
        errors = errors_of(dataset, "dissipated_energy_density", step)
        if errors is not None:
            draw_band(axes, length(line.at), density[line.where], errors[line.where], work, COLOURS[0])
        line.finish(axes, length, _field(dataset, "pressure", step))
        axes.set_xlim(*length(line.edges[[0, -1]]))
        axes.set_ylim(bottom=0.0)
        axes.set(ylabel=f"Dissipated energy [{work.unit}]")
        legend_of_panels(figure, [axes], str)
        figure.suptitle(_dissipation_title(dataset, step))
    return figure


def _density(dataset: Results, step: int) -> NDArray[Any]:
    """Work of friction per area, without values of the size of the solver's error."""
    density = _field(dataset, "dissipated_energy_density", step)
    return np.where(density > 1e-6 * density.max(), density, 0.0)


def _dissipation_title(dataset: Results, step: int) -> str:
    """Title with the work in all."""
    history = history_of(dataset)
    skips, work = skips_cycles(history), friction_work(history)
    title = friction_heading(dataset, step, f"Work of friction {'in the solved increments' if skips else 'so far'}")
    if work is not None:
        unit = si_unit(dataset, "dissipated_energy")
        title += f"\n{scale_for([work[step]], unit).text(work[step])} in all"
    if work is not None and skips:
        energy = float(history["dissipated_energy"][step])
        words = scale_for([energy], si_unit(dataset, "dissipated_energy")).text(energy)
        title += f", with skipped cycles; {words} in the solved increments"
    return with_error(title, dataset, "dissipated_energy_density", step)


def shear_profiles(dataset: Results, step: int = -1) -> Figure:
    """Shear traction of one step along x and along y, between the bounds that the friction law sets.

    The lines pass through the middle of the contact; where it is in patches, through the cell of largest pressure.
    Faint lines are the ends of the contact. Components that are small on both lines are left out.

    One panel along x, one along y; the stick zone on the line is tinted.

    Parameters
    ----------
    dataset : Results
        Results of a run with friction; ``shear_bound`` and the closed form ``reference_shear_x``,
        ``reference_shear_y`` are drawn where they are stored.
    """
    pressure, zone = (_field(dataset, name, step) for name in ("pressure", "contact_zone"))
    bound = _optional(dataset, "shear_bound", step)
    row, column, central = contact_middle(pressure)
    lines = lines_through(dataset, (row, column), view_of(zone > 0.5), central=central)
    shear = {axis: _field(dataset, f"shear_{axis}", step) for axis in "xy"}
    sizes = {axis: max(float(np.abs(q[line.where]).max()) for line in lines) for axis, q in shear.items()}
    references = {axis: _optional(dataset, f"reference_shear_{axis}", step) for axis in "xy"}
    least_shown = _NEGLIGIBLE * max(sizes.values())
    components = [axis for axis in "xy" if sizes[axis] > least_shown]
    curves = [*(shear[axis] for axis in components), *(references[axis] for axis in components), bound]
    lines = drawn_once(dataset, lines, [curve for curve in curves if curve is not None])
    limit = 0.0 if bound is None else max(float(bound[line.where].max()) for line in lines)
    stress = scale_for([limit, *sizes.values()], "Pa")
    least = min(float(q[line.where].min()) for q in shear.values() for line in lines)
    signs = (1, -1) if least < -_NEGLIGIBLE * limit else (1,)
    with paper_style():
        figure = line_figure(len(lines), 3.1)
        panels = figure.subplots(1, len(lines), sharey=True, squeeze=False)[0]
        for axes, line in zip(panels, lines, strict=True):
            length = scale_for(line.edges, "m")
            at = length(line.at)
            tint_stick(axes, zone[line.where], length(line.edges))
            if bound is not None:
                for sign in signs:
                    label = "friction bound" if sign == 1 else "_"
                    axes.plot(at, sign * stress(bound[line.where]), color="0.75", lw=3.0, label=label)
            for axis, reference in references.items():
                values = shear[axis][line.where]
                if np.abs(values).max() <= least_shown:
                    continue
                colour, label = COLOURS["xy".index(axis)], f"$q_{axis}$"
                axes.plot(
                    at, stress(values), "o-", color=colour, markevery=max(1, -(-at.size // MARKERS)),
                    markersize=2.8, linewidth=0.7, markerfacecolor="white", markeredgewidth=0.8, label=label, zorder=3,
                )  # fmt: skip
                if reference is not None:
                    error = np.linalg.norm(shear[axis] - reference) / (np.linalg.norm(reference) or np.nan)
                    word = f"{label}, closed form ({100 * error:.2g} % in the L2 norm)"
                    axes.plot(at, stress(reference[line.where]), "--", color="black", lw=1.1, label=word, zorder=4)
                errors = errors_of(dataset, f"shear_{axis}", step)
                if errors is not None:
                    draw_band(axes, at, values, errors[line.where], stress, colour)
            axes.axhline(0.0, color="0.6", linewidth=0.6, zorder=0)
            line.finish(axes, length, pressure)
            axes.set_xlim(*length(line.edges[[0, -1]]))
        panels[0].set_ylabel(f"Shear traction [{stress.unit}]")
        if max(limit, *sizes.values()) == 0:
            panels[0].set_ylim(-1, 1)
        legend_of_panels(figure, panels, str)  # bound, components, stick; closed forms are beside their components
        figure.suptitle(friction_heading(dataset, step, "Shear traction"))
    return figure


def tint_stick(axes: Axes, zone: NDArray[Any], edges: NDArray[Any]) -> None:
    """Stripe behind the cells of a line that stick."""
    for n, ends in enumerate(runs_of(np.rint(zone) == 2, edges)):
        axes.axvspan(*ends, color=ZONE_COLOURS[2], alpha=0.35, linewidth=0, zorder=0, label="stick" if n == 0 else "_")


def _field(dataset: Results, name: str, step: int) -> NDArray[Any]:
    """Surface field of one step; zero where the run leaves its direction out."""
    if name not in dataset:
        return np.zeros((dataset.sizes["y"], dataset.sizes["x"]))
    return np.asarray(dataset[name][step].values, dtype=float)


def _optional(dataset: Results, name: str, step: int) -> NDArray[Any] | None:
    """Surface field of one step, None if it is not stored or not valid."""
    if name not in dataset:
        return None
    values = _field(dataset, name, step)
    return values if np.isfinite(values).all() else None


def history_of(dataset: Results) -> dict[str, NDArray[Any]]:
    """Scalars of all steps by name."""
    scalars = (name for name, variable in dataset.data_vars.items() if variable.dims == ("step",))
    return {str(name): np.asarray(dataset[name].values, dtype=float) for name in scalars}


def driven(dataset: Results) -> list[str]:
    """Driven motions among ``x``, ``y`` and ``twist``; by-products of other loads do not count."""
    return driven_motions(history_of(dataset))


def friction_heading(dataset: Results, step: int, subject: str) -> str:
    """Title of a picture: its subject, the normal load, and the tangential load or torsion moment."""
    loads_in_title = [("normal_load", "P")]
    loads = driven(dataset)
    if set(loads) & {"x", "y"}:
        loads_in_title.append(("tangential_load", "Q"))
    if "twist" in loads:
        loads_in_title.append(("torsion_moment", "M"))
    entries = []
    for name, symbol in loads_in_title:
        values = np.asarray(dataset[name].values, dtype=float)
        value = float(values[step]) if abs(values[step]) > 1e-9 * np.abs(values).max() else 0.0
        entries.append(f"{symbol} = {scale_for([value], si_unit(dataset, name)).text(value)}")
    return f"{subject} at {', '.join(entries)}{instant(dataset, step)}"
