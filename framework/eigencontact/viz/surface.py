"""Pictures of the surface: the pressure as a map and along two lines, materials at the surface."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact.viz.lines import contact_middle, drawn_once, legend_of_panels, line_figure, lines_through
from eigencontact.viz.outline import draw_outline_below
from eigencontact.viz.style import COLOURS, heading, instant, paper_style, scale_for
from eigencontact.viz.window import contact_window, masked_map, view_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from eigencontact.core.grid import Box
    from eigencontact.results.stored import Results
    from eigencontact.viz.frame import Frame

__all__ = [
    "exposed_map",
    "homogeneous_words",
    "pressure_map",
    "pressure_profiles",
    "relative_difference",
    "several_exposed",
]

#: With more cells than this along a profile, only some carry a marker.
MARKERS = 64
#: How much of white is mixed into the colours of materials.
_PALE = 0.55


def pressure_map(dataset: Results, step: int = -1, on: Frame | None = None) -> Figure:
    """Contact pressure of one step as a map, cut to the contact and some room around it.

    Cells without pressure are grey; the outline of the contact is drawn where it is not ragged, those of inclusions
    below it are dashed.
    """
    pressure = np.asarray(dataset["pressure"][step].values, dtype=float)
    window = contact_window(dataset, pressure != 0 if on is None else on.film.touched("pressure"))
    figure = masked_map(
        window,
        pressure,
        unit="Pa",
        label="Pressure",
        title=heading(dataset, step, "Contact pressure"),
        outline=pressure != 0,
        empty="no contact",
        limits=None if on is None else on.film.limits("pressure"),
        on=on,
    )
    draw_outline_below(figure.axes[0], dataset, window.length)
    return figure


def pressure_profiles(dataset: Results, step: int = -1) -> Figure:
    """Contact pressure of one step along x and along y, beside the closed form where the run has one.

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
            line.finish(axes, length, pressure)
            axes.set_xlim(*length(line.edges[[0, -1]]))
        low = min(0.0, float(pressure.min()))
        high = max(0.0, *(float(field.max()) for field in fields)) or 1.0 / stress.factor
        panels[0].set_ylim(stress(low - 0.025 * (high - low)), stress(high + 0.06 * (high - low)))
        panels[0].set_ylabel(f"Pressure [{stress.unit}]")
        legend_of_panels(figure, panels[:1], lambda label: label != labels["computed"], len(lines))
        figure.suptitle(heading(dataset, step, "Contact pressure"))
    return figure


def homogeneous_words(dataset: Results) -> str:
    """Body that the closed form beside a contact of inhomogeneous bodies describes; empty without a closed form."""
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

    found = np.asarray(dataset["exposed_material"][step].values).astype(int)
    contact = np.asarray(dataset["pressure"][step].values) > 0
    numbers, names = np.unique(found), json.loads(dataset.attrs["exposed_materials"])
    pale = [_PALE + (1 - _PALE) * np.array(to_rgb(COLOURS[n % len(COLOURS)])) for n in range(numbers.size)]
    window = contact_window(dataset, contact)
    with paper_style():
        figure, axes, _ = window.axes_of_map(bar=False)
        axes.imshow(
            np.searchsorted(numbers, found)[window.view.slices],
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
