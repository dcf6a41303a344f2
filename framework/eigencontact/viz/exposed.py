"""Map of the materials at the surface."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import numpy as np

from eigencontact.viz.style import COLOURS, instant, paper_style
from eigencontact.viz.window import contact_window

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from eigencontact.results.stored import Results

__all__ = ["exposed_map", "several_exposed"]

#: How much of white is mixed into the colours of materials.
_PALE = 0.55


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
