"""Ends of the contact: marks on profiles and above sections."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact.viz.window import cell_edges, draw_contact_outline

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from eigencontact.results.stored import Results
    from eigencontact.viz.style import Scale

__all__ = ["contact_runs", "draw_contact_above", "draw_contact_ends", "draw_contact_from_above", "runs_of"]

#: With more runs than this the ends of the contact are a comb that hides the curve.
MOST_ENDS = 4


def runs_of(touched: NDArray[np.bool_], edges: NDArray[Any]) -> NDArray[np.float64]:
    """Ends (n, 2) of the runs of cells that are touched, given the edges of all cells."""
    padded = np.concatenate([[False], touched, [False]])
    begins, ends = (np.flatnonzero(padded[1:] & ~padded[:-1]), np.flatnonzero(~padded[1:] & padded[:-1]))
    return np.stack([edges[begins], edges[ends]], axis=1)


def contact_runs(dataset: Results, step: int, normal: str, at: float) -> NDArray[np.float64]:
    """Ends (n, 2) [m] of the contact along the line in which a plane normal to x or y cuts the surface.

    None where the plane passes beside the window. The contact is that of the row or column of cells that holds the
    place, so its ends lie on edges of cells.
    """
    if "pressure" not in dataset or normal not in ("x", "y"):
        return np.empty((0, 2))
    along = "y" if normal == "x" else "x"
    across, places = (np.asarray(dataset[axis].values, dtype=float) for axis in (normal, along))
    rows = cell_edges(across, dataset, "xy".index(normal))
    if not rows[0] <= at <= rows[-1]:
        return np.empty((0, 2))
    line = int(np.abs(across - at).argmin())
    where = (slice(None), line) if normal == "x" else (line, slice(None))
    touched = np.asarray(dataset["pressure"][step].values)[where] != 0
    return runs_of(touched, cell_edges(places, dataset, "xy".index(along)))


def draw_contact_above(axes: Axes, runs: NDArray[np.float64], length: Scale) -> None:
    """Bar along the upper edge of a section over every run of the contact."""
    for ends in runs:
        axes.plot(
            length(ends), [1.0, 1.0], transform=axes.get_xaxis_transform(), color="black", linewidth=3.2,
            solid_capstyle="butt", clip_on=False, zorder=7, scalex=False, scaley=False, label="_contact",
        )  # fmt: skip


def draw_contact_ends(axes: Axes, runs: NDArray[np.float64], length: Scale) -> None:
    """Faint line at both ends of every run of the contact, unless they are many."""
    if len(runs) > MOST_ENDS:
        return
    for at in np.unique(runs):
        axes.axvline(float(length(at)), color="0.55", linewidth=0.6, linestyle=(0, (2, 2)), zorder=0, label="_contact")


def draw_contact_from_above(axes: Axes, dataset: Results, step: int, length: Scale) -> None:
    """Outline of the contact over a section along the surface, faint, unless it is ragged."""
    touched = np.asarray(dataset["pressure"][step].values) != 0
    x, y = (cell_edges(np.asarray(dataset[axis].values, dtype=float), dataset, n) for n, axis in enumerate("xy"))
    draw_contact_outline(axes, touched, length(x), length(y), faint=True)
