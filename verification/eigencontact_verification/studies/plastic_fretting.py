"""Study of a sphere pulled to and fro on a body that yields (fretting mode I)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from eigencontact.viz.style import COLOURS, new_figure
from eigencontact_verification.studies.plastic import BIG, draw_field, line_of, loading, plastic_scene, strain_section
from eigencontact_verification.studies.study import Finished, Row, Study, Variant, every

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

    from eigencontact.scene.schema import Scene

__all__ = ["STUDIES"]

#: Tangential load, as a part of what friction carries.
_SHARE = 0.5


def _scene(values: Mapping[str, float], *, coarse: bool) -> Scene:
    """Pressed; pulled to B; pushed as far the other way, and pulled again to C."""
    pull, count = _SHARE * values["μ"] * BIG.load, 1 if coarse else 5
    ends = ((pull, count), (-pull, 2 * count), (pull, 2 * count))
    steps = [*loading(3 if coarse else 12), *({"tangential_load_x": end, "increments": n} for end, n in ends)]
    given = {**values, "p0/Sy": 2.0}
    return plastic_scene(given, steps, cells=4 if coarse else 12, output={"history": "all"})


def _turns(dataset: xr.Dataset) -> tuple[int, int, int]:
    """Positions along ``step``: pressed, pulled the first time (B), after the cycle (C)."""
    end = np.flatnonzero(np.isclose(dataset["time"].values % 1.0, 0.0, rtol=0.0, atol=1e-9))
    return int(end[-4]), int(end[-3]), int(end[-1])


def _read(_variant: Variant, dataset: xr.Dataset) -> Row:
    row = {}
    for name, at in zip("ABC", _turns(dataset), strict=True):
        now = dataset.isel(step=at)
        row[f"{name}: largest plastic strain"] = float(now["plastic_zone_max_strain"])
        row[f"{name}: plastic volume / a^3"] = float(now["plastic_zone_volume"]) / BIG.radius**3
        row[f"{name}: stick radius / contact radius"] = float(now["stick_radius_ratio"])
    return row


def _draw(found: Sequence[Finished]) -> Figure:
    figure = new_figure(2.5 * len(found) + 1.3, 8.6)
    panels = figure.subplots(5, len(found), squeeze=False)
    top = max(100.0 * item["C: largest plastic strain"] for item in found)
    for column, item in enumerate(found):
        data = item.dataset
        pressed, pulled, cycled = _turns(data)
        for row, (name, at) in enumerate((("B", pulled), ("C", cycled))):
            field = strain_section(data, int(data["step"][at]))
            shown = None if field is None else (*field[:2], 100 * field[2])
            title = rf"$\mu$ = {item['μ']:g}, point {name}"
            image = draw_field(panels[row, column], shown, np.linspace(0.0, top, 13), title, "viridis")
        tractions = panels[2, column]
        for n, at in enumerate((pressed, (pressed + pulled + 1) // 2, pulled)):
            now = data.isel(step=at)
            share = float(now["tangential_load_x"]) / (item["μ"] * BIG.load)
            for quantity, dash in (("pressure", "-"), ("shear_x", "--")):
                x, values = line_of(now, quantity)
                label = f"{abs(share):.2f}" if dash == "-" else None
                tractions.plot(x, values / BIG.peak, dash, color=COLOURS[n], label=label)
        tractions.set(title="tractions $/p_0$", xlim=(-1.3, 1.3))
        tractions.axhline(0.0, color="0.6", linewidth=0.6)
        for row, (axis, what) in enumerate((("x", "$u_x$ [nm]"), ("z", "$u_z$ [nm]")), 3):
            for n, (name, at) in enumerate((("A", pressed), ("B", pulled), ("C", cycled))):
                x, u = line_of(data.isel(step=at), f"residual_displacement_{axis}")
                panels[row, column].plot(x, 1e9 * u, color=COLOURS[n], linestyle=("-", "--", ":")[n], label=name)
            panels[row, column].set(title=what, xlim=(-2, 2))
        panels[4, column].invert_yaxis()
        panels[4, column].set_xlabel("$x/a$")
    panels[2, -1].legend(title=r"$Q/\mu P$", fontsize=7, title_fontsize=7)
    panels[3, -1].legend(fontsize=7)
    figure.colorbar(image, ax=panels[:2], shrink=0.8, aspect=24).set_label("equivalent plastic strain [%]")
    return figure


STUDIES = (
    Study(
        name="plastic-fretting",
        title="Sphere pulled to and fro beyond yield: plastic strain, tractions and print after a pull and a cycle",
        repeats="thesis figures 2.44 to 2.48 (case EP-4)",
        scene=_scene,
        label="μ = {μ:g}".format_map,
        rows=every({"μ": (0.05, 0.1, 0.2, 0.3, 0.5)}),
        coarse=every({"μ": (0.1, 0.5)}),
        read=_read,
        draw=_draw,
        remark="Below μ = 0.3 the pull adds next to no plastic strain; from 0.3 on it does so at the surface.",
    ),
)
