"""Pictures of what eigenstrain and inclusions do to the surface: uplift as a map, displacement along two lines.

Colours are the same in every picture: red where the surface is lifted out of the body, blue where it sinks, white where
it stays.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact.core.grid import Box
from eigencontact.viz.lines import contact_middle, drawn_once, legend_of_panels, line_figure, lines_through
from eigencontact.viz.outline import draw_outline_below
from eigencontact.viz.style import COLOURS, draw_cross, heading, lift_colours, paper_style, scale_for
from eigencontact.viz.window import Window, masked_map

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
    uplift = _uplift(dataset, step)
    window = Window(dataset, Box(0, uplift.shape[0], 0, uplift.shape[1]))
    row, column = _largest(uplift)
    peak = float(uplift[row, column])
    subject = f"{'Subsidence' if peak < 0 else 'Uplift'} of the surface by {cause(dataset)}"
    figure = masked_map(
        window,
        uplift,
        unit="m",
        label="Displacement out of the body",
        title=f"{heading(dataset, step, subject)}\nup to {scale_for(uplift, 'm').text(abs(peak))} (cross)",
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
    for component in "xy":
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
            axes.axhline(0.0, color="0.6", linewidth=0.6, zorder=0)
            axes.margins(x=0)
            line.finish(axes, length, pressure)
        panels[0].set_ylabel(f"Displacement [{rise.unit}]")
        legend_of_panels(figure, panels[:1], list(_NAMES.values()).index)
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
    """Row and column of the largest magnitude; of several alike, the one nearest the middle of the window."""
    size = np.abs(uplift)
    rows, columns = np.nonzero(size >= (1.0 - 1e-9) * size.max())
    middle = [(n - 1) / 2 for n in uplift.shape]
    best = int(np.argmin((rows - middle[0]) ** 2 + (columns - middle[1]) ** 2))
    return int(rows[best]), int(columns[best])
