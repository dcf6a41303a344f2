"""Study of the cells of a yielding body: plastic strain through heavy cycles on cells of several heights."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from eigencontact.viz.style import new_figure
from eigencontact_verification.studies.plastic import BIG, draw_field, loading, plastic_scene, strain_section
from eigencontact_verification.studies.study import Finished, Row, Study, Variant, every

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

    from eigencontact.scene.schema import Scene

__all__ = ["STUDIES"]


def _scene(values: Mapping[str, float], *, coarse: bool) -> Scene:
    """Loaded and unloaded several times, far beyond yield."""
    cells, rounds = (4, 1) if coarse else (10, 3)
    steps = [step for _ in range(rounds) for step in (*loading(2 if coarse else 4), {"normal_load": 0.0})]
    scene = plastic_scene({"μ": 0.0, "p0/Sy": 3.0}, steps, cells=cells)
    pitch = values["dz/dx"] * BIG.radius / cells
    return scene.model_copy(update={"numerics": scene.numerics.model_copy(update={"inclusion_pitch": pitch})})


def _read(_variant: Variant, dataset: xr.Dataset) -> Row:
    strain = dataset["equivalent_plastic_strain_1"].values[-1]
    total = float(strain.sum())
    row = {"largest plastic strain": float(strain.max()), "print [m]": float(dataset["max_sink"][-1])}
    for name, axes in (("z", (0,)), ("x and z", (0, 2)), ("x, y and z", (0, 1, 2))):
        sign = sum(np.indices(strain.shape)[axis] for axis in axes) % 2 * 2 - 1
        row[f"part that alternates along {name}"] = abs(float((sign * strain).sum())) / total
    return row


def _draw(found: Sequence[Finished]) -> Figure:
    figure = new_figure(2.7 * len(found) + 1.2, 2.5)
    panels = figure.subplots(1, len(found), sharey=True, squeeze=False)[0]
    top = 100.0 * max(item["largest plastic strain"] for item in found)
    for axes, item in zip(panels, found, strict=True):
        field = strain_section(item.dataset, int(item.dataset["step"][-1]))
        assert field is not None
        shown = (*field[:2], 100.0 * field[2])
        image = draw_field(axes, shown, np.linspace(0.0, top, 13), item.variant.label, "viridis")
        axes.set_xlabel("$x/a$")
    panels[0].set_ylabel("$z/a$")
    figure.colorbar(image, ax=panels, shrink=0.9).set_label("plastic strain [%]")
    return figure


STUDIES = (
    Study(
        name="plastic-cells",
        title="Plastic strain after heavy cycles on cells of several heights: is there noise from cell to cell?",
        repeats="thesis figure 2.28 (case EP-6)",
        scene=_scene,
        label="dz = {dz/dx:g} dx".format_map,
        rows=every({"dz/dx": (2.0, 1.0, 0.5)}),
        coarse=every({"dz/dx": (1.0, 0.5)}),
        read=_read,
        draw=_draw,
        remark="The published noise on cubes does not appear: cells are loaded by means over them, not by middles.",
    ),
)
