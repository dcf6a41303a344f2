"""Pictures of what eigenstrain and inclusions do to the surface: uplift as a map, displacement along two lines.

Colours are the same in every picture: red where the surface is lifted out of the body, blue where it sinks, white where
it stays.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact.viz.contact_edge import draw_contact_ends, runs_of
from eigencontact.viz.fitting import legend_below
from eigencontact.viz.outline import draw_outline_below
from eigencontact.viz.style import (
    COLOURS,
    box_size,
    heading,
    label_plane,
    lift_colours,
    new_figure,
    paper_style,
    scale_for,
)
from eigencontact.viz.window import alike, cell_edges, contact_middle, line_words

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from eigencontact.results.stored import Results

__all__ = ["cause", "displacement_profiles", "uplift_map"]

_NAMES = {"z": "uplift $-u_z$", "x": "$u_x$", "y": "$u_y$"}
_STYLES = {"z": "-", "x": "--", "y": ":"}


def cause(dataset: Results) -> str:
    """Cause of the surface displacement without tractions, as text: inclusions of another material, or eigenstrain."""
    if any(str(name).startswith("plastic_strain_") for name in dataset):
        return "plastic strain"
    return "the inclusions" if "inclusion_residual" in dataset else "eigenstrain"


def uplift_map(dataset: Results, step: int = -1) -> Figure:
    """Uplift of the surface by eigenstrain or inclusions, out of the body, with their outlines from above.

    The whole window; a cross at the largest value (in magnitude).
    """
    uplift, x, y = _uplift(dataset, step)
    dx, dy = (float(edge) for edge in np.atleast_1d(dataset.attrs["cell_size"]))
    extent = (x[0] - 0.5 * dx, x[-1] + 0.5 * dx, y[0] - 0.5 * dy, y[-1] + 0.5 * dy)
    length, rise = scale_for(extent, "m"), scale_for(uplift, "m")
    width, height = box_size(extent[1] - extent[0], extent[3] - extent[2])
    with paper_style():
        wide = width > 2.2 * height
        figure = new_figure(width + (0.8 if wide else 1.6), height + (1.5 if wide else 0.7))
        axes = figure.add_subplot()
        colours, low, high = lift_colours(float(uplift.min()), float(uplift.max()))
        image = axes.imshow(
            rise(uplift),
            origin="lower",
            extent=tuple(length(extent)),
            interpolation="bilinear",
            cmap=colours,
            vmin=low * rise.factor,
            vmax=high * rise.factor,
        )
        draw_outline_below(axes, dataset, length)
        label_plane(axes, f"x [{length.unit}]", f"y [{length.unit}]")
        row, column = _largest(uplift)
        peak = float(uplift[row, column])
        subject = f"{'Subsidence' if peak < 0 else 'Uplift'} of the surface by {cause(dataset)}"
        axes.set_title(f"{heading(dataset, step, subject)}\nup to {rise.text(abs(peak))} (cross)")
        axes.plot(length(x[column]), length(y[row]), "+", color="black", markersize=8, markeredgewidth=2.4)
        axes.plot(length(x[column]), length(y[row]), "+", color="white", markersize=7, markeredgewidth=1.1)
        bar = figure.colorbar(
            image,
            ax=axes,
            location="bottom" if wide else "right",
            shrink=0.6 if wide else 1.0,
            aspect=30 if wide else 22,
            pad=0.03,
        )
        bar.set_label(f"Displacement out of the body [{rise.unit}]")
    return figure


def displacement_profiles(dataset: Results, step: int = -1) -> Figure:
    """Uplift and in-plane displacement along x and along y.

    The lines pass through the middle of the contact, whose ends are faint lines. Without a contact, or with one in
    patches, they pass through the largest uplift (in magnitude), or through the middle of the window when the uplift is
    symmetric about it.

    One panel along x, one along y; only one where the other direction has a single cell.
    """
    uplift, x, y = _uplift(dataset, step)
    pressure = np.asarray(dataset["pressure"][step].values) if "pressure" in dataset else np.zeros_like(uplift)
    row, column, central = contact_middle(pressure)
    if not (central and pressure.any()):
        (row, column), central = _middle(uplift), False
    values = {"z": uplift}
    edge = dict(zip("xy", np.atleast_1d(dataset.attrs["cell_size"]).tolist(), strict=True))
    for component in "xy":
        name = f"residual_displacement_{component}"
        if name in dataset:
            values[component] = np.asarray(dataset[name][step].values, dtype=float)
    panels: list[tuple[str, str, NDArray[Any], tuple[Any, Any]]] = [
        ("x", line_words("x", "y", y[row], central=central, cell=edge["y"]), x, (row, slice(None))),
        ("y", line_words("y", "x", x[column], central=central, cell=edge["x"]), y, (slice(None), column)),
    ]
    panels = [panel for panel in panels if panel[2].size > 1] or panels[:1]
    if set(values) == {"z"} and alike(dataset, [uplift, pressure], [panel[3] for panel in panels]):
        panels = [("x", f"{panels[0][1]}, the same along y", *panels[0][2:])]
    rise = scale_for(np.stack([field[where] for field in values.values() for *_, where in panels[:1]]), "m")
    with paper_style():
        figure = new_figure(3.3 * len(panels) + (0.3 if len(panels) > 1 else 1.2), 2.9)
        all_axes = figure.subplots(1, len(panels), sharey=True, squeeze=False)[0]
        for axes, (along, line_title, at, where) in zip(all_axes, panels, strict=True):
            length = scale_for(at, "m")
            for n, (component, field) in enumerate(values.items()):
                style = {"color": COLOURS[n], "linestyle": _STYLES[component], "linewidth": 1.6 if n == 0 else 1.2}
                axes.plot(length(at), rise(field[where]), label=_NAMES[component], **style)
            axes.axhline(0.0, color="0.6", linewidth=0.6, zorder=0)
            axes.set_xlabel(f"{along} [{length.unit}]")
            axes.margins(x=0)
            axes.set_title(line_title)
            edges = cell_edges(at, dataset, "xy".index(along))
            draw_contact_ends(axes, runs_of(pressure[where] != 0, edges), length)
        all_axes[0].set_ylabel(f"Displacement [{rise.unit}]")
        handles, labels = all_axes[0].get_legend_handles_labels()
        legend_below(figure, handles, labels, len(labels))
        figure.suptitle(heading(dataset, step, f"Surface displacement by {cause(dataset)}"))
    return figure


def _uplift(dataset: Results, step: int) -> tuple[NDArray[Any], NDArray[Any], NDArray[Any]]:
    lifted = -np.asarray(dataset["residual_displacement_z"][step].values, dtype=float)
    x, y = (np.asarray(dataset[axis].values, dtype=float) for axis in "xy")
    return lifted + 0.0, x, y


def _middle(uplift: NDArray[Any]) -> tuple[int, int]:
    """Row and column of the profiles."""
    tolerance = 1e-6 * float(np.abs(uplift).max())
    if all(np.allclose(uplift, np.flip(uplift, axis), rtol=0, atol=tolerance) for axis in (0, 1)):
        return uplift.shape[0] // 2, uplift.shape[1] // 2
    return _largest(uplift)


def _largest(uplift: NDArray[Any]) -> tuple[int, int]:
    """Row and column of the largest magnitude; of several alike, the one nearest the middle of the window."""
    size = np.abs(uplift)
    rows, columns = np.nonzero(size >= (1.0 - 1e-9) * size.max())
    middle = [(n - 1) / 2 for n in uplift.shape]
    best = int(np.argmin((rows - middle[0]) ** 2 + (columns - middle[1]) ** 2))
    return int(rows[best]), int(columns[best])
