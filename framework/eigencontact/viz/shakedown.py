"""Map of shakedown and ratchetting in the cells of a body."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact.core.shakedown import STATES
from eigencontact.viz.lines import contact_runs, draw_contact_above
from eigencontact.viz.style import label_plane, paper_style, place, plane_figure, scale_for

if TYPE_CHECKING:
    from collections.abc import Mapping

    import xarray
    from matplotlib.figure import Figure

    from eigencontact.results.stored import Results

__all__ = ["shakedown_map"]

#: Colours of the states, which the colour-blind can tell apart.
_COLOURS = ("#f0f0f0", "#56b4e9", "#e69f00", "#b2182b")


def shakedown_map(results: Results, answer: xarray.Dataset, summary: Mapping[str, Any]) -> Figure:
    """Draw the state of each cell on the section normal to y through the largest increment in the cycle.

    Parameters
    ----------
    results : Results
        Whose last step gives the contact above the section.
    answer, summary : Dataset, mapping
        Of `eigencontact.shakedown`.
    """
    from matplotlib.colors import ListedColormap
    from matplotlib.patches import Patch

    states, size = np.asarray(answer["state"].values), np.asarray(answer["growth"].values)
    size = np.where(states == states.max(), 1.0 + size / (size.max() or 1.0), 0.0)  # the largest of the worst state
    middles = {axis: np.asarray(answer[axis].values, dtype=float) for axis in "zyx"}
    row = int(np.unravel_index(int(size.argmax()), size.shape)[1])
    edges = {axis: _edges(middles[axis]) for axis in "zx"}
    length = scale_for([*edges["z"], *edges["x"]], "m")
    with paper_style():
        figure, axes, _ = plane_figure(float(np.ptp(edges["x"])), float(np.ptp(edges["z"])))
        axes.pcolormesh(
            length(edges["x"]), length(edges["z"]), states[:, row], cmap=ListedColormap(_COLOURS), vmin=-0.5, vmax=3.5
        )
        axes.set_aspect("equal")
        axes.set_xlim(length(edges["x"][[0, -1]]))
        axes.set_ylim(length(edges["z"][[-1, 0]]))
        at = float(middles["y"][row])
        draw_contact_above(axes, contact_runs(results, -1, "y", at), length)
        label_plane(axes, f"x [{length.unit}]", f"z [{length.unit}]")
        present = [number for number in range(len(STATES)) if np.any(states[:, row] == number)]
        patches = [Patch(facecolor=_COLOURS[n], edgecolor="0.4", label=STATES[n]) for n in present]
        axes.legend(handles=patches, loc="upper center", bbox_to_anchor=(0.5, -0.22), ncols=2, frameon=False)
        steps = summary["steps"]
        words = f"body {summary['body']}, steps {steps[0]} to {steps[-1]}: {summary['state']}"
        axes.set_title(f"{words}\n{place('y', at)}")
    return figure


def _edges(middles: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    """Edges of cells of one size [m]; a single layer begins at the surface."""
    half = 0.5 * (middles[1] - middles[0]) if middles.size > 1 else abs(middles[0])
    return np.append(middles - half, middles[-1] + half)
