"""Studies of a coated sphere that wears as it slides over a rigid flat."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from eigencontact.viz.style import new_figure
from eigencontact_verification.studies.plastic import BIG
from eigencontact_verification.studies.study import Finished, Row, Study, Variant, every
from eigencontact_verification.studies.wear import (
    COATINGS,
    SECTION,
    draw_course,
    draw_profile,
    draw_sections,
    label,
    legend_below,
    numbers,
    scene_of,
)

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

    from eigencontact.scene.schema import Scene

__all__ = ["STUDIES"]

#: Largest depths [m] at which profiles and sections are drawn; the last is reached after some 1000 cycles.
_DEPTHS = (0.0, 0.5e-6, 1.0e-6, 1.8e-6)
_DASHES = (":", "-.", "--", "-")


def _scene(values: Mapping[str, float], *, coarse: bool) -> Scene:
    """A thousand metres; a step of wear each 25."""
    wear = ["wear.cycles-per-update=200" if coarse else "wear.cycles-per-update=25"]
    return scene_of("wear-gross-sliding", values, [*wear, f"grid.cells={25 if coarse else 65}"], stress=[])


def _scene_with_section(values: Mapping[str, float], *, coarse: bool) -> Scene:
    wear = ["wear.cycles-per-update=250" if coarse else "wear.cycles-per-update=50"]
    cells = [f"grid.cells={25 if coarse else 65}"]
    return scene_of("wear-gross-sliding", values, [*wear, *cells, "wear.body=2"], stress=[SECTION])


def _read(_variant: Variant, dataset: xr.Dataset) -> Row:
    last = dataset.isel(step=-1)
    flat = (4.0 * BIG.sphere_radius * float(last["worn_volume"]) / np.pi) ** 0.25  # radius of the flat end, rigid
    return {
        **numbers(dataset),
        "V of a cycle": 1e18 * float(last["worn_volume"]) / float(last["cycles"]),
        "depth / a^2/2R": float(last["max_worn_depth"]) * 2.0 * BIG.sphere_radius / flat**2,
    }


def _at_depths(dataset: xr.Dataset) -> list[int]:
    """Steps nearest to the depths."""
    return [int(np.abs(dataset["max_worn_depth"].values - depth).argmin()) for depth in _DEPTHS]


def _draw(found: Sequence[Finished]) -> Figure:
    figure = new_figure(9.6, 5.6)
    panels = figure.subplots(2, 3)
    for axes, what in zip(panels.flat, ("volume", "depth", "pressure", "area"), strict=False):
        draw_course(axes, found, what)
    worn, pressed = panels[1, 1], panels[1, 2]
    for n, item in enumerate(found):
        for step, dash in zip(_at_depths(item.dataset), _DASHES, strict=True):
            draw_profile(worn, item, step, "worn_depth", 1e6, n, dash)
            draw_profile(pressed, item, step, "pressure", 1.0 / BIG.peak, n, dash)
    worn.set(title="worn depth [µm] at 0, 0.5, 1, 1.8 µm")
    worn.invert_yaxis()
    pressed.set(title="pressure $/p_0$ at the same depths", ylim=(0, None))
    legend_below(panels[0, 0])
    return figure


def _draw_sections(found: Sequence[Finished]) -> Figure:
    datasets, titles = [], []
    for item in found:
        for step in _at_depths(item.dataset):
            data = item.dataset.isel(step=slice(step, step + 1))
            datasets.append(data)
            titles.append(f"{item.variant.label}, {1e6 * float(data['max_worn_depth'][0]):.2g} µm")
    figure = new_figure(10.6, 1.75 * len(found) + 0.4)
    panels = figure.subplots(len(found), len(_DEPTHS), squeeze=False)
    draw_sections(list(panels.flat), datasets, titles)
    return figure


_REMARK = (
    "The volume of a cycle is α μ P times its path whatever the coating; pressures and areas of the coatings come "
    "together. The text's depth of 2 µm is a tenth of a0, not twice it. The sphere is kept as a half-space whose "
    "surface stays flat: the gap grows by the worn depth, and the coating thins by it."
)

STUDIES = (
    Study(
        name="wear-sliding",
        title="Coated sphere that wears in sliding: volume, depth, pressure and area over cycles, and profiles",
        repeats="thesis figures 4.31 to 4.36 (cases WR-1 to WR-3)",
        scene=_scene,
        label=label,
        rows=every({"E₁/E₂": COATINGS}),
        coarse=every({"E₁/E₂": (0.5, 2.0)}),
        read=_read,
        draw=_draw,
        remark=_REMARK,
    ),
    Study(
        name="wear-sliding-stress",
        title="Von Mises stress below a coated sphere that wears in sliding",
        repeats="thesis figures 4.37 and 4.38 (case WR-4)",
        scene=_scene_with_section,
        label=label,
        rows=every({"E₁/E₂": COATINGS}),
        coarse=every({"E₁/E₂": (0.5, 2.0)}),
        read=_read,
        draw=_draw_sections,
        remark="The text's steps of 0.05 µm disturb the edge (figure 4.38): an explicit step must stay below 0.9 times "
        "the edge of a cell times p/E*, 57 nm at a/20. Steps here are implicit in the pressure, and of any size. "
        "The other body wears here, so that the coating stays as thick: the contact is the same to 0.4 %.",
    ),
)
