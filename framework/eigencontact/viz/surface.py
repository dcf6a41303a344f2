"""Pictures of the surface: pressure as a map and along two lines, materials, and displacement by eigenstrain.

Colours of displacement are the same in every picture: red where the surface is lifted out of the body, blue where it
sinks, white where it stays.
"""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact.core.grid import Box
from eigencontact.viz.errors import BAND, draw_band, errors_of, with_error
from eigencontact.viz.lines import contact_middle, drawn_once, legend_of_panels, line_figure, lines_through
from eigencontact.viz.outline import draw_outline_below
from eigencontact.viz.style import COLOURS, draw_cross, heading, instant, is_line, lift_colours, paper_style, scale_for
from eigencontact.viz.window import Window, contact_window, masked_map, view_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from eigencontact.results.stored import Results
    from eigencontact.viz.frame import Frame

__all__ = [
    "cause",
    "displacement_profiles",
    "exposed_map",
    "homogeneous_words",
    "pressure_map",
    "pressure_profiles",
    "relative_difference",
    "several_exposed",
    "uplift_map",
]

#: With more cells than this along a profile, only some carry a marker.
MARKERS = 64
#: How much of white is mixed into the colours of materials.
_PALE = 0.55
_NAMES = {"z": "uplift $-u_z$", "x": "$u_x$", "y": "$u_y$"}
_STYLES = {"z": "-", "x": "--", "y": ":"}


def pressure_map(dataset: Results, step: int = -1, on: Frame | None = None) -> Figure:
    """Contact pressure of one step as a map, restricted to the contact with a margin.

    Cells without pressure are grey; the outline of the contact is drawn where it is not ragged, those of inclusions
    below it are dashed.
    """
    pressure = np.asarray(dataset["pressure"][step].values, dtype=float)
    window = contact_window(dataset, pressure != 0 if on is None else on.film.touched("pressure"))
    title = heading(dataset, step, "Contact pressure")
    title = with_error(title, dataset, "pressure", step) if on is None else title  # frames keep their layout
    figure = masked_map(
        window,
        pressure,
        unit="Pa",
        label="Pressure",
        title=title,
        outline=pressure != 0,
        empty="no contact",
        limits=None if on is None else on.film.limits("pressure"),
        on=on,
    )
    draw_outline_below(figure.axes[0], dataset, window.length)
    return figure


def pressure_profiles(dataset: Results, step: int = -1) -> Figure:
    """Contact pressure of one step along x and along y, with the closed form if the run has one.

    Beside a contact with layers, inclusions or eigenstrain it is the closed form without them, under the same load.

    The lines pass through the middle of the contact; where it is in patches, through the cell of largest pressure.
    Markers are computed cells; faint lines are the ends of the contact.

    One panel along x, one along y; only one where the other direction has a single cell.
    """
    pressure = np.asarray(dataset["pressure"][step].values, dtype=float)
    reference = None
    homogeneous = homogeneous_words(dataset)
    if homogeneous or "reference_pressure" in dataset:
        reference = np.asarray(dataset["homogeneous_pressure" if homogeneous else "reference_pressure"][step].values)
        reference = reference if np.isfinite(reference).all() else None
    fields = [pressure] if reference is None else [pressure, reference]
    row, column, central = contact_middle(pressure)
    view = view_of(np.any([field != 0 for field in fields], axis=0))
    stress = scale_for(pressure if reference is None else [pressure.max(), reference.max()], "Pa")
    lines = drawn_once(dataset, lines_through(dataset, (row, column), view, central=central), fields)
    errors = errors_of(dataset, "pressure", step)
    labels = {"computed": "computed cells", "reference": "closed form"}
    if homogeneous and reference is not None:
        labels["reference"] = f"{homogeneous} (closed form)"
    elif reference is not None:
        labels["reference"] = _difference_words(pressure, reference, view)
    if any(line.at.size > MARKERS for line in lines):
        labels["computed"] = "computed cells (not all marked)"
    with paper_style():
        figure = line_figure(len(lines), 2.9)
        panels = figure.subplots(1, len(lines), sharey=True, squeeze=False)[0]
        for axes, line in zip(panels, lines, strict=True):
            length = scale_for(line.edges, "m")
            at = length(line.at)
            if reference is not None:
                style = "--" if homogeneous else "-"
                axes.plot(at, stress(reference[line.where]), style, color=COLOURS[1], label=labels["reference"])
            axes.plot(
                at,
                stress(pressure[line.where]),
                "o" if reference is not None and not homogeneous else "o-",
                color=COLOURS[0],
                markevery=max(1, -(-at.size // MARKERS)),
                markerfacecolor="none" if reference is not None else COLOURS[0],
                markeredgewidth=0.8,
                linewidth=0.8 if homogeneous else None,
                label=labels["computed"],
                zorder=3,
            )
            if errors is not None:
                draw_band(axes, at, pressure[line.where], errors[line.where], stress, COLOURS[0])
            line.finish(axes, length, pressure)
            axes.set_xlim(*length(line.edges[[0, -1]]))
        low = min(0.0, float(pressure.min()))
        high = max(0.0, *(float(field.max()) for field in fields)) or 1.0 / stress.factor
        panels[0].set_ylim(stress(low - 0.025 * (high - low)), stress(high + 0.06 * (high - low)))
        panels[0].set_ylabel(f"Pressure [{stress.unit}]")
        order = [labels["computed"], labels["reference"], BAND].index
        legend_of_panels(figure, panels[:1], order, len(lines))
        figure.suptitle(heading(dataset, step, "Contact pressure"))
    return figure


def homogeneous_words(dataset: Results) -> str:
    """Text about the body of the closed form in a contact of inhomogeneous bodies; empty without a closed form."""
    if "homogeneous_pressure" not in dataset:
        return ""
    return "homogeneous body" if "residual_displacement_z" in dataset else "bare substrate"


def relative_difference(pressure: NDArray[Any], reference: NDArray[Any]) -> tuple[float, float]:
    """Relative difference from the reference: root of the summed squares over all cells, and of the maxima."""
    size, peak = float(np.linalg.norm(reference)), float(np.max(reference))
    if size == 0 or peak == 0:
        return float("nan"), float("nan")
    return float(np.linalg.norm(pressure - reference)) / size, abs(float(np.max(pressure)) - peak) / peak


def _difference_words(pressure: NDArray[Any], reference: NDArray[Any], view: Box) -> str:
    """Label of the closed form with its relative difference from the pressure; both are zero outside the view."""
    in_norm, peak = relative_difference(pressure[view.slices], reference[view.slices])
    if not np.isfinite(in_norm):
        return "closed form"
    return f"closed form (relative difference: {100 * in_norm:.2g} % in the L2 norm, {100 * peak:.2g} % at the maximum)"


def several_exposed(dataset: Results, step: int = -1) -> bool:
    """Whether more than one material is at the surface in a step."""
    return "exposed_material" in dataset and float(np.ptp(dataset["exposed_material"][step].values)) > 0


def exposed_map(dataset: Results, step: int = -1) -> Figure:
    """Materials at the surface that the contact of a step met, by name, and the outline of that contact."""
    from matplotlib.colors import ListedColormap, to_rgb
    from matplotlib.patches import Patch

    materials = np.asarray(dataset["exposed_material"][step].values).astype(int)
    contact = np.asarray(dataset["pressure"][step].values) > 0
    numbers, names = np.unique(materials), json.loads(dataset.attrs["exposed_materials"])
    pale = [_PALE + (1 - _PALE) * np.array(to_rgb(COLOURS[n % len(COLOURS)])) for n in range(numbers.size)]
    window = contact_window(dataset, contact)
    with paper_style():
        figure, axes, _ = window.axes_of_map(bar=False)
        axes.imshow(
            np.searchsorted(numbers, materials)[window.view.slices],
            origin="lower",
            extent=window.extent,
            cmap=ListedColormap(pale),
            vmin=-0.5,
            vmax=numbers.size - 0.5,
        )
        window.label(axes)
        window.outline(axes, contact[window.view.slices])
        axes.set_title(f"Exposed materials{instant(dataset, step)}")
        entries = [Patch(color=colour, label=names[n]) for colour, n in zip(pale, numbers, strict=True)]
        figure.legend(handles=entries, loc="outside lower center", ncols=4)
    return figure


def cause(dataset: Results) -> str:
    """Cause of the surface displacement without tractions, as text: inclusions of another material, or eigenstrain."""
    if any(str(name).startswith("plastic_strain_") for name in dataset):
        return "plastic strain"
    return "the inclusions" if "inclusion_residual" in dataset else "eigenstrain"


def uplift_map(dataset: Results, step: int = -1) -> Figure:
    """Uplift of the surface by eigenstrain or inclusions, out of the body, with their outlines from above.

    The whole window; a cross at the largest value (in magnitude).
    """
    uplift = _uplift(dataset, step)
    window = Window(dataset, Box(0, uplift.shape[0], 0, uplift.shape[1]))
    row, column = _largest(uplift)
    peak = float(uplift[row, column])
    subject = f"{'Subsidence' if peak < 0 else 'Uplift'} of the surface by {cause(dataset)}"
    title = f"{heading(dataset, step, subject)}\nup to {scale_for(uplift, 'm').text(abs(peak))} (cross)"
    figure = masked_map(
        window,
        uplift,
        unit="m",
        label="Displacement out of the body",
        title=with_error(title, dataset, "residual_displacement_z", step),
        outline=np.zeros(uplift.shape, dtype=bool),
        empty="zero everywhere",
        masked=False,
        colours=lift_colours(float(uplift.min()), float(uplift.max())),
    )
    axes = figure.axes[0]
    draw_outline_below(axes, dataset, window.length)
    at = (float(dataset["x"][column]), float(dataset["y"][row]))
    draw_cross(axes, tuple(window.length(at)), (8, 2.4), (7, 1.1))
    return figure


def displacement_profiles(dataset: Results, step: int = -1) -> Figure:
    """Uplift and in-plane displacement along x and along y.

    The lines pass through the middle of the contact, whose ends are faint lines. Without a contact, or with one in
    patches, they pass through the largest uplift (in magnitude), or through the middle of the window when the uplift is
    symmetric about it.

    One panel along x, one along y; only one where the other direction has a single cell.
    """
    uplift = _uplift(dataset, step)
    pressure = np.asarray(dataset["pressure"][step].values) if "pressure" in dataset else np.zeros_like(uplift)
    row, column, central = contact_middle(pressure)
    if not (central and pressure.any()):
        (row, column), central = _middle(uplift), False
    values = {"z": uplift}
    for component in "x" if is_line(dataset) else "xy":
        name = f"residual_displacement_{component}"
        if name in dataset:
            values[component] = np.asarray(dataset[name][step].values, dtype=float)
    lines = lines_through(dataset, (row, column), central=central)
    if set(values) == {"z"}:
        lines = drawn_once(dataset, lines, [uplift, pressure])
    rise = scale_for(np.stack([field[lines[0].where] for field in values.values()]), "m")
    with paper_style():
        figure = line_figure(len(lines), 2.9)
        panels = figure.subplots(1, len(lines), sharey=True, squeeze=False)[0]
        for axes, line in zip(panels, lines, strict=True):
            length = scale_for(line.at, "m")
            for n, (component, field) in enumerate(values.items()):
                style = {"color": COLOURS[n], "linestyle": _STYLES[component], "linewidth": 1.6 if n == 0 else 1.2}
                axes.plot(length(line.at), rise(field[line.where]), label=_NAMES[component], **style)
                errors = errors_of(dataset, f"residual_displacement_{component}", step)
                if errors is not None:
                    draw_band(axes, length(line.at), field[line.where], errors[line.where], rise, COLOURS[n])
            axes.axhline(0.0, color="0.6", linewidth=0.6, zorder=0)
            axes.margins(x=0)
            line.finish(axes, length, pressure)
        panels[0].set_ylabel(f"Displacement [{rise.unit}]")
        legend_of_panels(figure, panels[:1], [*_NAMES.values(), BAND].index)
        figure.suptitle(heading(dataset, step, f"Surface displacement by {cause(dataset)}"))
    return figure


def _uplift(dataset: Results, step: int) -> NDArray[Any]:
    return -np.asarray(dataset["residual_displacement_z"][step].values, dtype=float) + 0.0


def _middle(uplift: NDArray[Any]) -> tuple[int, int]:
    """Row and column of the profiles."""
    tolerance = 1e-6 * float(np.abs(uplift).max())
    if all(np.allclose(uplift, np.flip(uplift, axis), rtol=0, atol=tolerance) for axis in (0, 1)):
        return uplift.shape[0] // 2, uplift.shape[1] // 2
    return _largest(uplift)


def _largest(uplift: NDArray[Any]) -> tuple[int, int]:
    """Row and column of the largest magnitude; of several equal ones, the one nearest the middle of the window."""
    size = np.abs(uplift)
    rows, columns = np.nonzero(size >= (1.0 - 1e-9) * size.max())
    middle = [(n - 1) / 2 for n in uplift.shape]
    best = int(np.argmin((rows - middle[0]) ** 2 + (columns - middle[1]) ** 2))
    return int(rows[best]), int(columns[best])
